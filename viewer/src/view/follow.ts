import { Matrix4, Quaternion, Vector3 } from "three";
import { Signal } from "../ui/signal";
import type { WorldNode } from "../world/node";
import type { World } from "../world/world";
import type { CameraPose } from "./camera";
import { outlook, sightOf } from "./outlook";
import type { Stage } from "./stage";

export type FollowMode = "free" | "third" | "first" | "top" | "camera" | "along";

const PRESETS = {
  front: new Vector3(1, 0, 0.25),
  side: new Vector3(0, -1, 0.25),
  top: new Vector3(0, -0.001, 1),
  corner: new Vector3(-0.8, -0.8, 0.65),
};
/** share of the picture, from its middle, in which a followed node may be */
const WITHIN = 0.7;
/** A camera behind a wall comes so far in front of it, m, but not nearer than so many radii of the node. */
const BEFORE_WALLS = 0.2;
const NEAREST = 1.5;
/** Walls are looked for again when the line of sight has moved so far, m, and at most every so many ms. */
const MOVED = 0.05;
/** A plan shows at least so much, m, with a margin around what acts. */
const PLAN = 6;
const MARGIN = 1.3;
const PAUSE = 100;
/** The view from a component is so far before its origin, m: its own housing does not hide the world. */
const BEFORE_LENS = 0.12;
/** From the axes of the view, which looks along -Z with +Y up, to those of a component: X ahead and Z up; of a camera Z ahead and Y down. */
const OF_PART = new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(new Vector3(0, -1, 0), new Vector3(0, 0, 1), new Vector3(-1, 0, 0)));
const OF_CAMERA = new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(new Vector3(1, 0, 0), new Vector3(0, -1, 0), new Vector3(0, 0, -1)));
export type Preset = keyof typeof PRESETS;

/** Lets the camera follow a node, or moves it to a viewpoint. */
export class Follow {
  readonly mode = new Signal<FollowMode>("free");
  node: WorldNode | null = null;
  private home: CameraPose | null = null;
  private readonly homeOffset = new Vector3();
  /** the node that the viewpoint of the script moves with */
  private followed: WorldNode | null = null;
  private readonly place = new Vector3();
  private readonly turn = new Quaternion();
  /** from the followed node to the camera when it began to follow, m */
  private readonly offset = new Vector3();
  private settled = false;
  /** whether the node is a camera that a robot carries */
  private isCamera = false;
  /** where the camera would be without walls */
  private readonly wanted = new Vector3();
  /** the share of the way from the node to that place at which the camera is, and which it is to reach */
  private share = 1;
  private freeShare = 1;
  /** the line of sight for which walls were looked for, and when */
  private readonly sight = [new Vector3(Infinity), new Vector3()] as const;
  private looked = -Infinity;
  private lastRobot = -1;
  private lastCamera = -1;

  constructor(private readonly stage: Stage) {
    stage.onStep((seconds) => this.step(seconds));
  }

  /** The user moves the camera: stop following. */
  release(): void {
    this.mode.set("free");
  }

  start(mode: FollowMode, node: WorldNode, isCamera = false): void {
    this.node = node;
    this.isCamera = isCamera;
    this.offset.copy(this.stage.view.position).sub(node.frame.getWorldPosition(this.place));
    this.settled = false;
    this.sight[0].setScalar(Infinity);
    this.mode.set(mode);
    this.stage.invalidate();
  }

  /** The world was described again: follow the node of the same name. */
  rebind(world: World): void {
    if (this.followed) this.followed = world.find(this.followed.name);
    if (this.node) this.node = world.find(this.node.name);
    if (!this.node) this.release();
  }

  /** Use the present viewpoint as home, which moves along with a node if there is one. */
  setHome(followed: WorldNode | null = null): void {
    this.home = this.stage.view.pose;
    this.followed = followed;
    this.homeOffset.copy(this.stage.view.position);
    if (followed) this.homeOffset.sub(followed.frame.getWorldPosition(this.place));
  }

