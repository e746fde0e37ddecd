// Attitude errors over time on a logarithmic scale, with a line at the current time of the view.

import { fill, vector } from "../dom.ts";
import { errorDecades, significant } from "../format.ts";
import { shorten } from "../text.ts";
import { type Actor, errorAt } from "./actors.ts";
import { dashOf } from "./polhode_view.ts";

const margin = { left: 52, right: 12, top: 10, bottom: 34 };

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

/** Exponents of the decades that contain the errors; [-16, 0] if there are none. */
export const decades = (errors: readonly (number | null)[]): [number, number] => errorDecades(errors) ?? [-16, 0];

export class ErrorPlot {
  readonly root: SVGSVGElement;
  private actors: Actor[] = [];
  private duration = 1;
  private range: [number, number] = [-16, 0];
  private width = 400;
  private readonly height = 220;
  private readonly still = vector("g", {});
  private readonly cursor = vector("g", {});

  constructor(private readonly go: (time: number, done: boolean) => void) {
    this.root = vector("svg", { class: "motion-errors", role: "img", "aria-label": "Attitude error over time" }, this.still, this.cursor) as SVGSVGElement;
    let held = false;
    const at = (event: PointerEvent, done: boolean): void => {
      const box = this.root.getBoundingClientRect();
      const part = ((event.clientX - box.left) * (this.width / (box.width || 1)) - margin.left) / this.inner();
      this.go(Math.max(0, Math.min(1, part)) * this.duration, done);
    };
    this.root.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      held = true;
      this.root.setPointerCapture(event.pointerId);
      at(event, false);
    });
    this.root.addEventListener("pointermove", (event) => {
      if (held) at(event, false);
    });
    this.root.addEventListener("pointerup", (event) => {
      if (held) at(event, true);
      held = false;
    });
    this.root.addEventListener("pointercancel", () => (held = false));
    this.root.style.touchAction = "pan-y";
  }

  private inner(): number {
    return this.width - margin.left - margin.right;
  }

  private x(t: number): number {
    return margin.left + (this.duration > 0 ? t / this.duration : 0) * this.inner();
  }

  private y(error: number): number {
    const [low, high] = this.range;
    const part = (Math.log10(error) - low) / (high - low);
    return this.height - margin.bottom - Math.max(0, Math.min(1, part)) * (this.height - margin.top - margin.bottom);
  }

  show(actors: readonly Actor[], duration: number): void {
    this.actors = actors.filter((actor) => (actor.method?.t.length ?? 0) > 0);
    this.duration = duration;
    // omits t = 0, where only rounding of the start remains, many decades below
    this.range = decades(this.actors.flatMap((actor) => actor.method?.attitude.filter((_, i) => (actor.method?.t[i] ?? 0) > 0) ?? []));
    this.draw();
  }

  resize(width: number): void {
    if (width < 40 || Math.abs(width - this.width) < 1) return;
    this.width = width;
    this.draw();
  }

  private draw(): void {
    const { width, height } = this;
    this.root.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.root.setAttribute("height", String(height));
    const made: SVGElement[] = [];
    const text = (content: string, x: number, y: number, anchor: string): void => {
      const label = vector("text", { x: String(x), y: String(y), "text-anchor": anchor });
      label.textContent = content;
      made.push(label);
    };
    const line = (x1: number, y1: number, x2: number, y2: number, kind: string): void => {
      made.push(vector("path", { d: `M${x1.toFixed(1)} ${y1.toFixed(1)}L${x2.toFixed(1)} ${y2.toFixed(1)}`, class: kind }));
    };
    const [low, high] = this.range;
    const bottom = height - margin.bottom;
    const every = Math.max(1, Math.ceil((high - low) / 6));
    for (let power = low; power <= high; power += every) {
      const y = this.y(10 ** power);
      line(margin.left, y, width - margin.right, y, "motion-grid");
      text(power === 0 ? "1" : `1e${power}`, margin.left - 6, y + 4, "end");
    }
    for (const t of ticks(0, this.duration, Math.max(2, Math.floor(this.inner() / 80)))) {
      line(this.x(t), bottom, this.x(t), bottom + 4, "motion-axis");
      text(significant(t), this.x(t), bottom + 17, "middle");
    }
    line(margin.left, bottom, width - margin.right, bottom, "motion-axis");
    line(margin.left, margin.top, margin.left, bottom, "motion-axis");
    text("time (s)", margin.left + this.inner() / 2, height - 3, "middle");
    for (const actor of this.actors) {
      const { method } = actor;
      if (method === null) continue;
      let path = "";
      let pen = false;
      method.t.forEach((t, i) => {
        const error = method.attitude[i] ?? null;
        if (error === null || !(error > 0)) pen = false;
        else {
          path += `${pen ? "L" : "M"}${this.x(t).toFixed(1)} ${this.y(error).toFixed(1)}`;
          pen = true;
        }
      });
      made.push(vector("path", { d: path, class: "motion-curve", stroke: actor.color, "stroke-dasharray": dashOf(actor.place).join(" ") || "none" }));
      if (actor.endsEarly && actor.end > 0) {
        const [x, y] = [this.x(actor.end), this.y(errorAt(method, actor.end) ?? 10 ** low)];
        made.push(vector("path", { d: `M${x - 4} ${y - 4}L${x + 4} ${y + 4}M${x - 4} ${y + 4}L${x + 4} ${y - 4}`, class: "motion-curve", stroke: actor.color }));
      }
    }
    if (this.actors.length === 0) text("no method with errors over time is selected", margin.left + this.inner() / 2, height / 2, "middle");
    fill(this.still, ...made);
  }

  at(time: number): void {
    const x = this.x(time);
    const made: SVGElement[] = [
      vector("path", { d: `M${x.toFixed(1)} ${margin.top}V${this.height - margin.bottom}`, class: "motion-cursor" }),
    ];
    const words: string[] = [];
    const numbers: { y: number; text: string }[] = [];
    for (const actor of this.actors) {
      const error = actor.method === null ? null : errorAt(actor.method, time);
      words.push(`${actor.name} ${error === null ? "has ended" : `${significant(error)} rad`}`);
      if (error === null || !(error > 0)) continue;
      const y = this.y(error);
      made.push(vector("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: "3.5", fill: actor.color }));
      numbers.push({ y: Math.max(margin.top + 10, y - 6), text: this.actors.length > 1 ? `${significant(error, 2)} rad, ${shorten(actor.name, 22)}` : `${significant(error, 2)} rad` });
    }
    // moves overlapping numbers downward
    numbers.sort((a, b) => a.y - b.y);
    const left = x > margin.left + 0.5 * this.inner();
    let above = -Infinity;
    for (const number of numbers) {
      above = Math.max(number.y, above + 14);
      const label = vector("text", { x: (x + (left ? -8 : 8)).toFixed(1), y: above.toFixed(1), "text-anchor": left ? "end" : "start", class: "motion-value" });
      label.textContent = number.text;
      made.push(label);
    }
    fill(this.cursor, ...made);
    this.root.setAttribute("aria-label", `Attitude error over time, logarithmic. At ${significant(time)} s: ${words.join(", ") || "no method is selected"}`);
  }
}
