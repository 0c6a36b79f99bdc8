import type { Connection } from "../connection/connection";
import type { FileMistake } from "../generated/protocol";
import type { Components } from "../model/components";
import type { Toasts } from "../panels/toasts";
import { disable, h } from "../ui/dom";
import type { Signal } from "../ui/signal";
import type { CodeEditor } from "./codeeditor";
import { confirmSave } from "./savedialog";

interface Script {
  file: string;
  text: string;
  /** numbers of lines, from 1, by the name of the object that they describe */
  lines: Record<string, number[]>;
  /** why it cannot be changed here; empty if it can */
  locked: string;
  /** identifies the text */
  version: string;
}

/** A changed script: what a save would do. */
interface Change {
  path: string;
  difference: string;
  folders: string[];
  /** of a text that is no Python; 0 if it is */
  line: number;
  error: string;
  /** whether this is the script that runs */
  runs: boolean;
}

/** The longest text that fits in a message, bytes. */
const LONGEST = 250_000;

/** The script of the scene: the lines of what is selected are marked, a click on a line selects, and it runs when it is saved. */
export class ScriptPanel {
  readonly element: HTMLElement;
  private readonly title = h("h2", {});
  private readonly why = h("p", { class: "quiet", hidden: true });
  private readonly error = h("p", { class: "error", role: "alert", hidden: true });
  private readonly place = h("div", { class: "code" });
  private readonly saveButton = h("button", { type: "button", class: "primary", hidden: true, onclick: () => void this.save() }, "save and run…");
  private readonly backButton = h("button", { type: "button", hidden: true, onclick: () => void this.discard() }, "discard");
  private editor: Promise<CodeEditor> | null = null;
  private script: Script | null = null;
  private mistakes: FileMistake[] = [];
  /** whether it has changes of the user */
  private edited = false;

  constructor(
    private readonly connection: Connection,
    private readonly components: Components,
    private readonly toasts: Toasts,
    private readonly drives: Signal<boolean>,
  ) {
    const head = h("div", { class: "tools" }, this.title, this.saveButton, this.backButton);
    this.element = h("section", { class: "panel script", "aria-label": "script", hidden: true }, head, this.why, this.error, this.place);
    connection.on("scene_changes", () => void this.refresh());
    connection.on("welcome", () => (this.mistakes = []));
    connection.on("saved_files", ({ mistakes }) => {
      this.mistakes = mistakes;
      this.tellMistake();
    });
    components.selected.watch(() => void this.mark());
    drives.watch(() => void this.refresh());
    addEventListener("beforeunload", (event) => this.edited && event.preventDefault());
  }

  async toggle(): Promise<void> {
    this.element.hidden = !this.element.hidden;
    await this.refresh();
  }

  private open(): Promise<CodeEditor> {
    this.editor ??= import("./codeeditor").then(
      ({ CodeEditor: Made }) => new Made(this.place, { onChange: () => this.change(true), onLine: (line) => this.choose(line), onSave: () => void this.save() }),
    );
    return this.editor;
  }

  /** Show what is wrong with the script that was saved, if anything is. */
  private tellMistake(): void {
    const own = this.mistakes.find(({ file }) => file === this.script?.file);
    this.fail(own ? own.line : 0, own ? own.text : "");
  }

  private async refresh(): Promise<void> {
    if (this.element.hidden) return;
    const [editor, answer] = await Promise.all([this.open(), this.connection.request({ type: "show_script" })]);
    if (this.edited) {
      // what the user writes stays; the simulator says at the save if both differ
      this.enable(editor);
      return;
    }
    this.script = answer.ok ? (answer.value as Script) : null;
    this.title.textContent = this.script?.file ?? "";
    editor.load(this.script?.text ?? "");
    this.enable(editor);
    if (answer.ok) this.tellMistake();
    else this.fail(0, answer.error);
    await this.mark();
  }

  private enable(editor: CodeEditor): void {
    const locked = !this.drives.value ? "Only the page that drives can change the script." : (this.script?.locked ?? "");
    editor.lock(locked !== "");
    this.why.hidden = locked === "";
    this.why.textContent = locked;
    disable(this.saveButton, !this.drives.value);
  }

  private change(edited: boolean): void {
    this.edited = edited;
    this.saveButton.hidden = this.backButton.hidden = !edited;
  }

  private async discard(): Promise<void> {
    this.change(false);
    this.fail(0, "");
    await this.refresh();
  }

  private choose(line: number): void {
    if (this.edited) return; // the lines are those of the text before
    const names = Object.entries(this.script?.lines ?? {}).filter(([, lines]) => lines.includes(line));
    // a component and not its robot, whose lines may contain it
    const found = names.sort(([a], [b]) => b.split(".").length - a.split(".").length)[0];
    if (found) this.components.selected.set(found[0]);
  }

  private async mark(): Promise<void> {
    if (this.element.hidden) return;
    (await this.open()).mark({ selected: this.edited ? [] : (this.script?.lines[this.components.selected.value ?? ""] ?? []) });
  }

  /** Show an error at its line, or none. */
  private fail(line: number, text: string): void {
    this.error.hidden = text === "";
    this.error.textContent = line > 0 ? `line ${line}: ${text}` : text;
    if (this.editor) void this.editor.then((editor) => editor.mark({ error: text === "" ? null : { line, text } }));
  }

  private async save(): Promise<void> {
    if (!this.edited || !this.script) return;
    const { version } = this.script;
    const text = (await this.open()).text;
    if (new Blob([JSON.stringify(text)]).size > LONGEST) return this.toasts.show("The script is too long to be changed here: use another editor.", "error");
    const shown = await this.connection.request({ type: "change_script", text, version, write: false });
    if (!shown.ok) return this.toasts.show(shown.error, "error");
    const { path, difference, folders, line, error } = shown.value as Change;
    this.fail(line, error);
    if (error === "") confirmSave(path, difference, folders, () => void this.write(text, version));
  }

  private async write(text: string, version: string): Promise<void> {
    const answer = await this.connection.request({ type: "change_script", text, version, write: true });
    if (!answer.ok) return this.toasts.show(answer.error, "error");
    const { path, runs } = answer.value as Change;
    this.change(false);
    if (runs) this.connection.send({ type: "reset" });
    else this.toasts.show(`Saved in ${path}: run it with "morse run ${path}".`);
    await this.refresh();
  }
}
