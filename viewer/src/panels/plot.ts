import uPlot from "uplot";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { colorOf } from "../ui/colors";
import { formatTime, isDate } from "./clock";
import { savePicture, saveTable } from "./plotfiles";
import { format, numberAt } from "./values";

const KEEP = 3000;
/** length of the time window, simulated seconds; 0 for all stored data */
const WINDOWS = [5, 15, 60, 0];

export interface Curve {
  component: string;
  /** path of the number in the component's data: field, or field.part */
  path: string;
  unit: string;
}

/** A field that has no value yet. */
export interface Awaited {
  component: string;
  field: string;
}

/** Curves over simulated time, in one diagram. */
export class Plot {
  readonly element: HTMLElement;
  readonly curves: Curve[] = [];
  readonly awaited: Awaited[] = [];
  onEmpty: () => void = () => {};
  onWindow: () => void = () => {};
  private readonly times: number[] = [];
  private readonly values: (number | null)[][] = [];
  private readonly canvas = h("div", { class: "canvas" });
  private readonly legend = h("ul", { class: "legend", tabIndex: 0, "aria-label": "curves" });
  private readonly span = h("select", { title: "time shown", "aria-label": "time shown", onchange: () => this.setWindow(Number(this.span.value)) });
  private chart: uPlot | null = null;
  private paused = false;
  private stale = true;
  private seconds = 15;

  constructor() {
    const pause = iconButton(icons.pause, "Hold", () => {
      this.paused = !this.paused;
      pause.setAttribute("aria-pressed", String(this.paused));
    });
    this.span.append(...WINDOWS.map((seconds) => h("option", { value: String(seconds) }, seconds === 0 ? "all" : `${seconds} s`)));
    this.span.value = String(this.seconds);
    this.element = h(
      "figure",
      { class: "plot" },
      h(
        "div",
        { class: "head" },
        this.legend,
        h(
          "div",
          { class: "tools" },
          this.span,
          pause,
          h("button", { type: "button", title: "save as picture", onclick: () => this.chart && savePicture(this.chart.ctx.canvas, this.curves) }, "PNG"),
          h("button", { type: "button", title: "save as table", onclick: () => saveTable(this.csv()) }, "CSV"),
          iconButton(icons.close, "Close", () => this.onEmpty()),
        ),
      ),
      this.canvas,
    );
    new ResizeObserver(() => this.chart?.setSize(this.size())).observe(this.canvas);
  }

  /** Length of the time window, simulated seconds; 0 for all. */
  get window(): number {
    return this.seconds;
  }

  setWindow(seconds: number): void {
    this.seconds = seconds;
    this.span.value = String(seconds);
    this.stale = true;
    this.draw();
    this.onWindow();
  }

  add(curve: Curve): void {
    if (this.curves.some(({ component, path }) => component === curve.component && path === curve.path)) return;
    this.curves.push(curve);
    this.values.push(this.times.map(() => null));
    this.build();
  }

  /** Show that a field will be plotted as soon as it has a value. */
  await(field: Awaited): void {
    this.awaited.push(field);
    this.label(-1);
  }

  /** The field has a value now. */
  arrived(field: Awaited): void {
    this.awaited.splice(this.awaited.indexOf(field), 1);
    this.label(-1);
  }

  /** New data of a component. */
  take(component: string, time: number, data: unknown): void {
    if (this.paused || !this.curves.some((curve) => curve.component === component)) return;
    this.forget(time);
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

  /** Redraw in the colours of the theme. */
  paint(): void {
    if (this.chart) this.build();
  }

  /** Draw the new data. */
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

  /** The simulation went back in time or was restarted: delete later data. */
  private forget(time: number): void {
    let length = this.times.length;
    while (length > 0 && (this.times[length - 1] as number) > time) length -= 1;
    for (const column of [this.times, ...this.values]) column.length = length;
  }

  private build(): void {
    this.chart?.destroy();
    this.label(-1); // first: the chart gets the height that the legend leaves
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--quiet");
    const grid = { stroke: style.getPropertyValue("--line"), width: 1 };
    const axis = { stroke: ink, grid, ticks: grid, font: "12px system-ui", size: 50 };
    // time begins at 0: the curve grows from the left until the window is full
    const range = (_chart: uPlot, low: number, high: number): [number, number] =>
      this.seconds === 0 || high === null ? [low, high] : [Math.max(0, high - this.seconds), Math.max(this.seconds, high)];
    // a constant value is in the middle of a range of its own size, not of 0 to 100
    const around = (_chart: uPlot, low: number | null, high: number | null): [number, number] => {
      if (low === null || high === null) return [-1, 1];
      const size = Math.max(Math.abs(low), Math.abs(high));
      if (high - low < 1e-6 * size || size < 1e-9) {
        const half = size < 1e-9 ? 1 : size / 10;
        return [low - half, high + half];
      }
      return uPlot.rangeNum(low, high, 0.1, true) as [number, number];
    };
    this.chart = new uPlot(
      {
        ...this.size(),
        legend: { show: false },
        cursor: { y: false },
        hooks: { setCursor: [(chart) => this.label(chart.cursor.idx ?? this.times.length - 1)] },
        scales: { x: { time: false, range }, y: { range: around } },
        axes: [{ ...axis, size: 30, values: (_chart, splits) => splits.map((split) => isDate(split) ? formatTime(split) : `${Number(split.toFixed(3))} s`) }, { ...axis, size: (_chart, texts) => 16 + 7 * Math.max(6, ...(texts ?? []).map((text) => text.length)), values: (_chart, splits) => this.ticks(splits) }],
        series: [
          {},
          ...this.curves.map((_curve, i) => ({ stroke: colorOf(i), width: 1.6, spanGaps: true, points: { show: false } })),
        ],
      },
      [this.times, ...this.values] as uPlot.AlignedData,
      this.canvas,
    );
  }

  /** The legend: curves by component and field, with their values at an index. */
  private label(index: number): void {
    const items = this.curves.map(({ component, path, unit }, i) => {
      const value = this.values[i]?.[index];
      const text = value == null ? "" : ` ${format(value)} ${unit}`;
      const whose = h("span", { class: "quiet" }, `${component}.`);
      return h("li", { title: `${component}.${path}`, style: `--ink: ${colorOf(i)}` }, h("span", {}, whose, path), h("b", {}, text));
    });
    const awaited = this.awaited.map(({ component, field }) => h("li", { class: "quiet" }, `${component}.${field} has no value yet…`));
    this.legend.replaceChildren(...items, ...awaited);
  }

  /** Different texts for different numbers, with the unit that all curves have. */
  private ticks(splits: number[]): string[] {
    const [unit = ""] = this.curves.map((curve) => curve.unit);
    const common = this.curves.every((curve) => curve.unit === unit) ? ` ${unit}` : "";
    const step = Math.abs((splits[1] ?? 1) - (splits[0] ?? 0)) || 1;
    const largest = Math.max(...splits.map(Math.abs));
    const power = (size: number): number => Math.floor(Math.log10(size) + 1e-9);
    const digits = Math.max(0, -power(step));
    const text = (split: number): string => {
      if (Math.abs(split) < step / 1000) return "0";
      return digits > 4 || largest >= 1e6 ? split.toExponential(Math.max(0, power(largest) - power(step))) : split.toFixed(digits);
    };
    return splits.map((split) => `${text(split)}${common}`);
  }

  private size(): { width: number; height: number } {
    return { width: Math.max(this.canvas.clientWidth, 160), height: Math.max(this.canvas.clientHeight, 40) };
  }
}
