// The modes of contacts and joints over time, one row per contact or joint, with marks at events. Clicking and dragging
// set the time; near an event, its time. A table below lists the events.

import type { Timeline, TimelineEvent } from "../data.ts";
import { element, fill, identity, vector } from "../dom.ts";
import { counted, quantity, significant } from "../format.ts";
import { oneLine, shorten } from "../text.ts";
import { scrubWith, ticks } from "./time_plot.ts";

const margin = { left: 14, right: 14, top: 4, bottom: 34 };
const [rowHeight, nameHeight, barHeight] = [48, 15, 18];
// px within which a click selects an event
const reach = 6;

interface Look {
  colors: readonly [string, string]; // in the light and in the dark theme
  fill: "line" | "hatched" | "light" | "solid";
}

/** Look of a mode: its kind of motion by colour and filling, so that colour is not the only distinction. */
export function lookOf(mode: string): Look {
  if (mode === "flight" || mode === "free") return { colors: ["#59616b", "#a0a8b2"], fill: "line" };
  if (mode.startsWith("slid")) return { colors: ["#a14e00", "#f0a35a"], fill: "hatched" };
  if (mode.startsWith("rolling") || mode === "spinning") return { colors: ["#00518a", "#7cc0ff"], fill: "light" };
  if (mode === "resting" || mode === "sticks") return { colors: ["#5b3fa0", "#b9a4f0"], fill: "solid" };
  return { colors: ["#1b7f3b", "#7fd79b"], fill: "solid" };
}

const words = (name: string): string => oneLine(name).replace(/_/g, " ");

const shapes: Record<string, string> = {
  down: "M-5 -8H5L0 1Z", up: "M-5 1H5L0 -8Z", circle: "M-4 -4a4 4 0 1 0 8 0a4 4 0 1 0 -8 0Z", square: "M-4 -8H4V0H-4Z", diamond: "M-5 -4L0 -9L5 -4L0 1Z", star: "M-5 -4H5M0 -9V1M-4 -8L4 0M-4 0L4 -8",
};
const marks: Record<string, [shape: string, filled: boolean]> = {
  impact: ["down", true], lands: ["down", false], lifts_off: ["up", false], rolls: ["circle", true], slides: ["circle", false], accumulates: ["star", false], stops: ["square", true],
  rests: ["diamond", true], leaves: ["diamond", false], sticks: ["square", true], slips: ["square", false],
};
const markOf = (kind: string): [string, boolean] => marks[kind] ?? (kind.endsWith("_starts") ? ["up", true] : ["diamond", true]);

function symbol(kind: string, x: number, y: number): SVGElement {
  const [shape, filled] = markOf(kind);
  return vector("path", { d: shapes[shape] ?? "", transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, class: filled ? "motion-mark filled" : "motion-mark" });
}

/** The impulses of an event as text; empty without impulse. */
export function impulseText(event: TimelineEvent, unit: string): string {
  const normal = event.normal === null || event.normal === 0 ? "" : quantity(event.normal, unit);
  const tangential = event.tangential === null || event.tangential === 0 ? "" : `${quantity(event.tangential, unit)} tangential`;
  return [normal, tangential].filter((one) => one !== "").join(", ");
}

/** The mode of a row at a time: at an event the one after it; "" if it is not known. */
export function modeAt(row: Timeline["rows"][number], t: number): string {
  let found = "";
  for (const { from, to, mode } of row.modes) {
    if (t < from) break;
    found = t <= to ? mode : "";
  }
  return found;
}

/** Modes at a time in words, without rows in flight if there are several; "" if there are none. */
export function modesText(timeline: Timeline, t: number): string {
  const all = timeline.rows.map((row) => [row.name, modeAt(row, t)] as const).filter(([, mode]) => mode !== "");
  const shown = all.length > 1 ? all.filter(([, mode]) => mode !== "flight") : all;
  const text = shown.slice(0, 4).map(([name, mode]) => `${shorten(oneLine(name), 40)} ${words(mode)}`).join(", ");
  return shown.length > 4 ? `${text}, ..` : text;
}

/** The times of events, ascending and distinct. */
export const eventTimes = (timeline: Timeline): number[] => [...new Set(timeline.events.map((event) => event.t))].sort((a, b) => a - b);

/** The next event time after t (sign 1) or the last one before t (sign -1); null if there is none. */
export function neighbour(times: readonly number[], t: number, sign: number): number | null {
  const slack = 1e-9 * Math.abs(t);
  return (sign > 0 ? times.find((one) => one > t + slack) : [...times].reverse().find((one) => one < t - slack)) ?? null;
}

