import { Box3, Box3Helper, Color } from "three";
import { theme } from "../ui/theme";
import type { WorldNode } from "../world/node";
import type { Stage } from "./stage";

/** A thin box around the selected object. */
export class Highlight {
  private readonly box = new Box3();
  private readonly lines = new Box3Helper(this.box);
  private node: WorldNode | null = null;

  constructor(private readonly stage: Stage) {
    const { material } = this.lines;
    for (const one of Array.isArray(material) ? material : [material]) {
      Object.assign(one, { transparent: true, opacity: 0.9, toneMapped: false });
    }
    this.lines.raycast = () => {};
    this.lines.visible = false;
    stage.scene.add(this.lines);
    stage.onDraw(() => this.update());
    theme.watch((now) => {
      const { color } = this.lines.material as unknown as { color: Color };
      color.set(now === "light" ? 0xd9660c : 0xff9a4d);
    });
  }

  show(node: WorldNode | null): void {
    this.node = node;
    this.stage.invalidate();
  }

  private update(): void {
    this.lines.visible = false;
    if (!this.node || !this.stage.world) return;
    this.box.copy(this.stage.world.boxOf(this.node.walk()));
    if (this.box.isEmpty()) return;
    this.box.expandByScalar(0.01 + 0.01 * this.box.max.distanceTo(this.box.min));
    this.lines.visible = true;
    this.lines.updateMatrixWorld(true);
  }
}
