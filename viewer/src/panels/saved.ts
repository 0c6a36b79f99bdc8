import type { Connection } from "../connection/connection";
import type { FileMistake } from "../generated/protocol";
import { h } from "../ui/dom";

/** Files that were saved: their errors, until they are mended, and those that wait for a restart. */
export class SavedPanel {
  readonly element = h("div", { class: "saved", role: "status", hidden: true });

  /** @param onOpen shows a mistake in the log */
  constructor(
    private readonly connection: Connection,
    private readonly onOpen: (mistake: FileMistake) => void,
  ) {
    connection.on("welcome", () => this.show([], []));
    connection.on("saved_files", ({ mistakes, waiting }) => this.show(mistakes, waiting));
  }

  private show(mistakes: FileMistake[], waiting: string[]): void {
    const wrong = mistakes.map((mistake) => {
      const { file, line, text } = mistake;
      const place = line > 0 ? `${file}, line ${line}` : file;
      return h("button", { type: "button", class: "error", title: "show it in the log", onclick: () => this.onOpen(mistake) }, h("b", {}, place), ` ${text}`);
    });
    const reload = h("button", { type: "button", class: "primary", onclick: () => this.connection.send({ type: "reset" }) }, "reload");
    const waits = waiting.length > 0 ? [h("p", {}, h("span", {}, `${waiting.join(", ")} was saved.`), reload)] : [];
    this.element.replaceChildren(...wrong, ...waits);
    this.element.hidden = wrong.length + waits.length === 0;
  }
}
