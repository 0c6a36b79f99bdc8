import { isTyping } from "../ui/dom";

export interface Shortcut {
  /** names of keys, as typed or by position, e.g. "h", "F7", "Space" */
  keys: string[];
  /** shown in the help */
  shown: string;
  what: string;
  group: "Time" | "View" | "Page";
  run: () => void;
}

/** Keys with an immediate effect; keys that are held to drive or fly are elsewhere. */
export class Shortcuts {
  readonly list: Shortcut[] = [];

  constructor() {
    addEventListener("keydown", (event) => {
      const prefix = event.ctrlKey || event.metaKey ? "Ctrl+" : "";
      // the browser's own Ctrl+S would save the page, also while somebody types
      const saves = prefix !== "" && event.key.toLowerCase() === "s";
      if ((isTyping(event) && !saves) || event.altKey || event.repeat) return;
      if (["Space", "Enter"].includes(event.code) && isPressed(event.target)) return;
      if (event.key === "Escape" && document.querySelector("dialog[open]")) return;
      const shortcut = this.list.find(({ keys }) => keys.includes(prefix + event.key) || keys.includes(prefix + event.code));
      if (!shortcut) return;
      event.preventDefault();
      shortcut.run();
    });
  }

  add(group: Shortcut["group"], keys: string[], shown: string, what: string, run: () => void): void {
    this.list.push({ group, keys, shown, what, run });
  }
}

/** Whether Space or Enter activate an element. */
function isPressed(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest("button, summary, a, input") !== null;
}
