import type { ComponentDescription } from "../generated/protocol";
import { h } from "../ui/dom";
import { theme } from "../ui/theme";

const SIZE = 220;
/** fields with the distances of a scan, in order of priority */
const RANGES = ["range_list", "ranges"];

/** A scan from above: the sensor is at the centre, its X axis points up. */
export class Scan {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { width: SIZE * 2, height: SIZE * 2, role: "img" });
  private readonly caption = h("figcaption", { class: "quiet" });

  constructor(
    private readonly field: string,
    /** full angle, degrees */
    private readonly window: number,
    /** m: a distance of this length means no hit */
    private readonly farthest: number,
  ) {
    this.canvas.ariaLabel = "the scan, from above";
    this.element = h("figure", { class: "scan" }, this.canvas, this.caption);
  }

  /** The scan of a component, or null if it is not a scanner. */
  static of(component: ComponentDescription): Scan | null {
    const field = component.data.find(({ name }) => RANGES.includes(name));
    const number = (property: string): number | null => {
      const value = component.properties.find(({ name }) => name === property)?.value;
      return typeof value === "number" ? value : null;
    };
    const window = number("scan_window");
    return field && component.kind === "sensor" && window !== null ? new Scan(field.name, window, number("laser_range") ?? Infinity) : null;
  }

  draw(data: Record<string, unknown>): void {
    const ranges = data[this.field];
    const context = this.canvas.getContext("2d");
    if (!context || !Array.isArray(ranges) || !ranges.every((range): range is number | null => range === null || typeof range === "number")) return;
    const isMet = (range: number | null): range is number => range !== null && range > 0 && range < this.farthest - 1e-6;
    const met = ranges.filter(isMet);
    const reach = niceReach(Math.max(...met, 0.1));
    const style = getComputedStyle(document.documentElement);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, 2 * SIZE, 2 * SIZE);
    context.setTransform(2, 0, 0, 2, SIZE, SIZE);
    const scale = (SIZE / 2 - 8) / reach;
    this.rings(context, reach, scale, style.getPropertyValue("--line"));
    context.fillStyle = theme.value === "dark" ? "rgb(255 154 77 / 18%)" : "rgb(194 84 10 / 14%)";
    const [beams, ink] = [ranges.length, style.getPropertyValue("--accent")];
    const place = (i: number, range: number): [number, number] => {
      const angle = ((-this.window / 2 + (beams > 1 ? (i * this.window) / (beams - 1) : this.window / 2)) * Math.PI) / 180;
      return [-scale * range * Math.sin(angle), -scale * range * Math.cos(angle)];
    };
    context.beginPath();
    context.moveTo(0, 0);
    ranges.forEach((range, i) => context.lineTo(...place(i, isMet(range) ? range : 0)));
    context.fill();
    context.fillStyle = ink;
    ranges.forEach((range, i) => {
      if (!isMet(range)) return;
      const [x, y] = place(i, range);
      context.fillRect(x - 1, y - 1, 2, 2);
    });
    this.caption.textContent = `${beams} rays; a ring is ${Number((reach / 4).toPrecision(3))} m`;
  }

  private rings(context: CanvasRenderingContext2D, reach: number, scale: number, ink: string): void {
    context.strokeStyle = ink;
    context.lineWidth = 1;
    for (let ring = 1; ring <= 4; ring++) {
      context.beginPath();
      context.arc(0, 0, (scale * reach * ring) / 4, 0, 2 * Math.PI);
      context.stroke();
    }
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(0, -scale * reach);
    context.stroke();
  }
}

/** A round number of metres that covers all distances. */
function niceReach(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  return [1, 2, 4, 8, 10].map((step) => step * power).find((reach) => reach >= most) ?? most;
}
