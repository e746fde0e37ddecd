// Curves of many methods in one plot: at most twelve are highlighted ("lit" in the code and in the address), the others
// are thin and grey. The legend beside the plot toggles them.

import { Choice, element, fill } from "./dom.ts";
import { count } from "./format.ts";
import { parseList, writeList } from "./fragment.ts";
import { light, mostLit, toggleLit } from "./lit.ts";
import { markOf, methodColor } from "./marks.ts";
import { axis, Plot, type Drawing, type Layout, type Theme, type Trace } from "./plot.ts";
import { TableView } from "./table_view.ts";
import { thinned } from "./thin.ts";
import { fileName, methodName, methodSwatch, named, type Tools } from "./tools.ts";
import { oneLine, plotText, type Cell } from "./text.ts";

export interface Curve {
  method: number;
  variant: string; // distinguishes curves of one method: "step", "tolerance", ..
  place: number; // index among the method's curves
  x: (number | null)[];
  y: (number | null)[];
  hover: (i: number) => string[]; // lines of text
  failures: { x: number | null; y: number | null; hover: string[] }[];
  other?: { x: number[]; y: number[]; hover: string[] }; // curve of the directory compared with
}

export interface Picture {
  curves: Curve[];
  x: { title: string; log: boolean };
  y: { title: string; log: boolean; range?: [number, number] }; // range: exponents of 10 on a logarithmic axis
  bands: { from: number; to: number; label: string; short: string }[];
  guides: { x: number[]; y: number[]; label: string }[];
  standard: number[]; // default selection of highlighted methods, the most important first
  detail?: (method: number) => { text: string; flag: string } | null;
  detailHead?: string;
}

const mostGreyPoints = 12000;
const mostLitPoints = 2000;

export class CurvePlot {
  readonly root: HTMLElement;
  readonly plot: Plot;
  private readonly legend: HTMLElement;
  private readonly numbers: HTMLElement;
  private numbersView: TableView | null = null;
  private readonly familyChoice: Choice;
  private picture: Picture | null = null;

  constructor(
    private readonly tools: Tools,
    name: string,
    label: string,
    file: () => string,
  ) {
    this.plot = new Plot(tools.page, label, `${name}.zoom`, () => fileName(tools.data.folder, file()), 500);
    this.plot.onClick((method) => {
      if (typeof method === "number" && !this.lit().includes(method)) this.toggle(method);
    });
    this.legend = element("div", { class: "legend-list" });
    this.familyChoice = new Choice("Highlight family", (family) => this.lightFamily(Number(family)));
    this.numbers = element("details", { class: "numbers", ontoggle: () => this.showNumbers() }, element("summary", {}, "Data of the highlighted curves"));
    this.root = element(
      "div",
      { class: "curve-plot" },
      element("div", { class: "with-legend" }, this.plot.root, element("div", { class: "legend" }, this.familyChoice.root, this.legend)),
      this.numbers,
    );
    tools.page.watch(["lit"], () => this.refresh());
  }

  show(picture: Picture): void {
    this.picture = picture;
    this.refresh();
  }

  /** Highlighted methods: the reader's selection among the plotted methods, else the default selection. */
  lit(): number[] {
    if (this.picture === null) return [];
    const here = new Set(this.picture.curves.map((curve) => curve.method));
    const asked = this.tools.page.get("lit");
    if (asked === "none") return [];
    const places = new Map(this.tools.data.methods.map((method, i) => [method.name, i]));
    const chosen = parseList(asked).flatMap((name) => {
      const place = places.get(name);
      return place !== undefined && here.has(place) ? [place] : [];
    });
    return chosen.length > 0 ? chosen.slice(-mostLit) : light(this.picture.standard.filter((method) => here.has(method)));
  }

  private write(methods: number[]): void {
    // very long names would make the address unusable
    const names = methods.map((method) => methodName(this.tools, method)).filter((name) => name.length <= 400);
    this.tools.page.set({ lit: names.length === 0 ? "none" : writeList(names) });
  }

