// A small graph of a few curves as SVG, linear or logarithmic.

import { element, fill, vector } from "../dom.ts";
import { tickText, ticks } from "../motion/time_plot.ts";

export interface Curve {
  name: string;
  color: string;
  dash: string; // "none", or the lengths of dashes
  x: readonly number[];
  y: readonly (number | null)[];
  thin?: boolean;
  mark?: [number, number]; // a point to emphasise
}

export interface Axes {
  x: string;
  y: string;
  log: boolean; // both axes
}

const margin = { left: 58, right: 12, top: 10, bottom: 34 };
const [width, height] = [380, 220];

/** Range of the values, widened if it is within rounding of one value. */
export function rangeOf(values: readonly number[], log: boolean): [number, number] {
  const kept = values.filter((one) => Number.isFinite(one) && (!log || one > 0)).map((one) => (log ? Math.log10(one) : one));
  const low = kept.reduce((least, one) => Math.min(least, one), Infinity);
  const high = kept.reduce((most, one) => Math.max(most, one), -Infinity);
  if (!(high >= low)) return [0, 1];
  const least = log ? 1 : 1e-3 * Math.max(Math.abs(low), Math.abs(high), 1e-12);
  const pad = Math.max(least - (high - low), 0) / 2 + 0.04 * (high - low);
  return [low - pad, high + pad];
}

export class Graph {
  readonly root: HTMLElement;
  private readonly svg = vector("svg", { class: "lesson-graph", role: "img", viewBox: `0 0 ${width} ${height}` });
  private readonly caption = element("figcaption");

  constructor(private readonly title: string) {
    this.root = element("figure", { class: "lesson-figure" }, this.svg as unknown as HTMLElement, this.caption);
  }

  /** Draws the curves. `summary`: one sentence on them. */
  show(curves: readonly Curve[], axes: Axes, summary: string): void {
    const { log } = axes;
    const map = (one: number): number => (log ? Math.log10(one) : one);
    const [left, right] = rangeOf(curves.flatMap((curve) => [...curve.x]), log);
    const [low, high] = rangeOf(curves.flatMap((curve) => curve.y.filter((one) => one !== null)), log);
    const px = (x: number): number => margin.left + ((map(x) - left) / (right - left)) * (width - margin.left - margin.right);
    const py = (y: number): number => height - margin.bottom - ((map(y) - low) / (high - low)) * (height - margin.top - margin.bottom);
    const made: SVGElement[] = [];
    const text = (content: string, x: number, y: number, anchor: string, turn = ""): void => {
      const label = vector("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor, ...(turn === "" ? {} : { transform: turn }) });
      label.textContent = content;
      made.push(label);
    };
    const places = (from: number, to: number, most: number): number[] => (log ? ticks(Math.ceil(from), Math.floor(to), most).filter(Number.isInteger) : ticks(from, to, most));
    const label = (one: number, all: readonly number[]): string => (log ? (one === 0 ? "1" : `1e${one}`) : tickText(one, Math.abs((all[1] ?? 1) - (all[0] ?? 0)) || 1));
    const xs = places(left, right, 6);
    const ys = places(low, high, 5);
    for (const y of ys) {
      const at = py(log ? 10 ** y : y);
      made.push(vector("path", { d: `M${margin.left} ${at.toFixed(1)}H${width - margin.right}`, class: "grid" }));
      text(label(y, ys), margin.left - 6, at + 4, "end");
    }
    for (const x of xs) text(label(x, xs), px(log ? 10 ** x : x), height - margin.bottom + 15, "middle");
    made.push(vector("path", { d: `M${margin.left} ${margin.top}V${height - margin.bottom}H${width - margin.right}`, class: "axis" }));
    text(axes.x, (margin.left + width - margin.right) / 2, height - 4, "middle");
    text(axes.y, 11, (height - margin.bottom + margin.top) / 2, "middle", `rotate(-90 11 ${(height - margin.bottom + margin.top) / 2})`);
    for (const curve of curves) {
      let path = "";
      let pen = false;
      curve.y.forEach((y, i) => {
        const x = curve.x[i] ?? NaN;
        pen = y !== null && Number.isFinite(y) && Number.isFinite(x) && (!log || (y > 0 && x > 0)) && ((path += `${pen ? "L" : "M"}${px(x).toFixed(1)} ${py(y).toFixed(1)}`), true);
      });
      made.push(vector("path", { d: path, class: "curve", stroke: curve.color, "stroke-dasharray": curve.dash, "stroke-width": curve.thin === true ? "1.1" : "2" }));
      if (curve.mark !== undefined) made.push(vector("circle", { cx: px(curve.mark[0]).toFixed(1), cy: py(curve.mark[1]).toFixed(1), r: "5", fill: curve.color }));
    }
    fill(this.svg, ...made);
    this.svg.setAttribute("aria-label", `${this.title}. ${summary}`);
    fill(this.caption, element("strong", {}, this.title), " ", summary);
  }
}
