import type { CameraPose } from "./camera";
import type { Stage } from "./stage";

const KEY = "morse.cameras";
const MOST = 50;

/** Stores the last viewpoint of the user for each simulation. */
export class CameraMemory {
  private key = "";
  private taken = false;

  constructor(private readonly stage: Stage) {
    setInterval(() => this.keep(), 1000);
    addEventListener("pagehide", () => this.keep());
  }

  /** The viewpoint for that simulation, if the user has moved the camera. */
  recall(key: string): CameraPose | null {
    this.key = key;
    this.taken = false;
    return this.all().find(([name]) => name === key)?.[1] ?? null;
  }

  /** The user has moved the camera. */
  take(): void {
    this.taken = true;
  }

  /** Return to the viewpoint of the script. */
  forget(): void {
    this.taken = false;
    localStorage.setItem(KEY, JSON.stringify(this.all().filter(([name]) => name !== this.key)));
  }

  private keep(): void {
    if (!this.taken || this.key === "") return;
    this.taken = false;
    const others = this.all().filter(([name]) => name !== this.key);
    localStorage.setItem(KEY, JSON.stringify([[this.key, this.stage.view.pose], ...others].slice(0, MOST)));
  }

  private all(): [string, CameraPose][] {
    try {
      return JSON.parse(localStorage.getItem(KEY) ?? "[]") as [string, CameraPose][];
    } catch {
      return [];
    }
  }
}
