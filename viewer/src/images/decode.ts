import type { Picture } from "../generated/protocol";
import { depthColor, heatColor, idColor } from "./palette";

/** The grey value of the largest depth: `FARTHEST_LEVEL` of the simulator. */
const FARTHEST = 32;
/** Darker grey values mean no depth. */
const NOTHING = FARTHEST / 2;

/** A decoded image, and the meaning of its pixels. */
export interface Pixels {
  image: ImageData | ImageBitmap;
  /** ids, row by row, or null */
  ids: Uint16Array | null;
  /** depth or temperature of a pixel, NaN for none; null if the image has neither */
  depthAt: ((index: number) => number) | null;
}

/** Decode an image, and colour depths, temperatures and ids. */
export async function decode(picture: Picture): Promise<Pixels> {
  const { width, height, mime, payload, meaning } = picture;
  if (mime === "image/x-rgba") return plain(new ImageData(new Uint8ClampedArray(payload), width, height));
  if (mime === "image/x-u16") {
    const ids = new Uint16Array(await inflate(payload));
    return { image: colored(ids, width, height), ids, depthAt: null };
  }
  const options: ImageBitmapOptions = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
  const bitmap = await createImageBitmap(new Blob([payload], { type: mime }), options);
  if (meaning === "depth") return depths(bitmap, picture, (depthWords ??= wordsOf(depthColor)));
  if (meaning === "temperature") return depths(bitmap, picture, (heatWords ??= wordsOf(heatColor)));
  return plain(bitmap);
}

function plain(image: ImageData | ImageBitmap): Pixels {
  return { image, ids: null, depthAt: null };
}

async function inflate(payload: ArrayBuffer): Promise<ArrayBuffer> {
  return new Response(new Blob([payload]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}

function colored(ids: Uint16Array, width: number, height: number): ImageData {
  const image = new ImageData(width, height);
  const words = new Uint32Array(image.data.buffer);
  const known = new Map<number, number>();
  ids.forEach((id, i) => {
    let word = known.get(id);
    if (word === undefined) known.set(id, (word = asWord(idColor(id))));
    words[i] = word;
  });
  return image;
}

let depthWords: Uint32Array | null = null;
let heatWords: Uint32Array | null = null;

/** The pixel for each grey value. */
function wordsOf(color: (share: number) => readonly [number, number, number]): Uint32Array {
  return Uint32Array.from({ length: 256 }, (_, grey) => asWord(grey < NOTHING ? [0, 0, 0] : color(shareOf(grey))));
}

function depths(bitmap: ImageBitmap, { width, height, low, high }: Picture, colors: Uint32Array): Pixels {
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true }) as OffscreenCanvasRenderingContext2D;
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  const image = context.getImageData(0, 0, width, height);
  const greys = Uint8Array.from({ length: width * height }, (_, i) => image.data[4 * i] as number);
  const words = new Uint32Array(image.data.buffer);
  greys.forEach((grey, i) => (words[i] = colors[grey] as number));
  const depthAt = (index: number): number => {
    const grey = greys[index] ?? 0;
    return grey < NOTHING ? NaN : low + (high - low) * Math.min(Math.max(shareOf(grey), 0), 1);
  };
  return { image, ids: null, depthAt };
}

function shareOf(grey: number): number {
  return (255 - grey) / (255 - FARTHEST);
}

/** Opaque RGBA as a little-endian word, as in graphics memory. */
function asWord([red, green, blue]: readonly [number, number, number]): number {
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
