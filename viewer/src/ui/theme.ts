import { Signal } from "./signal";

export type Theme = "light" | "dark";
export type Choice = Theme | "auto";

const KEY = "morse.theme";
const system = matchMedia("(prefers-color-scheme: dark)");

/** The choice of the user: light, dark, or as the system. */
export const choice = new Signal<Choice>((localStorage.getItem(KEY) as Choice | null) ?? "auto");
export const theme = new Signal<Theme>("light");

function apply(): void {
  const wanted = choice.value === "auto" ? (system.matches ? "dark" : "light") : choice.value;
  document.documentElement.dataset["theme"] = wanted;
  theme.set(wanted);
}

choice.watch((value) => {
  localStorage.setItem(KEY, value);
  apply();
});
system.addEventListener("change", apply);

export function toggleTheme(): void {
  choice.set(theme.value === "light" ? "dark" : "light");
}
