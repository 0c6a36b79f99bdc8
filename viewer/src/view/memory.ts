import type { CameraPose } from "./camera";
import type { Stage } from "./stage";

const KEY = "morse.cameras";
const MOST = 50;

/** Remembers for each simulation where its user last looked from. */
export class CameraMemory {
  private key = "";
  private taken = false;

  constructor(private readonly stage: Stage) {
    setInterval(() => this.keep(), 1000);
    addEventListener("pagehide", () => this.keep());
  }

  /** The camera of that simulation, if it was ever moved. */
  recall(key: string): CameraPose | null {
    this.key = key;
    this.taken = false;
    return this.all().find(([name]) => name === key)?.[1] ?? null;
  }

  /** The user has moved the camera. */
  take(): void {
    this.taken = true;
  }

  /** The user wants the script's camera again. */
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
