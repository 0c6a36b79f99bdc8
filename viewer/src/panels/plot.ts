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
  /** the path with the axis of a vector: position.x */
  label?: string;
  unit: string;
}

/** A field that has no value yet. */
export interface Awaited {
  component: string;
  field: string;
}

/** Points of a curve: numbers of the horizontal and of the vertical axis. */
type Points = [number[], number[]];

/** Curves over simulated time, or over another curve, in one diagram. */
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
  private readonly over = h("select", { title: "horizontal axis", "aria-label": "horizontal axis", onchange: () => this.setOver(this.over.value) });
  private chart: uPlot | null = null;
  private paused = false;
  private stale = true;
  private seconds = 15;

  /** @param onFoxglove says how Foxglove opens the run; null in a run without a simulator */
  constructor(onFoxglove: (() => void) | null) {
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
          this.over,
          this.span,
          pause,
          h("button", { type: "button", title: "save as picture", onclick: () => this.chart && savePicture(this.chart.ctx.canvas, this.titles()) }, "PNG"),
          h("button", { type: "button", title: "save as table", onclick: () => saveTable(this.csv()) }, "CSV"),
          onFoxglove && h("button", { type: "button", class: "foxglove", title: "open the run in Foxglove", onclick: onFoxglove }, "Foxglove"),
          iconButton(icons.close, "Close", () => this.onEmpty()),
        ),
      ),
      this.canvas,
    );
    new ResizeObserver(() => {
      this.chart?.setSize(this.size());
      this.stale = true; // equal scales depend on the size
    }).observe(this.canvas);
    this.offer();
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

  /** The curve of the horizontal axis, as component and path with a dot between; "" for time. */
  get horizontal(): string {
    return this.over.value;
  }

  /** Draw over a curve, by its name, or over time; a name that is no curve of the plot means time. */
  setOver(name: string): void {
    this.over.value = this.curves.some((curve) => nameOf(curve) === name) ? name : "";
    if (this.curves.length > 0) this.build();
    this.onWindow();
  }

  add(curve: Curve): void {
    if (this.curves.some(({ component, path }) => component === curve.component && path === curve.path)) return;
    this.curves.push(curve);
    this.values.push(this.times.map(() => null));
    this.offer();
    this.build();
  }

  /** The horizontal axes from which one can choose. */
  private offer(): void {
    const chosen = this.over.value;
    this.over.replaceChildren(h("option", { value: "" }, "over time"), ...this.curves.map((curve) => h("option", { value: nameOf(curve) }, `over ${labelOf(curve)}`)));
    this.over.value = chosen;
    this.over.hidden = this.curves.length < 2;
  }

  /** Index of the curve of the horizontal axis; -1 for time. */
  private get base(): number {
    return this.curves.findIndex((curve) => nameOf(curve) === this.over.value);
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
    this.chart.setData(this.content());
    if (this.chart.cursor.idx == null) this.label(this.times.length - 1);
  }

  csv(): string {
    const names = this.curves.map((curve) => `"${labelOf(curve)}${curve.unit ? ` (${curve.unit})` : ""}"`);
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

  /** What the chart draws: columns over time, or the points of each curve over the base. */
  private content(): uPlot.AlignedData {
    if (this.base < 0) return [this.times, ...this.values] as uPlot.AlignedData;
    return [null, ...this.others().map((i) => this.points(i))] as unknown as uPlot.AlignedData;
  }

  private others(): number[] {
    return [...this.curves.keys()].filter((i) => i !== this.base);
  }

  /** The values of a curve in the time window, each with the latest value of the base. */
  private points(curve: number): Points {
    const [base, column] = [this.values[this.base], this.values[curve]];
    const points: Points = [[], []];
    const begin = this.seconds === 0 ? -Infinity : (this.times.at(-1) ?? 0) - this.seconds;
    let x: number | null = null;
    this.times.forEach((time, row) => {
      x = base?.[row] ?? x;
      const y = column?.[row];
      if (x === null || y == null || time < begin) return;
      points[0].push(x);
      points[1].push(y);
    });
    return points;
  }

  /** Range of an axis around all points; metres and metres, for example, have the same scale: a circle is round. */
  private rangeOf(chart: uPlot, axis: 0 | 1): [number, number] {
    const bounds = ([0, 1] as const).map((one) => {
      const numbers = this.others().flatMap((i) => (chart.data[this.others().indexOf(i) + 1] as unknown as Points | undefined)?.[one] ?? []);
      return around(chart, numbers.length ? numbers.reduce((a, b) => Math.min(a, b)) : null, numbers.length ? numbers.reduce((a, b) => Math.max(a, b)) : null);
    }) as [[number, number], [number, number]];
    const [low, high] = bounds[axis];
    const unit = this.curves[this.base]?.unit ?? "";
    const { width, height } = chart.bbox;
    if (unit === "" || !(width > 0 && height > 0) || this.curves.some((curve) => curve.unit !== unit)) return [low, high];
    const pixels = [width, height] as const;
    const scale = Math.max(...bounds.map(([from, to], one) => (to - from) / (pixels[one] as number)));
    const half = (scale * pixels[axis]) / 2;
    return [(low + high) / 2 - half, (low + high) / 2 + half];
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
    // a number every 20 pixels, so that also a low diagram has two
    const vertical = { ...axis, space: 20, size: (_chart: uPlot, texts: string[] | null) => 16 + 7 * Math.max(6, ...(texts ?? []).map((text) => text.length)) };
    if (this.base >= 0) {
      const [base, others] = [this.curves[this.base] as Curve, this.others()];
      const facets = [{ scale: "x", auto: true }, { scale: "y", auto: true }];
      this.chart = new uPlot(
        {
          ...this.size(),
          mode: 2,
          legend: { show: false },
          cursor: { show: false },
          scales: { x: { time: false, range: (chart) => this.rangeOf(chart, 0) }, y: { range: (chart) => this.rangeOf(chart, 1) } },
          axes: [
            { ...axis, size: 30, values: (_chart, splits) => this.ticks(splits, [base]) },
            { ...vertical, values: (_chart, splits) => this.ticks(splits, others.map((i) => this.curves[i] as Curve)) },
          ],
          series: [{}, ...others.map((i) => ({ stroke: colorOf(i), width: 1.6, facets, points: { show: false }, paths: track }))],
        },
        this.content(),
        this.canvas,
      );
      this.stale = true; // the size of the diagram is known now
      return;
    }
    this.chart = new uPlot(
      {
        ...this.size(),
        legend: { show: false },
        cursor: { y: false },
        hooks: { setCursor: [(chart) => this.label(chart.cursor.idx ?? this.times.length - 1)] },
        scales: { x: { time: false, range }, y: { range: around } },
        axes: [{ ...axis, size: 30, values: (_chart, splits) => splits.map((split) => isDate(split) ? formatTime(split) : `${Number(split.toFixed(3))} s`) }, { ...vertical, values: (_chart, splits) => this.ticks(splits) }],
        series: [
          {},
          ...this.curves.map((_curve, i) => ({ stroke: colorOf(i), width: 1.6, spanGaps: true, points: { show: false } })),
        ],
      },
      this.content(),
      this.canvas,
    );
  }

  /** The legend: curves by component and field, with their values at an index. */
  private label(index: number): void {
    const items = this.curves.map(({ component, path, label, unit }, i) => {
      const value = this.values[i]?.[index];
      const text = value == null ? "" : ` ${format(value)} ${unit}`;
      const whose = h("span", { class: "quiet" }, `${component}.`);
      const ink = i === this.base ? "transparent" : colorOf(i);
      return h("li", { title: `${component}.${path}`, style: `--ink: ${ink}` }, h("span", {}, whose, label ?? path), h("b", {}, text));
    });
    const awaited = this.awaited.map(({ component, field }) => h("li", { class: "quiet" }, `${component}.${field} has no value yet…`));
    this.legend.replaceChildren(...items, ...awaited);
  }

  /** What a picture of the plot says about its curves, each with its colour. */
  private titles(): [string, string][] {
    if (this.base < 0) return this.curves.map((curve, i) => [labelOf(curve), colorOf(i)]);
    return this.others().map((i) => [`${labelOf(this.curves[i] as Curve)} over ${labelOf(this.curves[this.base] as Curve)}`, colorOf(i)]);
  }

  /** Different texts for different numbers, with the unit that all curves have. */
  private ticks(splits: number[], curves: Curve[] = this.curves): string[] {
    const [unit = ""] = curves.map((curve) => curve.unit);
    const common = curves.every((curve) => curve.unit === unit) ? ` ${unit}` : "";
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

/** What identifies a curve. */
function nameOf({ component, path }: Curve): string {
  return `${component}.${path}`;
}

/** What people read. */
function labelOf({ component, path, label }: Curve): string {
  return `${component}.${label ?? path}`;
}

/** The range of an axis: a constant value is in the middle of a range of its own size, not of 0 to 100. */
function around(_chart: uPlot, low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [-1, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (high - low < 1e-6 * size || size < 1e-9) {
    const half = size < 1e-9 ? 1 : size / 10;
    return [low - half, high + half];
  }
  return uPlot.rangeNum(low, high, 0.1, true) as [number, number];
}

/** The points in the order of time, with a ring at the latest one. */
function track(chart: uPlot, series: number): uPlot.Series.Paths | null {
  const [xs, ys] = chart.data[series] as unknown as Points;
  const path = new Path2D();
  let [x, y] = [0, 0];
  xs.forEach((value, i) => {
    [x, y] = [chart.valToPos(value, "x", true), chart.valToPos(ys[i] as number, "y", true)];
    path.lineTo(x, y); // the first one begins the path
  });
  if (xs.length === 0) return null;
  const radius = 4 * devicePixelRatio;
  path.moveTo(x + radius, y);
  path.arc(x, y, radius, 0, 2 * Math.PI);
  return { stroke: path, flags: 0 };
}
