import { Raycaster, Vector3 } from "three";
import type { Box3 } from "three";
import type { Components } from "../model/components";
import type { Signal } from "../ui/signal";
import { h } from "../ui/dom";
import { format } from "./values";
import type { World } from "../world/world";

/** A robot nearer than this to the end of the ground is told of, m. */
const NEAR = 1.5;
/** Robots higher than this over the ground fly, m. */
const FLYING = 2;
/** Walls are not so wide in both directions, m. */
const LARGE = 5;
/** Floors begin at one height, m; what begins higher stands on them: houses, trees. */
const SAME = 1;
/** Height over the robot's origin at which walls are looked for, and how far beyond the end of the ground, m. */
const BUMPER = 0.35;
const BEYOND = 0.5;
/** Milliseconds between two looks at the robots. */
const PAUSE = 500;

/** Says in words where the world ends, when a robot comes near, or has fallen off. */
export class WorldEnd {
  readonly element = h("p", { class: "notice world-end", role: "status", hidden: true });
  private ground: Box3 | null = null;
  private readonly place = new Vector3();

  constructor(
    private readonly world: Signal<World | null>,
    private readonly components: Components,
  ) {
    world.watch((now) => (this.ground = now && groundOf(now)));
    setInterval(() => this.look(), PAUSE);
  }

  private look(): void {
    const world = this.world.value;
    const texts: string[] = [];
    if (world && this.ground && world.description.view.water === null) {
      for (const { name, kind } of this.components.all.value) {
        const node = kind === "robot" ? world.find(name) : null;
        const text = node && this.tell(name, node.frame.getWorldPosition(this.place), this.ground);
        if (text) texts.push(text);
      }
    }
    this.element.hidden = texts.length === 0;
    const shown = texts.slice(0, 3).join("\n");
    if (this.element.textContent !== shown) this.element.textContent = shown;
  }

  private tell(name: string, { x, y, z }: Vector3, { min, max }: Box3): string | null {
    const sides: [number, string, Vector3][] = [
      [x - min.x, `x = ${format(min.x)} m`, new Vector3(-1, 0, 0)],
      [max.x - x, `x = ${format(max.x)} m`, new Vector3(1, 0, 0)],
      [y - min.y, `y = ${format(min.y)} m`, new Vector3(0, -1, 0)],
      [max.y - y, `y = ${format(max.y)} m`, new Vector3(0, 1, 0)],
    ];
    const [distance, where, outwards] = sides.reduce((a, b) => (b[0] < a[0] ? b : a));
    if (distance < 0 && z < min.z) return `${name} has fallen off: the ground of this world ends at ${where}. Undo its move, or start again (F11).`;
    if (distance >= NEAR || z > max.z + FLYING) return null;
    if (distance >= 0 && this.world.value?.isWalled(new Raycaster(new Vector3(x, y, z + BUMPER), outwards, 0, distance + BEYOND))) return null;
    return distance < 0 ? `${name} is beyond the ground, which ends at ${where}.` : `The ground ends at ${where}: beyond it, ${name} falls.`;
  }
}

/** The box around what robots can stand on; null without such objects. */
function groundOf(world: World): Box3 | null {
  const boxes = world.nodes
    .filter((node) => !node.moves && node.description.shapes.length > 0)
    .map((node) => world.boxOf([node]))
    .filter((box) => Math.min(box.max.x - box.min.x, box.max.y - box.min.y) > LARGE);
  const lowest = Math.min(...boxes.map(({ min }) => min.z));
  const floors = boxes.filter(({ min }) => min.z < lowest + SAME);
  return floors.length > 0 ? floors.reduce((all, box) => all.union(box)) : null;
}
