type Rgb = readonly [number, number, number];

/** From near to far; the lightness decreases monotonically, so that the order is visible without distinguishing hues. */
const DEPTHS: readonly Rgb[] = [
  [255, 246, 190],
  [255, 196, 92],
  [244, 122, 60],
  [205, 62, 92],
  [140, 46, 124],
  [84, 42, 134],
  [44, 36, 104],
];
/** The golden ratio: consecutive hues differ strongly. The same colours as those of `morse render --show ids`. */
const STEP = 0.6180339887;

/** The colour of a share, 0 for near, 1 for far. */
export function depthColor(share: number): Rgb {
  const place = Math.min(Math.max(share, 0), 1) * (DEPTHS.length - 1);
  const index = Math.min(Math.floor(place), DEPTHS.length - 2);
  const [from, to] = [DEPTHS[index] as Rgb, DEPTHS[index + 1] as Rgb];
  const mix = (i: 0 | 1 | 2): number => Math.round(from[i] + (to[i] - from[i]) * (place - index));
  return [mix(0), mix(1), mix(2)];
}

/** The colour of a share, 0 for cold, 1 for hot: the colours of depths, so that hot is bright. */
export function heatColor(share: number): Rgb {
  return depthColor(1 - share);
}

/** The colours of depths as a CSS gradient, near at the left. */
export const DEPTH_GRADIENT = `linear-gradient(90deg, ${DEPTHS.map((color) => `rgb(${color.join(" ")})`).join(", ")})`;

/** The colours of temperatures as a CSS gradient, cold at the left. */
export const HEAT_GRADIENT = DEPTH_GRADIENT.replace("90deg", "270deg");

/** The colour of an id; black for 0. */
export function idColor(id: number): Rgb {
  if (id === 0) return [0, 0, 0];
  return fromHsv((id * STEP) % 1, [0.75, 0.5][Math.floor(id / 8) % 2] as number, [0.95, 0.7][Math.floor(id / 16) % 2] as number);
}

function fromHsv(hue: number, saturation: number, value: number): Rgb {
  const part = (offset: number): number => {
    const place = (offset + hue * 6) % 6;
    return Math.round(255 * (value - value * saturation * Math.max(0, Math.min(place, 4 - place, 1))));
  };
  return [part(5), part(3), part(1)];
}
