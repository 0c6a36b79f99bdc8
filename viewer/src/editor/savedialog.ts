import { h } from "../ui/dom";

/** Show the lines of the script that a save changes, and ask whether to save. */
export function confirmSave(path: string, difference: string, folders: string[], save: () => void): void {
  if (document.querySelector("dialog.save")) return;
  const close = (): void => dialog.remove();
  const lines = difference.split("\n").map((line) => {
    const kind = line.startsWith("+") ? "added" : line.startsWith("-") ? "removed" : line.startsWith("@@") ? "quiet" : "";
    return h("span", { class: kind }, line.startsWith("@@") ? "⋯" : line, "\n");
  });
  const button = h("button", { type: "button", class: "primary", onclick: () => (close(), save()) }, "save");
  const dialog = h(
    "dialog",
    { class: "ask save", "aria-label": "Save the scene", onclose: close },
    h("p", {}, "Save the scene in ", h("b", {}, path)),
    ...folders.map((folder) => h("p", { class: "quiet" }, "with the files of your model in ", h("b", {}, folder))),
    h("pre", { tabIndex: 0, "aria-label": "changed lines" }, ...lines),
    h("div", { class: "tools" }, h("button", { type: "button", onclick: close }, "cancel"), button),
  );
  document.body.append(dialog);
  dialog.showModal();
  button.focus();
}
