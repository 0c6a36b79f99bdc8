import { ACESFilmicToneMapping, PCFShadowMap, Scene, Vector3, WebGLRenderer } from "three";
import type { ViewDescription } from "../generated/protocol";
import { lookOf } from "../world/batches";
import { Ground } from "../world/ground";
import { Lights } from "../world/lights";
import { Sky } from "../world/sky";
import type { Surfaces, World } from "../world/world";
import { ViewCamera } from "./camera";
import { meansOfDrawing, Quality, rememberMeans } from "./quality";

/** Without a world, the empty ground is drawn after this many milliseconds: earlier, it would delay the world. */
const EMPTY_AFTER = 700;

/** The canvas: renders the world after every change. */
export class Stage {
  readonly scene = new Scene();
  readonly view = new ViewCamera();
  readonly renderer: WebGLRenderer;
  readonly ground: Ground;
  readonly lights: Lights;
  readonly sky: Sky;
  readonly quality: Quality;
  readonly surfaces: Surfaces;
  /** point at which the camera looks, approximately */
  readonly target = new Vector3();
  world: World | null = null;
  frames = 0;
  /** whether lines are drawn at every metre of the height 0 */
  grid = false;
  private stale = true;
  private empty = false;
  private readonly steps: ((seconds: number) => boolean)[] = [];
  private readonly before: (() => void)[] = [];
  private readonly drawn: (() => void)[] = [];

  constructor(readonly element: HTMLElement) {
    const means = meansOfDrawing();
    this.renderer = new WebGLRenderer({ antialias: means.smooth, powerPreference: "high-performance" });
    rememberMeans(this.renderer.getContext());
    this.surfaces = { anisotropy: means.matt ? 1 : Math.min(8, this.renderer.capabilities.getMaxAnisotropy()), matt: means.matt };
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.9;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.domElement.tabIndex = -1;
    element.append(this.renderer.domElement);
    this.ground = new Ground(this.scene);
    this.lights = new Lights(this.scene);
    this.sky = new Sky(this.scene);
    this.quality = new Quality(means, (level) => {
      this.renderer.setPixelRatio(level.pixels);
      this.lights.setShadowSize(level.shadows);
    });
    this.renderer.domElement.addEventListener("webglcontextrestored", this.invalidate);
    new ResizeObserver(() => this.resize()).observe(element);
    this.paint();
  }

  /** Something has changed: render a frame soon. */
  readonly invalidate = (): void => {
    this.stale = true;
  };

  /** Register a function to call before each frame; it returns whether it changed anything. */
  onStep(step: (seconds: number) => boolean): void {
    this.steps.push(step);
  }

  /** Register a function to call just before each frame, after the camera was moved. */
  onDraw(prepare: () => void): void {
    this.before.push(prepare);
  }

  onDrawn(done: () => void): void {
    this.drawn.push(done);
  }

  show(world: World): string[] {
    this.world?.dispose();
    this.world = world;
    this.scene.add(world.root);
    const dark = this.lights.install(world);
    this.paint();
    return dark;
  }

  /** The lamps of the world have changed. */
  relight(): void {
    if (this.world) this.lights.install(this.world);
    this.paint();
  }

  start(): void {
    let last = performance.now();
    setTimeout(() => (this.empty = true), EMPTY_AFTER);
    const frame = (): void => {
      requestAnimationFrame(frame);
      const now = performance.now();
      // a page that was suspended must not jump
      const seconds = Math.min((now - last) / 1000, 0.25);
      last = now;
      for (const step of this.steps) if (step(seconds)) this.stale = true;
      if (!this.world && !this.empty) return;
      if (this.stale) this.draw();
      else this.refine();
    };
    requestAnimationFrame(frame);
  }

  /** Render now. */
  draw(): void {
    this.stale = false;
    this.quality.coarse();
    const began = performance.now();
    this.render();
    this.frames += 1;
    this.quality.measure(began);
    for (const done of this.drawn) done();
  }

  /** Nothing moves: render the same frame once more with more pixels. */
  private refine(): void {
    if (this.quality.fine()) this.render();
  }

  private render(): void {
    this.view.update();
    for (const prepare of this.before) prepare();
    this.sky.at(this.view.position.z);
    // where a world has no floor, lines would look like one: only if somebody wants them
    this.ground.mesh.material.visible = this.world === null || this.grid;
    this.lights.follow(this.target, this.view.position.distanceTo(this.target));
    this.world?.sort(lookOf(this.view.camera, this.element.clientHeight * this.renderer.getPixelRatio()));
    this.renderer.render(this.scene, this.view.camera);
  }

  private paint(): void {
    const view: ViewDescription | null = this.world?.description.view ?? null;
    this.sky.paint(view, this.lights.towardsSun);
    this.lights.paint(view);
    this.invalidate();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.view.setAspect(width / height);
    if (this.world || this.empty) this.draw();
  }
}
