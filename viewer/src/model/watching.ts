import type { Connection } from "../connection/connection";

type Kind = "values" | "overlays" | "images";

/** Reports to the simulation what this page shows, so that it sends nothing else. */
export class Watching {
  private readonly wanted: Record<Kind, Map<string, string[]>> = { values: new Map(), overlays: new Map(), images: new Map() };
  private told = "";

  constructor(private readonly connection: Connection) {
    connection.on("welcome", () => {
      this.told = "";
      this.tell();
    });
  }

  /** Set what one part of the page shows, replacing its previous list. */
  set(kind: Kind, part: string, names: string[]): void {
    this.wanted[kind].set(part, names);
    this.tell();
  }

  private tell(): void {
    const all = (kind: Kind): string[] => [...new Set([...this.wanted[kind].values()].flat())].sort().slice(0, 1000);
    const message = { type: "watch" as const, values: all("values"), overlays: all("overlays"), images: all("images").slice(0, 100) };
    const text = JSON.stringify(message);
    if (text === this.told) return;
    this.told = text;
    this.connection.send(message);
  }
}