  private toggle(method: number): void {
    const before = this.lit();
    const after = toggleLit(before, method);
    this.write(after);
    const gone = before.find((one) => one !== method && !after.includes(one));
    this.tools.page.announce(
      `${methodName(this.tools, method).slice(0, 80)} ${after.includes(method) ? "highlighted" : "dimmed"}` +
        (gone === undefined ? "" : `, ${methodName(this.tools, gone).slice(0, 80)} dimmed`) + `; ${after.length} of ${mostLit} highlighted`,
    );
  }

  private lightFamily(family: number): void {
    if (this.picture === null) return;
    const here = [...new Set(this.picture.curves.map((curve) => curve.method))];
    if (!(family >= 0)) {
      this.tools.page.set({ lit: "" });
      return;
    }
    this.write(light(here.filter((method) => this.tools.data.methods[method]?.family === family)));
  }

  private refresh(): void {
    if (this.picture === null) return;
    this.showLegend();
    const lit = this.lit();
    this.plot.draw((theme) => this.drawing(theme, lit));
    this.showNumbers();
  }

  private showLegend(): void {
    const picture = this.picture as Picture;
    const lit = new Set(this.lit());
    const methods = [...new Set(picture.curves.map((curve) => curve.method))];
    const variants = new Map<number, Set<string>>();
    for (const curve of picture.curves) {
      const known = variants.get(curve.method) ?? new Set();
      variants.set(curve.method, known.add(curve.variant));
    }
    const entry = (method: number): HTMLElement => {
      const isLit = lit.has(method);
      const detail = picture.detail?.(method) ?? null;
      const several = [...(variants.get(method) ?? [])].filter((one) => one !== "");
      return element(
        "li",
        {},
        element(
          "button",
          {
            type: "button", class: "entry", "aria-pressed": String(isLit), "data-method": method,
            title: oneLine(`${methodName(this.tools, method)}${several.length > 1 ? ` (${several.join(", ")})` : ""}`).slice(0, 600),
            onclick: () => this.toggle(method),
          },
          methodSwatch(this.tools, method, isLit),
          named(methodName(this.tools, method), 34),
          detail === null ? null : element("span", { class: detail.flag === "" ? "detail" : "detail flagged", title: detail.flag === "" ? null : detail.flag }, detail.text),
        ),
      );
    };
    const families = this.tools.data.families;
    const byFamily = families.map((_, f) => methods.filter((method) => this.tools.data.methods[method]?.family === f));
    this.familyChoice.update(
      [["", "default selection"], ...byFamily.flatMap((some, f): [string, string][] => (some.length > 0 ? [[String(f), `${oneLine(families[f]?.label ?? "").slice(0, 60)} (${some.length})`]] : []))],
      "",
    );
    const focused = document.activeElement instanceof HTMLElement && this.legend.contains(document.activeElement) ? document.activeElement.dataset.method : undefined;
    const inOrder = byFamily.flat();
    const others = byFamily.map((some) => some.filter((method) => !lit.has(method)));
    const unlit = inOrder.length - inOrder.filter((method) => lit.has(method)).length;
    const scrolled = this.legend.scrollTop;
    fill(
      this.legend,
      element("p", { class: "legend-head" }, `Highlighted: ${inOrder.length - unlit} of ${count(inOrder.length)}`, picture.detailHead === undefined ? null : element("span", { class: "detail" }, picture.detailHead)),
      element("ul", {}, ...inOrder.filter((method) => lit.has(method)).map(entry)),
      unlit > 0 ? element("p", { class: "legend-head" }, "Grey; click to highlight") : null,
      ...others.flatMap((some, f) => some.length === 0 ? [] : [
        element("p", { class: "family" }, oneLine(families[f]?.label ?? "").slice(0, 60)), element("ul", {}, ...some.map(entry)),
      ]),
    );
    this.legend.scrollTop = scrolled;
    if (focused !== undefined) this.legend.querySelector<HTMLElement>(`button[data-method="${focused}"]`)?.focus();
  }

