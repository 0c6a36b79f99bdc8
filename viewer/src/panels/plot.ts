import uPlot from "uplot";
import { h, iconButton } from "../ui/dom";
import { fileName, save } from "../ui/files";
import { icons } from "../ui/icons";
import { format, numberAt } from "./values";

const KEEP = 3000;
const COLORS = ["#d9660c", "#2f7fc2", "#3a9a4a", "#b14cc0", "#c23b4a", "#0f9a9a", "#8a7a1a", "#6a6fd0"];

export interface Curve {
  component: string;
  /** place of the number in the component's data: field, or field.part */
  path: string;
  unit: string;
}

/** A field that has no value yet. */
export interface Awaited {
  component: string;
  field: string;
}

/** Curves over simulated time, in one picture. */
export class Plot {
  readonly element: HTMLElement;
  readonly curves: Curve[] = [];
  readonly awaited: Awaited[] = [];
  onEmpty: () => void = () => {};
  private readonly times: number[] = [];
  private readonly values: (number | null)[][] = [];
  private readonly canvas = h("div", { class: "canvas" });
  private readonly legend = h("ul", { class: "legend" });
  private chart: uPlot | null = null;
  private paused = false;
  private stale = true;

  constructor() {
    const pause = iconButton(icons.pause, "Hold", () => {
      this.paused = !this.paused;
      pause.setAttribute("aria-pressed", String(this.paused));
    });
    this.element = h(
      "figure",
      { class: "plot" },
      h(
        "div",
        { class: "tools" },
        this.legend,
        pause,
        h("button", { type: "button", onclick: () => this.savePicture() }, "PNG"),
        h("button", { type: "button", onclick: () => this.saveTable() }, "CSV"),
        iconButton(icons.close, "Close", () => this.onEmpty()),
      ),
      this.canvas,
    );
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  add(curve: Curve): void {
    if (this.curves.some(({ component, path }) => component === curve.component && path === curve.path)) return;
    this.curves.push(curve);
    this.values.push(this.times.map(() => null));
    this.build();
  }

  /** Say that a field will be plotted as soon as it has a value. */
  await(field: Awaited): void {
    this.awaited.push(field);
    this.label(-1);
  }

  /** The field is awaited no longer. */
  arrived(field: Awaited): void {
    this.awaited.splice(this.awaited.indexOf(field), 1);
    this.label(-1);
  }

  /** New data of a component. */
  take(component: string, time: number, data: unknown): void {
    if (this.paused || !this.curves.some((curve) => curve.component === component)) return;
    const last = this.times.at(-1);
    if (last !== undefined && time < last) this.clear(); // the simulation began anew
    if (time !== this.times.at(-1)) {
      this.times.push(time);
      for (const column of this.values) column.push(null);
    }
    this.curves.forEach((curve, i) => {
      if (curve.component === component) (this.values[i] as (number | null)[])[this.times.length - 1] = numberAt(data, curve.path);
    });
    if (this.times.length > KEEP) for (const column of [this.times, ...this.values]) column.splice(0, column.length - KEEP);
    this.stale = true;
  }

  /** In the colours of the theme. */
  paint(): void {
    if (this.chart) this.build();
  }

  /** Draw what has come since the last time. */
  draw(): void {
    if (!this.stale || !this.chart) return;
    this.stale = false;
    this.chart.setData([this.times, ...this.values] as uPlot.AlignedData);
    if (this.chart.cursor.idx == null) this.label(this.times.length - 1);
  }

  csv(): string {
    const names = this.curves.map(({ component, path, unit }) => `"${component}.${path}${unit ? ` (${unit})` : ""}"`);
    const rows = this.times.map((time, i) => [time, ...this.values.map((column) => column[i] ?? "")].join(","));
    return [["time (s)", ...names].join(","), ...rows].join("\n") + "\n";
  }

  dispose(): void {
    this.chart?.destroy();
    this.element.remove();
  }

  private clear(): void {
    for (const column of [this.times, ...this.values]) column.length = 0;
  }

  private build(): void {
    this.chart?.destroy();
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--quiet");
    const grid = { stroke: style.getPropertyValue("--line"), width: 1 };
    const axis = { stroke: ink, grid, ticks: grid, font: "12px system-ui", size: 50 };
    this.chart = new uPlot(
      {
        ...this.size(),
        legend: { show: false },
        cursor: { y: false },
        hooks: { setCursor: [(chart) => this.label(chart.cursor.idx ?? this.times.length - 1)] },
        scales: { x: { time: false } },
        axes: [{ ...axis, size: 30 }, axis],
        series: [
          {},
          ...this.curves.map((_curve, i) => ({
            stroke: COLORS[i % COLORS.length] as string,
            width: 1.6,
            spanGaps: true,
            points: { show: false },
          })),
        ],
      },
      [this.times, ...this.values] as uPlot.AlignedData,
      this.canvas,
    );
    this.label(-1);
  }

  /** The curves by name, with their values at an index. */
  private label(index: number): void {
    const items = this.curves.map(({ component, path, unit }, i) => {
      const value = this.values[i]?.[index];
      const text = value == null ? "" : ` ${format(value)} ${unit}`;
      return h("li", { title: `${component}.${path}`, style: `--ink: ${COLORS[i % COLORS.length] as string}` }, path, h("b", {}, text));
    });
    const awaited = this.awaited.map(({ component, field }) => h("li", { class: "quiet" }, `${component}.${field} has no value yet…`));
    this.legend.replaceChildren(...items, ...awaited);
  }

  private size(): { width: number; height: number } {
    return { width: Math.max(this.canvas.clientWidth, 160), height: Math.max(this.canvas.clientHeight, 80) };
  }

  private resize(): void {
    this.chart?.setSize(this.size());
  }

  private savePicture(): void {
    if (!this.chart) return;
    const drawn = this.chart.ctx.canvas;
    const picture = h("canvas", { width: drawn.width, height: drawn.height + 40 });
    const context = picture.getContext("2d");
    if (!context) return;
    context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--panel");
    context.fillRect(0, 0, picture.width, picture.height);
    context.drawImage(drawn, 0, 0);
    context.font = "20px system-ui, sans-serif";
    let x = 20;
    this.curves.forEach(({ component, path }, i) => {
      const label = `${component}.${path}`;
      context.fillStyle = COLORS[i % COLORS.length] as string;
      context.fillText(label, x, drawn.height + 26);
      x += context.measureText(label).width + 24;
    });
    picture.toBlob((blob) => blob && save(blob, fileName("plot", "png")));
  }

  private saveTable(): void {
    save(this.csv(), fileName("plot", "csv"));
  }
}
