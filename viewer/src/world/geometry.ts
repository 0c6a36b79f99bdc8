import { BufferAttribute, BufferGeometry } from "three";
import type { MeshDescription } from "../generated/protocol";

/** Fetches packed meshes; a file that several meshes share is fetched once. */
export class GeometryStore {
  /** @param fetchFile gives the content at an address */
  constructor(private readonly fetchFile: (url: string) => Promise<Response>) {}

  private readonly files = new Map<string, Promise<ArrayBuffer>>();
  private readonly known = new Map<string, BufferGeometry>();

  async load(meshes: MeshDescription[]): Promise<BufferGeometry[]> {
    await Promise.all([...new Set(meshes.map((mesh) => mesh.url))].map((url) => this.file(url)));
    return Promise.all(meshes.map((mesh) => this.geometry(mesh)));
  }

  private async geometry(mesh: MeshDescription): Promise<BufferGeometry> {
    const key = `${mesh.url}@${mesh.offset}`;
    const known = this.known.get(key);
    if (known) return known;
    const geometry = unpack(await this.file(mesh.url), mesh);
    this.known.set(key, geometry);
    return geometry;
  }

  private file(url: string): Promise<ArrayBuffer> {
    let file = this.files.get(url);
    if (!file) {
      file = this.fetchFile(url).then((answer) => {
        if (!answer.ok) throw new Error(`the geometry cannot be fetched: ${answer.status} ${answer.statusText}`);
        return answer.arrayBuffer();
      });
      file.catch(() => this.files.delete(url));
      this.files.set(url, file);
    }
    return file;
  }
}

function unpack(file: ArrayBuffer, mesh: MeshDescription): BufferGeometry {
  const { vertices, indices } = mesh;
  let at = mesh.offset;
  const floats = (count: number): Float32Array => {
    const array = new Float32Array(file, at, count);
    at += count * 4;
    return array;
  };
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(floats(vertices * 3), 3));
  geometry.setAttribute("normal", new BufferAttribute(floats(vertices * 3), 3));
  if (mesh.textured) geometry.setAttribute("uv", new BufferAttribute(floats(vertices * 2), 2));
  geometry.setIndex(new BufferAttribute(new Uint32Array(file, at, indices), 1));
  for (const [start, count, slot] of mesh.groups) geometry.addGroup(start, count, slot);
  geometry.computeBoundingSphere();
  geometry.computeBoundingBox();
  return geometry;
}
