import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Object3D, Plane, Vector3 } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { Connection } from "../connection/connection";
import { Signal } from "../ui/signal";
import type { WorldNode } from "../world/node";
import { pick, pickPlane } from "./pick";
import type { Stage } from "./stage";

const EVERY = 60; // ms between two messages

/** Moves objects: handles set the pose; dragging the object itself applies a force while time runs. */
export class Mover {
  readonly node = new Signal<WorldNode | null>(null);
  /** whether time advances: dragging then applies a force */
  running: () => boolean = () => false;
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
    private readonly teleport: (node: WorldNode, proxy: Object3D, first: boolean) => void,
  ) {
    const canvas = stage.renderer.domElement;
    this.handles = new TransformControls(stage.view.camera, canvas);
    this.handles.setSize(0.8);
    this.handles.addEventListener("change", stage.invalidate);
    this.handles.addEventListener("mouseDown", () => (this.begins = true));
    this.handles.addEventListener("objectChange", () => this.put());
    this.handles.addEventListener("mouseUp", () => this.put(true));
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
  toggle(node: WorldNode | null): void {
    const mover = node?.find(({ description }) => description.frame === "world") ?? node;
    this.node.set(mover === this.node.value ? null : mover);
    if (this.node.value) this.handles.attach(this.proxy);
    else this.handles.detach();
    this.stage.invalidate();
  }

  /** Switch the handles between translation and rotation. */
  turn(): void {
    this.handles.setMode(this.handles.mode === "translate" ? "rotate" : "translate");
  }

  /** A press of the mouse: handled here if it hits a handle or the object itself. */
  claims(event: PointerEvent): boolean {
    const node = this.node.value;
    if (!node || event.button !== 0 || event.ctrlKey || event.shiftKey) return false;
    if (this.handles.axis !== null) return true;
    const hit = pick(this.stage, event.clientX, event.clientY);
    if (!hit || !hit.node.find((one) => one === node)) return false;
    this.begins = true;
    this.plane.setFromNormalAndCoplanarPoint(this.stage.view.ahead.negate(), hit.point);
    const anchor = node.frame.worldToLocal(hit.point.clone());
    this.held = { node, anchor, target: hit.point.clone(), grip: hit.point.clone().sub(this.proxy.position) };
    return true;
  }

  private pull(event: PointerEvent): void {
    if (!this.held) return;
    const target = pickPlane(this.stage, event.clientX, event.clientY, this.plane);
    if (!target) return;
    this.held.target.copy(target);
    this.stage.invalidate();
    if (!this.running()) {
      this.proxy.position.copy(target).sub(this.held.grip);
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
    if (this.running()) this.connection.send({ type: "drag_end" });
    else this.put(true);
    this.held = null;
    this.cord.visible = false;
    this.stage.invalidate();
  }

  private put(now = false): void {
    const node = this.node.value;
    if (!node || !(now || this.due())) return;
    this.teleport(node, this.proxy, this.begins);
    this.begins = false;
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
    if (!this.handles.dragging && !(this.held && !this.running())) {
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
    this.cord.visible = this.running();
  }
}
