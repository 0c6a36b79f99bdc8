import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Points, PointsMaterial, Vector3 } from "three";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { Signal } from "../ui/signal";
import { pick } from "../view/pick";
import type { Stage } from "../view/stage";

const HINT = "Ruler: click two points of the world.";
const COLOR = 0xd12fae;

/** A point of an object, which it moves with. */
interface Mark {
  name: string;
  /** the point in the frame of the object, m */
  local: Vector3;
}

/** Measures the distance of two points that the user clicks, and the direction from the first to the second one. */
export class Ruler {
  readonly on = new Signal(false);
  readonly element: HTMLElement;
  private readonly text = h("span", {}, HINT);
  private readonly ends = new BufferAttribute(new Float32Array(6), 3);
  private readonly line: Line;
  private readonly dots: Points;
  private marks: Mark[] = [];

  constructor(private readonly stage: Stage) {
    this.element = h("div", { class: "ruler", hidden: true }, this.text, iconButton(icons.close, "End measuring", () => this.on.set(false), "B"));
    const geometry = new BufferGeometry().setAttribute("position", this.ends);
    this.line = new Line(geometry, new LineBasicMaterial({ color: COLOR, depthTest: false, toneMapped: false }));
    this.dots = new Points(geometry, new PointsMaterial({ color: COLOR, size: 9, sizeAttenuation: false, depthTest: false, toneMapped: false }));
    for (const drawn of [this.line, this.dots]) {
      drawn.visible = drawn.frustumCulled = false;
      drawn.raycast = () => {};
      drawn.renderOrder = 5;
      stage.scene.add(drawn);
    }
    stage.onDraw(() => this.update());
    this.on.watch((on) => {
      this.element.hidden = !on;
      this.marks = [];
      this.say(HINT);
      stage.invalidate();
    });
  }

  /** A click at a point of the page; returns whether the ruler takes it. */
  click(x: number, y: number): boolean {
    if (!this.on.value) return false;
    const hit = pick(this.stage, x, y);
    if (!hit) {
      this.marks = [];
      this.stage.invalidate();
      this.say("There is nothing at that point: click an object or the ground.");
      return true;
    }
    if (this.marks.length === 2) this.marks = [];
    this.marks.push({ name: hit.node.name, local: hit.node.frame.worldToLocal(hit.point.clone()) });
    if (this.marks.length === 1) this.say(`From ${hit.node.name}: click the second point.`);
    this.stage.invalidate();
    return true;
  }

  private update(): void {
    let points = this.marks.map(({ name, local }) => this.stage.world?.find(name)?.frame.localToWorld(local.clone()));
    if (points.includes(undefined)) {
      this.marks = points = []; // an object is no longer there
      this.say(HINT);
    }
    const [first, second = first] = points;
    this.dots.visible = first !== undefined && second !== undefined;
    this.line.visible = this.dots.visible && points.length === 2;
    if (!first || !second) return;
    first.toArray(this.ends.array, 0);
    second.toArray(this.ends.array, 3);
    this.ends.needsUpdate = true;
    if (points.length === 2) this.say(`${this.marks.map(({ name }) => name).join(" → ")}: ${measureOf(first, second)}`);
  }

  private say(text: string): void {
    if (this.text.textContent !== text) this.text.textContent = text;
  }
}

/** The way between two points, m; its direction from +X about +Z, and its rise above the horizontal, degrees. */
function measureOf(from: Vector3, to: Vector3): string {
  const way = to.clone().sub(from);
  const flat = Math.hypot(way.x, way.y);
  const text = (value: number, digits: number): string => (Number(value.toFixed(digits)) + 0).toFixed(digits); // no -0
  const degrees = (y: number, x: number): string => `${text((Math.atan2(y, x) * 180) / Math.PI, 1)}°`;
  const parts = [`${text(way.length(), 3)} m`, `x ${text(way.x, 3)}, y ${text(way.y, 3)}, z ${text(way.z, 3)} m`];
  if (flat > 1e-3) parts.push(`heading ${degrees(way.y, way.x)}`);
  if (way.length() > 1e-3) parts.push(`rise ${degrees(way.z, flat)}`);
  // lines break between the parts alone
  return parts.map((part) => part.replaceAll(" ", "\u00a0")).join(" · ");
}
