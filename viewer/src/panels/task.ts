import type { Connection } from "../connection/connection";
import type { TaskPoint } from "../generated/protocol";
import { h, inline } from "../ui/dom";

/** What is to be done here, such as the task of a lesson, and what has been checked of it. */
export class TaskPanel {
  readonly element = h("details", { class: "notice task", hidden: true });

  constructor(connection: Connection) {
    connection.on("welcome", () => (this.element.hidden = true));
    connection.on("task", ({ title, text, points, is_checked }) => {
      const first = this.element.hidden && this.element.childElementCount === 0;
      const right = points.filter((point) => point.is_right).length;
      const state = points.length === 0 ? "" : ` · ${right} of ${points.length}${is_checked ? "" : " so far"}`;
      const passed = is_checked && points.length > 0 && right === points.length ? " · passed" : "";
      this.element.replaceChildren(
        h("summary", {}, h("b", {}, title), state + passed),
        h("ul", { class: "points", "aria-label": "what has been checked", hidden: points.length === 0 }, ...points.map(item)),
        h("div", { class: "text" }, ...paragraphs(text)),
      );
      if (first) this.element.open = innerWidth >= 600; // on a phone it would cover the world
      if (is_checked && points.some((point) => !point.is_right)) this.element.open = true;
      this.element.hidden = false;
    });
  }
}

function item({ what, is_right, hint }: TaskPoint): HTMLElement {
  return h("li", { class: is_right ? "right" : "wrong" }, h("span", { role: "img", "aria-label": is_right ? "right" : "wrong" }, is_right ? "✓" : "✗"), h("span", {}, what, hint !== "" && h("small", {}, hint)));
}

/** Paragraphs and lists of Markdown, with code in them. */
function paragraphs(text: string): HTMLElement[] {
  const blocks = text.split(/\n\s*\n/).filter((block) => block.trim() !== "");
  return blocks.map((block) => {
    const items = block.split(/^\s*[*-] /m);
    if (items.length < 2) return h("p", {}, ...inline(block));
    const [before, ...rest] = items;
    return h("div", {}, before?.trim() ? h("p", {}, ...inline(before)) : null, h("ul", {}, ...rest.map((one) => h("li", {}, ...inline(one)))));
  });
}
