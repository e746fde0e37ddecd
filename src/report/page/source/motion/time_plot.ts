// A plot of curves over time as SVG, linear or logarithmic, with a line at the current time of the view. Clicking and
// dragging set the time. All plots of the motion view are of this class.

import { fill, vector } from "../dom.ts";
import { significant } from "../format.ts";
import { shorten } from "../text.ts";
import { findInterval } from "./interpolation.ts";

const margin = { left: 52, right: 12, top: 10, bottom: 34 };

export interface TimeCurve {
  name: string;
  color: string;
  dash: string; // "none", or the lengths of dashes
  t: readonly number[]; // s, ascending
  y: readonly (number | null)[];
  starts?: readonly number[]; // indices of the first samples of segments, ascending; segments are not connected
  ended?: boolean; // a cross marks its end
}

export interface TimeAxes {
  unit: string;
  log: boolean;
  range: readonly [number, number]; // lowest and highest value; if logarithmic, their exponents of 10
  lines?: readonly { y: number; text: string; color: string }[]; // limits
  marks?: readonly number[]; // times of events, s
  numbers?: boolean; // write the current values beside the curves
  empty: string; // text if there are no curves
}

/** Round values in a range, at most about `most`. */
export function ticks(low: number, high: number, most: number): number[] {
  const span = high - low;
  if (!(span > 0) || most < 1) return [low];
  const rough = span / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => span / one <= most) ?? 10 * power;
  const made: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * span; ++i) made.push(i * step + 0); // no negative zero
  return made;
}

/** Number for a tick, with the digits that the distance of ticks needs. */
export function tickText(value: number, step: number): string {
  const digits = value === 0 ? 1 : Math.max(1, Math.ceil(Math.log10(Math.abs(value) / step) - 1e-9) + 1);
  return significant(value, Math.min(8, digits));
}

/** Range of the values, with a margin; includes `always`. */
export function linearRange(values: readonly (number | null)[], always: readonly number[] = []): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const value of [...values, ...always]) {
    if (value === null || !Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (!(high >= low)) return [0, 1];
  // a single value is in the middle
  const pad = high > low ? 0.06 * (high - low) : Math.abs(high) > 0 ? 1e-3 * Math.abs(high) : 1;
  return [low - pad, high + pad];
}

/** The segment [first, last] of samples that contains t; null between segments. */
function segmentAt(curve: Pick<TimeCurve, "t" | "starts">, t: number): [number, number] | null {
  const { t: times, starts = [0] } = curve;
  // samples are not exactly at the ends of segments; at a common end of two, the later one is used
  const slack = 1e-5 * Math.abs(times[times.length - 1] ?? 0);
  for (let i = starts.length - 1; i >= 0; --i) {
    const [first, last] = [starts[i] ?? 0, (starts[i + 1] ?? times.length) - 1];
    if (last < first || t < (times[first] ?? 0) - slack) continue;
    return t <= (times[last] ?? 0) + slack ? [first, last] : null;
  }
  return null;
}

/** Index of a sample and the fraction of the interval that follows it at the time t; null outside the segments. */
export function placeAt(curve: Pick<TimeCurve, "t" | "starts">, t: number): [number, number] | null {
  const segment = segmentAt(curve, t);
  if (segment === null) return null;
  const [first, last] = segment;
  if (first === last) return [first, 0];
  const k = Math.max(first, Math.min(last - 1, findInterval(curve.t, t)));
  const [from, to] = [curve.t[k] ?? 0, curve.t[k + 1] ?? 0];
  return [k, to > from ? Math.max(0, Math.min(1, (t - from) / (to - from))) : 0];
}

/** Value of a curve at a time, interpolated linearly, or logarithmically on a logarithmic scale. */
export function valueAt(curve: Pick<TimeCurve, "t" | "y" | "starts">, t: number, log: boolean): number | null {
  const place = placeAt(curve, t);
  if (place === null) return null;
  const [k, s] = place;
  const [a, b] = [curve.y[k] ?? null, curve.y[k + 1] ?? null];
  if (s === 0 || a === null || b === null) return s === 0 ? a : b ?? a;
  return log && a > 0 && b > 0 ? Math.exp((1 - s) * Math.log(a) + s * Math.log(b)) : (1 - s) * a + s * b;
}

/** Sets the time by clicking and dragging. `timeAt`: time of a horizontal position on the screen. */
export function scrubWith(root: SVGSVGElement, timeAt: (x: number, dragged: boolean) => number, go: (time: number, done: boolean) => void): void {
  let held = false;
  let dragged = false;
  root.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    held = true;
    dragged = false;
    root.setPointerCapture(event.pointerId);
    go(timeAt(event.clientX, false), false);
  });
  root.addEventListener("pointermove", (event) => {
    if (!held) return;
    dragged = true;
    go(timeAt(event.clientX, true), false);
  });
  root.addEventListener("pointerup", (event) => {
    if (held) go(timeAt(event.clientX, dragged), true);
    held = false;
  });
  root.addEventListener("pointercancel", () => (held = false));
  root.style.touchAction = "pan-y";
}

