import { Box3, Box3Helper, Color } from "three";
import { theme } from "../ui/theme";
import type { WorldNode } from "../world/node";
import type { Stage } from "./stage";

/** A thin box around each selected object. */
export class Highlight {
  private readonly boxes: { box: Box3; lines: Box3Helper }[] = [];
  private nodes: WorldNode[] = [];

  constructor(private readonly stage: Stage) {
    stage.onDraw(() => this.update());
    theme.watch(() => this.boxes.forEach(({ lines }) => paint(lines)));
  }

  show(nodes: WorldNode[]): void {
    this.nodes = nodes;
    while (this.boxes.length < nodes.length) this.boxes.push(this.make());
    this.stage.invalidate();
  }

  private make(): { box: Box3; lines: Box3Helper } {
    const box = new Box3();
    const lines = new Box3Helper(box);
    const { material } = lines;
    for (const one of Array.isArray(material) ? material : [material]) {
      Object.assign(one, { transparent: true, opacity: 0.9, toneMapped: false });
    }
    paint(lines);
    lines.raycast = () => {};
    this.stage.scene.add(lines);
    return { box, lines };
  }

  private update(): void {
    this.boxes.forEach(({ box, lines }, i) => {
      const node = this.nodes[i];
      lines.visible = false;
      if (!node || !this.stage.world) return;
      box.copy(this.stage.world.boxOf(node.walk()));
      if (box.isEmpty()) return;
      box.expandByScalar(0.01 + 0.01 * box.max.distanceTo(box.min));
      lines.visible = true;
      lines.updateMatrixWorld(true);
    });
  }
}

function paint(lines: Box3Helper): void {
  const { color } = lines.material as unknown as { color: Color };
  color.set(theme.value === "light" ? 0xd9660c : 0xff9a4d);
}
