// Types of the functions of gifenc used here; gifenc has none.
declare module "gifenc" {
  export type Palette = number[][];
  export function quantize(rgba: Uint8Array, colors: number, options?: { format?: "rgb565" | "rgb444" | "rgba4444" }): Palette;
  export function applyPalette(rgba: Uint8Array, palette: Palette, format?: "rgb565" | "rgb444" | "rgba4444"): Uint8Array;
  export function GIFEncoder(): {
    writeFrame(
      index: Uint8Array, width: number, height: number,
      options?: { palette?: Palette; delay?: number; repeat?: number; transparent?: boolean; transparentIndex?: number; dispose?: number },
    ): void;
    finish(): void;
    bytes(): Uint8Array;
  };
}
