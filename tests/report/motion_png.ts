// Reads and writes PNG pictures with 8 bits per channel and without interlacing.

import { deflateSync, inflateSync } from "node:zlib";

export interface Picture {
  width: number;
  height: number;
  rgba: Uint8Array;
}

const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);

/** The Paeth predictor, section 9.4 of the specification. */
function paeth(a: number, b: number, c: number): number {
  const p = a + b - c;
  const [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

function predicted(filter: number, left: number, above: number, corner: number): number {
  return [0, left, above, (left + above) >> 1, paeth(left, above, corner)][filter] ?? 0;
}

export function readPng(file: Uint8Array): Picture {
  const bytes = Buffer.from(file.buffer, file.byteOffset, file.byteLength);
  if (!bytes.subarray(0, 8).equals(signature)) throw new Error("not a PNG");
  let [width, height, channels] = [0, 0, 0];
  let palette: Buffer | null = null;
  const data: Buffer[] = [];
  for (let at = 8; at + 8 <= bytes.length; ) {
    const size = bytes.readUInt32BE(at);
    const name = bytes.toString("latin1", at + 4, at + 8);
    const body = bytes.subarray(at + 8, at + 8 + size);
    if (name === "IHDR") {
      [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
      channels = ({ 2: 3, 3: 1, 6: 4 } as Record<number, number>)[body[9] ?? -1] ?? 0;
      if (body[8] !== 8 || channels === 0 || body[12] !== 0) throw new Error("unsupported kind of PNG: only 8 bits without interlacing, with palette, RGB or RGBA");
    } else if (name === "PLTE") palette = body;
    else if (name === "IDAT") data.push(body);
    at += size + 12;
  }
  const raw = inflateSync(Buffer.concat(data));
  const stride = width * channels;
  const rgba = new Uint8Array(4 * width * height).fill(255);
  let before = new Uint8Array(stride);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)] ?? 0;
    const line = new Uint8Array(stride);
    for (let i = 0; i < stride; ++i) {
      const left = i >= channels ? line[i - channels] ?? 0 : 0;
      const corner = i >= channels ? before[i - channels] ?? 0 : 0;
      line[i] = (raw[y * (stride + 1) + 1 + i] ?? 0) + predicted(filter, left, before[i] ?? 0, corner);
    }
    for (let x = 0; x < width; ++x) {
      const at = 4 * (y * width + x);
      if (palette !== null && channels === 1) rgba.set(palette.subarray(3 * (line[x] ?? 0), 3 * (line[x] ?? 0) + 3), at);
      else rgba.set(line.subarray(x * channels, (x + 1) * channels), at);
    }
    before = line;
  }
  return { width, height, rgba };
}

const crcTable = Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c >>> 0;
});

function chunk(name: string, body: Uint8Array): Buffer {
  const made = Buffer.alloc(body.length + 12);
  made.writeUInt32BE(body.length, 0);
  made.write(name, 4, "latin1");
  made.set(body, 8);
  let crc = 0xffffffff;
  for (let i = 4; i < body.length + 8; ++i) crc = (crcTable[(crc ^ (made[i] ?? 0)) & 255] ?? 0) ^ (crc >>> 8);
  made.writeUInt32BE((crc ^ 0xffffffff) >>> 0, body.length + 8);
  return made;
}

/** Compresses lines, each with the filter that gives the smallest sum, or all without filter: the smaller result. */
function packed(lines: Uint8Array[], channels: number): Buffer {
  const tried = [true, false].map((choose) => {
    const made: Uint8Array[] = [];
    lines.forEach((line, y) => {
      const before = lines[y - 1] ?? new Uint8Array(line.length);
      let best = new Uint8Array(line.length + 1);
      let least = Infinity;
      for (const filter of choose ? [0, 1, 2, 3, 4] : [0]) {
        const out = new Uint8Array(line.length + 1);
        out[0] = filter;
        let sum = 0;
        for (let i = 0; i < line.length; ++i) {
          const left = i >= channels ? line[i - channels] ?? 0 : 0;
          const corner = i >= channels ? before[i - channels] ?? 0 : 0;
          const value = ((line[i] ?? 0) - predicted(filter, left, before[i] ?? 0, corner)) & 255;
          out[i + 1] = value;
          sum += value < 128 ? value : 256 - value;
        }
        if (sum < least) [best, least] = [out, sum];
      }
      made.push(best);
    });
    return deflateSync(Buffer.concat(made), { level: 9, memLevel: 9 });
  });
  return tried.sort((a, b) => a.length - b.length)[0] as Buffer;
}

/** Writes an opaque picture, with a palette if 256 colours suffice. */
export function writePng({ width, height, rgba }: Picture): Uint8Array {
  const colors = new Map<number, number>();
  for (let i = 0; i < rgba.length && colors.size <= 256; i += 4) {
    const color = ((rgba[i] ?? 0) << 16) | ((rgba[i + 1] ?? 0) << 8) | (rgba[i + 2] ?? 0);
    if (!colors.has(color)) colors.set(color, colors.size);
  }
  const indexed = colors.size <= 256;
  const channels = indexed ? 1 : 3;
  const lines = Array.from({ length: height }, (_, y) => {
    const line = new Uint8Array(width * channels);
    for (let x = 0; x < width; ++x) {
      const at = 4 * (y * width + x);
      if (indexed) line[x] = colors.get(((rgba[at] ?? 0) << 16) | ((rgba[at + 1] ?? 0) << 8) | (rgba[at + 2] ?? 0)) ?? 0;
      else line.set(rgba.subarray(at, at + 3), 3 * x);
    }
    return line;
  });
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, indexed ? 3 : 2, 0, 0, 0], 8);
  const palette = Buffer.from([...colors.keys()].flatMap((color) => [color >> 16, (color >> 8) & 255, color & 255]));
  return Buffer.concat([signature, chunk("IHDR", header), ...(indexed ? [chunk("PLTE", palette)] : []), chunk("IDAT", packed(lines, channels)), chunk("IEND", new Uint8Array())]);
}