  /** Return to the viewpoint of the script. */
  goHome(): void {
    this.release();
    this.lastCamera = -1;
    if (this.home) this.stage.view.pose = this.home;
    if (this.followed) {
      this.start("along", this.followed);
      this.offset.copy(this.homeOffset);
    }
    this.stage.invalidate();
  }

  /** Go near the next robot and look at it. */
  nextRobot(): WorldNode | null {
    const robots = this.stage.world?.nodes.filter((node) => node.description.kind.includes("robot")) ?? [];
    if (robots.length === 0) return null;
    this.lastRobot = (this.lastRobot + 1) % robots.length;
    const robot = robots[this.lastRobot] as WorldNode;
    this.release();
    this.standNear(robot);
    return robot;
  }

  /** Look at a node from an unobstructed position. */
  private standNear(node: WorldNode): void {
    const { view, world, target } = this.stage;
    if (!world) return;
    const { center, radius } = world.boundsOf(node);
    view.position.copy(outlook(world, node, center, headingOf(node), this.distanceTo(radius)));
    view.lookAt(center);
    target.copy(center);
    this.stage.invalidate();
  }

  /** Distance at which an object of that radius fills the image, m. */
  private distanceTo(radius: number): number {
    return (Math.max(radius, 0.3) * 2.4) / Math.sin((Math.min(this.stage.view.camera.fov, 60) * Math.PI) / 360) / 1.6;
  }

  /** Look through the next camera of the world; after the last one, from the user's viewpoint. */
  nextCamera(): string {
    const cameras = this.stage.world?.nodes.filter((node) => node.description.camera !== null) ?? [];
    this.lastCamera += 1;
    const camera = cameras[this.lastCamera];
    if (!camera) {
      this.goHome();
      return "viewpoint";
    }
    this.start("camera", camera);
    return camera.name;
  }

  /** Show a node in the image, from the present direction or from a side of the node. */
  frameNode(node: WorldNode, preset: Preset | null = null): void {
    const { view, world, target } = this.stage;
    if (!world) return;
    const bounds = world.boundsOf(node);
    const way = preset ? PRESETS[preset].clone() : view.position.clone().sub(bounds.center);
    if (preset && preset !== "top") way.applyAxisAngle(new Vector3(0, 0, 1), headingOf(node));
    view.position.copy(bounds.center).addScaledVector(way.normalize(), this.distanceTo(bounds.radius));
    view.lookAt(bounds.center);
    target.copy(bounds.center);
    this.stage.invalidate();
  }

