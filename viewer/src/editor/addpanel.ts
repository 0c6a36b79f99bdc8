import { fileAddress } from "../connection/address";
import type { Connection } from "../connection/connection";
import type { Model } from "../generated/protocol";
import { h } from "../ui/dom";
import { icons } from "../ui/icons";
import { draggable } from "./dragging";

const TOUCH = matchMedia("(pointer: coarse)").matches;
const HINT = TOUCH
  ? "Tap a model, or drag it sideways into the world. Sensors and actuators go onto the selected robot, or where you drop them."
  : "Press a model, or drag it into the world. Sensors and actuators go onto the selected robot, or where you drop them.";
const FAVOURITES = "morse.favourites";

/** A name that may be broken between its words: Localized·PR2, Depth·Camera. */
function inParts(name: string): (string | HTMLElement)[] {
  return name.split(/(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=_)/).flatMap((part, i) => (i > 0 ? [h("wbr", {}), part] : [part]));
}

/** The ranks of a model: its name is the word, begins with it, has it, its words have it, a word of its description begins with it, only its group has it. */
const IS_NAME = -1;
const BEGINS = 0;
const BY_NAME = 1;
const BY_WORDS = 2;
const BY_DOC = 3;
const BY_GROUP = 4;

/** How well a model fits a word that somebody looks for: its name first, then its words, then what it is. */
function rankOf({ name, group, kind, doc, words }: Model, word: string): number {
  if (name.toLowerCase() === word) return IS_NAME;
  if (name.toLowerCase().startsWith(word)) return BEGINS;
  // not the file of an object: "door" is in indoors-1
  if (`${name} ${kind.split("#").at(-1) ?? ""}`.toLowerCase().includes(word)) return BY_NAME;
  const all = words.toLowerCase().split(/\W+/);
  const place = all.indexOf(word);
  // what it is for comes first in its words
  if (place >= 0) return BY_WORDS + place / (place + 1);
  if ([...doc.toLowerCase().split(/\W+/), ...all].some((one) => one.startsWith(word))) return BY_DOC;
  return group.toLowerCase().includes(word) ? BY_GROUP : Infinity;
}

export interface Placing {
  /** Show where a model dragged to a point of the page would be put. */
  show: (model: Model, x: number, y: number) => void;
  /** Put a model at a point of the page, or in the middle of the view. */
  put: (model: Model, place: { x: number; y: number } | null) => void;
  cancel: () => void;
}

/** The models that can be added, with pictures: dragged into the world, or pressed. */
export class AddPanel {
  readonly element: HTMLElement;
  private readonly filter = h("input", { type: "search", placeholder: "find…", "aria-label": "find a model" });
  private readonly list = h("div", { class: "models" });
  private readonly ghost = h("div", { class: "ghost", hidden: true });
  private readonly pictures = new Map<string, string>();
  private models: Model[] = [];
  private asked = false;

  constructor(
    private readonly connection: Connection,
    private readonly placing: Placing,
    /** files of one's own */
    own: HTMLElement,
  ) {
    const hint = h("p", { class: "quiet" }, HINT);
    this.element = h("section", { class: "panel add-panel", "aria-label": "add to the scene", hidden: true }, this.filter, hint, own, this.list);
    document.body.append(this.ghost);
    this.filter.addEventListener("input", () => this.render());
    connection.on("welcome", () => (this.asked = false));
    connection.on("models", ({ models }) => {
      this.models = models;
      this.render();
    });
    connection.on("model_picture", ({ kind, url }) => {
      this.pictures.set(kind, url);
      const image = this.list.querySelector<HTMLImageElement>(`[data-kind="${CSS.escape(kind)}"] img`);
      if (image) this.paint(image, kind);
    });
  }

  open(): void {
    this.element.hidden = false;
    if (!this.asked) this.connection.send({ type: "list_models" });
    this.asked = true;
    this.render();
    if (!TOUCH) this.filter.focus(); // a keyboard on the screen would cover the models
  }

  close(): void {
    this.element.hidden = true;
  }

