import type { DisplayDescription } from "../generated/protocol";
import { h, iconButton } from "./dom";
import { icons } from "./icons";

const KEY = "morse.panels";
const NARROW = 900; // pixels: in narrower windows, panels cover the view

export type Place = "left" | "right" | "bottom";

/** The areas of the page that contain panels. */
export class Shell {
  readonly header = h("header", { class: "bar" });
  readonly left = h("aside", { class: "left", "aria-label": "robots and components" });
  readonly right = h("aside", { class: "right", "aria-label": "details" });
  readonly bottom = h("section", { class: "bottom", "aria-label": "plots and messages" });
  readonly view = h("main", { class: "view", "aria-label": "the simulated world" });
  /** what lies over the view from its upper edge downward */
  readonly over = h("div", { class: "over" });
  /** whether the user wants the details of the selection */
  private wanted: boolean;
  /** areas that the user has closed since the page was loaded */
  private readonly closed = new Set<Place>();
  readonly toggles: Record<Place, HTMLButtonElement>;

  constructor() {
    this.toggles = {
      left: iconButton(icons.tree, "Robots and components", () => this.toggle("left")),
      right: iconButton(icons.panel, "Details", () => this.toggle("right")),
      bottom: iconButton(icons.plot, "Plots and messages", () => this.toggle("bottom")),
    };
    this.view.append(this.over);
    document.body.append(h("div", { class: "shell" }, this.header, this.left, this.view, this.right, this.bottom));
    // menus of narrow windows begin below the header, whose height depends on what is in it
    const measure = (): void => document.documentElement.style.setProperty("--bar", `${this.header.offsetHeight}px`);
    new ResizeObserver(measure).observe(this.header);
    measure();
    const kept = JSON.parse(localStorage.getItem(KEY) ?? "null") as Place[] | null;
    const open = innerWidth < NARROW ? [] : (kept ?? ["left", "right"]);
    this.wanted = open.includes("right");
    for (const place of ["left", "bottom"] as const) this.set(place, open.includes(place));
    this.set("right", false);
  }

  get narrow(): boolean {
    return innerWidth < NARROW;
  }

  toggle(place: Place): void {
    this.set(place, this[place].hidden !== false);
    if (this[place].hidden) this.closed.add(place);
    else this.closed.delete(place);
    if (this.narrow) return;
    if (place === "right") this.wanted = !this.right.hidden;
    const open = (["left", "right", "bottom"] as const).filter((one) => (one === "right" ? this.wanted : !this[one].hidden));
    localStorage.setItem(KEY, JSON.stringify(open));
  }

  /** Whether there is content for the right panel; without content, the view uses its area. */
  fill(something: boolean): void {
    if (this.narrow) {
      this.set("right", something && !this.right.hidden);
      if (something) this.flag("right", "info");
      else delete this.toggles.right.dataset["news"];
    } else this.set("right", something && this.wanted);
  }

  /** Open a panel without making it a choice of the user. */
  show(place: Place): void {
    if (this[place].hidden) this.set(place, true);
  }

  /** Open an area for an error, unless it would cover the view or the user has closed it: then its button tells. */
  offer(place: Place): void {
    if (!this.narrow && !this.closed.has(place)) this.show(place);
    this.flag(place, "error");
  }

  /** The panels that a script opens; in a narrow window, they would cover the world. */
  arrange(panels: NonNullable<DisplayDescription["panels"]>): void {
    if (this.narrow) return;
    this.wanted = panels.includes("details");
    this.set("left", panels.includes("tree"));
    this.set("bottom", panels.includes("plots"));
    if (!this.wanted) this.set("right", false);
  }

  /** A closed area has new content. */
  flag(place: Place, level: string): void {
    if (this[place].hidden) this.toggles[place].dataset["news"] = level;
  }

  private set(place: Place, open: boolean): void {
    this[place].hidden = !open;
    if (open) delete this.toggles[place].dataset["news"];
    this.toggles[place].setAttribute("aria-pressed", String(open));
    // only one panel at a time if they cover the view
    if (open && this.narrow) for (const other of ["left", "right", "bottom"] as const) if (other !== place && !this[other].hidden) this.set(other, false);
  }
}
