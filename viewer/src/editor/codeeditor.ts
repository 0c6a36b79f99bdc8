/* An editor of Python, which the page loads when the script is opened first: it is as large as the rest of the page. */
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { python } from "@codemirror/lang-python";
import { HighlightStyle, bracketMatching, indentUnit, syntaxHighlighting } from "@codemirror/language";
import { Compartment, EditorState, StateEffect, StateField, Transaction } from "@codemirror/state";
import { Decoration, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import type { DecorationSet } from "@codemirror/view";
import { tags } from "@lezer/highlight";

interface Marks {
  /** numbers of lines, from 1 */
  selected: number[];
  error: { line: number; text: string } | null;
}

const setMarks = StateEffect.define<Marks>();
const marks = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update: (old, transaction) => {
    let now = old.map(transaction.changes);
    for (const effect of transaction.effects) if (effect.is(setMarks)) now = decorated(transaction.state, effect.value);
    return now;
  },
  provide: (field) => EditorView.decorations.from(field),
});

function decorated(state: EditorState, { selected, error }: Marks): DecorationSet {
  const within = (line: number): boolean => line >= 1 && line <= state.doc.lines;
  const ranges = selected.filter(within).map((line) => Decoration.line({ class: "marked" }).range(state.doc.line(line).from));
  if (error && within(error.line)) {
    const attributes = { title: error.text };
    ranges.push(Decoration.line({ class: "wrong", attributes }).range(state.doc.line(error.line).from));
  }
  return Decoration.set(ranges, true);
}

const colors = HighlightStyle.define([
  { tag: tags.comment, color: "var(--quiet)" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--good)" },
  { tag: [tags.keyword, tags.bool, tags.null, tags.operatorKeyword], color: "var(--accent)" },
  { tag: tags.number, color: "var(--warn)" },
  { tag: tags.invalid, color: "var(--bad)" },
]);

/** The text of a script, with marked lines. */
export class CodeEditor {
  private readonly view: EditorView;
  private readonly writable = new Compartment();
  private present: Marks = { selected: [], error: null };

  constructor(parent: HTMLElement, { onChange, onLine, onSave }: { onChange: () => void; onLine: (line: number) => void; onSave: () => void }) {
    const save = (): boolean => (onSave(), true);
    const extensions = [
      lineNumbers(),
      history(),
      bracketMatching(),
      highlightActiveLine(),
      indentUnit.of("    "),
      python(),
      syntaxHighlighting(colors),
      marks,
      this.writable.of(locked(true)),
      EditorView.contentAttributes.of({ "aria-label": "lines of the script" }),
      keymap.of([{ key: "Mod-s", run: save, stopPropagation: true, preventDefault: true }, ...defaultKeymap, ...historyKeymap, indentWithTab]),
      EditorView.updateListener.of((update) => {
        if (update.docChanged && !update.transactions.some((one) => one.annotation(Transaction.userEvent) === "load")) onChange();
        if (update.transactions.some((one) => one.isUserEvent("select.pointer"))) {
          onLine(update.state.doc.lineAt(update.state.selection.main.head).number);
        }
      }),
    ];
    this.view = new EditorView({ parent, state: EditorState.create({ doc: "", extensions }) });
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  /** Show another text, which is not a change of the user. */
  load(text: string): void {
    if (text === this.text) return;
    const { state } = this.view;
    const top = this.view.scrollDOM.scrollTop;
    this.view.dispatch({
      changes: { from: 0, to: state.doc.length, insert: text },
      selection: { anchor: Math.min(state.selection.main.anchor, text.length) },
      annotations: [Transaction.userEvent.of("load"), Transaction.addToHistory.of(false)],
    });
    this.view.scrollDOM.scrollTop = top;
  }

  lock(isLocked: boolean): void {
    this.view.dispatch({ effects: this.writable.reconfigure(locked(isLocked)) });
  }

  /** Mark the lines of what is selected, and the line of an error; the first one is scrolled into sight. */
  mark(now: Partial<Marks>): void {
    this.present = { ...this.present, ...now };
    this.view.dispatch({ effects: setMarks.of(this.present) });
    const line = now.error?.line ?? now.selected?.[0];
    if (line !== undefined && line >= 1 && line <= this.view.state.doc.lines && !this.view.hasFocus) {
      this.view.dispatch({ effects: EditorView.scrollIntoView(this.view.state.doc.line(line).from, { y: "nearest", yMargin: 30 }) });
    }
  }
}

const locked = (isLocked: boolean) => [EditorState.readOnly.of(isLocked), EditorView.editable.of(!isLocked)];
