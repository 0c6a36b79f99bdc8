import { Raycaster, Vector3 } from "three";
import { nodeOf } from "../world/batches";
import type { WorldNode } from "../world/node";
import type { World } from "../world/world";

/** Angles about +Z from behind the node, in the order in which they are tried, radians. */
const TURNS = [0.78, -0.78, 1.57, -1.57, 0.3, -0.3, 2.36, -2.36, 3.14];
/** Angles above the horizon. */
const HEIGHTS = [0.52, 0.9, 1.2];
/** Free space around the camera, m. */
const ROOM = 0.4;
const ray = new Raycaster();
const UP = new Vector3(0, 0, 1);

/** A position at about that distance from a node, from which nothing obstructs the view of it. */
export function outlook(world: World, node: WorldNode, center: Vector3, heading: number, distance: number): Vector3 {
  let best = new Vector3();
  let most = -1;
  for (const height of HEIGHTS) {
    for (const turn of TURNS) {
      const angle = heading + Math.PI + turn;
      const way = new Vector3(Math.cos(angle) * Math.cos(height), Math.sin(angle) * Math.cos(height), Math.sin(height));
      const free = Math.min(clear(world, node, center, way, distance + ROOM) - ROOM, distance);
      if (free > most + 1e-3) {
        most = free;
        best = center.clone().addScaledVector(way, Math.max(free, 0.3));
      }
      if (free >= distance) return best;
    }
  }
  return best;
}

/**
 * The distance from a node up to which it is seen from a position, m: in front of the wall that hides it, if there is one.
 * A pole that hides a part of it is no wall.
 */
export function sightOf(world: World, node: WorldNode, center: Vector3, radius: number, position: Vector3): number {
  const reach = position.distanceTo(center);
  const way = center.clone().sub(position).normalize();
  const aside = way.clone().cross(UP).normalize().multiplyScalar(0.6 * radius);
  let free = 0;
  for (const shift of [0, 1, -1]) {
    if (free >= reach) break;
    free = Math.max(free, reach - (others(world, node, position.clone().addScaledVector(aside, shift), way, reach).at(-1) ?? 0));
  }
  return free;
}

/** The free length of a line from other objects than the node, tested in both directions. */
function clear(world: World, node: WorldNode, from: Vector3, way: Vector3, reach: number): number {
  const ahead = others(world, node, from, way, reach)[0] ?? reach;
  // walls that are visible only from behind do not count on the way out
  const back = others(world, node, from.clone().addScaledVector(way, reach), way.clone().negate(), reach).at(-1);
  return Math.min(ahead, back === undefined ? reach : reach - back);
}

/** The distances at which a line meets other objects than the node, as they are seen from its beginning. */
function others(world: World, node: WorldNode, origin: Vector3, way: Vector3, reach: number): number[] {
  ray.set(origin, way);
  ray.far = reach;
  return ray
    .intersectObject(world.root, true)
    .filter((hit) => {
      const owner = nodeOf(hit.object, hit.instanceId);
      return owner?.visible === true && !owner.find((one) => one === node);
    })
    .map((hit) => hit.distance);
}
