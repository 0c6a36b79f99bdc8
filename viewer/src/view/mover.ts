import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, MathUtils, Object3D, Plane, Quaternion, Vector3 } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { Connection } from "../connection/connection";
import { h } from "../ui/dom";
import { Signal } from "../ui/signal";
import type { WorldNode } from "../world/node";
import type { World } from "../world/world";
import { pick, pickPlane } from "./pick";
import type { Stage } from "./stage";

const EVERY = 60; // ms between two messages

/** Steps of the handles while they snap: m, rad, and part of the size. */
const STEPS = { translate: 0.1, rotate: MathUtils.degToRad(15), scale: 0.1 };

export type Mode = keyof typeof STEPS;

/** A movement, or a part of it. */
export interface Movement {
  node: WorldNode;
  position: Vector3;
  quaternion: Quaternion;
  /** whether it begins the movement of this node */
  first: boolean;
  /** that of all nodes that move together */
  group: number;
}

/** Whether a node is a sensor or an actuator. */
const isMounted = ({ description }: WorldNode): boolean => ["sensor", "actuator"].includes(description.kind);

/** The number of changes that are undone together. */
export const newGroup = (): number => 1 + Math.floor(Math.random() * (2 ** 52));

/** Moves objects: handles set the pose; dragging the object itself applies a force while time runs. */
export class Mover {
  readonly node = new Signal<WorldNode | null>(null);
  /** whether time advances: dragging then applies a force */
  running: () => boolean = () => false;
  readonly mode = new Signal<Mode>("translate");
  /** whether the handles move in steps */
  readonly snaps = new Signal(false);
  /** what the handles do */
  readonly element = h("div", { class: "tools mover", role: "toolbar", "aria-label": "move", hidden: true });
  /** nodes that move with it, and their poses relative to it when the movement began */
  private others: { node: WorldNode; position: Vector3; quaternion: Quaternion }[] = [];
  private group = 0;
  private readonly handles: TransformControls;
  private readonly proxy = new Object3D();
  private readonly cord: Line;
  private readonly plane = new Plane();
  private held: { node: WorldNode; anchor: Vector3; target: Vector3; grip: Vector3 } | null = null;
  private last = 0;
  /** whether the next pose begins a movement */
  private begins = true;

