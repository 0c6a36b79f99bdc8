import { Euler, Quaternion, Vector3 } from "three";
import type { Connection } from "../connection/connection";
import type { Images } from "./images";
import type { Toasts } from "./toasts";
import { disable, h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import type { Follow } from "../view/follow";
import type { Movement } from "../view/mover";
import type { Stage } from "../view/stage";
import type { WorldNode } from "../world/node";
import type { World } from "../world/world";

/** The pose of the selected object, and its actions. */
export class ObjectPanel {
  private readonly place = h("td", { class: "value" });
  private readonly angles = h("td", { class: "value" });
  private node: WorldNode | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly follow: Follow,
    private readonly images: Images,
    private readonly toasts: Toasts,
    private readonly connection: Connection,
    private readonly onMove: (node: WorldNode) => void,
    private readonly onDelete: (node: WorldNode) => void,
    private readonly onDuplicate: (node: WorldNode) => void,
    private readonly drives: Signal<boolean>,
  ) {
    stage.onDrawn(() => this.update());
  }

  /** The panel for the object with that name, or nothing if it is not in the world. */
  show(name: string, camera: boolean): HTMLElement | null {
    this.node = this.stage.world?.find(name) ?? null;
    const node = this.node;
    if (!node) return null;
    this.update();
    const button = (icon: string, label: string, hint: string, run: () => void, keys = ""): HTMLButtonElement => {
      const made = iconButton(icon, hint, run, keys);
      made.append(h("span", { class: "caption" }, label));
      return made;
    };
    const owner = node.description.placed_by;
    /** One that changes the scene. */
    const change = (...parts: Parameters<typeof button>): HTMLButtonElement => {
      const made = button(...parts);
      disable(made, !this.drives.value);
      return made;
    };
    /** One that changes the scene, but not what a component places at each start. */
    const own = (...parts: Parameters<typeof button>): HTMLButtonElement => {
      const made = change(...parts);
      if (owner) {
        made.disabled = true;
        made.title = `it comes with ${owner}: only both together`;
      }
      return made;
    };
    return h(
      "div",
      { class: "object" },
      h(
        "table",
        { class: "data" },
        h("tr", {}, h("th", { scope: "row" }, "position"), this.place, h("td", { class: "unit" }, "m")),
        h("tr", { title: "roll, pitch, yaw" }, h("th", { scope: "row" }, "rotation"), this.angles, h("td", { class: "unit" }, "rad")),
      ),
      h(
        "div",
        { class: "tools captions" },
        button(icons.focus, "focus", "Focus", () => this.follow.frameNode(node), "C"),
        button(icons.eye, "follow", "Follow", () => this.follow.start("third", node)),
        change(icons.move, "move", "Move", () => this.onMove(node), "M"),
        own(icons.boxes, "duplicate", "Duplicate", () => this.onDuplicate(node), "Ctrl+D"),
        own(icons.bin, "delete", "Delete", () => this.onDelete(node), "Del"),
        button(icons.copy, "copy", "Copy the pose as builder code", () => void this.copy()),
        camera && button(icons.camera, "picture", "Show the picture of the camera", () => this.images.toggle(name), "V"),
      ),
      this.note(node),
    );
  }

  /** What a move of the object does not do, in words, before one tries; null if it does all. */
  private note(node: WorldNode): HTMLElement | null {
    const owner = node.description.placed_by;
    const places = this.stage.world?.nodes.some(({ description }) => description.placed_by === node.name) ?? false;
    if (!owner && !places) return null;
    const text = owner
      ? `${owner} puts it in its place, at the latest at each start: a move lasts until then, and is not saved.`
      : "What it puts in place follows a move at the next start (F11).";
    return h("p", { class: "quiet" }, text);
  }

  /** The world was described again: the object may be a new one with the same name. */
  rebind(world: World): void {
    this.node = world.find(this.node?.name ?? "");
  }

  /** The pose of a node as lines of a scene script. */
  code(node: WorldNode): string {
    const { position, angles } = poseOf(node);
    const variable = node.name.replace(/\W+/g, "_").replace(/^(?=\d)/, "_");
    const list = (numbers: number[]): string => numbers.map((number) => trim(number)).join(", ");
    return `${variable}.translate(${list(position)})\n${variable}.rotate(${list(angles)})\n`;
  }

  private async copy(): Promise<void> {
    if (!this.node) return;
    const code = this.code(this.node);
    try {
      await navigator.clipboard.writeText(code);
      this.toasts.show("The pose is on the clipboard.");
    } catch {
      // without a secure connection, browsers do not allow access to the clipboard
      this.toasts.show(code);
    }
  }

  private update(): void {
    if (!this.node || !this.place.isConnected) return;
    const { position, angles } = poseOf(this.node);
    this.place.textContent = position.map(millimetres).join(", ");
    this.angles.textContent = angles.map(millimetres).join(", ");
  }

  /** Set the pose of a node, as a client would; the first pose of a movement begins a new change of the scene. */
  async teleport({ node, position, quaternion: turn, first, group }: Movement): Promise<void> {
    const answer = await this.connection.request({
      type: "teleport",
      node: node.name,
      position: position.toArray(),
      quaternion: [turn.w, turn.x, turn.y, turn.z],
      first,
      group,
    });
    if (!answer.ok) this.toasts.show(answer.error, "error");
  }
}

function poseOf(node: WorldNode): { position: number[]; angles: number[] } {
  const position = node.frame.getWorldPosition(new Vector3()).toArray();
  const angles = new Euler().setFromQuaternion(node.frame.getWorldQuaternion(new Quaternion()), "ZYX");
  return { position, angles: [angles.x, angles.y, angles.z] };
}

/** To three decimals, without a negative zero. */
function millimetres(value: number): string {
  return (Math.round(value * 1000) / 1000 + 0).toFixed(3);
}

function trim(value: number): string {
  return String(Number(value.toFixed(4)));
}
