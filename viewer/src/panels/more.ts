import { iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { closeWhenLeft } from "../ui/popup";

/** Opens the controls that do not fit into the header; style sheets show this button in narrow windows. */
export class MoreButton {
  readonly element = iconButton(icons.more, "More", () => this.show(!this.open));

  constructor(private readonly content: HTMLElement) {
    this.element.classList.add("more");
    this.element.setAttribute("aria-controls", content.id);
    this.show(false);
    content.addEventListener("click", ({ target }) => target instanceof HTMLSelectElement || this.show(false));
    closeWhenLeft([content, this.element], this.element, () => this.open, () => this.show(false));
  }

  private get open(): boolean {
    return this.element.getAttribute("aria-expanded") === "true";
  }

  private show(open: boolean): void {
    this.element.setAttribute("aria-expanded", String(open));
    this.content.classList.toggle("open", open);
  }
}
