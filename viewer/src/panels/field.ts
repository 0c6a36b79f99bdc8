import { h } from "../ui/dom";
import { parse, write } from "./values";

/** Description of a value that can be changed. */
export interface Changeable {
  name: string;
  type: string;
  unit?: string;
  choices?: unknown[] | null;
  low?: number | null;
  high?: number | null;
}

export type Field = HTMLInputElement | HTMLSelectElement;

/** An input for a value: a check box, a list of choices, a number with limits, or text. */
export function makeField(what: Changeable, value: unknown): Field {
  if (what.choices && what.choices.length > 0) {
    const select = h("select", { "aria-label": what.name });
    // a value that is not among the choices is shown nevertheless
    const options = what.choices.some((choice) => write(choice) === write(value)) ? what.choices : [value, ...what.choices];
    select.append(...options.map((choice) => h("option", { value: write(choice) }, write(choice))));
    fill(select, value);
    return select;
  }
  const input = h("input", { "aria-label": what.name, spellcheck: false, type: typeof value === "boolean" ? "checkbox" : "text" });
  const bounds = [what.low != null && `at least ${what.low}`, what.high != null && `at most ${what.high}`].filter(Boolean).join(", ");
  input.title = [what.type, what.unit, bounds].filter(Boolean).join(" · ");
  if (typeof value === "number") input.inputMode = "decimal";
  fill(input, value);
  return input;
}

/** Show a value in its field. */
export function fill(field: Field, value: unknown): void {
  if (field instanceof HTMLInputElement && field.type === "checkbox") field.checked = value === true;
  else {
    const text = write(value);
    if (field instanceof HTMLSelectElement && ![...field.options].some((option) => option.value === text)) field.append(h("option", { value: text }, text));
    field.value = text;
  }
}

/** The content of a field, converted to the type that the component declares. */
export function read(field: Field, type: string): unknown {
  return field instanceof HTMLInputElement && field.type === "checkbox" ? field.checked : parse(field.value, type);
}

/** Whether the user may be editing it. */
export function inUse(field: Field): boolean {
  return document.activeElement === field && !(field instanceof HTMLInputElement && field.type === "checkbox");
}
