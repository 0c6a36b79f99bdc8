export interface Level {
  /** maximum device pixels per CSS pixel */
  pixels: number;
  /** side of the shadow map, pixels; 0 for no shadows */
  shadows: number;
}

const LEVELS: Level[] = [
  { pixels: 2, shadows: 4096 },
  { pixels: 1.5, shadows: 2048 },
  { pixels: 1, shadows: 1024 },
  { pixels: 0.75, shadows: 1024 },
  { pixels: 0.6, shadows: 512 },
];
const SLOW = 40; // ms per frame
const FRAMES = 12;
/** ms without a change after which the image is refined */
const STILL = 300;
/** maximum time to render a refined image, ms */
const PATIENCE = 1200;
/** maximum device pixels per CSS pixel in a refined image */
const FINEST = 2;

/** Renders as well as the machine can at an acceptable rate, and better when nothing moves. */
export class Quality {
  private level: number;
  private readonly fixed: boolean;
  private readonly mayRefine: boolean;
  private previous = 0;
  /** smoothed time of a frame, ms */
  private took: number;
  private refined = false;
  private times: number[] = [];
  private readonly software: boolean;

  constructor(
    { asked, software }: Means,
    private readonly apply: (level: Level) => void,
  ) {
    this.software = software;
    this.took = software ? 150 : 16;
    this.fixed = asked !== null;
    this.mayRefine = asked !== "low";
    this.level = asked === "high" ? 0 : asked === "low" || software ? LEVELS.length - 1 : 1;
    this.use();
  }

  /** A frame began at that time; only consecutive frames measure the time of a frame. */
  measure(began: number): void {
    const took = began - this.previous;
    this.previous = began;
    if (took > 1000) return;
    this.took = took;
    if (this.fixed) return;
    this.times.push(took);
    if (this.times.length < FRAMES) return;
    const median = this.times.sort((a, b) => a - b)[FRAMES >> 1] as number;
    this.times = [];
    if (median > SLOW && this.level < LEVELS.length - 1) {
      this.level += 1;
      this.use();
    }
  }

  /** An object moves: use the resolution for a high rate. */
  coarse(): void {
    if (!this.refined) return;
    this.refined = false;
    this.use();
  }

  /** Nothing has moved for a while: switch to a higher resolution if it is time; returns whether it was. */
  fine(): boolean {
    if (!this.mayRefine || this.refined || performance.now() - this.previous < STILL) return false;
    this.refined = true;
    const level = LEVELS[this.level] as Level;
    const usual = Math.min(devicePixelRatio, level.pixels);
    // the time grows with the number of pixels
    const affordable = usual * Math.sqrt((this.software ? PATIENCE / 4 : PATIENCE) / Math.max(this.took, 1));
    const pixels = Math.min((this.software ? 1 : FINEST) * devicePixelRatio, affordable, 4);
    if (pixels < 1.2 * usual) return false;
    this.apply({ pixels, shadows: level.shadows });
    return true;
  }

  private use(): void {
    const { pixels, shadows } = LEVELS[this.level] as Level;
    this.apply({ pixels: Math.min(devicePixelRatio, pixels), shadows });
  }
}

/** Options from the machine and the address of the page. */
export interface Means {
  /** "high" or "low", if the address contains it */
  asked: string | null;
  /** rendering without a graphics card */
  software: boolean;
  /** antialiasing: doubles the time in software */
  smooth: boolean;
  /** surfaces without gloss, and textures that blur at flat angles */
  matt: boolean;
}

const KEY = "morse.drawnBy";
const SOFTWARE = "software";

/** Determined before there is a canvas: antialiasing cannot be changed later. */
export function meansOfDrawing(): Means {
  const asked = new URLSearchParams(location.search).get("quality");
  const software = (localStorage.getItem(KEY) ?? probe()) === SOFTWARE;
  return { asked, software, smooth: asked === "high" || (asked !== "low" && !software), matt: software && asked !== "high" };
}

/** Store the renderer, so that the next page need not determine it. */
export function rememberMeans(context: Context): void {
  localStorage.setItem(KEY, drawnBy(context));
}

type Context = WebGLRenderingContext | WebGL2RenderingContext | null;

function probe(): string {
  const context = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("webgl2");
  const by = drawnBy(context);
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return by;
}

function drawnBy(context: Context): string {
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? String(context?.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  return /swiftshader|llvmpipe|software/i.test(name) ? SOFTWARE : "card";
}
