import type { Connection } from "../connection/connection";
import type { Answer, ComponentDescription, FieldDescription, PropertyDescription } from "../generated/protocol";
import type { Components, Live } from "../model/components";
import type { Watching } from "../model/watching";
import { disable, h } from "../ui/dom";
import type { Signal } from "../ui/signal";
import { unitText } from "../ui/units";
import type { Field } from "./field";
import { fill, inUse, makeField, read } from "./field";
import { SettingsPanel } from "../editor/settings";
import { Scan } from "./scan";
import { serviceForm } from "./services";
import { decimalsOf, format, numbersIn } from "./values";

export const FIELD = "application/x-morse-field";

/** The selected component: its data, its properties, its services. */
export class Inspector {
  readonly element = h("section", { class: "panel inspector", "aria-label": "inspector" });
  private readonly cells = new Map<string, HTMLElement>();
  private readonly properties = new Map<string, Field>();
  /** data of an actuator, by field; created with the first value */
  private readonly commands = new Map<string, Field>();
  private readonly sliders = new Map<string, HTMLInputElement>();
  private active: HTMLInputElement | null = null;
  private complaint: HTMLElement | null = null;
  private note: HTMLElement | null = null;
  private scan: Scan | null = null;
  private shown: string | null = null;
  private readonly settings: SettingsPanel;

  constructor(
    private readonly connection: Connection,
    private readonly components: Components,
    private readonly watching: Watching,
    private readonly drives: Signal<boolean>,
    private readonly extra: (name: string) => HTMLElement | null,
    private readonly onPlot: (component: string, field: string) => void,
  ) {
    this.settings = new SettingsPanel(connection);
    components.selected.watch((name) => this.show(name));
    components.all.watch(() => this.show(components.selected.value));
    components.onValues((name, live) => name === this.shown && this.update(live));
    components.onChange((component) => component.name === this.shown && this.refresh(component));
    drives.watch((drives) => {
      this.element.classList.toggle("watching", !drives);
      this.show(this.shown);
    });
  }

  private show(name: string | null): void {
    this.shown = name;
    for (const fields of [this.cells, this.properties, this.commands, this.sliders]) fields.clear();
    this.scan = null;
    const component = this.components.find(name);
    // the simulator says what can be set: of objects, those that a page has added
    const settable = this.drives.value && (!component || ["sensor", "actuator"].includes(component.kind) || component.name === "simulation");
    this.settings.show(settable ? name : null);
    this.watching.set("values", "inspector", component && component.kind !== "service" ? [component.name] : []);
    if (name === null) {
      this.element.replaceChildren(h("p", { class: "quiet" }, "Select a robot, a component or an object: here or in the view."));
      return;
    }
    const parts: (HTMLElement | null)[] = [component ? this.head(component) : h("h2", {}, name), this.extra(name)];
    if (!component) {
      this.settings.element.open = true; // an object has nothing else
      parts.push(this.settings.element);
    } else parts.push(this.data(component), this.propertiesOf(component), this.settings.element, this.services(component));
    this.element.replaceChildren(...parts.filter((part): part is HTMLElement => part !== null));
    const live = name === null ? null : this.components.valuesOf(name);
    if (live) this.update(live);
    this.lock();
  }

  /** Watchers see the controls, but cannot use them. */
  private lock(): void {
    if (this.drives.value) return;
    const changing = ".properties, .commands, .service, .switch".split(", ").map((part) => `${part} :is(input, select, button)`);
    for (const control of this.element.querySelectorAll<HTMLInputElement>(changing.join())) disable(control, true);
  }

