import { Signal } from "../ui/signal";

const KEY = "morse.session";

interface Kept {
  world: string;
  parts: Record<string, unknown>;
}

/** The state of this tab for a world, so that a reload restores it. */
export class Session {
  /** the world that is shown, by its key */
  readonly world = new Signal<string>("");
  private kept: Kept = { world: "", parts: {} };

  constructor() {
    try {
      const kept = JSON.parse(sessionStorage.getItem(KEY) ?? "null") as Kept | null;
      if (kept !== null && typeof kept.parts === "object") this.kept = kept;
    } catch {
      // unreadable state is discarded
    }
  }

  /** The state that a part of the page stored for this world, or null. */
  recall<T>(part: string): T | null {
    if (this.kept.world !== this.world.value) return null;
    return (this.kept.parts[part] as T | undefined) ?? null;
  }

  keep(part: string, value: unknown): void {
    if (this.world.value === "") return;
    if (this.kept.world !== this.world.value) this.kept = { world: this.world.value, parts: {} };
    this.kept.parts[part] = value;
    sessionStorage.setItem(KEY, JSON.stringify(this.kept));
  }
}
