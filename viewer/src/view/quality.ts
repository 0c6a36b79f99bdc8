export interface Level {
  /** most pixels of the card for one of the page */
  pixels: number;
  /** pixels along the side of the shadow map; 0 for no shadows */
  shadows: number;
}

const LEVELS: Level[] = [
  { pixels: 2, shadows: 4096 },
  { pixels: 1.5, shadows: 2048 },
  { pixels: 1, shadows: 1024 },
  { pixels: 0.75, shadows: 1024 },
  { pixels: 0.6, shadows: 512 },
];
const SLOW = 40; // ms a frame
const FRAMES = 12;

/** Draws as well as the machine can without getting slow. */
export class Quality {
  private level: number;
  private readonly fixed: boolean;
  private previous = 0;
  private times: number[] = [];

  constructor(
    { asked, software }: Means,
    private readonly apply: (level: Level) => void,
  ) {
    this.fixed = asked !== null;
    this.level = asked === "high" ? 0 : asked === "low" || software ? LEVELS.length - 1 : 1;
    this.use();
  }

  /** A frame was begun at that time; only frames that follow on each other tell how long one takes. */
  measure(began: number): void {
    const took = began - this.previous;
    this.previous = began;
    if (this.fixed || took > 1000) return;
    this.times.push(took);
    if (this.times.length < FRAMES) return;
    const median = this.times.sort((a, b) => a - b)[FRAMES >> 1] as number;
    this.times = [];
    if (median > SLOW && this.level < LEVELS.length - 1) {
      this.level += 1;
      this.use();
    }
  }

  private use(): void {
    this.apply(LEVELS[this.level] as Level);
  }
}

/** What the machine and the address of the page allow. */
export interface Means {
  /** "high" or "low", if the address says so */
  asked: string | null;
  /** the processor stands in for a graphics card */
  software: boolean;
  /** smooth edges: the processor would take twice as long */
  smooth: boolean;
}

const KEY = "morse.drawnBy";
const SOFTWARE = "software";

/** Found out before there is a canvas: whether its edges are smooth cannot be changed later. */
export function meansOfDrawing(): Means {
  const asked = new URLSearchParams(location.search).get("quality");
  const software = (localStorage.getItem(KEY) ?? probe()) === SOFTWARE;
  return { asked, software, smooth: asked === "high" || (asked !== "low" && !software) };
}

/** Keep what draws, so that the next page need not find out. */
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
