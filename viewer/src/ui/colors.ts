/** Colours that can be distinguished on light and dark backgrounds, also with red-green colour blindness. */
const COLORS = ["#d9660c", "#2f7fc2", "#3a9a4a", "#b14cc0", "#c23b4a", "#0f9a9a", "#8a7a1a", "#6a6fd0"];

/** The colour of a curve: all are different. */
export function colorOf(index: number): string {
  // after these, hues at the golden angle
  return COLORS[index] ?? `hsl(${((index * 137.508) % 360).toFixed(0)} 55% ${index % 2 === 0 ? 45 : 58}%)`;
}