  private drawing(theme: Theme, lit: number[]): Drawing {
    const picture = this.picture as Picture;
    const isLit = new Set(lit);
    const traces: Trace[] = [];
    const grey = picture.curves.filter((curve) => !isLit.has(curve.method));
    if (grey.length > 0) {
      const total = grey.reduce((sum, curve) => sum + curve.x.length, 0);
      const each = total > mostGreyPoints ? Math.max(4, Math.floor(mostGreyPoints / grey.length)) : Infinity;
      const x: (number | null)[] = [];
      const y: (number | null)[] = [];
      const text: string[] = [];
      const method: (number | null)[] = [];
      for (const curve of grey) {
        const label = plotText(methodName(this.tools, curve.method));
        for (const i of thinned(curve.y, each)) {
          x.push(curve.x[i] ?? null);
          y.push(curve.y[i] ?? null);
          text.push(`${label}<br>click to highlight`);
          method.push(curve.method);
        }
        x.push(null);
        y.push(null);
        text.push("");
        method.push(null);
      }
      const look = { line: { color: theme.grey, width: 1 }, marker: { size: 4, color: theme.grey }, hoverinfo: "text", showlegend: false };
      // marks are slow to draw; only single points need one
      const lone = grey.filter((curve) => curve.x.length === 1);
      if (lone.length > 0) {
        traces.push({
          type: "scatter", mode: "markers", x: lone.map((curve) => curve.x[0] ?? null), y: lone.map((curve) => curve.y[0] ?? null), ...look,
          text: lone.map((curve) => `${plotText(methodName(this.tools, curve.method))}<br>click to highlight`), customdata: lone.map((curve) => curve.method) as never,
        } as Trace);
      }
      traces.push({
        type: "scatter", mode: "lines", x, y, text, customdata: method as never, ...look, connectgaps: false,
      } as Trace);
    }
    picture.guides.forEach((guide) =>
      traces.push({
        type: "scatter", mode: "text+lines", x: guide.x, y: guide.y, text: guide.x.map((_, i) => (i === 0 ? plotText(guide.label) : "")),
        textposition: "top right", textfont: { color: theme.faint, size: 11 }, hoverinfo: "skip", showlegend: false,
        line: { color: theme.faint, width: 1, dash: "dot" },
      } as unknown as Trace),
    );
    const order = lit.map((method) => ({ method, family: this.tools.data.methods[method]?.family ?? 0 })).sort((a, b) => a.family - b.family || a.method - b.method);
    order.forEach(({ method }, rank) => {
      const known = this.tools.data.methods[method];
      const color = methodColor(this.tools.data, known, theme.dark);
      const mark = markOf(known?.mark ?? 0);
      const group = `m${method}`;
      picture.curves.filter((curve) => curve.method === method).forEach((curve, nth) => {
        const kept = thinned(curve.y, mostLitPoints);
        const name = plotText(methodName(this.tools, method) + (curve.variant === "" ? "" : ` (${curve.variant})`), 60);
        const second = curve.place > 0;
        traces.push({
          type: "scatter", mode: "lines+markers", name, legendgroup: group, showlegend: curve.x.length > 0, customdata: kept.map(() => method) as never,
          x: kept.map((i) => curve.x[i] ?? null), y: kept.map((i) => curve.y[i] ?? null),
          text: kept.map((i) => curve.hover(i).map((line) => plotText(line, 110)).join("<br>")), hoverinfo: "text",
          line: { color, width: second ? 1.1 : 1.8, dash: mark.dash }, opacity: second ? 0.85 : 1,
          marker: { symbol: mark.symbol, color, size: second || kept.length > 40 ? 6 : 8, line: { color, width: 1.4 }, maxdisplayed: 40 },
        } as Trace);
        if (curve.other !== undefined && curve.other.x.length > 0) {
          traces.push({
            type: "scatter", mode: "lines+markers", name: `${name}, ${plotText(this.tools.data.comparison?.folder ?? "", 30)}`, legendgroup: group,
            x: curve.other.x, y: curve.other.y, text: curve.other.hover.map((line) => plotText(line, 160)), hoverinfo: "text",
            line: { color, width: 1.2, dash: "dash" }, marker: { symbol: `${mark.symbol.replace(/(-thin)?-open$/, "")}-open`, color, size: 9, line: { color, width: 1.2 } },
          } as Trace);
        }
        this.failures(traces, curve, nth, rank, color);
      });
    });
    const layout: Layout = {
      xaxis: axis(theme, picture.x.title, picture.x.log),
      yaxis: axis(theme, picture.y.title, picture.y.log, picture.y.range === undefined ? {} : { range: picture.y.range, autorange: false }),
      // failures are marked at the edge of the plot at any zoom
      xaxis2: { overlaying: "x", anchor: "y", range: [0, 1], fixedrange: true, visible: false },
      yaxis2: { overlaying: "y", anchor: "x", range: [0, 1], fixedrange: true, visible: false },
      shapes: picture.bands.flatMap((band) => [
        { type: "rect", xref: "paper", x0: 0, x1: 1, yref: "y", y0: band.from, y1: band.to, fillcolor: theme.band, line: { width: 0 }, layer: "below" },
        { type: "line", xref: "paper", x0: 0, x1: 1, yref: "y", y0: band.to, y1: band.to, line: { color: theme.faint, width: 1, dash: "dot" }, layer: "below" },
      ]) as Layout["shapes"],
      annotations: picture.bands.map((band) => ({
        xref: "paper", x: 0.01, yref: "y", y: picture.y.log ? Math.log10(band.to) : band.to, text: plotText(this.plot.narrow() ? band.short : band.label, 120), showarrow: false, xanchor: "left", yanchor: "top",
        font: { size: 11, color: theme.faint },
      })) as Layout["annotations"],
    };
    if (!traces.some((trace) => (trace as { yaxis?: string }).yaxis === "y2")) delete (layout as Record<string, unknown>).yaxis2;
    if (!traces.some((trace) => (trace as { xaxis?: string }).xaxis === "x2")) delete (layout as Record<string, unknown>).xaxis2;
    return { traces, layout };
  }

