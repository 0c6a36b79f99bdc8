import { h } from "../ui/dom";

/** Short messages in the corner. */
export class Toasts {
  readonly element = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

  show(text: string, kind: "info" | "error" = "info"): void {
    const toast = h("div", { class: `toast ${kind}` }, text);
    // repeated messages are shown once
    for (const other of this.element.children) if (other.textContent === text) other.remove();
    this.element.append(toast);
    setTimeout(() => toast.remove(), kind === "error" ? 8000 : 4000);
  }
}
