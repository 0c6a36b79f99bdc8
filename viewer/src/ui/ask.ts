import { h } from "./dom";

/** Ask for confirmation before an irreversible action. */
export function ask(question: string, yes: string, run: () => void): void {
  if (document.querySelector("dialog.ask")) return;
  const close = (): void => dialog.remove();
  const confirm = h("button", { type: "button", class: "primary", onclick: () => (close(), run()) }, yes);
  const dialog = h(
    "dialog",
    { class: "ask", "aria-label": question, onclose: close },
    h("p", {}, question),
    h("div", { class: "tools" }, h("button", { type: "button", onclick: close }, "cancel"), confirm),
  );
  document.body.append(dialog);
  dialog.showModal();
  confirm.focus();
}
