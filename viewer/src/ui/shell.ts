import { h } from "./dom";

/** The places of the page that panels are put into. */
export class Shell {
  readonly header = h("header", { class: "bar" });
  readonly left = h("aside", { class: "left", hidden: true });
  readonly right = h("aside", { class: "right", hidden: true });
  readonly bottom = h("section", { class: "bottom", hidden: true });
  readonly view = h("main", { class: "view", "aria-label": "the simulated world" });
  readonly corner = h("div", { class: "corner" });

  constructor() {
    this.view.append(this.corner);
    document.body.append(h("div", { class: "shell" }, this.header, this.left, this.view, this.right, this.bottom));
  }
}
