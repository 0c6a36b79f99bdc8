import type { Connection } from "../connection/connection";
import type { Toasts } from "../panels/toasts";
import { disable, h } from "../ui/dom";
import type { Signal } from "../ui/signal";
import type { Item } from "./zip";
import { unzipped } from "./zip";

/** Bytes of a message with a part of a file: as base64 it is below the limit of the simulator. */
const PART = 120_000;
const MOST_FILES = 1000;
/** What belongs to models; of a folder, all other files stay where they are. */
const KNOWN = /\.(urdf|sdf|world|xml|mjcf|blend|glb|gltf|dae|obj|stl|ply|mtl|bin|config|png|jpe?g|bmp|gif|tga|tiff?|webp|hdr)$/i;

interface Examined {
  file: string;
  error: string;
  contents: [string, string][];
  /** kind and name of each */
  kinds: [string, string][];
}

export type Add = (kind: string, name: string, place: { x: number; y: number } | null) => Promise<boolean>;

/** Takes files that are dropped on the page or chosen: sends them, shows what is in them, and adds the model. */
export class Uploader {
  readonly element: HTMLElement;
  private readonly veil = h("div", { class: "veil", hidden: true }, "Drop a model, or its folder, or a ZIP of it: URDF, SDF, MJCF, glTF, .blend, meshes");

  constructor(
    private readonly connection: Connection,
    private readonly toasts: Toasts,
    private readonly drives: Signal<boolean>,
    private readonly add: Add,
    /** shows an exported run beside the present one */
    private readonly compare: (file: File) => void,
  ) {
    const files = this.chooser("a model…", "Add a model of your own: URDF, SDF, MJCF, glTF, .blend or meshes, with the files that it needs, or a ZIP of them", false);
    const folder = this.chooser("a folder…", "Add a model of your own with its folder", true);
    this.element = h("div", { class: "tools upload" }, h("span", { class: "quiet" }, "your own:"), files, folder);
    document.body.append(this.veil);
    let depth = 0;
    const isFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    const enter = (by: number) => (event: DragEvent): void => {
      if (!isFiles(event)) return;
      depth = Math.max(depth + by, 0);
      this.veil.hidden = depth === 0;
    };
    addEventListener("dragenter", enter(1));
    addEventListener("dragleave", enter(-1));
    // without this, the browser shows the file in the place of the page
    addEventListener("dragover", (event) => isFiles(event) && event.preventDefault());
    addEventListener("drop", (event) => {
      if (!isFiles(event)) return;
      event.preventDefault();
      depth = 0;
      this.veil.hidden = true;
      const onWorld = event.target instanceof HTMLCanvasElement;
      // at once: the list is empty after the event
      const dropped = [...(event.dataTransfer?.items ?? [])].filter(({ kind }) => kind === "file");
      const entries = dropped.map((item) => item.webkitGetAsEntry() ?? item.getAsFile()).filter((entry) => entry !== null);
      void Promise.all(entries.map(itemsOf)).then((lists) => this.take(lists.flat(), onWorld ? { x: event.clientX, y: event.clientY } : null), (error: unknown) => this.toasts.show(String(error), "error"));
    });
  }

