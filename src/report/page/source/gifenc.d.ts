declare module "gifenc" {
  type Palette = number[][];
  interface Encoder {
    /** Adds an image. `delay`: ms until the next one. */
    writeFrame(index: Uint8Array, width: number, height: number, options: { palette: Palette; delay: number }): void;
    finish(): void;
    bytes(): Uint8Array;
  }
  export function GIFEncoder(): Encoder;
  /** The colours of an image (RGBA), at most `colors`. */
  export function quantize(data: Uint8ClampedArray, colors: number): Palette;
  export function applyPalette(data: Uint8ClampedArray, palette: Palette): Uint8Array;
}
