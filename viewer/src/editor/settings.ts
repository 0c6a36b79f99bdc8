import type { Connection } from "../connection/connection";
import type { ComponentSettings, PropertyDescription, SettingDescription } from "../generated/protocol";
import type { Field } from "../panels/field";
import { makeField, read } from "../panels/field";
import { write } from "../panels/values";
import { h, iconButton, inline } from "../ui/dom";
import { icons } from "../ui/icons";
import { unitText } from "../ui/units";

const TITLES: Record<string, string> = { alter: "add a modifier", add_stream: "add a stream", add_default_interface: "connect all to a middleware" };
const LATER = "These count when the scene is saved and loaded again (F11):";

/** Frequency, level, realism, modifiers and streams of the selected component, colour and physics of an object: calls that the script gets when it is saved. */
export class SettingsPanel {
  readonly element = h("details", { class: "settings", hidden: true }, h("summary", {}, "settings"));
  private readonly content = h("div", {});
  private readonly error = h("p", { class: "error", role: "alert", hidden: true });
  private component = "";

  constructor(private readonly connection: Connection) {
    this.element.append(this.error, this.content);
    connection.on("component_settings", (settings) => settings.component === this.component && this.fill(settings));
  }

  /** The settings of a component; nothing of what cannot be set up. */
  show(component: string | null): void {
    if (this.component !== (component ?? "")) {
      this.content.replaceChildren();
      this.element.hidden = true; // until it is known what can be set
    }
    this.component = component ?? "";
    this.error.hidden = true;
    if (component !== null) this.connection.send({ type: "list_settings", component });
  }

  private fill({ settings, own, scripted }: ComponentSettings): void {
    this.element.hidden = false;
    const of = (method: string): SettingDescription[] => settings.filter((one) => one.method === method);
    const plain = settings.filter(({ method }) => !(method in TITLES));
    const forms = (late: boolean): HTMLElement[] =>
      plain.filter(({ later }) => later === late).map((one) => this.form(one, own.some(([method]) => method === one.method)));
    const several = Object.keys(TITLES).map((method) => this.choice(method, of(method), own, scripted));
    const hint = settings.some(({ later }) => later) ? [h("p", { class: "quiet" }, LATER)] : [];
    this.content.replaceChildren(...forms(false), ...hint, ...forms(true), ...several.filter((one): one is HTMLElement => one !== null));
  }

  /** One that is set once: its fields, and a button. */
  private form(setting: SettingDescription, isOwn: boolean): HTMLElement {
    const fields = setting.arguments.map((argument) => makeField({ ...argument, name: labelOf(setting, argument) }, argument.value));
    const apply = (): void => void this.configure(setting, fields, false);
    const rows = setting.arguments.map((argument, i) => row(labelOf(setting, argument), argument, fields[i] as Field));
    const back = isOwn ? iconButton(icons.undo, `Take ${setting.method} back`, () => void this.configure(setting, [], true)) : null;
    if (setting.arguments.length === 1) {
      fields[0]?.addEventListener("change", apply);
      return h("table", { class: "properties", title: setting.doc }, ...rows.map((one) => (one.append(h("td", {}, back ?? "")), one)));
    }
    const button = h("button", { type: "button", onclick: apply }, "apply");
    // a call without values would say nothing
    const enable = (): void => {
      button.disabled = setting.arguments.every((argument, i) => isUnchanged(argument, fields[i] as Field));
      button.title = button.disabled ? "change a value first" : "";
    };
    enable();
    for (const field of fields) field.addEventListener("input", enable);
    return h("details", { class: "setting" }, h("summary", { title: setting.doc }, setting.method), this.body(setting, rows, button, back));
  }

  private body(setting: SettingDescription, rows: HTMLElement[], button: HTMLElement, back: HTMLElement | null): HTMLElement {
    return h("div", {}, setting.doc !== "" && h("p", { class: "quiet" }, ...inline(setting.doc)), h("table", { class: "properties" }, ...rows), h("div", { class: "tools" }, button, back ?? ""));
  }

  /** Those of which a component may have several: what it has, and a list of what can be added. */
  private choice(method: string, settings: SettingDescription[], own: [string, string][], scripted: [string, string][]): HTMLElement | null {
    const here = (list: [string, string][]): string[] => list.filter(([one]) => one === method).map(([, name]) => name);
    const items = [
      ...here(scripted).map((name) => h("li", { title: "of the script" }, name)),
      ...here(own).map((name) => h("li", {}, name, iconButton(icons.close, `Remove ${name}`, () => void this.configure({ method, name, doc: "", arguments: [], later: false }, [], true)))),
    ];
    const addable = settings.filter(({ name }) => !here(own).includes(name));
    if (items.length + addable.length === 0) return null;
    const title = TITLES[method] as string;
    const select = h("select", { "aria-label": title }, h("option", { value: "" }, `${title}…`), ...addable.map(({ name }) => h("option", { value: name }, name)));
    const chosen = h("div", {});
    select.addEventListener("change", () => {
      const setting = addable.find(({ name }) => name === select.value);
      const fields = setting?.arguments.map((argument) => makeField(argument, argument.value)) ?? [];
      const rows = setting?.arguments.map((argument, i) => row(argument.name, argument, fields[i] as Field)) ?? [];
      chosen.replaceChildren(...(setting ? [this.body(setting, rows, h("button", { type: "button", onclick: () => void this.configure(setting, fields, false) }, "add"), null)] : []));
    });
    return h("div", { class: "several" }, items.length > 0 && h("ul", {}, ...items), addable.length > 0 && select, chosen);
  }

  private async configure(setting: SettingDescription, fields: Field[], remove: boolean): Promise<void> {
    const values: Record<string, unknown> = setting.name === "" ? {} : { "": setting.name };
    setting.arguments.forEach((argument, i) => {
      const field = fields[i];
      // what is as it would be without the argument is not written
      if (field && (setting.arguments.length === 1 || !isUnchanged(argument, field))) values[setting.name === "" && setting.arguments.length === 1 ? "" : argument.name] = read(field, argument.type);
    });
    const { component } = this;
    const answer = await this.connection.request({ type: "configure", component, method: setting.method, values, remove });
    this.error.hidden = answer.ok;
    this.error.textContent = answer.error;
    if (answer.ok && component === this.component) this.connection.send({ type: "list_settings", component });
  }
}

/** Whether a field has the value that the argument has without it. */
function isUnchanged({ value }: PropertyDescription, field: Field): boolean {
  return field instanceof HTMLInputElement && field.type === "checkbox" ? field.checked === value : field.value === write(value);
}

/** The only argument of a method needs no name of its own. */
function labelOf(setting: SettingDescription, argument: PropertyDescription): string {
  return setting.arguments.length === 1 ? setting.method : argument.name;
}

function row(name: string, argument: PropertyDescription, field: Field): HTMLElement {
  return h("tr", {}, h("th", { scope: "row", title: argument.doc }, name), h("td", {}, field), h("td", { class: "unit" }, unitText(argument.unit)));
}
