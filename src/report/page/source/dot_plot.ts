// Dot plot: one number of each row of a table on one axis.

import { Choice, element, fill } from "./dom.ts";
import { significant } from "./format.ts";
import { axis, Plot, type Layout, type Trace } from "./plot.ts";
import { markOf, methodColor } from "./marks.ts";
import { fileName, type Tools } from "./tools.ts";
import { oneLine, plotText, shorten } from "./text.ts";
import type { Table } from "./data.ts";

export interface Dot {
  label: string;
  value: number;
  low: number | null;
  high: number | null;
  hover: string[];
  method: number; // -1: none
}

const mostDots = 90;

/** Range of an axis for plotly that covers all values with a margin at both ends. */
export function around(values: readonly number[], logarithmic: boolean): [number, number] {
  const places = values.filter((value) => Number.isFinite(value) && (!logarithmic || value > 0)).map((value) => (logarithmic ? Math.log10(value) : value));
  const [low, high] = [Math.min(...places), Math.max(...places)];
  const room = 0.05 * (high - low) || 0.1 * Math.abs(high) || 0.1;
  return [low - room, high + room];
}

/** Rows of dots, the first at the top. `one` draws a line at 1. */
export class DotPlot {
  readonly root: HTMLElement;
  private readonly plot: Plot;
  private readonly note = element("p", { class: "faint", hidden: true });

  constructor(
    private readonly tools: Tools,
    label: string,
    file: () => string,
  ) {
    this.plot = new Plot(tools.page, label, "", () => fileName(tools.data.folder, file()), 320);
    this.root = element("div", { class: "dot-plot" }, this.plot.root, this.note);
  }

  show(dots: readonly Dot[], title: string, one: boolean, log?: boolean, short = title): void {
    const shown = dots.filter((dot) => Number.isFinite(dot.value)).slice(0, mostDots);
    this.root.hidden = shown.length === 0;
    this.note.hidden = dots.length <= shown.length;
    this.note.textContent = `Only the first ${shown.length} of ${dots.length} rows are plotted; the table has all rows.`;
    if (shown.length === 0) return;
    const values = shown.map((dot) => dot.value);
    const logarithmic = log ?? (values.every((value) => value > 0) && Math.max(...values) > 20 * Math.min(...values));
    const drawn = logarithmic ? shown.filter((dot) => dot.value > 0) : shown;
    const all = [...drawn.flatMap((dot) => [dot.value, ...[dot.low, dot.high].filter((end) => end !== null)]), ...(one ? [1] : [])];
    this.plot.setHeight(80 + (drawn.length > 40 ? 15 : 19) * drawn.length);
    this.plot.draw((theme) => {
      const color = (dot: Dot): string => (dot.method < 0 ? (theme.dark ? "#7cc0ff" : "#00518a") : methodColor(this.tools.data, this.tools.data.methods[dot.method], theme.dark));
      const ends = drawn.map((dot) => ({ high: dot.high === null ? 0 : dot.high - dot.value, low: dot.low === null ? 0 : dot.value - dot.low }));
      const whiskers: Trace[] = drawn.flatMap((dot, i) =>
        dot.low === null || dot.high === null ? [] : [{ type: "scatter", mode: "lines", x: [dot.low, dot.high], y: [i, i], line: { color: color(dot), width: 2 }, hoverinfo: "skip", showlegend: false } as Trace]);
      const trace = {
        type: "scatter", mode: "markers", x: drawn.map((dot) => dot.value), y: drawn.map((_, i) => i), showlegend: false,
        text: drawn.map((dot, i) => [dot.label, significant(dot.value) + ((ends[i]?.high ?? 0) > 0 ? ` (${significant(dot.low)} to ${significant(dot.high)})` : ""), ...dot.hover].map((line) => plotText(line, 110)).join("<br>")), hoverinfo: "text",
        marker: { size: 9, color: drawn.map(color), symbol: drawn.map((dot) => (dot.method < 0 ? "circle" : markOf(this.tools.data.methods[dot.method]?.mark ?? 0).symbol)), line: { color: drawn.map(color), width: 1.3 } },
      } as unknown as Trace;
      const length = this.plot.narrow() ? 20 : 44;
      const layout: Layout = {
        xaxis: axis(theme, plotText(this.plot.narrow() ? short : title), logarithmic, { range: around(all, logarithmic) }),
        yaxis: {
          ...axis(theme, "", false), range: [drawn.length - 0.5, -0.5], tickmode: "array", tickvals: drawn.map((_, i) => i), ticktext: drawn.map((dot) => plotText(dot.label, length)),
          tickfont: { size: 11 }, ticks: "", fixedrange: true,
        } as Layout["yaxis"],
        shapes: (one ? [{ type: "line", x0: 1, x1: 1, yref: "paper", y0: 0, y1: 1, line: { color: theme.ink, width: 1.2 }, layer: "below" }] : []) as Layout["shapes"],
        margin: { l: 20, r: 20, t: 10, b: 48 },
      };
      return { traces: [...whiskers, trace], layout };
    });
  }
}

