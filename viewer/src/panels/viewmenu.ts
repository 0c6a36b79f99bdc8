import type { Layers } from "../layers/layers";
import type { Components } from "../model/components";
import { isCamera } from "../model/components";
import { h } from "../ui/dom";
import { icons } from "../ui/icons";
import { closeWhenLeft } from "../ui/popup";
import type { Signal } from "../ui/signal";
import type { Follow, FollowMode, Preset } from "../view/follow";
import type { Stage } from "../view/stage";
import type { WorldNode } from "../world/node";

const MODES: [FollowMode, string, string][] = [
  ["free", "free", "0"],
  ["along", "along", "4"],
  ["third", "behind", "1"],
  ["first", "on board", "2"],
  ["top", "from above", "3"],
];
const SIDES: [Preset, string][] = [
  ["front", "front"],
  ["side", "side"],
  ["top", "top"],
  ["corner", "corner"],
];

/** The viewpoint and the overlays. */
export class ViewMenu {
  readonly element: HTMLDetailsElement;
  private readonly modes = new Map<FollowMode, HTMLButtonElement>();

  constructor(
    private readonly stage: Stage,
    private readonly follow: Follow,
    private readonly components: Components,
    layers: Layers,
    pictures: HTMLElement,
    ruler: Signal<boolean>,
  ) {
    const summary = h("summary", { title: "view", "aria-label": "view" });
    summary.innerHTML = icons.eye;
    const modes = MODES.map(([mode, label, key]) => {
      const button = h("button", { type: "button", title: key, onclick: () => this.start(mode) }, label);
      this.modes.set(mode, button);
      return button;
    });
    const sides = SIDES.map(([preset, label]) => h("button", { type: "button", onclick: () => this.look(preset) }, label));
    const plan = h("button", { type: "button", title: "5", onclick: () => follow.plan() }, "plan");
    const measure = h("button", { type: "button", title: "B", onclick: () => this.measure(ruler) }, "ruler");
    ruler.watch((on) => measure.setAttribute("aria-pressed", String(on)));
    const popup = h(
      "div",
      { class: "popup" },
      h("fieldset", {}, h("legend", {}, "follow"), h("div", { class: "choice" }, ...modes)),
      h("fieldset", {}, h("legend", {}, "look from"), h("div", { class: "choice" }, ...sides, plan)),
      h("fieldset", {}, h("legend", {}, "measure"), h("div", { class: "choice" }, measure)),
      layers.element,
      pictures,
    );
    this.element = h("details", { class: "menu" }, summary, popup);
    follow.mode.watch((now) => this.modes.forEach((button, mode) => button.setAttribute("aria-pressed", String(mode === now))));
    const { element } = this;
    closeWhenLeft([element], summary, () => element.open, () => (element.open = false));
  }

  /** Follow the selected object, or a robot if none is selected. */
  start(mode: FollowMode): void {
    const mounted = mode === "first" ? this.mounted() : null;
    const node = mounted ?? this.node();
    const component = this.components.find(mounted?.name ?? null);
    if (mode === "free" || !node) this.follow.release();
    else this.follow.start(mode, node, component !== null && component !== undefined && isCamera(component));
  }

  /** The menu makes room for the points to click. */
  private measure(ruler: Signal<boolean>): void {
    ruler.set(!ruler.value);
    this.element.open = false;
  }

  look(preset: Preset): void {
    const node = this.node();
    this.follow.release();
    if (node) this.follow.frameNode(node, preset);
  }

  /** The selected sensor or actuator, which has a view of its own. */
  private mounted(): WorldNode | null {
    const node = this.stage.world?.find(this.components.selected.value ?? "") ?? null;
    return node && ["sensor", "actuator"].includes(node.description.kind) ? node : null;
  }

  private node(): WorldNode | null {
    const { world } = this.stage;
    const selected = this.components.selected.value;
    const robot = this.components.robotOf(selected);
    return (
      world?.find(robot ?? selected ?? "") ?? world?.nodes.find(({ description }) => description.kind.includes("robot")) ?? world?.nodes[0] ?? null
    );
  }
}
