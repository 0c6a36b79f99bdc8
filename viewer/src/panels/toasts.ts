import { h } from "../ui/dom";

/** Short messages in the corner. */
export class Toasts {
  readonly element = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

  /** @param onOpen called when the message is clicked */
  show(text: string, kind: "info" | "error" = "info", onOpen: (() => void) | null = null): void {
    const toast = h("div", { class: `toast ${kind}${onOpen ? " open" : ""}`, onclick: () => onOpen?.() }, text);
    // repeated messages are shown once
    for (const other of this.element.children) if (other.textContent === text) other.remove();
    this.element.append(toast);
    setTimeout(() => toast.remove(), kind === "error" ? 8000 : 4000);
  }
}
