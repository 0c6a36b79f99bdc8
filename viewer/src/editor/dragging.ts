/** Distance in pixels after which a press is a drag. */
const SLACK = 6;

/** Let an element be dragged by mouse, pen or finger, or pressed. */
export function draggable(
  element: HTMLElement,
  handlers: { drag: (x: number, y: number) => void; drop: (x: number, y: number) => void; cancel: () => void; press: () => void },
): void {
  let from: { x: number; y: number } | null = null;
  let dragged = false;
  const end = (): void => {
    from = null;
    removeEventListener("keydown", escape, true);
  };
  const escape = (event: KeyboardEvent): void => {
    if (event.key !== "Escape" || !dragged) return;
    event.stopPropagation();
    end();
    handlers.cancel();
  };
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    from = { x: event.clientX, y: event.clientY };
    dragged = false;
    element.setPointerCapture(event.pointerId);
    addEventListener("keydown", escape, true);
  });
  element.addEventListener("pointermove", (event) => {
    if (!from) return;
    dragged ||= Math.hypot(event.clientX - from.x, event.clientY - from.y) > SLACK;
    if (dragged) handlers.drag(event.clientX, event.clientY);
  });
  element.addEventListener("pointerup", (event) => {
    if (!from) return;
    end();
    if (dragged) handlers.drop(event.clientX, event.clientY);
  });
  element.addEventListener("pointercancel", () => {
    if (from && dragged) handlers.cancel();
    end();
  });
  // by keys as well, and not at the end of a drag
  element.addEventListener("click", () => {
    if (!dragged) handlers.press();
    dragged = false;
  });
}
