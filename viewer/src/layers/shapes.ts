import type { BufferGeometry } from "three";
import { BoxGeometry, CapsuleGeometry, CylinderGeometry, EdgesGeometry, LineBasicMaterial, LineSegments, Matrix4, SphereGeometry, Vector3, WireframeGeometry } from "three";
import { ConvexGeometry } from "three/examples/jsm/geometries/ConvexGeometry.js";
import type { ShapeDescription } from "../generated/protocol";
import type { Surroundings } from "./layer";
import { Layer } from "./layer";

const EDGES = new LineBasicMaterial({ color: 0x19b37a, transparent: true, opacity: 0.9, toneMapped: false });

/** The collision shapes. */
export class Shapes extends Layer {
  constructor() {
    super("shapes", "collision shapes");
  }

  override build({ world }: Surroundings): void {
    for (const node of world.nodes) {
      for (const shape of node.description.shapes) {
        const geometry = outline(shape);
        if (!geometry) continue;
        const lines = new LineSegments(geometry, EDGES);
        lines.name = node.name;
        lines.matrixAutoUpdate = false;
        lines.userData["local"] = localOf(shape);
        lines.raycast = () => {};
        this.root.add(lines);
      }
    }
  }

  override update({ world }: Surroundings): void {
    for (const lines of this.root.children) {
      const node = world.find(lines.name);
      if (node) lines.matrix.multiplyMatrices(node.frame.matrixWorld, lines.userData["local"] as Matrix4);
      lines.matrixWorldNeedsUpdate = true;
    }
  }
}

/** From the frame of the shape to that of its node. */
function localOf({ kind, position, rotation }: ShapeDescription): Matrix4 {
  if (kind === "convex") return new Matrix4(); // its vertices are in the frame of the node
  const [a, b, c, d, e, f, g, h, i] = rotation as [number, number, number, number, number, number, number, number, number];
  const [x, y, z] = position;
  return new Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

function outline({ kind, size, vertices }: ShapeDescription): BufferGeometry | null {
  const [a = 0, b = 0, c = 0] = size;
  switch (kind) {
    case "box":
      return new EdgesGeometry(new BoxGeometry(2 * a, 2 * b, 2 * c));
    case "sphere":
      return new WireframeGeometry(new SphereGeometry(a, 16, 8));
    case "ellipsoid":
      return new WireframeGeometry(new SphereGeometry(1, 16, 8).scale(a, b, c));
    case "cylinder":
      return new EdgesGeometry(new CylinderGeometry(a, a, 2 * b, 24).rotateX(Math.PI / 2), 40);
    case "capsule":
      return new WireframeGeometry(new CapsuleGeometry(a, 2 * b, 4, 12).rotateX(Math.PI / 2));
    case "convex":
      return vertices.length < 4 ? null : new EdgesGeometry(new ConvexGeometry(vertices.map((point) => new Vector3(...point))), 5);
    default:
      return null;
  }
}
