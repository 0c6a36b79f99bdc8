import type { Picture } from "../generated/protocol";
import type { Pixels } from "../images/decode";
import { decode } from "../images/decode";
import { Marks } from "../images/marks";
import { DEPTH_GRADIENT, HEAT_GRADIENT } from "../images/palette";
import { h, iconButton } from "../ui/dom";
import { fileName, save } from "../ui/files";
import { icons } from "../ui/icons";

/** Number of images from which the rate is computed. */
const COUNTED = 10;

/** Actions of the page for the panel. */
export interface PictureActions {
  hold(): void;
  close(): void;
}

/** The image of one camera, with boxes, scale, size and rate. */
export class PicturePanel {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { width: 160, height: 120, role: "img" });
  private readonly marks = new Marks();
  private readonly reading = h("output", { class: "reading", hidden: true });
  private readonly near = h("span", {});
  private readonly far = h("span", {});
  private readonly ramp = h("span", { class: "ramp" });
  private readonly scale = h("div", { class: "scale", hidden: true }, this.near, this.ramp, this.far);
  private readonly facts = h("span", { class: "facts quiet" }, "no picture yet");
  private readonly holdButton: HTMLButtonElement;
  private readonly boxesButton = iconButton(icons.boxes, "Boxes with names", () => this.toggleBoxes());
  private readonly sizeButton = iconButton(icons.enlarge, "Larger", () => this.toggleSize());
  private readonly times: number[] = [];
  private picture: Picture | null = null;
  private pixels: Pixels | null = null;
  /** images that were decoded or skipped */
  taken = 0;
  private decoding = false;
  private next: Picture | null = null;

  constructor(
    readonly camera: string,
    color: string,
    actions: PictureActions,
  ) {
    this.canvas.setAttribute("aria-label", `what ${camera} sees`);
    this.holdButton = iconButton(icons.pause, "Stop the cameras", () => actions.hold(), "Space");
    this.holdButton.classList.add("hold");
    this.boxesButton.hidden = true;
    this.boxesButton.setAttribute("aria-pressed", "true");
    const shown = h("div", { class: "shown" }, this.canvas, this.marks.element, this.reading);
    shown.addEventListener("pointermove", (event) => this.read(event));
    shown.addEventListener("pointerleave", () => (this.reading.hidden = true));
    shown.addEventListener("dblclick", () => this.toggleSize());
    this.element = h(
      "figure",
      { class: "image", style: `--ink: ${color}`, "data-camera": camera },
      shown,
      this.scale,
      h(
        "figcaption",
        {},
        h("span", { class: "name", title: camera }, camera),
        this.facts,
        h(
          "span",
          { class: "tools" },
          this.boxesButton,
          this.holdButton,
          iconButton(icons.shot, "Save the picture", () => this.save()),
          this.sizeButton,
          iconButton(icons.close, "Close", () => actions.close()),
        ),
      ),
    );
  }

  /** The label of the button is its next action. */
  showCapturing(active: boolean): void {
    this.holdButton.innerHTML = active ? icons.pause : icons.play;
    this.holdButton.ariaLabel = active ? "Stop the cameras" : "Let the cameras take pictures";
    this.holdButton.title = `${this.holdButton.ariaLabel} (Space)`;
  }

  /** Draw an image; of several that arrive during the decoding of another one, only the last one is drawn. */
  async show(picture: Picture): Promise<void> {
    this.next = picture;
    if (this.decoding) return;
    this.decoding = true;
    try {
      while (this.next) {
        const one: Picture = this.next;
        this.next = null;
        const pixels = await decode(one).catch(() => null);
        // an image that the browser cannot decode is skipped
        if (pixels) this.draw(one, pixels);
        this.taken += 1;
      }
    } finally {
      this.decoding = false;
    }
  }

  private draw(picture: Picture, pixels: Pixels): void {
    const { width, height, time, meaning, low, high, unit, sightings } = picture;
    const { canvas } = this;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext("2d");
    if (pixels.image instanceof ImageData) context?.putImageData(pixels.image, 0, 0);
    else {
      context?.drawImage(pixels.image, 0, 0, width, height);
      pixels.image.close();
    }
    this.picture = picture;
    this.pixels = pixels;
    this.marks.show(sightings, width, height);
    this.boxesButton.hidden = meaning !== "ids";
    this.scale.hidden = meaning !== "depth" && meaning !== "temperature";
    this.ramp.style.background = meaning === "temperature" ? HEAT_GRADIENT : DEPTH_GRADIENT;
    this.near.textContent = withUnit(low, unit);
    this.far.textContent = withUnit(high, unit);
    this.count(time);
    const rate = this.rate();
    this.facts.textContent = `${width}×${height}${rate === null ? "" : ` · ${rate.toFixed(rate < 10 ? 1 : 0)} Hz`}`;
  }

  private count(time: number): void {
    const last = this.times.at(-1) ?? -Infinity;
    // the simulation went back in time, or was restarted
    if (time < last) this.times.length = 0;
    if (time !== last) this.times.push(time);
    if (this.times.length > COUNTED) this.times.shift();
  }

  /** Images per simulated second, or null while there are too few. */
  private rate(): number | null {
    const [first, last] = [this.times[0], this.times.at(-1)];
    if (first === undefined || last === undefined || last <= first) return null;
    return (this.times.length - 1) / (last - first);
  }

  /** Show the meaning of the pixel under the pointer: a depth, a temperature, or the name of an object. */
  private read(event: PointerEvent): void {
    const { picture, pixels } = this;
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    this.reading.hidden = true;
    if (!picture || !pixels || width === 0 || height === 0) return;
    const [column, row] = [Math.floor(((event.clientX - left) / width) * picture.width), Math.floor(((event.clientY - top) / height) * picture.height)];
    if (column < 0 || row < 0 || column >= picture.width || row >= picture.height) return;
    const text = this.meaningOf(row * picture.width + column, picture, pixels);
    this.reading.hidden = text === "";
    this.reading.textContent = text;
  }

  private meaningOf(index: number, { sightings, unit }: Picture, { ids, depthAt }: Pixels): string {
    if (ids) {
      const id = ids[index] ?? 0;
      if (id === 0) return "nothing";
      const sighting = sightings.find((one) => one.id === id);
      return sighting ? [sighting.name, sighting.kind].filter((part) => part !== "").join(": ") : `id ${id}`;
    }
    if (!depthAt) return "";
    const depth = depthAt(index);
    return Number.isNaN(depth) ? "nothing" : `≈ ${withUnit(depth, unit)}`;
  }

  private toggleBoxes(): void {
    const { element } = this.marks;
    element.hidden = !element.hidden;
    this.boxesButton.setAttribute("aria-pressed", String(!element.hidden));
  }

  private toggleSize(): void {
    const large = this.element.classList.toggle("large");
    this.sizeButton.innerHTML = large ? icons.reduce : icons.enlarge;
    this.sizeButton.ariaLabel = this.sizeButton.title = large ? "Smaller" : "Larger";
  }

  private save(): void {
    const copy = h("canvas", { width: this.canvas.width, height: this.canvas.height });
    const context = copy.getContext("2d");
    if (!context) return;
    context.drawImage(this.canvas, 0, 0);
    this.marks.drawOn(context);
    copy.toBlob((blob) => blob && save(blob, fileName(this.camera, "png")));
  }
}

function withUnit(value: number, unit: string): string {
  return `${Math.abs(value) < 10 ? value.toFixed(2) : value.toFixed(1)} ${unit}`.trim();
}
