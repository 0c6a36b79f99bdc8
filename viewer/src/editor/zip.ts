/** A file with its path below the folder that was dropped. */
export interface Item {
  path: string;
  file: File;
}

/** Bytes of all files together, as the simulator takes them. */
const LARGEST = 128 << 20;
const MOST_ENTRIES = 20_000;
/** The end of an archive: its record, and a comment of any length. */
const END = 22;
const END_MARK = 0x06054b50;
const ENTRY_MARK = 0x02014b50;
const STORED = 0;
const DEFLATED = 8;

/** The files in a ZIP archive, which may be anybody's: what it says of sizes is not trusted. */
export async function unzipped(archive: File): Promise<Item[]> {
  const tail = new DataView(await archive.slice(Math.max(archive.size - END - 0xffff, 0)).arrayBuffer());
  let end = tail.byteLength - END;
  while (end >= 0 && tail.getUint32(end, true) !== END_MARK) end -= 1;
  if (end < 0) throw new Error("it is not a ZIP archive, or a part of it is missing");
  const [count, size, begin] = [tail.getUint16(end + 10, true), tail.getUint32(end + 12, true), tail.getUint32(end + 16, true)];
  if (count > MOST_ENTRIES || begin + size > archive.size) throw new Error("it is too large, or damaged");
  const list = new DataView(await archive.slice(begin, begin + size).arrayBuffer());
  const items: Item[] = [];
  let left = LARGEST;
  for (let at = 0, number = 0; number < count; number += 1) {
    if (at + 46 > list.byteLength || list.getUint32(at, true) !== ENTRY_MARK) throw new Error("its list of files is damaged");
    const [flags, method, packed] = [list.getUint16(at + 8, true), list.getUint16(at + 10, true), list.getUint32(at + 20, true)];
    const [named, extra, comment, place] = [list.getUint16(at + 28, true), list.getUint16(at + 30, true), list.getUint16(at + 32, true), list.getUint32(at + 42, true)];
    // programs for Windows may separate folders their way
    const path = new TextDecoder().decode(new Uint8Array(list.buffer, at + 46, Math.min(named, list.byteLength - at - 46))).replaceAll("\\", "/");
    at += 46 + named + extra + comment;
    if (path.endsWith("/")) continue; // a folder
    if ((flags & 1) !== 0) throw new Error(`${path} needs a password`);
    if (method !== STORED && method !== DEFLATED) throw new Error(`${path} is packed by another method than deflate`);
    const head = new DataView(await archive.slice(place, place + 30).arrayBuffer());
    if (head.byteLength < 30) throw new Error(`${path} is missing`);
    const data = place + 30 + head.getUint16(26, true) + head.getUint16(28, true);
    const bytes = await read(archive.slice(data, data + packed), method === DEFLATED, left);
    left -= bytes.size;
    items.push({ path, file: new File([bytes], path.slice(path.lastIndexOf("/") + 1)) });
  }
  return items;
}

async function read(content: Blob, isPacked: boolean, most: number): Promise<Blob> {
  const stream = isPacked ? content.stream().pipeThrough(new DecompressionStream("deflate-raw")) : content.stream();
  const reader = stream.getReader();
  const parts: Uint8Array<ArrayBuffer>[] = [];
  for (let left = most; ; ) {
    const { done, value } = await reader.read();
    if (done) return new Blob(parts);
    left -= value.length;
    if (left < 0) {
      await reader.cancel();
      throw new Error(`it has more than ${LARGEST >> 20} MB`);
    }
    parts.push(value);
  }
}
