/** Close a popup when something else is pressed or focused, and by Escape, which gives the focus back to what opens it. */
export function closeWhenLeft(parts: Element[], opener: HTMLElement, isOpen: () => boolean, close: () => void): void {
  const leave = ({ target }: Event): void => {
    const inside = target instanceof Node && parts.some((part) => part.contains(target));
    if (isOpen() && !inside) close();
  };
  addEventListener("pointerdown", leave);
  addEventListener("focusin", leave);
  const escape = (event: Event): void => {
    if (!(event instanceof KeyboardEvent) || event.key !== "Escape" || !isOpen()) return;
    event.stopPropagation(); // what is selected stays so
    close();
    opener.focus();
  };
  for (const part of parts) part.addEventListener("keydown", escape);
}
