import { isTyping } from "../ui/dom";

export interface Shortcut {
  /** names of keys, as typed or by their place, e.g. "h", "F7", "Space" */
  keys: string[];
  /** shown in the help */
  shown: string;
  what: string;
  group: "Time" | "View" | "Page";
  run: () => void;
}

/** Keys that do something at once; those held down to drive or fly are elsewhere. */
export class Shortcuts {
  readonly list: Shortcut[] = [];

  constructor() {
    addEventListener("keydown", (event) => {
      if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      if (["Space", "Enter"].includes(event.code) && isPressed(event.target)) return;
      if (event.key === "Escape" && document.querySelector("dialog[open]")) return;
      const shortcut = this.list.find(({ keys }) => keys.includes(event.key) || keys.includes(event.code));
      if (!shortcut) return;
      event.preventDefault();
      shortcut.run();
    });
  }

  add(group: Shortcut["group"], keys: string[], shown: string, what: string, run: () => void): void {
    this.list.push({ group, keys, shown, what, run });
  }
}

/** Whether an element is pressed by Space or Enter itself. */
function isPressed(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest("button, summary, a, input") !== null;
}
