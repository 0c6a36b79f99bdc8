import type { Sighting } from "../generated/protocol";
import { h } from "../ui/dom";
import { idColor } from "./palette";

/** Width of the frames in saved images, px. */
const LINE = 2;
/** Width of a character of a name, px: a name that is wider than its box is left out. */
const LETTER = 6.2;

/** Boxes with names over an image. */
export class Marks {
  readonly element = h("div", { class: "marks", "aria-hidden": "true" });
  private shown: Sighting[] = [];
  private width = 1;
  private told = "";

  constructor() {
    new ResizeObserver(() => this.fit()).observe(this.element);
  }

  show(sightings: Sighting[], width: number, height: number): void {
    const text = JSON.stringify([sightings, width, height]);
    if (text === this.told) return;
    this.told = text;
    this.shown = sightings;
    this.width = width;
    this.element.replaceChildren(...sightings.map((sighting) => mark(sighting, width, height)));
    this.fit();
  }

  /** Show the names that fit into their boxes. */
  private fit(): void {
    const scale = this.element.clientWidth / this.width;
    this.shown.forEach(({ name, box: [x0, , x1] }, i) => {
      const label = this.element.children[i]?.firstElementChild as HTMLElement | null;
      if (label) label.hidden = name.length * LETTER + LETTER > (x1 - x0) * scale;
    });
  }

  /** Draw the boxes into an image that is saved. */
  drawOn(context: CanvasRenderingContext2D): void {
    if (this.element.hidden) return;
    const size = Math.max(10, Math.round(context.canvas.height / 30));
    context.font = `${size}px system-ui, sans-serif`;
    context.textBaseline = "top";
    context.lineWidth = LINE;
    for (const { id, name, box } of this.shown) {
      const [x0, y0, x1, y1] = box;
      context.strokeStyle = context.fillStyle = inkOf(id);
      context.strokeRect(x0 + LINE / 2, y0 + LINE / 2, x1 - x0 - LINE, y1 - y0 - LINE);
      context.fillRect(x0, y0, context.measureText(name).width + 6, size + 4);
      context.fillStyle = "#111";
      context.fillText(name, x0 + 3, y0 + 2);
    }
  }
}

function mark({ id, name, kind, box }: Sighting, width: number, height: number): HTMLElement {
  const [x0, y0, x1, y1] = box;
  const percent = (value: number, whole: number): string => `${((100 * value) / whole).toFixed(3)}%`;
  const place =
    `left: ${percent(x0, width)}; top: ${percent(y0, height)}; width: ${percent(x1 - x0, width)}; ` +
    `height: ${percent(y1 - y0, height)}; --ink: ${inkOf(id)}`;
  return h("div", { class: "mark-box", style: place, title: kind === "" ? name : `${name}: ${kind}` }, h("span", {}, name));
}

/** The colour of an id, bright enough for a frame over its own pixels. */
function inkOf(id: number): string {
  const [red, green, blue] = idColor(id).map((part) => Math.round(part + (255 - part) * 0.55)) as [number, number, number];
  return `rgb(${red} ${green} ${blue})`;
}
