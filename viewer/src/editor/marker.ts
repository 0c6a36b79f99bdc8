import { Mesh, MeshBasicMaterial, RingGeometry, Vector3 } from "three";
import type { Hit } from "../view/pick";
import { pick, pointUnder } from "../view/pick";
import type { Stage } from "../view/stage";

const UP = new Vector3(0, 0, 1);

/** A ring at the place of the world where something will be put. */
export class Marker {
  private readonly ring = new Mesh(
    new RingGeometry(0.22, 0.3, 40),
    new MeshBasicMaterial({ color: 0xff7a1a, depthTest: false, transparent: true, opacity: 0.9, toneMapped: false }),
  );

  constructor(private readonly stage: Stage) {
    this.ring.visible = false;
    this.ring.renderOrder = 5;
    this.ring.raycast = () => {};
    stage.scene.add(this.ring);
  }

  /** Show it at a point of the page; returns the place in the world, and what is there. */
  point(x: number, y: number): { point: Vector3; hit: Hit | null } {
    const hit = pick(this.stage, x, y);
    const point = hit?.point ?? pointUnder(this.stage, x, y);
    this.ring.position.copy(point);
    this.ring.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), hit?.normal ?? UP);
    this.ring.scale.setScalar(Math.max(0.3, this.stage.view.position.distanceTo(point) / 12));
    this.ring.visible = true;
    this.stage.invalidate();
    return { point, hit };
  }

  hide(): void {
    this.ring.visible = false;
    this.stage.invalidate();
  }
}
