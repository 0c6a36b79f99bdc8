/** Colours that are told apart on light and dark ground, also by those who see no red or green. */
const COLORS = ["#d9660c", "#2f7fc2", "#3a9a4a", "#b14cc0", "#c23b4a", "#0f9a9a", "#8a7a1a", "#6a6fd0"];

/** The colour of a curve: none twice. */
export function colorOf(index: number): string {
  // beyond the chosen ones, hues as far apart as the golden angle makes them
  return COLORS[index] ?? `hsl(${((index * 137.508) % 360).toFixed(0)} 55% ${index % 2 === 0 ? 45 : 58}%)`;
}
