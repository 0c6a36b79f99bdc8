import { Vector3 } from "three";
import type { World } from "../world/world";
import type { Hit } from "./pick";

/** An object that is larger than this in both directions, m, may be the ground. */
const LARGE = 5;
/** Faces with a smaller slope are floors: cosine of the angle to the horizontal. */
const LEVEL = 0.9;
/** Floors are in the lowest part of a building; flat objects are floors entirely: shares of the height and the width. */
const LOW = 0.35;
const FLAT = 0.05;

/** Whether a hit is on the ground or a floor: a click on it selects nothing. */
export function isGround({ node, point, normal }: Hit, world: World): boolean {
  if (node.moves || node.find(({ description }) => description.kind !== "") || normal.z < LEVEL) return false;
  const box = world.boxOf([node]);
  const size = box.getSize(new Vector3());
  return size.x > LARGE && size.y > LARGE && point.z <= box.min.z + Math.max(LOW * size.z, FLAT * Math.min(size.x, size.y));
}
