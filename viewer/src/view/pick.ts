import type { Intersection } from "three";
import { InstancedMesh, Matrix3, Matrix4, Plane, Raycaster, Vector2, Vector3 } from "three";
import { nodeOf } from "../world/batches";
import type { WorldNode } from "../world/node";
import type { Stage } from "./stage";

export interface Hit {
  node: WorldNode;
  point: Vector3;
  /** normal of the face that was hit, in the world frame */
  normal: Vector3;
}

const ray = new Raycaster();

function aim(stage: Stage, x: number, y: number): void {
  const frame = stage.renderer.domElement.getBoundingClientRect();
  const at = new Vector2(((x - frame.left) / frame.width) * 2 - 1, 1 - ((y - frame.top) / frame.height) * 2);
  ray.setFromCamera(at, stage.view.camera);
}

/** The object drawn at a point of the page. */
export function pick(stage: Stage, x: number, y: number): Hit | null {
  if (!stage.world) return null;
  aim(stage, x, y);
  stage.world.root.traverseVisible((object) => {
    if (object instanceof InstancedMesh) object.boundingSphere = null; // the instances have moved
  });
  const shown = (hit: Intersection): boolean => nodeOf(hit.object, hit.instanceId)?.visible === true;
  const hit = ray.intersectObject(stage.world.root, true).find(shown);
  const node = hit && nodeOf(hit.object, hit.instanceId);
  return hit && node ? { node, point: hit.point, normal: normalOf(hit) } : null;
}

function normalOf({ object, face, instanceId }: Intersection): Vector3 {
  const turn = object.matrixWorld.clone();
  if (object instanceof InstancedMesh && instanceId !== undefined) turn.multiply(object.getMatrixAt(instanceId, new Matrix4()) ?? new Matrix4());
  const normal = (face?.normal.clone() ?? new Vector3()).applyNormalMatrix(new Matrix3().getNormalMatrix(turn));
  return normal.dot(ray.ray.direction) > 0 ? normal.negate() : normal;
}

/** The point of a plane at a point of the page. */
export function pickPlane(stage: Stage, x: number, y: number, plane: Plane): Vector3 | null {
  aim(stage, x, y);
  return ray.ray.intersectPlane(plane, new Vector3());
}

/** The point in the world at a point of the page: on an object, else on the ground, else straight ahead. */
export function pointUnder(stage: Stage, x: number, y: number): Vector3 {
  const hit = pick(stage, x, y);
  if (hit) return hit.point;
  const ground = pickPlane(stage, x, y, new Plane(new Vector3(0, 0, 1), 0));
  if (ground && ground.distanceTo(stage.view.position) < 200) return ground;
  return stage.view.position.clone().addScaledVector(stage.view.ahead, 10);
}
