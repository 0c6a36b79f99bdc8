/** The address of a file of the simulator, relative to the page: a proxy may serve both in a folder. */
export function fileAddress(path: string, page: string): string {
  return new URL(path.replace(/^\//, ""), new URL(".", page)).href;
}
