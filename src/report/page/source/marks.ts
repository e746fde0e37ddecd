// Mark and colour of a method, the same in every plot, legend and table.

import type { Family, Method, ReportData } from "./data.ts";
import { vector } from "./dom.ts";

export const marks = [
  "circle", "square", "triangle-up", "diamond", "triangle-down", "pentagon",
  "circle-open", "square-open", "triangle-up-open", "diamond-open", "triangle-down-open", "pentagon-open",
  "cross-thin-open", "x-thin-open", "asterisk-open",
] as const;
export const dashes = ["solid", "dash", "dot", "dashdot", "longdash"] as const;

export interface Mark {
  symbol: string;
  dash: string;
}

export function markOf(place: number): Mark {
  const at = Number.isInteger(place) && place >= 0 ? place : 0;
  return {
    symbol: marks[at % marks.length] ?? "circle",
    dash: dashes[Math.floor(at / marks.length) % dashes.length] ?? "solid",
  };
}

/** Colour of a family; a neutral colour if the document's value is not a valid colour. */
export function colorOf(family: Family | undefined, dark: boolean): string {
  const color = dark ? family?.color_dark : family?.color;
  return color !== undefined && /^#[0-9a-f]{6}$/i.test(color) ? color : dark ? "#b8bec6" : "#59616b";
}

export function methodColor(data: ReportData, method: Method | undefined, dark: boolean): string {
  return colorOf(method === undefined ? undefined : data.families[method.family], dark);
}

const polygon = (points: [number, number][]): string => points.map(([x, y]) => `${8 + x},${7 + y}`).join(" ");
const shapes: Record<string, [number, number][]> = {
  square: [[-3.6, -3.6], [3.6, -3.6], [3.6, 3.6], [-3.6, 3.6]],
  "triangle-up": [[-4.4, 3.2], [4.4, 3.2], [0, -4.4]],
  "triangle-down": [[-4.4, -3.2], [4.4, -3.2], [0, 4.4]],
  diamond: [[-4.8, 0], [0, -4.8], [4.8, 0], [0, 4.8]],
  pentagon: [[0, -4.6], [4.4, -1.4], [2.7, 3.7], [-2.7, 3.7], [-4.4, -1.4]],
};
const strokes: Record<string, string> = {
  "cross-thin": "M3.6 7H12.4M8 2.6V11.4",
  "x-thin": "M4.8 3.8L11.2 10.2M4.8 10.2L11.2 3.8",
  asterisk: "M3.6 7H12.4M8 2.6V11.4M4.8 3.8L11.2 10.2M4.8 10.2L11.2 3.8",
};
const dashArrays: Record<string, string> = { dash: "4 2", dot: "1.5 2", dashdot: "4 2 1.5 2", longdash: "7 3" };

/** A sample of the curve for a legend; decorative only. */
export function swatch(mark: Mark, color: string, lit: boolean): SVGElement {
  const open = mark.symbol.endsWith("-open");
  const shape = mark.symbol.replace(/-open$/, "");
  const look = { fill: open ? "none" : color, stroke: color, "stroke-width": "1.4" };
  const line = vector("path", {
    d: "M0 7H16", stroke: color, "stroke-width": lit ? "1.8" : "1", "stroke-dasharray": dashArrays[mark.dash] ?? "none",
  });
  let symbol: SVGElement;
  if (shape in strokes) symbol = vector("path", { d: strokes[shape] ?? "", fill: "none", stroke: color, "stroke-width": "1.6" });
  else if (shape in shapes) symbol = vector("polygon", { points: polygon(shapes[shape] ?? []), ...look });
  else symbol = vector("circle", { cx: "8", cy: "7", r: "3.9", ...look });
  return vector("svg", { class: "swatch", width: "16", height: "14", viewBox: "0 0 16 14", "aria-hidden": "true" }, line, symbol);
}
