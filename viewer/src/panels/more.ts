import { iconButton } from "../ui/dom";
import { icons } from "../ui/icons";

/** Opens what the header has no room for; style sheets show it where there is little room. */
export class MoreButton {
  readonly element = iconButton(icons.more, "More", () => this.show(!this.open));

  constructor(private readonly content: HTMLElement) {
    this.element.classList.add("more");
    this.element.setAttribute("aria-controls", content.id);
    this.show(false);
    addEventListener("pointerdown", ({ target }) => !this.owns(target) && this.show(false));
    content.addEventListener("click", () => this.show(false));
    addEventListener("focusin", ({ target }) => this.open && !this.owns(target) && this.show(false));
    for (const part of [content, this.element]) part.addEventListener("keydown", (event) => event.key === "Escape" && this.leave(event));
  }

  private get open(): boolean {
    return this.element.getAttribute("aria-expanded") === "true";
  }

  private owns(target: EventTarget | null): boolean {
    return target instanceof Node && (this.content.contains(target) || this.element.contains(target));
  }

  private show(open: boolean): void {
    this.element.setAttribute("aria-expanded", String(open));
    this.content.classList.toggle("open", open);
  }

  private leave(event: KeyboardEvent): void {
    if (!this.open) return;
    event.stopPropagation();
    this.show(false);
    this.element.focus();
  }
}
