/** Close a popup when another element is pressed or focused, and by Escape, which returns the focus to the opener. */
export function closeWhenLeft(parts: Element[], opener: HTMLElement, isOpen: () => boolean, close: () => void): void {
  const leave = ({ target }: Event): void => {
    const inside = target instanceof Node && parts.some((part) => part.contains(target));
    if (isOpen() && !inside) close();
  };
  addEventListener("pointerdown", leave);
  addEventListener("focusin", leave);
  const escape = (event: Event): void => {
    if (!(event instanceof KeyboardEvent) || event.key !== "Escape" || !isOpen()) return;
    event.stopPropagation(); // the selection stays
    close();
    opener.focus();
  };
  for (const part of parts) part.addEventListener("keydown", escape);
}
