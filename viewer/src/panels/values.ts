/** Decimals of a field by its name: a millimetre, also of a place on earth in degrees. */
export function decimalsOf(name: string): number {
  return /^(latitude|longitude)/.test(name) ? 8 : 3;
}

/** Format a value for display; numbers with the relevant precision, those declared as float with decimals even if they are whole. */
export function format(value: unknown, type = "", decimals = 3): string {
  if (typeof value === "number") return formatNumber(value, type.includes("float"), decimals);
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (value === null || value === undefined) return "–";
  if (typeof value === "string") return value;
  if (Array.isArray(value)) {
    if (value.length === 0) return "none";
    if (value.length > 8) return `${value.length} values`;
    return value.map((part) => format(part, type, decimals)).join(", ");
  }
  if (typeof value === "object") {
    const entries = Object.entries(value);
    if (entries.length === 0) return "none";
    return entries.length > 6 ? `${entries.length} entries` : entries.map(([name, part]) => `${name}: ${format(part, "", decimalsOf(name))}`).join(", ");
  }
  return String(value);
}

/** Smaller numbers are rounding errors. */
const NOTHING = 1e-9;

/** From here on, numbers have an exponent; times since 1970 and places on a map are below. */
const HUGE = 1e10;

function formatNumber(value: number, real: boolean, decimals: number): string {
  if (Number.isInteger(value) && !(real && Math.abs(value) < HUGE)) return String(value);
  const size = Math.abs(value);
  if (size < NOTHING) return "0.000";
  return (size < 1e-3 || size >= HUGE) ? value.toExponential(2) : value.toFixed(decimals);
}

/** The numbers in a value, each with its path: x, 0, position.1 */
export function numbersIn(value: unknown, path: string[] = []): [string, number][] {
  if (typeof value === "number") return [[path.join("."), value]];
  if (typeof value === "boolean") return [[path.join("."), value ? 1 : 0]];
  if (value === null || typeof value !== "object" || path.length > 3) return [];
  const entries = Object.entries(value);
  return entries.length > 16 ? [] : entries.flatMap(([name, part]) => numbersIn(part, [...path, name]));
}

/** The number at a path in a value. */
export function numberAt(value: unknown, path: string): number | null {
  let part: unknown = value;
  for (const name of path.split(".")) {
    if (part === null || typeof part !== "object") return null;
    part = Reflect.get(part, name);
  }
  return typeof part === "number" ? part : typeof part === "boolean" ? Number(part) : null;
}

/** Typed text as the type that a component declares; the component refuses wrong values. */
export function parse(text: string, type: string): unknown {
  const trimmed = text.trim();
  if (/^str/.test(type)) return text;
  const python = trimmed.replace(/\bTrue\b/g, "true").replace(/\bFalse\b/g, "false").replace(/\bNone\b/g, "null");
  try {
    return JSON.parse(python);
  } catch {
    try {
      // tuples and quotes in Python syntax
      return JSON.parse(python.replace(/'/g, '"').replace(/\(/g, "[").replace(/\)/g, "]"));
    } catch {
      return text;
    }
  }
}

/** A value as text for editing. */
export function write(value: unknown): string {
  // as in scene scripts, where a property may be None
  if (value === null) return "None";
  return typeof value === "string" ? value : JSON.stringify(value);
}