  private chooser(label: string, title: string, folder: boolean): HTMLElement {
    const input = h("input", { type: "file", multiple: true, webkitdirectory: folder, hidden: true, "aria-label": title });
    input.addEventListener("change", () => {
      const items = [...(input.files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
      input.value = "";
      void this.take(items, null);
    });
    const button = h("button", { type: "button", title, onclick: () => input.click() }, label);
    this.drives.watch((drives) => disable(button, !drives));
    return h("span", {}, input, button);
  }

  /** Send files, and add the model among them. */
  async take(items: Item[], place: { x: number; y: number } | null): Promise<void> {
    const only = items.length === 1 ? items[0] : undefined;
    if (only && /\.html?$/i.test(only.path)) return this.compare(only.file);
    if (!this.drives.value) return this.toasts.show("Only the page that drives can add a model.", "error");
    if (only && /\.zip$/i.test(only.path)) {
      try {
        items = await unzipped(only.file);
      } catch (error) {
        return this.toasts.show(`${only.path} cannot be read: ${error instanceof Error ? error.message : String(error)}`, "error");
      }
    }
    const { name, known, others } = sorted(items);
    const first = known[0];
    if (!first) return this.toasts.show(`There is no model in ${only ? only.path : `these ${items.length} files`}.`, "error");
    if (known.length > MOST_FILES) return this.toasts.show(`A model has at most ${MOST_FILES} files, not ${known.length}.`, "error");
    const files = known.map(({ path, file }): [string, number] => [path, file.size]);
    const begun = await this.connection.request({ type: "begin_upload", name, files });
    if (!begun.ok) return this.toasts.show(begun.error, "error");
    const upload = begun.value as number;
    const total = files.reduce((sum, [, size]) => sum + size, 0);
    let sent = 0;
    const bar = h("progress", { max: Math.max(total, 1), value: 0, "aria-label": `${name} is being sent` });
    this.element.append(bar);
    try {
      for (const [number, { file }] of known.entries()) {
        for (let at = 0; at < file.size; at += PART) {
          const data = await base64(file.slice(at, at + PART));
          const answer = await this.connection.request({ type: "upload_part", upload, file: number, data });
          if (!answer.ok) return this.toasts.show(answer.error, "error");
          bar.value = sent += PART;
        }
      }
      const answer = await this.connection.request({ type: "examine_upload", upload });
      if (!answer.ok) return this.toasts.show(answer.error, "error");
      const report = answer.value as Examined[];
      const all = report.flatMap(({ kinds }) => kinds);
      const only = all.length === 1 ? all[0] : undefined;
      const added = only ? await this.add(only[0], only[1], place) : false;
      this.show(name, report, added, others);
    } catch (error) {
      this.toasts.show(`${name} cannot be read: ${String(error)}`, "error"); // e.g. deleted meanwhile
    } finally {
      bar.remove();
    }
  }

  /** What is in the files, and what of it can be added. */
  private show(name: string, report: Examined[], added: boolean, others: number): void {
    const dialog = h("dialog", { class: "ask examined", "aria-label": `What is in ${name}`, onclose: () => dialog.remove() });
    const button = ([kind, label]: [string, string]): HTMLElement => {
      const add = h("button", { type: "button", onclick: () => void this.add(kind, label, null).then((done) => (add.disabled = done)) }, `add ${label}`);
      return add;
    };
    const parts = report.map(({ file, error, contents, kinds }) =>
      h(
        "section",
        {},
        h("h2", {}, file),
        error !== "" && h("p", { class: "error" }, error),
        h("table", {}, ...contents.map(([title, text]) => h("tr", { class: title.startsWith("left out") ? "warned" : "" }, h("th", { scope: "row" }, title), h("td", {}, text)))),
        !added && kinds.length > 0 && h("div", { class: "kinds" }, ...kinds.map(button)),
      ),
    );
    const head = added ? `${name} is in the scene.` : report.some(({ kinds }) => kinds.length > 0) ? "What do you want to add?" : `${name} cannot be added.`;
    const close = h("button", { type: "button", class: "primary", onclick: () => dialog.remove() }, "close");
    dialog.append(
      h("p", {}, head),
      h("div", { class: "parts" }, ...parts),
      others > 0 ? h("p", { class: "quiet" }, `${others} other ${others === 1 ? "file is" : "files are"} no part of a model, and stay where they are.`) : "",
      h("div", { class: "tools" }, close),
    );
    document.querySelector("dialog.examined")?.remove();
    document.body.append(dialog);
    dialog.showModal();
    close.focus();
  }
}

/** The name of a model, its files below its folder, and the number of those that do not belong to it. */
function sorted(items: Item[]): { name: string; known: Item[]; others: number } {
  const visible = items.filter(({ path }) => !path.split("/").some((part) => part.startsWith(".")));
  const known = visible.filter(({ path }) => KNOWN.test(path));
  const tops = new Set(known.map(({ path }) => (path.includes("/") ? path.slice(0, path.indexOf("/")) : "")));
  const [top] = tops;
  if (tops.size === 1 && top) {
    return { name: top, known: known.map(({ path, file }) => ({ path: path.slice(top.length + 1), file })), others: visible.length - known.length };
  }
  const main = known.find(({ path }) => /\.(urdf|sdf|world|xml|mjcf|blend|glb|gltf)$/i.test(path)) ?? known[0];
  return { name: main?.file.name.replace(/\.\w+$/, "") ?? "", known, others: visible.length - known.length };
}

/** The files of a dropped file or folder. */
async function itemsOf(entry: FileSystemEntry | File): Promise<Item[]> {
  if (entry instanceof File) return [{ path: entry.name, file: entry }];
  const path = entry.fullPath.replace(/^\//, "");
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{ path, file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: Item[] = [];
  // a part of a folder at a time
  for (;;) {
    const entries = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0 || found.length > 20 * MOST_FILES) return found;
    found.push(...(await Promise.all(entries.map(itemsOf))).flat());
  }
}

function base64(blob: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve((reader.result as string).replace(/^[^,]*,/, ""));
    reader.onerror = () => reject(reader.error ?? new Error("it cannot be read"));
    reader.readAsDataURL(blob);
  });
}
