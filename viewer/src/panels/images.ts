import type { Connection } from "../connection/connection";
import type { Picture } from "../generated/protocol";
import type { Components } from "../model/components";
import type { Watching } from "../model/watching";
import { h, iconButton } from "../ui/dom";
import { fileName, save } from "../ui/files";
import { icons } from "../ui/icons";

interface Panel {
  element: HTMLElement;
  canvas: HTMLCanvasElement;
}

/** Camera images, one small panel each. */
export class Images {
  readonly element = h("div", { class: "images" });
  private readonly panels = new Map<string, Panel>();
  /** shown by the shortcut */
  private preferred: string | null = null;
  private capturing = true;

  constructor(
    private readonly connection: Connection,
    private readonly components: Components,
    private readonly watching: Watching,
  ) {
    connection.on("picture", (picture) => void this.show(picture));
    connection.on("capturing", ({ active }) => this.showCapturing(active));
  }

  /** The camera that the script selected for display: shown until it is closed. */
  prefer(camera: string | null): void {
    if (camera !== null && camera !== this.preferred && !this.panels.has(camera)) this.open(camera);
    this.preferred = camera;
  }

  /** Show or hide the image of a camera; without a name, of the selected camera or the first one. */
  toggle(camera: string | null = null): string | null {
    const name = camera ?? this.preferred ?? this.components.all.value.find(isCamera)?.name ?? null;
    if (name === null) return null;
    if (this.panels.has(name)) this.close(name);
    else this.open(name);
    return name;
  }

  private open(camera: string): void {
    const canvas = h("canvas", { width: 160, height: 120, role: "img", "aria-label": `what ${camera} sees` });
    const element = h(
      "figure",
      { class: "image" },
      canvas,
      h(
        "figcaption",
        {},
        h("span", {}, camera),
        this.hold(),
        iconButton(icons.shot, "Save the picture", () => canvas.toBlob((blob) => blob && save(blob, fileName(camera, "png")))),
        iconButton(icons.close, "Close", () => this.close(camera)),
      ),
    );
    this.panels.set(camera, { element, canvas });
    this.element.append(element);
    this.tell();
  }

  /** Start or stop capturing of all cameras. */
  capture(): void {
    this.connection.send({ type: "toggle_capturing" });
  }

  private hold(): HTMLButtonElement {
    const button = iconButton(icons.pause, "Stop the cameras", () => this.capture(), "Space");
    button.classList.add("hold");
    dress(button, this.capturing);
    return button;
  }

  private showCapturing(active: boolean): void {
    this.capturing = active;
    this.element.classList.toggle("stopped", !active);
    for (const button of this.element.querySelectorAll<HTMLButtonElement>(".hold")) dress(button, active);
  }

  private close(camera: string): void {
    this.panels.get(camera)?.element.remove();
    this.panels.delete(camera);
    this.tell();
  }

  private tell(): void {
    this.watching.set("images", "images", [...this.panels.keys()]);
  }

  private async show({ camera, width, height, mime, payload }: Picture): Promise<void> {
    const panel = this.panels.get(camera);
    if (!panel) return;
    const { canvas } = panel;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext("2d");
    if (mime === "image/x-rgba") context?.putImageData(new ImageData(new Uint8ClampedArray(payload), width, height), 0, 0);
    else {
      const bitmap = await createImageBitmap(new Blob([payload], { type: mime }));
      context?.drawImage(bitmap, 0, 0, width, height);
      bitmap.close();
    }
  }
}

/** The label of the button is its next action. */
function dress(button: HTMLButtonElement, capturing: boolean): void {
  button.innerHTML = capturing ? icons.pause : icons.play;
  button.ariaLabel = capturing ? "Stop the cameras" : "Let the cameras take pictures";
  button.title = `${button.ariaLabel} (Space)`;
}

function isCamera({ kind, data }: { kind: string; data: { name: string }[] }): boolean {
  return kind === "sensor" && data.some(({ name }) => name === "image");
}