export class TimePlot {
  readonly root: SVGSVGElement;
  private curves: readonly TimeCurve[] = [];
  private axes: TimeAxes = { unit: "", log: false, range: [0, 1], empty: "" };
  private duration = 1;
  private width = 400;
  private readonly still = vector("g", {});
  private readonly cursor = vector("g", {});

  constructor(private readonly title: string, go: (time: number, done: boolean) => void, private readonly height = 220, kind = "") {
    this.root = vector("svg", { class: `motion-plot ${kind}`.trim(), role: "img", "aria-label": title }, this.still, this.cursor) as SVGSVGElement;
    scrubWith(this.root, (x) => {
      const box = this.root.getBoundingClientRect();
      const part = ((x - box.left) * (this.width / (box.width || 1)) - margin.left) / this.inner();
      return Math.max(0, Math.min(1, part)) * this.duration;
    }, go);
  }

  private inner(): number {
    return this.width - margin.left - margin.right;
  }

  private x(t: number): number {
    return margin.left + (this.duration > 0 ? t / this.duration : 0) * this.inner();
  }

  private y(value: number): number {
    const [low, high] = this.axes.range;
    const part = ((this.axes.log ? Math.log10(value) : value) - low) / (high - low);
    return this.height - margin.bottom - Math.max(0, Math.min(1, part)) * (this.height - margin.top - margin.bottom);
  }

  show(curves: readonly TimeCurve[], axes: TimeAxes, duration: number): void {
    this.curves = curves;
    this.axes = axes;
    this.duration = duration;
    this.draw();
  }

  /** Adapts to the width on the screen. */
  resize(): void {
    const width = this.root.clientWidth;
    if (width < 40 || Math.abs(width - this.width) < 1) return;
    this.width = width;
    this.draw();
  }

  private pathOf(curve: TimeCurve): string {
    const starts = new Set(curve.starts ?? [0]);
    let path = "";
    let pen = false;
    curve.t.forEach((t, i) => {
      const value = curve.y[i] ?? null;
      if (starts.has(i)) pen = false;
      if (value === null || (this.axes.log && !(value > 0))) pen = false;
      else {
        path += `${pen ? "L" : "M"}${this.x(t).toFixed(1)} ${this.y(value).toFixed(1)}`;
        pen = true;
      }
    });
    return path;
  }

