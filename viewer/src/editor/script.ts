import type { Connection } from "../connection/connection";
import type { SceneChanges } from "../generated/protocol";
import type { Components } from "../model/components";
import { h, reveal } from "../ui/dom";

interface Script {
  file: string;
  text: string;
  /** numbers of lines, from 1, by the name of the object that they describe */
  lines: Record<string, number[]>;
}

const TOKENS = /(#.*)|("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')|\b(from|import|for|in|def|return|if|else|elif|while|with|as|class|None|True|False|not|and|or|lambda)\b|\b(\d+(?:\.\d*)?)\b/g;

/** The script of the scene as it would be saved; the lines of what is selected are marked, and a click on a line selects. */
export class ScriptPanel {
  readonly element: HTMLElement;
  private readonly code = h("ol", { class: "code", "aria-label": "lines of the script" });
  private readonly title = h("h2", {});
  private script: Script | null = null;

  constructor(
    private readonly connection: Connection,
    private readonly components: Components,
  ) {
    this.element = h("section", { class: "panel script", "aria-label": "script", hidden: true }, this.title, this.code);
    connection.on("scene_changes", (changes: SceneChanges) => void this.refresh(changes));
    components.selected.watch(() => this.mark());
  }

  async toggle(): Promise<void> {
    this.element.hidden = !this.element.hidden;
    await this.refresh();
  }

  private async refresh(_?: SceneChanges): Promise<void> {
    if (this.element.hidden) return;
    const answer = await this.connection.request({ type: "show_script" });
    this.script = answer.ok ? (answer.value as Script) : null;
    this.title.textContent = this.script?.file ?? answer.error;
    const lines = this.script?.text.replace(/\n$/, "").split("\n") ?? [];
    this.code.replaceChildren(...lines.map((line, i) => h("li", { onclick: () => this.choose(i + 1) }, ...colored(line))));
    this.mark();
  }

  private choose(line: number): void {
    const names = Object.entries(this.script?.lines ?? {}).filter(([, lines]) => lines.includes(line));
    if (names[0]) this.components.selected.set(names[0][0]);
  }

  private mark(): void {
    const lines = this.script?.lines[this.components.selected.value ?? ""] ?? [];
    [...this.code.children].forEach((item, i) => item.classList.toggle("marked", lines.includes(i + 1)));
    const first = this.code.children[(lines[0] ?? 0) - 1];
    if (first instanceof HTMLElement) reveal(first);
  }
}

/** A line of Python with comments, texts, keywords and numbers in colours. */
function colored(line: string): (string | HTMLElement)[] {
  const parts: (string | HTMLElement)[] = [];
  let at = 0;
  for (const match of line.matchAll(TOKENS)) {
    const kind = ["comment", "text", "keyword", "number"].find((_, i) => match[i + 1] !== undefined) as string;
    parts.push(line.slice(at, match.index), h("span", { class: kind }, match[0]));
    at = match.index + match[0].length;
  }
  return [...parts, line.slice(at) || (at === 0 ? " " : "")];
}
