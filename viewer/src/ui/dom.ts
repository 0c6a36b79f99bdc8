type Child = Node | string | null | undefined | false;
type Properties = Record<string, unknown>;

/** Create an element: properties that begin with "on" are listeners, "class" and names with a dash are attributes. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value as EventListener);
    else if (name === "class" || name === "for" || name === "role" || name.includes("-")) {
      if (value !== undefined) element.setAttribute(name, String(value));
    } else Reflect.set(element, name, value);
  }
  element.append(...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false));
  return element;
}

/** Whether a text field receives the typed keys. */
export function isTyping(event: Event): boolean {
  const target = event.target;
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) return !["checkbox", "radio", "range", "button"].includes(target.type);
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement || target.isContentEditable;
}

/**
 * Scroll an element into sight within this page. `scrollIntoView` also scrolls the page around a frame: a recorded run in a
 * document would move what somebody reads.
 */
export function reveal(element: Element, block: "nearest" | "center" = "nearest"): void {
  for (let box = element.parentElement; box !== null; box = box.parentElement) {
    if (!/auto|scroll/.test(getComputedStyle(box).overflow)) continue;
    const [inner, outer] = [element.getBoundingClientRect(), box.getBoundingClientRect()];
    const shift = (first: number, last: number, begin: number, end: number): number => {
      if (block === "center") return (first + last - begin - end) / 2;
      if (first < begin || last - first > end - begin) return first - begin;
      return Math.max(last - end, 0);
    };
    box.scrollTop += shift(inner.top, inner.bottom, outer.top, outer.bottom);
    if (block === "nearest") box.scrollLeft += shift(inner.left, inner.right, outer.left, outer.right);
  }
}

const WHY = ": only the page that drives can do this";

/** The reason for a control without a tooltip of its own. */
const ALONE = "Only the page that drives can do this";

/** Disable a control of the driving page for others, with the reason in its tooltip. */
export function disable(control: HTMLButtonElement | HTMLSelectElement | HTMLInputElement, disabled: boolean): void {
  control.disabled = disabled;
  const own = control.title === ALONE ? "" : control.title.replace(WHY, "");
  control.title = !disabled ? own : own === "" ? ALONE : own + WHY;
}

/** A button with an icon; the label is its accessible name and its tooltip. */
export function iconButton(icon: string, label: string, onclick: () => void, keys = ""): HTMLButtonElement {
  const button = h("button", {
    class: "icon",
    type: "button",
    title: keys === "" ? label : `${label} (${keys})`,
    "aria-label": label,
    onclick,
  });
  button.innerHTML = icon;
  return button;
}

/** Text with code in it, between one or two backquotes, as in docstrings and Markdown. */
export function inline(text: string): (string | HTMLElement)[] {
  return text.replace(/\s+/g, " ").trim().split(/`+/).map((part, i) => (i % 2 === 1 ? h("code", {}, part) : part));
}