  private draw(): void {
    const { width, height, axes } = this;
    this.root.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.root.setAttribute("height", String(height));
    const made: SVGElement[] = [];
    const text = (content: string, x: number, y: number, anchor: string, kind = ""): void => {
      const label = vector("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor, ...(kind === "" ? {} : { class: kind }) });
      label.textContent = content;
      made.push(label);
    };
    const line = (x1: number, y1: number, x2: number, y2: number, kind: string, more: Record<string, string> = {}): void => {
      made.push(vector("path", { d: `M${x1.toFixed(1)} ${y1.toFixed(1)}L${x2.toFixed(1)} ${y2.toFixed(1)}`, class: kind, ...more }));
    };
    const [low, high] = axes.range;
    const [right, bottom] = [width - margin.right, height - margin.bottom];
    if (axes.log) {
      const every = Math.max(1, Math.ceil((high - low) / 6));
      for (let power = low; power <= high; power += every) {
        line(margin.left, this.y(10 ** power), right, this.y(10 ** power), "motion-grid");
        text(power === 0 ? "1" : `1e${power}`, margin.left - 6, this.y(10 ** power) + 4, "end");
      }
    } else {
      const places = ticks(low, high, Math.max(2, Math.floor((bottom - margin.top) / 34)));
      const step = Math.abs((places[1] ?? 1) - (places[0] ?? 0)) || 1;
      for (const value of places) {
        line(margin.left, this.y(value), right, this.y(value), "motion-grid");
        text(tickText(value, step), margin.left - 6, this.y(value) + 4, "end");
      }
    }
    for (const t of ticks(0, this.duration, Math.max(2, Math.floor(this.inner() / 80)))) {
      line(this.x(t), bottom, this.x(t), bottom + 4, "motion-axis");
      text(significant(t), this.x(t), bottom + 17, "middle");
    }
    for (const t of axes.marks ?? []) line(this.x(t), margin.top, this.x(t), bottom, "motion-event");
    line(margin.left, bottom, right, bottom, "motion-axis");
    line(margin.left, margin.top, margin.left, bottom, "motion-axis");
    text("time (s)", margin.left + this.inner() / 2, height - 3, "middle");
    for (const limit of axes.lines ?? []) {
      const y = this.y(limit.y);
      line(margin.left, y, right, y, "motion-limit", { stroke: limit.color });
      if (limit.text !== "") text(limit.text, right - 3, y < margin.top + 14 ? y + 13 : y - 4, "end", "motion-limit-name");
    }
    for (const curve of this.curves) {
      made.push(vector("path", { d: this.pathOf(curve), class: "motion-curve", stroke: curve.color, "stroke-dasharray": curve.dash }));
      const last = curve.t.length - 1;
      const end = curve.t[last] ?? 0;
      if (curve.ended !== true || !(end > 0)) continue;
      const value = curve.y[last] ?? null;
      const [x, y] = [this.x(end), value === null || (axes.log && !(value > 0)) ? bottom : this.y(value)];
      made.push(vector("path", { d: `M${x - 4} ${y - 4}L${x + 4} ${y + 4}M${x - 4} ${y + 4}L${x + 4} ${y - 4}`, class: "motion-curve", stroke: curve.color }));
    }
    if (this.curves.length === 0) text(axes.empty, margin.left + this.inner() / 2, height / 2, "middle");
    fill(this.still, ...made);
  }

  /** Moves the line of the current time. Returns the values of the curves. */
  at(time: number): (number | null)[] {
    const { axes } = this;
    const x = this.x(time);
    const made: SVGElement[] = [vector("path", { d: `M${x.toFixed(1)} ${margin.top}V${this.height - margin.bottom}`, class: "motion-cursor" })];
    const words: string[] = [];
    const numbers: { y: number; text: string }[] = [];
    const values = this.curves.map((curve) => valueAt(curve, time, axes.log));
    this.curves.forEach((curve, i) => {
      const value = values[i] ?? null;
      const quantity = value === null ? "" : `${significant(value)} ${axes.unit}`.trim();
      words.push(`${curve.name} ${value !== null ? quantity : curve.ended === true || axes.log ? "has ended" : "none"}`);
      if (value === null || (axes.log && !(value > 0))) return;
      const y = this.y(value);
      made.push(vector("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: "3.5", fill: curve.color }));
      const short = `${significant(value, 2)} ${axes.unit}`.trim();
      numbers.push({ y: Math.max(margin.top + 10, y - 6), text: this.curves.length > 1 ? `${short}, ${shorten(curve.name, 22)}` : short });
    });
    if (axes.numbers === true) made.push(...this.numbersBeside(x, numbers));
    fill(this.cursor, ...made);
    this.root.setAttribute("aria-label", `${this.title}. At ${significant(time)} s: ${words.join(", ") || axes.empty}`);
    return values;
  }

  /** Texts beside the line of the current time; overlapping ones move downward. */
  private numbersBeside(x: number, numbers: { y: number; text: string }[]): SVGElement[] {
    numbers.sort((a, b) => a.y - b.y);
    const left = x > margin.left + 0.5 * this.inner();
    let above = -Infinity;
    return numbers.map((number) => {
      above = Math.max(number.y, above + 14);
      const label = vector("text", { x: (x + (left ? -8 : 8)).toFixed(1), y: above.toFixed(1), "text-anchor": left ? "end" : "start", class: "motion-value" });
      label.textContent = number.text;
      return label;
    });
  }
}