/** Label of a row: its first text cells. */
export function labelOf(table: Table, row: readonly (string | number | null)[]): string {
  const texts = table.columns.flatMap((column, c) => (column.numeric || /^(message|left_out|setting_kind|step|own|peer|reached|family|proof|within.*)$/.test(column.name) ? [] : [row[c]]));
  const label = texts.filter((cell) => cell !== null && cell !== undefined && cell !== "").slice(0, 3).map(String);
  // settings distinguish rows with the same name
  const settings = table.columns.flatMap((column, c) => (column.numeric && /^(attitude_error|ratio|links|bodies|tolerance)$/.test(column.name) && typeof row[c] === "number" ? [significant(row[c])] : []));
  return [...label, ...(table.columns.some((column) => /^(own|ratio|joint)$/.test(column.name)) ? settings.slice(0, 1) : [])].map((part) => shorten(oneLine(part), 40)).join(", ");
}

/** Dot plot of a column that the reader selects; null if the table has no suitable column. */
export function tableDots(tools: Tools, table: Table, key: string, preferred: readonly RegExp[]): HTMLElement | null {
  const drawable = table.columns.flatMap((column, c) =>
    column.numeric && column.name !== "place" && table.rows.some((row) => typeof row[c] === "number") ? [c] : []);
  const [firstColumn] = drawable;
  if (firstColumn === undefined || !table.columns.some((column) => !column.numeric)) return null;
  const standard = preferred.flatMap((pattern) => drawable.filter((c) => pattern.test(table.columns[c]?.name ?? "")))[0] ?? firstColumn;
  const name = (c: number): string => table.columns[c]?.name ?? "";
  const plot = new DotPlot(tools, `${shorten(oneLine(table.title || table.name), 80)}: dot plot`, () => table.name);
  const choice = new Choice("Plotted column", (value) => tools.page.set({ [key]: value === name(standard) ? "" : value }));
  const methods = new Map(tools.data.methods.map((method, m) => [method.name, m]));
  const methodColumn = table.columns.findIndex((column) => column.name === "method" || column.name === "own");
  const show = (): void => {
    const asked = drawable.find((c) => name(c) === tools.page.get(key)) ?? standard;
    choice.update(drawable.map((c) => [name(c), shorten(oneLine(name(c)).replace(/_/g, " "), 40)]), name(asked));
    const dots = table.rows.flatMap((row): Dot[] => {
      const value = row[asked];
      if (typeof value !== "number") return [];
      const method = methodColumn < 0 ? -1 : (methods.get(String(row[methodColumn] ?? "")) ?? -1);
      return [{ label: labelOf(table, row), value, low: null, high: null, hover: [], method }];
    });
    plot.show(dots, name(asked).replace(/_/g, " "), /ratio|factor|gain/.test(name(asked)));
  };
  tools.page.watch([key], show);
  show();
  const root = element("div", { class: "body" });
  fill(root, choice.root, plot.root);
  return root;
}
