/** The keys that fly the camera, by their positions on the keyboard. */
export const FLY = {
  ahead: ["KeyW", "KeyZ"],
  back: ["KeyS"],
  left: ["KeyA", "KeyQ"],
  right: ["KeyD"],
  up: ["KeyR"],
  down: ["KeyF"],
};

export const CAMERA_KEYS: ReadonlySet<string> = new Set(Object.values(FLY).flat());
