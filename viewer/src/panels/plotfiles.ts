import { h } from "../ui/dom";
import { fileName, save } from "../ui/files";
import { colorOf } from "../ui/colors";
import type { Curve } from "./plot";

/** Save a plot with the names of its curves as a picture. */
export function savePicture(drawn: HTMLCanvasElement, curves: Curve[]): void {
  const picture = h("canvas", { width: drawn.width, height: drawn.height + 40 });
  const context = picture.getContext("2d");
  if (!context) return;
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--panel");
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(drawn, 0, 0);
  context.font = "20px system-ui, sans-serif";
  let x = 20;
  curves.forEach(({ component, path }, i) => {
    const label = `${component}.${path}`;
    context.fillStyle = colorOf(i);
    context.fillText(label, x, drawn.height + 26);
    x += context.measureText(label).width + 24;
  });
  picture.toBlob((blob) => blob && save(blob, fileName("plot", "png")));
}

export function saveTable(csv: string): void {
  save(csv, fileName("plot", "csv"));
}
