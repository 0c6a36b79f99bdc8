import { BufferAttribute, BufferGeometry, Vector3 } from "three";

const known = new WeakMap<BufferGeometry, Map<number, BufferGeometry>>();

/**
 * A mesh with fewer triangles for small sizes on the screen: the vertices in one cell of a grid are merged at their mean
 * (vertex clustering; J. Rossignac and P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993).
 * The grid has the given number of cells along the longest side of the mesh.
 */
export function coarse(geometry: BufferGeometry, cells: number): BufferGeometry {
  const levels = known.get(geometry) ?? new Map<number, BufferGeometry>();
  known.set(geometry, levels);
  let level = levels.get(cells);
  if (!level) {
    level = cluster(geometry, cells);
    levels.set(cells, level);
  }
  return level;
}

function cluster(geometry: BufferGeometry, cells: number): BufferGeometry {
  const places = cellsOf(geometry, cells);
  // vertices with different normals stay separate, so that edges stay sharp; their positions are merged: no gaps
  const corners = apart(places, geometry.getAttribute("normal").array);
  const made = new BufferGeometry();
  const positions = mean(geometry, "position", places);
  const gathered = new Float32Array(corners.count * 3);
  corners.of.forEach((corner, i) => gathered.set(positions.subarray(3 * (places.of[i] as number), 3 * (places.of[i] as number) + 3), 3 * corner));
  made.setAttribute("position", new BufferAttribute(gathered, 3));
  made.setAttribute("normal", new BufferAttribute(mean(geometry, "normal", corners), 3));
  if (geometry.hasAttribute("uv")) made.setAttribute("uv", new BufferAttribute(mean(geometry, "uv", corners), 2));
  const index: number[] = [];
  for (const { start, count, materialIndex } of geometry.groups) {
    const from = index.length;
    const seen = new Set<string>();
    for (let i = start; i < start + count; i += 3) {
      const triangle = [0, 1, 2].map((k) => geometry.index?.array[i + k] as number);
      const [a, b, c] = triangle.map((vertex) => places.of[vertex]);
      if (a === b || b === c || c === a) continue; // degenerated to a line or a point
      const shrunk = triangle.map((vertex) => corners.of[vertex] as number);
      const key = [...shrunk].sort().join();
      if (!seen.has(key)) index.push(...shrunk);
      seen.add(key);
    }
    made.addGroup(from, index.length - from, materialIndex);
  }
  made.setIndex(new BufferAttribute(new Uint32Array(index), 1));
  made.boundingBox = geometry.boundingBox;
  made.boundingSphere = geometry.boundingSphere;
  return made;
}

/** Merged vertices: the group of each vertex, and the number of groups. */
interface Groups {
  of: Uint32Array;
  count: number;
}

function group(vertices: number, keyOf: (vertex: number) => number): Groups {
  const numbers = new Map<number, number>();
  const of = new Uint32Array(vertices);
  for (let i = 0; i < vertices; i++) {
    const key = keyOf(i);
    let number = numbers.get(key);
    if (number === undefined) numbers.set(key, (number = numbers.size));
    of[i] = number;
  }
  return { of, count: numbers.size };
}

function cellsOf(geometry: BufferGeometry, cells: number): Groups {
  const { array } = geometry.getAttribute("position");
  const low = (geometry.boundingBox?.min ?? new Vector3()).toArray();
  const sides = geometry.boundingBox?.getSize(new Vector3()).toArray() ?? [1];
  const size = Math.max(...sides) / cells || 1;
  const at = (vertex: number, axis: number): number =>
    Math.min(Math.floor(((array[3 * vertex + axis] as number) - (low[axis] as number)) / size), cells);
  return group(array.length / 3, (vertex) => (at(vertex, 0) * (cells + 1) + at(vertex, 1)) * (cells + 1) + at(vertex, 2));
}

/** The same groups, each divided by the six main directions of the normals. */
function apart({ of }: Groups, normals: ArrayLike<number>): Groups {
  return group(of.length, (vertex) => {
    const [x, y, z] = [0, 1, 2].map((axis) => normals[3 * vertex + axis] as number) as [number, number, number];
    const largest = Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
    const axis = largest === Math.abs(x) ? 0 : largest === Math.abs(y) ? 1 : 2;
    return (of[vertex] as number) * 6 + 2 * axis + (([x, y, z][axis] as number) < 0 ? 1 : 0);
  });
}

/** The mean of an attribute over the vertices of each group. */
function mean(geometry: BufferGeometry, name: string, { of, count }: Groups): Float32Array {
  const { array, itemSize } = geometry.getAttribute(name);
  const sums = new Float32Array(count * itemSize);
  const members = new Uint32Array(count);
  of.forEach((at, i) => {
    members[at] = (members[at] as number) + 1;
    for (let k = 0; k < itemSize; k++) sums[at * itemSize + k] = (sums[at * itemSize + k] as number) + (array[i * itemSize + k] as number);
  });
  return sums.map((sum, i) => sum / (members[Math.floor(i / itemSize)] as number));
}
