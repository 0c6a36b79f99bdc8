import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";

/** What there is for Foxglove. */
export interface Recorded {
  /** the file, if one has been written or is being written */
  path: string | null;
  /** whether the file is being written */
  running: boolean;
  /** starts or stops a recording; null if this page cannot */
  toggle: (() => void) | null;
  copy: (text: string) => void;
}

/** Say how Foxglove opens the recording of this run. The page itself sends nothing anywhere. */
export function showFoxglove({ path, running, toggle, copy }: Recorded): void {
  const close = (): void => dialog.remove();
  const act = toggle && h("button", { type: "button", class: "primary", onclick: () => (close(), toggle()) }, running ? "stop recording" : "record the run");
  const copied = (text: string): HTMLElement => h("span", { class: "copied" }, h("code", {}, text), iconButton(icons.copy, `Copy ${text}`, () => copy(text)));
  const steps =
    path === null
      ? [h("p", {}, toggle ? "Foxglove opens recordings. Record the run first." : "Foxglove opens recordings: the file that is replayed, by ", toggle ? "" : h("b", {}, "Open local file"), toggle ? "" : ".")]
      : [
          running ? h("p", {}, "The recording is still being written: stop it before you open it.") : null,
          h(
            "ol",
            {},
            h("li", {}, "Start Foxglove on this machine."),
            h("li", {}, h("b", {}, "Open local file"), ": ", copied(path)),
            h("li", {}, "For a layout with its topics, write one and import it from the menu of layouts: ", copied(`morse export ${quoted(path)} --foxglove-layout`)),
          ),
        ];
  const live = h("p", { class: "quiet" }, "To look on while the simulation runs: ", copied('robot.add_default_interface("foxglove")'), " in the script, then ", h("b", {}, "Open connection"), ", ", h("b", {}, "Foxglove WebSocket"), ", ", h("code", {}, "ws://localhost:8766"), ".");
  const dialog = h(
    "dialog",
    { class: "ask foxglove", "aria-label": "Open in Foxglove", onclose: close },
    h("h2", {}, "Open in Foxglove"),
    ...steps,
    live,
    h("div", { class: "tools" }, h("button", { type: "button", onclick: close }, "close"), act),
  );
  document.body.append(dialog);
  dialog.showModal();
}

/** A path as one word of a shell. */
function quoted(path: string): string {
  return /^[\w./:\\-]+$/.test(path) ? path : `"${path.replace(/(["$`])/g, "\\$1")}"`;
}
