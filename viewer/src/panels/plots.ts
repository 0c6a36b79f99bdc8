import "uplot/dist/uPlot.min.css";
import type { Components } from "../model/components";
import type { Session } from "../model/session";
import type { Watching } from "../model/watching";
import { h, reveal } from "../ui/dom";
import { theme } from "../ui/theme";
import { unitText } from "../ui/units";
import { FIELD } from "./inspector";
import type { Awaited, Curve } from "./plot";
import { Plot } from "./plot";
import { format, numbersIn } from "./values";

interface KeptPlot {
  curves: Curve[];
  awaited: Awaited[];
  window: number;
  /** the curve of the horizontal axis; "" for time */
  horizontal: string;
}

const HINT = matchMedia("(pointer: coarse)").matches
  ? "Tap the name of a field in the details twice to plot it."
  : "Drop a field of the inspector here to plot it, or double-click it there.";

/** The plots, side by side; a dropped field creates a new plot or is added to one. */
export class PlotsPanel {
  readonly element = h("section", { class: "plots", "aria-label": "plots" });
  readonly plots: Plot[] = [];
  private readonly hint = h("p", { class: "drop quiet" }, HINT);

  constructor(
    private readonly components: Components,
    private readonly watching: Watching,
    private readonly session: Session,
    private readonly onFirst: () => void,
    private readonly tell: (text: string) => void,
    private readonly onFoxglove: (() => void) | null,
  ) {
    this.element.append(this.hint);
    this.accept(this.element, null);
    components.onValues((name, { time, data }) => {
      for (const plot of [...this.plots]) {
        this.settle(plot, name);
        plot.take(name, time, data);
      }
    });
    theme.watch(() => {
      for (const plot of this.plots) plot.paint();
    });
    setInterval(() => {
      for (const plot of this.plots) plot.draw();
    }, 100);
    session.world.watch(() => this.recall());
  }

  /** Restore the plots of this tab after a reload. */
  private recall(): void {
    for (const { curves, awaited, window, horizontal } of this.session.recall<KeptPlot[]>("plots") ?? []) {
      if (this.plots.some((plot) => JSON.stringify(plot.curves) === JSON.stringify(curves))) continue;
      const plot = this.create();
      for (const curve of curves) plot.add(curve);
      for (const field of awaited) plot.await(field);
      plot.setWindow(window);
      plot.setOver(horizontal);
      this.ask();
      this.onFirst();
    }
  }

  private keep(): void {
    const kept: KeptPlot[] = this.plots.map(({ curves, awaited, window, horizontal }) => ({ curves, awaited, window, horizontal }));
    this.session.keep("plots", kept);
  }

  /** Plot all numbers of a field, in a new plot or in an existing one. */
  plot(component: string, field: string, into: Plot | null = null): Plot | null {
    const curves = this.curvesOf(component, field);
    if (curves !== null && curves.length === 0) {
      this.refuse(component, field);
      return into;
    }
    const plot = into ?? this.create();
    if (curves === null) plot.await({ component, field });
    else for (const curve of curves) plot.add(curve);
    this.ask();
    this.onFirst();
    reveal(plot.element);
    return plot;
  }

  /** A field that a plot waits for has its first value: create its curves. */
  private settle(plot: Plot, component: string): void {
    for (const awaited of plot.awaited.filter((one) => one.component === component)) {
      const curves = this.curvesOf(component, awaited.field);
      if (curves === null) continue;
      plot.arrived(awaited);
      for (const curve of curves) plot.add(curve);
      if (curves.length === 0) this.refuse(component, awaited.field);
      this.keep();
    }
    if (plot.curves.length + plot.awaited.length === 0) plot.onEmpty();
  }

  private refuse(component: string, field: string): void {
    const value = this.components.valuesOf(component)?.data[field];
    this.tell(`${component}.${field} cannot be plotted: ${value !== null && typeof value === "object" ? format(value) : "it is not a number"}.`);
  }

  private create(): Plot {
    const plot = new Plot(this.onFoxglove);
    plot.onEmpty = () => {
      plot.dispose();
      this.plots.splice(this.plots.indexOf(plot), 1);
      this.ask();
    };
    plot.onWindow = () => this.keep();
    this.accept(plot.element, plot);
    this.plots.push(plot);
    this.element.insertBefore(plot.element, this.hint);
    return plot;
  }

  /** The numbers of a field, or null while it has no value. */
  private curvesOf(component: string, field: string): Curve[] | null {
    const value = this.components.valuesOf(component)?.data[field] ?? null;
    if (value === null) return null;
    const { unit, type } = this.components.find(component)?.data.find(({ name }) => name === field) ?? { unit: "", type: "" };
    const isVector = type.startsWith("vec3");
    return numbersIn(value, [field]).map(([path], i) => {
      const curve = { component, path, unit: unitText(unit) };
      return isVector && path !== field ? { ...curve, label: `${field}.${"xyz"[i] ?? i}` } : curve;
    });
  }

  private accept(element: HTMLElement, plot: Plot | null): void {
    element.addEventListener("dragover", (event) => {
      if (!event.dataTransfer?.types.includes(FIELD)) return;
      event.preventDefault();
      event.stopPropagation();
    });
    element.addEventListener("drop", (event) => {
      const dropped = event.dataTransfer?.getData(FIELD);
      if (!dropped) return;
      event.preventDefault();
      event.stopPropagation();
      const [component, field] = JSON.parse(dropped) as [string, string];
      this.plot(component, field, plot);
    });
  }

  private ask(): void {
    this.hint.hidden = this.plots.length > 0;
    this.keep();
    this.watching.set("values", "plots", [...new Set(this.plots.flatMap(({ curves, awaited }) => [...curves, ...awaited].map(({ component }) => component)))]);
  }
}