  private render(): void {
    if (this.element.hidden) return;
    if (this.models.length === 0) {
      this.list.replaceChildren(h("p", { class: "quiet" }, "The models are being listed…"));
      return;
    }
    const words = this.filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const rank = (model: Model): number => Math.max(...words.map((word) => rankOf(model, word)), IS_NAME);
    const named = (model: Model): number => Math.min(Math.trunc(rank(model)), BY_WORDS);
    // what is looked for by what it does is a component, not a robot that may have one
    const isRobot = (model: Model): number => (words.length > 0 && model.group === "robots" ? 1 : 0);
    const fitting = this.models
      .filter((model) => rank(model) < Infinity)
      .sort((a, b) => named(a) - named(b) || isRobot(a) - isRobot(b) || rank(a) - rank(b));
    const better = fitting.filter((model) => rank(model) < BY_GROUP);
    const found = better.length > 0 ? better : fitting;
    const groups = new Map<string, Model[]>();
    const kept = this.favourites();
    if (kept.length > 0) groups.set("favourites", found.filter(({ kind }) => kept.includes(kind)));
    for (const model of found) groups.set(model.group, [...(groups.get(model.group) ?? []), model]);
    const parts = [...groups].filter(([, models]) => models.length > 0).map(([group, models]) =>
      h("fieldset", {}, h("legend", {}, group), h("div", { class: "grid" }, ...models.map((model) => this.button(model)))),
    );
    this.list.replaceChildren(...(parts.length > 0 ? parts : [h("p", { class: "quiet" }, "Nothing of that name.")]));
  }

  private button(model: Model): HTMLElement {
    const image = h("img", { alt: "", draggable: false, loading: "lazy", width: 72, height: 54 });
    const icon = h("span", { class: "kind" });
    icon.innerHTML = { robots: icons.robot, sensors: icons.sensor, actuators: icons.actuator }[model.group] ?? icons.boxes;
    const button = h(
      "button",
      { type: "button", class: "model", title: `${[model.name, model.doc].filter(Boolean).join("\n")}\nF: a favourite, or not`, "data-kind": model.kind },
      icon,
      image,
      h("span", { class: "caption" }, ...inParts(model.name)),
    );
    button.addEventListener("keydown", (event) => event.key.toLowerCase() === "f" && this.toggleFavourite(model, event));
    button.addEventListener("contextmenu", (event) => this.toggleFavourite(model, event));
    this.paint(image, model.kind);
    draggable(button, {
      drag: (x, y) => {
        this.carry(model, x, y);
        this.placing.show(model, x, y);
      },
      drop: (x, y) => {
        this.ghost.hidden = true;
        this.placing.put(model, { x, y });
      },
      cancel: () => {
        this.ghost.hidden = true;
        this.placing.cancel();
      },
      press: () => this.placing.put(model, null),
    });
    return button;
  }

  private favourites(): string[] {
    return JSON.parse(localStorage.getItem(FAVOURITES) ?? "[]") as string[];
  }

  private toggleFavourite({ kind }: Model, event: Event): void {
    event.preventDefault();
    event.stopPropagation();
    const kept = this.favourites();
    localStorage.setItem(FAVOURITES, JSON.stringify(kept.includes(kind) ? kept.filter((one) => one !== kind) : [...kept, kind]));
    this.render();
  }

  private paint(image: HTMLImageElement, kind: string): void {
    const url = this.pictures.get(kind);
    image.hidden = url === undefined;
    if (url === undefined) return;
    image.src = fileAddress(url, location.href);
    image.previousElementSibling?.remove();
  }

  private carry(model: Model, x: number, y: number): void {
    const url = this.pictures.get(model.kind);
    this.ghost.style.backgroundImage = url === undefined ? "" : `url("${fileAddress(url, location.href)}")`;
    this.ghost.textContent = url === undefined ? model.name : "";
    this.ghost.style.transform = `translate(${x + 12}px, ${y + 12}px)`;
    this.ghost.hidden = false;
  }
}
