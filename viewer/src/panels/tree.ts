import type { Components } from "../model/components";
import type { ComponentDescription } from "../generated/protocol";
import { h, reveal } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import type { World } from "../world/world";

const ICONS: Record<string, string> = { robot: icons.robot, external_robot: icons.robot, sensor: icons.sensor, actuator: icons.actuator };
const OBJECTS = "objects";

interface Row {
  name: string;
  label: string;
  icon: string;
  level: number;
  /** rows that are folded with it */
  children: Row[];
}

/** Robots and their components, and the objects of the world. */
export class TreePanel {
  readonly element: HTMLElement;
  private readonly list = h("div", { role: "tree", class: "tree", "aria-label": "robots and components", "aria-multiselectable": "true", tabIndex: 0 });
  private readonly filter = h("input", { type: "search", placeholder: "find…", "aria-label": "find in the tree" });
  private readonly folded = new Set<string>([OBJECTS]);
  private rows: Row[] = [];

  constructor(
    private readonly components: Components,
    private readonly world: Signal<World | null>,
    private readonly onOpen: (name: string) => void,
    /** a component was clicked, not only reached by keys */
    private readonly onChosen: () => void,
  ) {
    this.element = h("section", { class: "panel tree-panel" }, this.filter, this.list);
    this.filter.addEventListener("input", () => this.render());
    this.list.addEventListener("keydown", (event) => this.key(event));
    components.all.watch(() => this.rebuild());
    world.watch(() => this.rebuild());
    components.selected.watch((name) => this.mark(name));
    components.also.watch(() => this.mark(components.selected.value));
    components.onChange(({ name }) => this.dress(name));
  }

  private rebuild(): void {
    const all = this.components.all.value;
    const robots = all.filter(({ kind }) => kind.includes("robot"));
    const row = (component: ComponentDescription, level: number): Row => ({
      name: component.name,
      label: component.robot && component.robot !== component.name ? component.name.slice(component.robot.length + 1) : component.name,
      icon: ICONS[component.kind] ?? icons.more,
      level,
      children: level === 1 ? all.filter((one) => one.robot === component.name && one !== component).map((one) => row(one, 2)) : [],
    });
    this.rows = robots.map((robot) => row(robot, 1));
    this.rows.push(...all.filter(({ kind }) => kind === "service").map((one) => row(one, 1)));
    const objects = this.objects();
    if (objects.length > 0) this.rows.push({ name: OBJECTS, label: "objects", icon: icons.focus, level: 1, children: objects });
    this.render();
  }

  private objects(): Row[] {
    const nodes = this.world.value?.nodes.filter((node) => !node.parent && node.description.kind === "") ?? [];
    return nodes
      .filter((node) => [...node.walk()].some((below) => below.description.mesh >= 0))
      .map(({ name }) => ({ name, label: name, icon: "", level: 2, children: [] }));
  }

  private render(): void {
    const wanted = this.filter.value.trim().toLowerCase();
    const fits = (row: Row): boolean => wanted === "" || row.name.toLowerCase().includes(wanted);
    const items: HTMLElement[] = [];
    for (const row of this.rows) {
      const below = row.children.filter((child) => fits(child) || (wanted !== "" && fits(row)));
      if (!fits(row) && below.length === 0) continue;
      const open = wanted !== "" || !this.folded.has(row.name);
      items.push(this.draw(row, row.children.length > 0 ? open : null));
      if (open) items.push(...below.map((child) => this.draw(child, null)));
    }
    const nothing = h("p", { class: "quiet" }, wanted === "" ? "No robots yet." : "Nothing of that name.");
    this.list.replaceChildren(...(items.length > 0 ? items : [nothing]));
    this.mark(this.components.selected.value);
  }

  private draw(row: Row, open: boolean | null): HTMLElement {
    const fold = h("span", { class: "fold", onclick: (event: Event) => (event.stopPropagation(), this.toggle(row.name)) });
    if (open !== null) fold.innerHTML = icons.chevron;
    const icon = h("span", { class: "kind" });
    icon.innerHTML = row.icon;
    const item = h("div", { role: "treeitem", "aria-level": row.level, "data-name": row.name, title: row.name }, fold, icon, row.label);
    if (open !== null) item.setAttribute("aria-expanded", String(open));
    this.dress(row.name, item);
    item.addEventListener("click", (event) => (row.name === OBJECTS ? this.toggle(OBJECTS) : this.choose(row.name, event.shiftKey || event.ctrlKey || event.metaKey)));
    item.addEventListener("dblclick", () => this.onOpen(row.name));
    return item;
  }

  private choose(name: string, more: boolean): void {
    this.components.choose(name, more);
    if (!more) this.onChosen();
  }

  /** Show whether a component is active, and whether it has a problem. */
  private dress(name: string, item = this.item(name)): void {
    if (!item) return;
    item.classList.toggle("asleep", this.components.find(name)?.active === false);
    const complaint = this.components.complaints.get(name);
    item.querySelector(".mark")?.remove();
    item.title = complaint ? `${name}\n${complaint.text}` : name;
    if (!complaint) return;
    const mark = h("span", { class: `mark ${complaint.level}`, role: "img", "aria-label": complaint.level });
    mark.innerHTML = icons.warn;
    item.append(mark);
  }

  private toggle(name: string): void {
    if (!this.folded.delete(name)) this.folded.add(name);
    this.render();
  }

  private item(name: string): HTMLElement | null {
    return this.list.querySelector(`[data-name="${CSS.escape(name)}"]`);
  }

  private mark(name: string | null): void {
    for (const item of this.list.querySelectorAll('[aria-selected="true"]')) item.setAttribute("aria-selected", "false");
    const item = name === null ? null : this.item(name);
    item?.setAttribute("aria-selected", "true");
    for (const other of this.components.also.value) this.item(other)?.setAttribute("aria-selected", "true");
    if (item) reveal(item);
  }

  private key(event: KeyboardEvent): void {
    const items = [...this.list.querySelectorAll<HTMLElement>('[role="treeitem"]')];
    const at = items.findIndex((item) => item.dataset["name"] === this.components.selected.value);
    const name = items[at]?.dataset["name"] ?? "";
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key] ?? 0;
    if (step !== 0) this.components.selected.set(items[Math.max(0, Math.min(items.length - 1, at + step))]?.dataset["name"] ?? null);
    else if (event.key === "ArrowLeft" && !this.folded.has(name)) this.toggle(name);
    else if (event.key === "ArrowRight" && this.folded.has(name)) this.toggle(name);
    else if (event.key === "Enter") this.onOpen(name);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
