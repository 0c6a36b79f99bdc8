import type { Light, Object3D, Scene } from "three";
import { Color, DirectionalLight, HemisphereLight, PointLight, SpotLight, Vector3 } from "three";
import type { LightDescription, ViewDescription } from "../generated/protocol";
import type { WorldNode } from "./node";
import type { World } from "./world";

/** A white surface under perpendicular light of a lamp of energy 1 has its full colour. */
const FULL = Math.PI;
/** Graphics cards support a limited number of lights. */
const MOST_LAMPS = 8;
/** Half of the angle of an area lamp, radians: it lights everything in front of it, less and less to the sides. */
const AREA = 1.5;
/** Approximates a lamp that fades to half at its distance, over the relevant distances. */
const DECAY = 0.3;
/** With other lamps, which cast no shadows here, a sun is stronger, and lamps and sky are weaker: its shadows stay visible. */
const BESIDE = { sun: 1.5, lamps: 0.7, sky: 0.65 };
/** Radius around the viewpoint in which the sun casts shadows, metres. */
const SHADOWS = 22;
/** Width of the soft edge of a shadow, metres. */
const SOFT = 0.05;

/** Sun and sky, and the lamps of the world. */
export class Lights {
  private readonly sky = new HemisphereLight(0xffffff, 0x808080, 1);
  private readonly sun = new DirectionalLight(0xffffff, 1);
  private readonly lamps: Object3D[] = [];
  private readonly direction = new Vector3(0.45, -0.55, 0.75).normalize();
  private lit = false;
  /** whether the world has a sun and other lamps */
  private mixed = false;
  /** share of the light of the sun that clouds and fog scatter */
  private clouds = 0;
  private view: ViewDescription | null = null;

  constructor(scene: Scene) {
    this.sky.position.set(0, 0, 1);
    this.sun.castShadow = true;
    this.sun.shadow.bias = -0.0002;
    this.setShadowSize(2048);
    scene.add(this.sky, this.sun, this.sun.target);
  }

  get towardsSun(): Vector3 {
    return this.direction;
  }

  setShadowSize(pixels: number): void {
    this.sun.castShadow = pixels > 0;
    if (pixels === 0 || this.sun.shadow.mapSize.x === pixels) return;
    this.sun.shadow.mapSize.set(pixels, pixels);
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
  }

  /** Install the lamps of a world; a sun among them replaces the sun. Returns the names of lamps that are not shown. */
  install(world: World): string[] {
    const daylight = world.description.view.daylight;
    for (const lamp of this.lamps) lamp.removeFromParent();
    this.lamps.length = 0;
    const strongest = strongestFirst(world);
    let sunny = false;
    const isSun = ({ description }: WorldNode): boolean => description.light?.type === "SUN";
    this.mixed = strongest.some(isSun) && !strongest.every(isSun);
    for (const node of strongest.slice(0, MOST_LAMPS)) {
      const description = node.description.light as LightDescription;
      if (description.type === "SUN" && !sunny) {
        sunny = true;
        this.direction.set(0, 0, 1).transformDirection(node.frame.matrixWorld);
        this.sun.color.setRGB(...description.color);
        this.sun.userData["energy"] = description.energy;
      } else this.add(node.frame, makeLamp(description, this.mixed ? BESIDE.lamps : 1, daylight));
    }
    this.lit = strongest.length > 0;
    if (!sunny) {
      this.direction.set(0.45, -0.55, 0.75).normalize();
      this.sun.color.set(0xfff3e2);
      // lamps light the world: a weak sun remains, for shape and shadows
      this.sun.userData["energy"] = this.lit ? 0.35 : 0.95;
    }
    return strongest.slice(MOST_LAMPS).map((node) => node.name);
  }

  /** Cover the sun: shadows become weak, and the light comes from the whole sky. */
  cloud(share: number): void {
    this.clouds = share;
    this.paint(this.view);
  }

