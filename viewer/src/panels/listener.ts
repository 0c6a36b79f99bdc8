import type { Connection } from "../connection/connection";
import { disable, h } from "../ui/dom";
import { icons } from "../ui/icons";
import { Signal } from "../ui/signal";

const ALL = "";

/** Selects the robot that the keys drive. */
export class Listener {
  readonly element = h("label", { class: "listener", hidden: true, title: "the robot that the arrow keys drive" });
  readonly robot = new Signal<string | null>(null);
  /** the robots that keys can drive */
  readonly robots = new Signal<string[]>([]);
  private readonly select = h("select", { "aria-label": "the robot that obeys the keys" });

  constructor(private readonly connection: Connection) {
    this.element.innerHTML = icons.wheel;
    this.element.append(this.select);
    this.select.addEventListener("change", () => {
      this.ask(this.select.value === ALL ? null : this.select.value);
      this.select.blur();
    });
    connection.on("listening", ({ robots, robot }) => {
      this.element.hidden = robots.length === 0;
      const options = robots.map((name) => h("option", { value: name }, name));
      if (robots.length > 1) options.unshift(h("option", { value: ALL }, "all robots"));
      this.select.replaceChildren(...options);
      this.select.value = robot ?? (robots.length > 1 ? ALL : (robots[0] ?? ALL));
      this.robot.set(robot);
      this.robots.set(robots);
    });
  }

  /** The robot that keys drive; null if there is none, or more than one. */
  get driven(): string | null {
    const robots = this.robots.value;
    return this.robot.value ?? (robots.length === 1 ? (robots[0] ?? null) : null);
  }

  enable(enabled: boolean): void {
    disable(this.select, !enabled);
  }

  ask(robot: string | null): void {
    this.connection.send({ type: "listen_to", robot });
  }
}
