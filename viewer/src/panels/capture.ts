import { h, iconButton } from "../ui/dom";
import { fileName, save } from "../ui/files";
import { icons } from "../ui/icons";
import type { Stage } from "../view/stage";
import type { Toasts } from "./toasts";

/** Saves the view as a picture or a film. */
export class Capture {
  readonly element: HTMLElement;
  private readonly film = iconButton(icons.film, "Film the view", () => this.toggleFilm());
  private recorder: MediaRecorder | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly toasts: Toasts,
  ) {
    this.element = h("div", { class: "tools" }, iconButton(icons.shot, "Screenshot", () => this.picture(), "X"), this.film);
  }

  picture(): void {
    this.stage.draw(); // the buffer of the last frame can no longer be read
    this.stage.renderer.domElement.toBlob((blob) => {
      if (blob) save(blob, fileName("view", "png"));
      else this.toasts.show("The browser did not return a picture.", "error");
    });
  }

  toggleFilm(): void {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    const type = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find((one) => MediaRecorder.isTypeSupported(one));
    if (type === undefined) {
      this.toasts.show("This browser cannot film the view.", "error");
      return;
    }
    const parts: Blob[] = [];
    const recorder = new MediaRecorder(this.stage.renderer.domElement.captureStream(30), { mimeType: type, videoBitsPerSecond: 8e6 });
    recorder.ondataavailable = ({ data }) => parts.push(data);
    recorder.onstop = () => {
      this.recorder = null;
      this.film.setAttribute("aria-pressed", "false");
      save(new Blob(parts, { type: "video/webm" }), fileName("view", "webm"));
    };
    recorder.start(1000);
    this.recorder = recorder;
    this.film.setAttribute("aria-pressed", "true");
    this.toasts.show("Filming. Press the button again to stop.");
  }
}
