import { h } from "../ui/dom";
import type { Stage } from "../view/stage";

/** Rendered frames per second, if the script requests it. */
export class Rate {
  readonly element = h("p", { class: "rate", hidden: true });

  constructor(stage: Stage) {
    let frames = 0;
    setInterval(() => {
      this.element.hidden = stage.world?.description.view.show_framerate !== true;
      if (!this.element.hidden) this.element.textContent = `${stage.frames - frames} frames/s`;
      frames = stage.frames;
    }, 1000);
  }
}
