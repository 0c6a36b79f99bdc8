/** Let the user save a file. */
export function save(content: Blob | string, name: string): void {
  const blob = typeof content === "string" ? new Blob([content], { type: "text/plain" }) : content;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A file name with the present time. */
export function fileName(what: string, ending: string): string {
  const now = new Date().toISOString().slice(0, 19).replace(/[:T]/g, "-");
  return `morse-${what.replace(/[^\w.-]+/g, "_")}-${now}.${ending}`;
}