  /** Look straight down at all that moves or measures, +Y up; at the whole world if nothing does. */
  plan(): void {
    const { view, world, target } = this.stage;
    if (!world) return;
    this.release();
    const acting = world.nodes.filter((node) => node.moves || node.description.kind !== "");
    const box = world.boxOf(acting);
    if (box.isEmpty()) box.copy(world.boxOf(world.nodes));
    if (box.isEmpty()) return;
    const [center, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3())];
    const slope = Math.tan((view.camera.fov * Math.PI) / 360);
    const half = Math.max(size.y, size.x / view.camera.aspect, PLAN) / 2;
    view.pose = { position: [center.x, center.y, box.max.z + (half * MARGIN) / slope], yaw: Math.PI / 2, pitch: -Math.PI / 2, roll: 0 };
    target.copy(center);
    this.stage.invalidate();
  }

  private step(seconds: number): boolean {
    if (this.mode.value === "free" || !this.node || !this.stage.world) {
      this.aim();
      return false;
    }
    const { position, yaw, pitch } = this.stage.view.pose;
    const bounds = this.stage.world.boundsOf(this.node);
    const gain = this.settled ? 1 - Math.exp(-seconds * 8) : 1;
    this.node.frame.getWorldQuaternion(this.turn);
    this.node.frame.getWorldPosition(this.place);
    if (this.mode.value === "camera") this.through();
    else if (this.mode.value === "along") this.accompany(bounds.center, gain);
    else if (this.mode.value === "first") this.ride(bounds.radius);
    else this.chase(bounds.center, Math.max(bounds.radius, 0.3), gain);
    this.settled = true;
    this.stage.target.copy(bounds.center);
    const { view } = this.stage;
    return this.hasToLook(bounds.center) || view.position.distanceTo(new Vector3(...position)) > 1e-4 || Math.abs(view.yaw - yaw) + Math.abs(view.pitch - pitch) > 1e-5;
  }

  /** Without a followed node, shadows are centred on the ground ahead. */
  private aim(): void {
    const { view, target } = this.stage;
    const reach = view.ahead.z < -0.05 && view.position.z > 0 ? Math.min(-view.position.z / view.ahead.z, 60) : 12;
    target.copy(view.position).addScaledVector(view.ahead, Math.max(reach, 1));
  }

  /** Keep the direction, unless the node is outside of the picture, where it would stay. */
  private accompany(center: Vector3, gain: number): void {
    const { view } = this.stage;
    this.stand(center, this.place.clone().add(this.offset), gain);
    view.update();
    const { x, y, z } = center.clone().project(view.camera);
    if (Math.abs(x) > WITHIN || Math.abs(y) > WITHIN || z > 1) view.lookAt(center);
  }

  private through(): void {
    this.stage.view.position.copy(this.place);
    this.stage.view.setQuaternion(this.turn);
  }

  private ride(radius: number): void {
    if (["sensor", "actuator"].includes(this.node?.description.kind ?? "")) {
      this.turn.multiply(this.isCamera ? OF_CAMERA : OF_PART);
      this.stage.view.position.copy(this.place).addScaledVector(new Vector3(0, 0, -1).applyQuaternion(this.turn), BEFORE_LENS);
      this.stage.view.setQuaternion(this.turn);
      return;
    }
    const ahead = new Vector3(1, 0, 0).applyQuaternion(this.turn);
    const { view } = this.stage;
    view.position.copy(this.place).addScaledVector(ahead, radius * 0.6).add(new Vector3(0, 0, radius * 0.5));
    view.lookAt(view.position.clone().add(ahead));
  }

  private chase(center: Vector3, radius: number, gain: number): void {
    const { view } = this.stage;
    const way = this.mode.value === "top" ? new Vector3(-0.02, 0, 9) : new Vector3(-5.5, 0, 2.8);
    way.applyAxisAngle(new Vector3(0, 0, 1), headingOf(this.node as WorldNode)).multiplyScalar(radius).add(center);
    this.stand(center, way, gain);
    view.lookAt(center);
  }

  /** Move the camera toward a place, but not behind a wall that hides the node. */
  private stand(center: Vector3, place: Vector3, gain: number): void {
    const { view, world } = this.stage;
    if (!this.settled) this.wanted.copy(view.position);
    this.wanted.lerp(place, gain);
    if (world && this.node && this.hasToLook(center) && performance.now() - this.looked >= PAUSE) {
      const { radius } = world.boundsOf(this.node);
      const distance = this.wanted.distanceTo(center);
      const free = sightOf(world, this.node, center, radius, this.wanted);
      const nearest = Math.min(Math.max(free - BEFORE_WALLS, NEAREST * radius), distance);
      this.freeShare = free < distance ? nearest / distance : 1;
      this.sight[0].copy(center);
      this.sight[1].copy(this.wanted);
      this.looked = performance.now();
    }
    this.share += (this.freeShare - this.share) * (this.settled ? gain : 1);
    view.position.copy(center).lerp(this.wanted, this.share);
  }

  /** Whether walls have to be looked for, because the line of sight has moved. */
  private hasToLook(center: Vector3): boolean {
    if (this.mode.value === "camera" || this.mode.value === "first") return false;
    return !(this.sight[0].distanceTo(center) < MOVED && this.sight[1].distanceTo(this.wanted) < MOVED);
  }
}

/** Heading of a node about +Z, radians. */
function headingOf(node: WorldNode): number {
  const ahead = new Vector3(1, 0, 0).transformDirection(node.frame.matrixWorld);
  return Math.atan2(ahead.y, ahead.x);
}
