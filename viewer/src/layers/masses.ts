import { Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";
import type { Connection } from "../connection/connection";
import type { MassCentre } from "../generated/protocol";
import type { Surroundings } from "./layer";
import { Layer } from "./layer";

const BALL = new MeshBasicMaterial({ color: 0xe0b000, depthTest: false, transparent: true, opacity: 0.85, toneMapped: false });

/** Centres of mass of bodies; the size grows with the mass. */
export class Masses extends Layer {
  private readonly known = new Map<string, MassCentre>();

  constructor(connection: Connection) {
    super("masses", "centres of mass");
    connection.on("mass_centre", (centre) => this.known.set(centre.node, centre));
  }

  override build({ world }: Surroundings): void {
    for (const centre of this.known.values()) {
      if (!world.find(centre.node)) continue;
      const ball = new Mesh(new SphereGeometry(Math.min(0.03 + 0.012 * Math.cbrt(centre.mass), 0.25), 16, 12), BALL);
      ball.name = centre.node;
      ball.renderOrder = 3;
      ball.raycast = () => {};
      this.root.add(ball);
    }
  }

  override update({ world }: Surroundings): void {
    for (const ball of this.root.children) {
      const node = world.find(ball.name);
      const centre = this.known.get(ball.name);
      if (node && centre) ball.position.copy(new Vector3(...centre.position).applyMatrix4(node.frame.matrixWorld));
    }
  }
}