  /** Marks failed runs at their coordinates, or at the edge if a coordinate is undefined. */
  private failures(traces: Trace[], curve: Curve, nth: number, rank: number, color: string): void {
    const lane = 0.985 - 0.016 * (rank % 6);
    const kinds: [boolean, boolean][] = [[true, true], [true, false], [false, true], [false, false]];
    for (const [hasX, hasY] of kinds) {
      const some = curve.failures.filter((one) => (one.x !== null) === hasX && (one.y !== null) === hasY);
      if (some.length === 0) continue;
      traces.push({
        type: "scatter", mode: "markers", name: `failures ${curve.method} ${nth}`, showlegend: false, legendgroup: `m${curve.method}`,
        x: some.map((one) => (hasX ? one.x : 0.99)), y: some.map((one) => (hasY ? one.y : lane)),
        ...(hasX ? {} : { xaxis: "x2" }), ...(hasY ? {} : { yaxis: "y2" }), cliponaxis: false,
        text: some.map((one) => one.hover.map((line) => plotText(line, 110)).join("<br>")), hoverinfo: "text",
        marker: { symbol: "x", size: 9, color, line: { color: "#ffffff", width: 0.6 } },
      } as Trace);
    }
  }

  private showNumbers(): void {
    if (!(this.numbers as HTMLDetailsElement).open || this.picture === null) return;
    const picture = this.picture;
    const rows: Cell[][] = [];
    for (const method of this.lit()) {
      for (const curve of picture.curves.filter((one) => one.method === method)) {
        curve.x.forEach((x, i) => {
          if (rows.length < 20000) rows.push([methodName(this.tools, method), curve.variant, x, curve.y[i] ?? null, curve.hover(i).slice(1).join("; ")]);
        });
        curve.failures.forEach((one) => rows.push([methodName(this.tools, method), curve.variant, one.x, one.y, one.hover.slice(1).join("; ")]));
      }
    }
    const content = {
      caption: "Data of the highlighted curves",
      columns: [
        { name: "method", numeric: false }, { name: "curve", numeric: false }, { name: picture.x.title, numeric: true },
        { name: picture.y.title, numeric: true }, { name: "remarks", numeric: false },
      ],
      rows,
    };
    if (this.numbersView === null) {
      this.numbersView = new TableView(this.tools.page, "", content);
      this.numbers.append(this.numbersView.root);
    } else this.numbersView.show(content);
  }
}