  constructor(
    private readonly stage: Stage,
    private readonly connection: Connection,
    private readonly teleport: (movement: Movement) => void,
    private readonly scale: (nodes: WorldNode[], factors: [number, number, number], group: number) => void,
  ) {
    const canvas = stage.renderer.domElement;
    this.handles = new TransformControls(stage.view.camera, canvas);
    this.handles.setSize(0.8);
    this.handles.addEventListener("change", stage.invalidate);
    this.handles.addEventListener("mouseDown", () => this.begin());
    this.handles.addEventListener("objectChange", () => this.mode.value !== "scale" && this.put());
    this.handles.addEventListener("mouseUp", () => (this.mode.value === "scale" ? this.resize() : this.put(true)));
    this.fillTools();
    stage.scene.add(this.proxy, this.handles.getHelper());
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(6), 3));
    this.cord = new Line(geometry, new LineBasicMaterial({ color: 0xd12fae, depthTest: false, toneMapped: false }));
    this.cord.visible = this.cord.frustumCulled = false;
    this.cord.raycast = () => {};
    this.cord.renderOrder = 4;
    stage.scene.add(this.cord);
    stage.onDraw(() => this.update());
    canvas.addEventListener("pointermove", (event) => this.pull(event));
    addEventListener("pointerup", () => this.letGo());
    addEventListener("blur", () => this.letGo());
  }

  /** Attach the handles to a node, or detach them. */
  toggle(node: WorldNode | null, others: WorldNode[] = []): void {
    // a component moves on what carries it, a part of an object with the object
    const free = (one: WorldNode): WorldNode => (isMounted(one) ? one : (one.find(({ description }) => description.frame === "world") ?? one));
    const mover = node && free(node);
    this.node.set(mover === this.node.value ? null : mover);
    const rest = new Set(this.node.value ? others.map(free).filter((one) => one !== mover) : []);
    this.others = [...rest].map((one) => ({ node: one, position: new Vector3(), quaternion: new Quaternion() }));
    this.element.hidden = this.node.value === null;
    if (this.node.value) this.handles.attach(this.proxy);
    else this.handles.detach();
    this.stage.invalidate();
  }

  /** The world was described again: the handles go on with the nodes of the same names. */
  rebind(world: World): void {
    if (!this.node.value) return;
    const node = world.find(this.node.value.name);
    this.others = this.others.flatMap((other) => {
      const again = world.find(other.node.name);
      return again ? [{ ...other, node: again }] : [];
    });
    const held = this.held && world.find(this.held.node.name);
    if (this.held) this.held = held ? { ...this.held, node: held } : null;
    if (node) this.node.set(node);
    else this.toggle(null);
  }

  /** Switch the handles between translation, rotation and size. */
  turn(): void {
    const modes = Object.keys(STEPS) as Mode[];
    this.mode.set(modes[(modes.indexOf(this.mode.value) + 1) % modes.length] as Mode);
  }

  private fillTools(): void {
    const button = (label: string, title: string, run: () => void): HTMLButtonElement => h("button", { type: "button", title, onclick: run }, label);
    const names: [Mode, string][] = [["translate", "move"], ["rotate", "turn"], ["scale", "scale"]];
    const modes = names.map(([mode, label]) => ({ mode, made: button(label, `${label} (N: the next one)`, () => this.mode.set(mode)) }));
    const snap = button("snap", "Steps of 0.1 m, 15° and a tenth (G)", () => this.snaps.set(!this.snaps.value));
    this.element.append(...modes.map(({ made }) => made), snap);
    this.mode.watch((now) => {
      for (const { mode, made } of modes) made.setAttribute("aria-pressed", String(mode === now));
      this.handles.setMode(now);
      this.stage.invalidate();
    });
    this.snaps.watch((on) => {
      snap.setAttribute("aria-pressed", String(on));
      this.handles.setTranslationSnap(on ? STEPS.translate : null);
      this.handles.setRotationSnap(on ? STEPS.rotate : null);
      this.handles.setScaleSnap(on ? STEPS.scale : null);
    });
  }

  /** A movement begins: the others keep their poses relative to the one with the handles. */
  private begin(): void {
    this.begins = true;
    this.group = newGroup();
    const back = this.proxy.quaternion.clone().invert();
    for (const { node, position, quaternion } of this.others) {
      node.frame.getWorldPosition(position).sub(this.proxy.position).applyQuaternion(back);
      node.frame.getWorldQuaternion(quaternion).premultiply(back);
    }
  }

  private resize(): void {
    const node = this.node.value;
    const { x, y, z } = this.proxy.scale;
    this.proxy.scale.set(1, 1, 1);
    const least = (factor: number): number => Math.max(Math.abs(factor), 0.01);
    if (node && (x !== 1 || y !== 1 || z !== 1)) this.scale([node, ...this.others.map((one) => one.node)], [least(x), least(y), least(z)], newGroup());
  }

  /** A press of the mouse: handled here if it hits a handle or the object itself. */
  claims(event: PointerEvent): boolean {
    const node = this.node.value;
    if (!node || event.button !== 0 || event.ctrlKey || event.shiftKey) return false;
    if (this.handles.axis !== null) return true;
    const hit = pick(this.stage, event.clientX, event.clientY);
    const own = hit && [node, ...this.others.map((one) => one.node)].find((one) => hit.node.find((part) => part === one));
    if (!hit || !own) return false;
    this.begin();
    this.plane.setFromNormalAndCoplanarPoint(this.stage.view.ahead.negate(), hit.point);
    const anchor = own.frame.worldToLocal(hit.point.clone());
    this.held = { node: own, anchor, target: hit.point.clone(), grip: hit.point.clone().sub(this.proxy.position) };
    return true;
  }

  private pull(event: PointerEvent): void {
    if (!this.held) return;
    const target = pickPlane(this.stage, event.clientX, event.clientY, this.plane);
    if (!target) return;
    this.held.target.copy(target);
    this.stage.invalidate();
    if (!this.pulls()) {
      this.proxy.position.copy(target).sub(this.held.grip);
      if (this.snaps.value) this.proxy.position.divideScalar(STEPS.translate).round().multiplyScalar(STEPS.translate);
      this.put();
    } else if (this.due()) this.tell();
  }

  private tell(): void {
    if (!this.held) return;
    const { node, anchor, target } = this.held;
    this.connection.send({ type: "drag", node: node.name, anchor: anchor.toArray(), target: target.toArray() });
  }

  private letGo(): void {
    if (!this.held) return;
    if (this.pulls()) this.connection.send({ type: "drag_end" });
    else this.put(true);
    this.held = null;
    this.cord.visible = false;
    this.stage.invalidate();
  }

  private put(now = false): void {
    const node = this.node.value;
    if (!node || !(now || this.due())) return;
    const { position, quaternion } = this.proxy;
    const { begins: first, group } = this;
    this.teleport({ node, position: position.clone(), quaternion: quaternion.clone(), first, group });
    for (const other of this.others) {
      const place = other.position.clone().applyQuaternion(quaternion).add(position);
      this.teleport({ node: other.node, position: place, quaternion: quaternion.clone().multiply(other.quaternion), first, group });
    }
    this.begins = false;
  }

  /** Whether a force is applied to what is held: while time runs, and not to a component. */
  private pulls(): boolean {
    return this.running() && !(this.held && isMounted(this.held.node));
  }

  private due(): boolean {
    const now = performance.now();
    if (now - this.last < EVERY) return false;
    this.last = now;
    return true;
  }

  private update(): void {
    const node = this.node.value;
    if (!node) return;
    if (!this.handles.dragging && !(this.held && !this.pulls())) {
      node.frame.getWorldPosition(this.proxy.position);
      node.frame.getWorldQuaternion(this.proxy.quaternion);
      this.proxy.updateMatrixWorld(true);
    }
    if (!this.held) return;
    const ends = this.cord.geometry.getAttribute("position") as BufferAttribute;
    const { anchor, target } = this.held;
    const start = node.frame.localToWorld(anchor.clone());
    ends.setXYZ(0, start.x, start.y, start.z);
    ends.setXYZ(1, target.x, target.y, target.z);
    ends.needsUpdate = true;
    this.cord.visible = this.pulls();
  }
}
