import type { Connection } from "../connection/connection";
import { h } from "../ui/dom";

/** The properties that the script displays, over the view. */
export class DebugList {
  private readonly rows = h("tbody");
  private readonly rest = h("p", { class: "quiet", hidden: true });
  readonly element = h("details", { class: "debug", open: true, hidden: true }, h("summary", {}, "properties"), h("table", {}, this.rows), this.rest);

  constructor(connection: Connection) {
    connection.on("debug_properties", ({ properties, more }) => {
      this.element.hidden = properties.length === 0;
      this.rows.replaceChildren(
        ...properties.map(({ node, name, value }) => h("tr", {}, h("th", { scope: "row" }, `${node}.${name}`), h("td", {}, value))),
      );
      this.rest.hidden = more === 0;
      this.rest.textContent = `and ${more} more`;
    });
  }
}
