import type { Shortcuts } from "../input/shortcuts";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";

const HELD: [string, [string, string][]][] = [
  ["Drive", [
    ["↑ ↓ ← →", "forward, back, turn"],
    ["T G", "up, down"],
    ["U O", "sideways"],
    ["I K · J L", "pitch · roll"],
    ["gamepad", "drives like a joystick"],
  ]],
  ["Camera", [
    ["Ctrl + mouse", "look around"],
    ["W A S D", "fly (also Z, Q)"],
    ["R F", "up, down"],
    ["Shift", "four times as fast"],
    ["drag", "orbit"],
    ["right drag", "pan, as Shift + drag"],
    ["wheel", "zoom to the pointer"],
  ]],
];
const NAMES = { View: "View", Time: "Time", Page: "This page" } as const;

/** The overlay that lists every key. */
export class Help {
  readonly element = h("dialog", { class: "help", "aria-label": "Keys" });

  constructor(private readonly shortcuts: Shortcuts) {
    this.element.addEventListener("click", (event) => event.target === this.element && this.element.close());
  }

  toggle(): void {
    if (this.element.open) {
      this.element.close();
      return;
    }
    const groups = (Object.keys(NAMES) as (keyof typeof NAMES)[]).map((group): [string, [string, string][]] => [
      NAMES[group],
      this.shortcuts.list.filter((one) => one.group === group).map((one) => [one.shown, one.what]),
    ]);
    this.element.replaceChildren(
      h("header", {}, h("h2", {}, "Keys"), iconButton(icons.close, "Close", () => this.element.close(), "Esc")),
      h("div", { class: "columns" }, ...[...HELD, ...groups].map(([title, rows]) => section(title, rows))),
      h("footer", { class: "quiet" }, "Made with three.js and uPlot: ", h("a", { href: "assets/licences.txt", target: "_blank" }, "licences")),
    );
    this.element.showModal();
  }
}

function section(title: string, rows: [string, string][]): HTMLElement {
  const lines = rows.flatMap(([keys, what]) => [h("dt", {}, ...caps(keys)), h("dd", {}, what)]);
  return h("section", {}, h("h3", {}, title), h("dl", {}, ...lines));
}

function caps(keys: string): (Node | string)[] {
  if (/^(drag|wheel|gamepad|right)/.test(keys)) return [keys];
  return keys.split(/( \+ | · | )/).map((part) => (part.trim() === "" || ["+", "·"].includes(part.trim()) ? part : h("kbd", {}, part)));
}
