import { h } from "../ui/dom";
import { fileName, save } from "../ui/files";

/** Save a plot with the titles of its curves, each in its colour, as a picture. */
export function savePicture(drawn: HTMLCanvasElement, titles: [string, string][]): void {
  const picture = h("canvas", { width: drawn.width, height: drawn.height + 40 });
  const context = picture.getContext("2d");
  if (!context) return;
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--panel");
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(drawn, 0, 0);
  context.font = "20px system-ui, sans-serif";
  let x = 20;
  titles.forEach(([label, color]) => {
    context.fillStyle = color;
    context.fillText(label, x, drawn.height + 26);
    x += context.measureText(label).width + 24;
  });
  picture.toBlob((blob) => blob && save(blob, fileName("plot", "png")));
}

export function saveTable(csv: string): void {
  save(csv, fileName("plot", "csv"));
}