  paint(view: ViewDescription | null): void {
    this.view = view;
    const dim = view?.daylight ?? 1;
    this.sun.intensity = FULL * ((this.sun.userData["energy"] as number | undefined) ?? 0.95) * dim * 0.85 * (this.mixed ? BESIDE.sun : 1) * (1 - 0.75 * this.clouds);
    const ambient = view?.ambient_color;
    this.sky.color.set(0xdfeeff);
    this.sky.groundColor.set(0xb9aea0);
    if (ambient) this.sky.color.lerp(new Color().setRGB(...ambient), 0.5);
    this.sky.intensity = FULL * (this.lit ? 0.5 : 0.62) * dim * (this.mixed ? BESIDE.sky : 1);
  }

  /** Centre the shadows on a point; in steps, so that their edges do not flicker. */
  follow(target: Vector3, distance: number): void {
    const half = Math.min(SHADOWS * 3, Math.max(SHADOWS / 3, distance * 1.4));
    const size = 2 ** Math.ceil(Math.log2(half));
    const shadow = this.sun.shadow.camera;
    if (shadow.right !== size) {
      shadow.left = shadow.bottom = -size;
      shadow.right = shadow.top = size;
      shadow.near = 1;
      shadow.far = 8 * size + 60;
      shadow.updateProjectionMatrix();
    }
    // the coarser the map, the larger the offset that a surface needs
    const texel = (2 * size) / this.sun.shadow.mapSize.x;
    this.sun.shadow.radius = Math.min(4, Math.max(1, SOFT / texel));
    this.sun.shadow.normalBias = texel * 1.2 * this.sun.shadow.radius;
    const step = size / 8;
    const snapped = this.sun.target.position;
    snapped.set(Math.round(target.x / step) * step, Math.round(target.y / step) * step, Math.round(target.z / step) * step);
    this.sun.position.copy(snapped).addScaledVector(this.direction, 4 * size + 30);
  }

  private add(frame: Object3D, lamp: Light): void {
    frame.add(lamp);
    this.lamps.push(lamp);
    if (lamp instanceof SpotLight || lamp instanceof DirectionalLight) {
      lamp.position.set(0, 0, 0);
      lamp.target.position.set(0, 0, -1);
      frame.add(lamp.target);
      this.lamps.push(lamp.target);
    }
  }
}

/** The lamps by their light at the initial viewpoint: near lamps precede distant ones. */
function strongestFirst(world: World): WorldNode[] {
  const place = new Vector3(...world.description.view.camera_location);
  const lamp = new Vector3();
  const given = (node: WorldNode): number => {
    const { type, energy, distance } = node.description.light as LightDescription;
    if (type === "SUN" || type === "HEMI") return energy; // independent of the position
    return energy / (1 + lamp.setFromMatrixPosition(node.frame.matrixWorld).distanceToSquared(place) / Math.max(distance, 0.01) ** 2);
  };
  const lamps = world.nodes.filter((node) => node.description.light !== null).map((node): [WorldNode, number] => [node, given(node)]);
  return lamps.sort(([, a], [, b]) => b - a).map(([node]) => node);
}

/** A lamp; a sun and a sky shine with their share of the daylight. */
function makeLamp(description: LightDescription, share: number, daylight: number): Light {
  const color = new Color().setRGB(...description.color);
  const { energy, distance } = description;
  if (description.type === "SUN") return new DirectionalLight(color, FULL * energy * daylight);
  if (description.type === "HEMI") return new HemisphereLight(color, 0x404040, FULL * energy * 0.5 * daylight);
  const intensity = FULL * energy * 0.5 * share * distance ** DECAY;
  if (description.type === "AREA") return new SpotLight(color, intensity, 0, AREA, 1, DECAY);
  if (description.type !== "SPOT") return new PointLight(color, intensity, 0, DECAY);
  const spot = new SpotLight(color, intensity, 0, Math.min(description.spot_size / 2, 1.5), 0.3, DECAY);
  spot.castShadow = description.casts_shadow;
  spot.shadow.mapSize.set(1024, 1024);
  spot.shadow.bias = -0.0005;
  spot.shadow.normalBias = 0.03;
  spot.shadow.radius = 3;
  return spot;
}
