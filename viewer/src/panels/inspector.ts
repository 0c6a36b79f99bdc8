import type { Connection } from "../connection/connection";
import type { ComponentDescription, PropertyDescription } from "../generated/protocol";
import type { Components, Live } from "../model/components";
import type { Watching } from "../model/watching";
import { h } from "../ui/dom";
import type { Signal } from "../ui/signal";
import { serviceForm } from "./services";
import { format, numbersIn, parse, write } from "./values";

export const FIELD = "application/x-morse-field";

/** The selected component: what it measures or obeys, its properties, its services. */
export class Inspector {
  readonly element = h("section", { class: "panel inspector", "aria-label": "inspector" });
  private readonly cells = new Map<string, HTMLElement>();
  private readonly inputs = new Map<string, HTMLInputElement>();
  private active: HTMLInputElement | null = null;
  private shown: string | null = null;

  constructor(
    private readonly connection: Connection,
    private readonly components: Components,
    private readonly watching: Watching,
    drives: Signal<boolean>,
    private readonly extra: (name: string) => HTMLElement | null,
    private readonly onPlot: (component: string, field: string) => void,
  ) {
    components.selected.watch((name) => this.show(name));
    components.all.watch(() => this.show(components.selected.value));
    components.onValues((name, live) => name === this.shown && this.update(live));
    components.onChange((component) => component.name === this.shown && this.refresh(component));
    drives.watch((drives) => this.element.classList.toggle("watching", !drives));
  }

  private show(name: string | null): void {
    this.shown = name;
    this.cells.clear();
    this.inputs.clear();
    const component = this.components.find(name);
    this.watching.set("values", "inspector", component && component.data.length > 0 ? [component.name] : []);
    if (name === null) {
      this.element.replaceChildren(h("p", { class: "quiet" }, "Select a robot, a component or an object: here or in the view."));
      return;
    }
    const parts: (HTMLElement | null)[] = [component ? this.head(component) : h("h2", {}, name), this.extra(name)];
    if (component) parts.push(this.data(component), this.properties(component), this.services(component));
    this.element.replaceChildren(...parts.filter((part): part is HTMLElement => part !== null));
    const live = name === null ? null : this.components.valuesOf(name);
    if (live) this.update(live);
  }

  private head(component: ComponentDescription): HTMLElement {
    const facts = [component.kind.replace("_", " "), component.frequency > 0 && `${format(component.frequency)} Hz`, component.level]
      .filter(Boolean)
      .join(" · ");
    const active = h("input", { type: "checkbox", checked: component.active, onchange: () => this.activate(component.name, active) });
    this.active = active;
    return h(
      "header",
      {},
      h("h2", {}, component.name),
      h("p", { class: "quiet" }, component.title !== component.name ? `${component.title} · ${facts}` : facts),
      component.doc !== "" && h("p", {}, component.doc),
      component.kind !== "service" && h("label", { class: "switch" }, active, "active"),
    );
  }

  private data(component: ComponentDescription): HTMLElement | null {
    if (component.data.length === 0) return null;
    const rows = component.data.map((field) => {
      const cell = h("td", { class: "value", "data-type": field.type }, "–");
      this.cells.set(field.name, cell);
      const plot = (): void => this.onPlot(component.name, field.name);
      const name = h("th", { scope: "row", draggable: true, title: `${field.doc}\ndrag into a plot, or press Enter`, tabIndex: 0 }, ...breakable(field.name));
      name.addEventListener("dragstart", (event) => event.dataTransfer?.setData(FIELD, JSON.stringify([component.name, field.name])));
      name.addEventListener("dblclick", plot);
      name.addEventListener("keydown", (event) => event.key === "Enter" && plot());
      return h("tr", {}, name, cell, h("td", { class: "unit" }, field.unit));
    });
    return section("data", h("table", { class: "data" }, ...rows));
  }

  private update({ data }: Live): void {
    for (const [name, cell] of this.cells) {
      const text = format(data[name], cell.dataset["type"]);
      if (cell.textContent !== text) cell.textContent = text;
      cell.parentElement?.classList.toggle("numeric", numbersIn(data[name]).length > 0);
    }
  }

  private properties(component: ComponentDescription): HTMLElement | null {
    if (component.properties.length === 0) return null;
    const rows = component.properties.map((property) => this.property(component.name, property));
    return section("properties", h("table", { class: "properties" }, ...rows));
  }

  private property(component: string, property: PropertyDescription): HTMLElement {
    const error = h("p", { class: "error", role: "alert", hidden: true });
    const yesOrNo = typeof property.value === "boolean";
    const input = h("input", { type: yesOrNo ? "checkbox" : "text", "aria-label": property.name, spellcheck: false });
    fill(input, property.value);
    this.inputs.set(property.name, input);
    const set = async (): Promise<void> => {
      const value = yesOrNo ? input.checked : parse(input.value, property.type);
      const answer = await this.connection.request({ type: "set_property", component, name: property.name, value });
      if (!answer.ok && yesOrNo) input.checked = !input.checked;
      error.hidden = answer.ok;
      error.textContent = answer.error;
      input.setAttribute("aria-invalid", String(!answer.ok));
    };
    input.addEventListener("change", () => void set());
    const hint = [property.doc, property.type].filter((text) => text !== "").join("\n");
    return h("tr", {}, h("th", { scope: "row", title: hint }, ...breakable(property.name)), h("td", {}, input, error));
  }

  private services(component: ComponentDescription): HTMLElement | null {
    if (component.services.length === 0) return null;
    return section("services", ...component.services.map((service) => serviceForm(this.connection, component.name, service)));
  }

  /** Something changed: what is being typed stays. */
  private refresh({ properties, active }: ComponentDescription): void {
    if (this.active) this.active.checked = active;
    for (const { name, value } of properties) {
      const input = this.inputs.get(name);
      if (input && (input.type === "checkbox" || input !== document.activeElement)) fill(input, value);
    }
  }

  private async activate(component: string, box: HTMLInputElement): Promise<void> {
    const answer = await this.connection.request({ type: "activate", component, active: box.checked });
    if (!answer.ok) box.checked = !box.checked;
  }
}

/** Show a value in its field. */
function fill(input: HTMLInputElement, value: unknown): void {
  if (input.type === "checkbox") input.checked = value === true;
  else input.value = write(value);
}

/** A long name may be broken after its underscores. */
function breakable(name: string): (HTMLElement | string)[] {
  return name.split(/(?<=_)/).flatMap((part, i) => (i === 0 ? [part] : [h("wbr"), part]));
}

function section(title: string, ...content: HTMLElement[]): HTMLElement {
  return h("details", { open: true }, h("summary", {}, title), ...content);
}