export class ModeStrip {
  readonly root: HTMLElement;
  private readonly svg = vector("svg", { class: "motion-strip", role: "img", "aria-label": "Modes over time" }) as SVGSVGElement;
  private readonly still = vector("g", {});
  private readonly cursor = vector("g", {});
  private readonly legend = element("ul", { class: "motion-legend" });
  private readonly note = element("span", {});
  private readonly rows = element("tbody");
  private readonly table = element("details", { class: "motion-table", ontoggle: () => this.fillTable() }, element("summary", {}, "Table of events"),
    element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Events" },
      element("table", {}, element("thead", {}, element("tr", {}, ...["time (s)", "contact or joint", "event", "impulse"].map((title) => element("th", { scope: "col" }, title)))), this.rows)));
  private timeline: Timeline | null = null;
  private times: number[] = [];
  private duration = 1;
  private width = 600;
  private dark = false;

  constructor(private readonly go: (time: number, done: boolean) => void) {
    this.svg.append(this.still, this.cursor);
    this.root = element("figure", { class: "motion-modes", hidden: true }, this.svg as unknown as HTMLElement,
      element("figcaption", {}, "Modes and events of the truth. Click to set the time. ", this.note), this.legend, this.table);
    scrubWith(this.svg, (x, dragged) => {
      const box = this.svg.getBoundingClientRect();
      const at = (x - box.left) * (this.width / (box.width || 1));
      const near = this.times.map((t) => [Math.abs(this.x(t) - at), t] as const).sort((a, b) => a[0] - b[0])[0];
      if (!dragged && near !== undefined && near[0] <= reach) return near[1];
      return Math.max(0, Math.min(1, (at - margin.left) / this.inner())) * this.duration;
    }, go);
  }

  isEvent(t: number): boolean {
    return this.times.includes(t);
  }

  /** The neighbouring event, see neighbour(). */
  neighbour(t: number, sign: number): number | null {
    return neighbour(this.times, t, sign);
  }

  show(timeline: Timeline | null, duration: number, dark: boolean): void {
    this.timeline = timeline;
    this.duration = duration;
    this.dark = dark;
    this.times = timeline === null ? [] : eventTimes(timeline);
    this.root.hidden = timeline === null;
    this.table.hidden = this.times.length === 0;
    if (timeline === null) return;
    const omitted = timeline.total - timeline.events.length;
    const keys = this.times.length > 0 ? "The keys [ and ] go to the previous and the next event. " : "";
    this.note.textContent = keys + (omitted > 0 ? `The last ${omitted} of ${counted(timeline.total, "event")} are omitted.` : "");
    this.draw();
    this.fillTable();
  }

  resize(): void {
    const width = this.svg.clientWidth;
    if (width < 40 || Math.abs(width - this.width) < 1) return;
    this.width = width;
    this.draw();
  }

  private inner(): number {
    return this.width - margin.left - margin.right;
  }

  private x(t: number): number {
    return margin.left + (this.duration > 0 ? t / this.duration : 0) * this.inner();
  }

  private hatching(color: string): { pattern: SVGElement; fill: string } {
    const id = identity("hatch");
    const pattern = vector("pattern", { id, width: "6", height: "6", patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
      vector("path", { d: "M0 0V6", stroke: color, "stroke-width": "2.4", "stroke-opacity": "0.55" }));
    return { pattern, fill: `url(#${id})` };
  }

  /** A bar of a mode. */
  private bar(mode: string, x: number, y: number, width: number, height: number): SVGElement[] {
    const look = lookOf(mode);
    const color = look.colors[this.dark ? 1 : 0];
    const middle = y + height / 2;
    if (look.fill === "line") return [vector("path", { d: `M${x.toFixed(1)} ${middle}h${width.toFixed(1)}`, stroke: color, "stroke-width": "2", "stroke-dasharray": mode === "flight" ? "2 3" : "none" })];
    const box = { x: x.toFixed(1), y: String(y), width: Math.max(0.8, width).toFixed(1), height: String(height), stroke: color, "stroke-width": "1.2" };
    if (look.fill !== "hatched") return [vector("rect", { ...box, fill: color, "fill-opacity": look.fill === "light" ? "0.15" : "0.42" })];
    const { pattern, fill: hatched } = this.hatching(color);
    return [pattern, vector("rect", { ...box, fill: hatched })];
  }

  private draw(): void {
    const { timeline, width } = this;
    if (timeline === null) return;
    const bottom = margin.top + rowHeight * timeline.rows.length;
    const height = bottom + margin.bottom;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.setAttribute("height", String(height));
    const made: SVGElement[] = [];
    const text = (content: string, x: number, y: number, anchor: string, kind = ""): void => {
      const label = vector("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor, class: kind });
      label.textContent = content;
      made.push(label);
    };
    timeline.rows.forEach((row, i) => {
      const top = margin.top + rowHeight * i;
      const y = top + nameHeight + 10;
      text(shorten(oneLine(row.name), Math.max(12, Math.floor(this.inner() / 8))), margin.left, top + 12, "start", "motion-row");
      if (row.modes.length === 0) made.push(...this.bar("flight", margin.left, y, this.inner(), barHeight));
      for (const { from, to, mode } of row.modes) {
        const [left, right] = [this.x(from), this.x(to)];
        made.push(...this.bar(mode, left, y, right - left, barHeight));
        const name = words(mode);
        if (lookOf(mode).fill !== "line" && right - left > 7 * name.length + 6) text(name, (left + right) / 2, y + 13, "middle", "motion-mode");
      }
      for (const event of timeline.events) {
        if (event.row !== i) continue;
        const mark = symbol(event.kind, this.x(event.t), y);
        const title = vector("title", {});
        const impulse = impulseText(event, row.unit);
        title.textContent = `${words(event.kind)} at ${significant(event.t, 7)} s${impulse === "" ? "" : `, impulse ${impulse}`}`;
        mark.append(title);
        made.push(vector("path", { d: `M${this.x(event.t).toFixed(1)} ${y}v${barHeight}`, class: "motion-event" }), mark);
      }
    });
    for (const t of ticks(0, this.duration, Math.max(2, Math.floor(this.inner() / 80)))) {
      made.push(vector("path", { d: `M${this.x(t).toFixed(1)} ${bottom}v4`, class: "motion-axis" }));
      text(significant(t), this.x(t), bottom + 17, "middle");
    }
    made.push(vector("path", { d: `M${margin.left} ${bottom}H${width - margin.right}`, class: "motion-axis" }));
    text("time (s)", margin.left + this.inner() / 2, height - 3, "middle");
    fill(this.still, ...made);
    this.drawLegend(timeline);
  }

  private drawLegend(timeline: Timeline): void {
    const modes = [...new Set(timeline.rows.flatMap((row) => row.modes.map(({ mode }) => mode)))];
    const kinds = [...new Set(timeline.events.map(({ kind }) => kind))];
    const sample = (content: SVGElement[], name: string): HTMLElement => element("li", {},
      vector("svg", { class: "motion-sample", width: "22", height: "16", viewBox: "0 0 22 16", "aria-hidden": "true" }, ...content) as unknown as HTMLElement, element("span", { class: "name" }, words(name)));
    fill(this.legend, ...modes.map((mode) => sample(this.bar(mode, 1, 1, 20, 14), mode)), ...kinds.map((kind) => sample([symbol(kind, 11, 12)], kind)));
  }

  /** Fills the table when it is opened. */
  private fillTable(): void {
    const { timeline } = this;
    if (timeline === null || !this.table.open) {
      fill(this.rows);
      return;
    }
    fill(this.rows, ...timeline.events.map((event) => {
      const row = timeline.rows[event.row];
      const time = significant(event.t, 8);
      return element("tr", {}, element("td", {}, element("button", { type: "button", title: "Go to this time", onclick: () => this.go(event.t, true) }, time)),
        element("td", {}, shorten(oneLine(row?.name ?? ""), 60)), element("td", {}, words(event.kind)), element("td", {}, impulseText(event, row?.unit ?? "")));
    }));
  }

  at(time: number): void {
    const { timeline } = this;
    if (timeline === null) return;
    const x = this.x(time).toFixed(1);
    fill(this.cursor, vector("path", { d: `M${x} ${margin.top + nameHeight}V${margin.top + rowHeight * timeline.rows.length}`, class: "motion-cursor" }));
    this.svg.setAttribute("aria-label", `Modes over time of ${counted(timeline.rows.length, "contact or joint", "contacts or joints")}, with ${counted(timeline.total, "event")}. At ${significant(time)} s: ${modesText(timeline, time) || "no contact"}`);
  }
}
