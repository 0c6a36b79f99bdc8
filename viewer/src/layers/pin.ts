import { CanvasTexture, Sprite, SpriteMaterial } from "three";
import type { Components } from "../model/components";
import type { Stage } from "../view/stage";

const SIZE = 64;

/** A pin at the selected sensor or actuator, which may be too small to be seen, or have no body. */
export class Pin {
  private readonly sprite: Sprite;

  constructor(
    private readonly stage: Stage,
    private readonly components: Components,
  ) {
    const material = new SpriteMaterial({ map: new CanvasTexture(drawing()), depthTest: false, sizeAttenuation: false, toneMapped: false, fog: false });
    this.sprite = new Sprite(material);
    this.sprite.center.set(0.5, 0);
    this.sprite.scale.set(0.045, 0.06, 1);
    this.sprite.renderOrder = 6;
    this.sprite.raycast = () => {};
    stage.scene.add(this.sprite);
    stage.onDraw(() => this.update());
    components.selected.watch(() => stage.invalidate());
  }

  private update(): void {
    const component = this.components.find(this.components.selected.value);
    const node = component && ["sensor", "actuator"].includes(component.kind) ? this.stage.world?.find(component.name) : null;
    this.sprite.visible = Boolean(node);
    node?.frame.getWorldPosition(this.sprite.position);
  }
}

function drawing(): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [SIZE * 0.75, SIZE];
  const pen = canvas.getContext("2d");
  if (!pen) return canvas;
  const [middle, radius] = [SIZE * 0.375, SIZE * 0.3];
  pen.beginPath();
  pen.arc(middle, radius + 3, radius, Math.PI * 0.85, Math.PI * 0.15);
  pen.lineTo(middle, SIZE - 1);
  pen.closePath();
  pen.fillStyle = "#e8650a";
  pen.strokeStyle = "#ffffff";
  pen.lineWidth = 3;
  pen.fill();
  pen.stroke();
  pen.beginPath();
  pen.arc(middle, radius + 3, radius * 0.4, 0, 7);
  pen.fillStyle = "#ffffff";
  pen.fill();
  return canvas;
}