  private head(component: ComponentDescription): HTMLElement {
    const kind = component.kind.replace("_", " ");
    const titled = component.title.toLowerCase().endsWith(` ${kind}`);
    const facts = [!titled && kind, component.frequency > 0 && `${format(component.frequency)} Hz`, component.level]
      .filter(Boolean)
      .join(" · ");
    const active = h("input", { type: "checkbox", checked: component.active, onchange: () => void this.activate(component.name, active) });
    this.active = active;
    this.complaint = h("p", { class: "complaint" });
    this.complain(component.name);
    return h(
      "header",
      {},
      h("h2", {}, component.name),
      h("p", { class: "quiet" }, component.title !== component.name ? `${component.title} · ${facts}` : facts),
      component.doc !== "" && h("p", {}, component.doc),
      this.complaint,
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
      return h("tr", {}, name, cell, h("td", { class: "unit" }, unitText(field.unit)));
    });
    this.scan = Scan.of(component);
    this.note = h("p", { class: "quiet", hidden: true });
    const drawn = this.scan ? [this.scan.element] : [];
    return section("data", this.note, h("table", { class: component.kind === "actuator" ? "data commands" : "data" }, ...rows), ...drawn);
  }

  private update({ data, note }: Live): void {
    const component = this.components.find(this.shown);
    if (this.note) {
      this.note.hidden = note === "";
      this.note.textContent = note;
    }
    this.addRows(data);
    for (const [name, cell] of this.cells) {
      const value = data[name];
      cell.parentElement?.classList.toggle("numeric", numbersIn(value).length > 0);
      if (component?.kind === "actuator") this.updateCommand(component, name, cell, value);
      else {
        const text = format(value, cell.dataset["type"], decimalsOf(name));
        if (cell.textContent !== text) cell.textContent = text;
      }
    }
    this.scan?.draw(data);
  }

  /** Values of a recording may have names that the component does not declare: those of ROS. */
  private addRows(data: Record<string, unknown>): void {
    const table = this.cells.values().next().value?.closest("table");
    if (!table) return;
    for (const name of Object.keys(data)) {
      if (name === "timestamp" || this.cells.has(name)) continue;
      const cell = h("td", { class: "value" }, "–");
      this.cells.set(name, cell);
      table.append(h("tr", {}, h("th", { scope: "row" }, ...breakable(name)), cell, h("td", { class: "unit" })));
    }
  }

  /** Data of an actuator can be set by a command, as clients do. */
  private updateCommand(component: ComponentDescription, name: string, cell: HTMLElement, value: unknown): void {
    const known = this.commands.get(name);
    if (known) {
      const slider = this.sliders.get(name);
      if (slider?.matches(":active")) return;
      if (!inUse(known)) fill(known, value);
      if (slider) slider.value = String(value);
      return;
    }
    const declared = component.data.find((field) => field.name === name) as FieldDescription;
    const field = makeField(declared, value);
    this.commands.set(name, field);
    const send = (): Promise<Answer> =>
      this.connection.request({ type: "command", component: component.name, fields: { [name]: read(field, declared.type) } });
    const error = onChange(field, send);
    cell.replaceChildren(field, error);
    if (declared.reached && field instanceof HTMLInputElement) cell.prepend(this.slider(declared, value, field));
    this.lock();
  }

  /** A slider for the values that a command can reach; the field beside it sends them. */
  private slider(declared: FieldDescription, value: unknown, field: HTMLInputElement): HTMLInputElement {
    const [low, high] = declared.reached as [number, number];
    const slider = h("input", { type: "range", min: String(low), max: String(high), step: "any", "aria-label": `${declared.name}, ${low} to ${high}` });
    slider.value = String(value);
    slider.addEventListener("input", () => {
      field.value = Number(slider.value).toPrecision(4);
      field.dispatchEvent(new Event("change"));
    });
    this.sliders.set(declared.name, slider);
    return slider;
  }

  private propertiesOf(component: ComponentDescription): HTMLElement | null {
    if (component.properties.length === 0) return null;
    const rows = component.properties.map((property) => this.property(component.name, property));
    return section("properties", h("table", { class: "properties" }, ...rows));
  }

  private property(component: string, property: PropertyDescription): HTMLElement {
    const field = makeField(property, property.value);
    this.properties.set(property.name, field);
    const set = (): Promise<Answer> =>
      this.connection.request({ type: "set_property", component, name: property.name, value: read(field, property.type) });
    const error = onChange(field, set);
    const hint = [property.doc, property.type].filter((text) => text !== "").join("\n");
    const name = h("th", { scope: "row", title: hint }, ...breakable(property.name));
    return h("tr", {}, name, h("td", {}, field, error), h("td", { class: "unit" }, unitText(property.unit)));
  }

  private services(component: ComponentDescription): HTMLElement | null {
    if (component.services.length === 0) return null;
    return section("services", ...component.services.map((service) => serviceForm(this.connection, component.name, service)));
  }

  /** A value has changed: a field that is being edited keeps its content. */
  private refresh({ name, properties, active }: ComponentDescription): void {
    if (this.active) this.active.checked = active;
    this.complain(name);
    for (const { name: property, value } of properties) {
      const field = this.properties.get(property);
      if (field && !inUse(field)) fill(field, value);
    }
  }

  private complain(name: string): void {
    if (!this.complaint) return;
    const complaint = this.components.complaints.get(name);
    this.complaint.hidden = !complaint;
    this.complaint.className = `complaint ${complaint?.level ?? ""}`;
    this.complaint.textContent = complaint?.text ?? "";
  }

  private async activate(component: string, box: HTMLInputElement): Promise<void> {
    const answer = await this.connection.request({ type: "activate", component, active: box.checked });
    if (!answer.ok) box.checked = !box.checked;
  }
}

/** Send a field whenever it is changed; the element shows why a value was refused. */
function onChange(field: Field, send: () => Promise<Answer>): HTMLElement {
  const error = h("p", { class: "error", role: "alert", hidden: true });
  field.addEventListener("change", () => {
    void send().then((answer) => {
      if (!answer.ok && field instanceof HTMLInputElement && field.type === "checkbox") field.checked = !field.checked;
      error.hidden = answer.ok;
      error.textContent = answer.error;
      field.setAttribute("aria-invalid", String(!answer.ok));
    });
  });
  return error;
}

/** Allow line breaks after the underscores and before the capitals of a long name. */
function breakable(name: string): (HTMLElement | string)[] {
  return name.split(/(?<=_)|(?<=[a-z])(?=[A-Z])/).flatMap((part, i) => (i === 0 ? [part] : [h("wbr"), part]));
}

function section(title: string, ...content: HTMLElement[]): HTMLElement {
  return h("details", { open: true }, h("summary", {}, title), ...content);
}
