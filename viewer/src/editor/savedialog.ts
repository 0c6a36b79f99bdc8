import { h } from "../ui/dom";

/**
 * Show the lines of the script that a save changes, and ask whether to save.
 *
 * @param waits whether something appears only when the scene is loaded again
 */
export function confirmSave(path: string, difference: string, waits: boolean, save: (reload: boolean) => void): void {
  if (document.querySelector("dialog.save")) return;
  const close = (): void => dialog.remove();
  const lines = difference.split("\n").map((line) => {
    const kind = line.startsWith("+") ? "added" : line.startsWith("-") ? "removed" : line.startsWith("@@") ? "quiet" : "";
    return h("span", { class: kind }, line.startsWith("@@") ? "⋯" : line, "\n");
  });
  const button = (text: string, primary: boolean, reload: boolean): HTMLButtonElement =>
    h("button", { type: "button", class: primary ? "primary" : "", onclick: () => (close(), save(reload)) }, text);
  const buttons = [button("save", !waits, false), ...(waits ? [button("save and reload", true, true)] : [])];
  const dialog = h(
    "dialog",
    { class: "ask save", "aria-label": "Save the scene", onclose: close },
    h("p", {}, "Save the scene in ", h("b", {}, path)),
    h("pre", { tabIndex: 0, "aria-label": "changed lines" }, ...lines),
    h("div", { class: "tools" }, h("button", { type: "button", onclick: close }, "cancel"), ...buttons),
  );
  document.body.append(dialog);
  dialog.showModal();
  buttons.at(-1)?.focus();
}
