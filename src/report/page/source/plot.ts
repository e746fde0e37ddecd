// A plotly plot with accessible tools: buttons with names, keyboard control, zoom in the address, export.

import type Plotly from "plotly.js-basic-dist-min";
import { element, identity } from "./dom.ts";
import type { Page } from "./state.ts";

export type Trace = Partial<Plotly.PlotData>;
export type Layout = Partial<Plotly.Layout>;

export interface Theme {
  dark: boolean;
  ground: string;
  ink: string;
  faint: string; // secondary text
  grid: string;
  grey: string; // curves that are not highlighted
  band: string;
}

export const themes: { light: Theme; dark: Theme } = {
  light: { dark: false, ground: "#ffffff", ink: "#1c2127", faint: "#59616b", grid: "#e4e7eb", grey: "#c9ced4", band: "#eef0f3" },
  dark: { dark: true, ground: "#14171b", ink: "#e6e9ed", faint: "#a0a8b2", grid: "#2b3037", grey: "#464d56", band: "#1e2329" },
};

export interface Drawing {
  traces: Trace[];
  layout: Layout;
}

type Library = typeof Plotly;
let library: Promise<Library> | null = null;

/** Loads plotly when the first plot is drawn. */
export function loadPlotly(): Promise<Library> {
  library ??= import("plotly.js-basic-dist-min").then((loaded) => (loaded as { default?: Library }).default ?? (loaded as unknown as Library));
  return library;
}

const font = 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", sans-serif';

/** Common properties of a linear or logarithmic axis. */
export function axis(theme: Theme, title: string, log: boolean, more: object = {}): Partial<Plotly.LayoutAxis> {
  return {
    title: { text: title, standoff: 8 },
    type: log ? "log" : "linear",
    gridcolor: theme.grid,
    linecolor: theme.faint,
    zerolinecolor: theme.grid,
    ticks: "outside",
    tickcolor: theme.faint,
    ticklen: 4,
    exponentformat: "power",
    automargin: true,
    mirror: true,
    showline: true,
    ...(log ? { dtick: undefined, minor: { showgrid: false } } : { zeroline: false }),
    ...more,
  } as Partial<Plotly.LayoutAxis>;
}

type Range = [number, number];
interface Drawn extends HTMLElement {
  on?: (name: string, listener: (event: never) => void) => void;
  layout?: { xaxis?: { range?: Range }; yaxis?: { range?: Range } };
}

export class Plot {
  readonly root: HTMLElement;
  private readonly host: Drawn;
  private readonly dragButtons: HTMLButtonElement[];
  private drag: "zoom" | "pan" = "zoom";
  private make: ((theme: Theme) => Drawing) | null = null;
  private ready = false;
  private busy: Promise<void> = Promise.resolve();
  private click: ((customdata: unknown) => void) | null = null;

  /** `zoomKey` is the key of the ranges in the state; "" does not store them. */
  constructor(
    private readonly page: Page,
    label: string,
    private readonly zoomKey: string,
    private readonly file: () => string,
    height = 460,
  ) {
    const help = identity("help");
    this.host = element("div", {
      class: "plot", style: `height:${height}px`, tabindex: 0, role: "group", "aria-label": label, "aria-describedby": help,
      onkeydown: (event: KeyboardEvent) => this.key(event),
    });
    const tool = (text: string, title: string, act: () => void): HTMLButtonElement =>
      element("button", { type: "button", title, onclick: act }, text);
    this.dragButtons = [
      tool("Zoom", "Drag to zoom in", () => this.setDrag("zoom")),
      tool("Pan", "Drag to move the view", () => this.setDrag("pan")),
    ];
    this.root = element(
      "figure",
      { class: "figure" },
      element(
        "div",
        { class: "plot-tools", role: "toolbar", "aria-label": `Plot tools: ${label}` },
        ...this.dragButtons,
        tool("−", "Zoom out", () => this.scale(1.5)),
        tool("+", "Zoom in", () => this.scale(1 / 1.5)),
        tool("Reset", "Show the whole range", () => this.reset()),
        element("span", { class: "gap" }),
        tool("SVG", "Save as SVG with a white background", () => void this.save("svg")),
        tool("PNG", "Save as PNG with a white background", () => void this.save("png")),
      ),
      this.host,
      element("p", { id: help, class: "unseen" }, "Arrow keys move the view, plus and minus zoom, 0 shows the whole range. A table below lists the data."),
    );
    this.showDrag();
    page.onTheme(() => this.redraw());
    if (zoomKey !== "") page.watch([zoomKey], () => this.applyZoom());
  }

  onClick(listener: (customdata: unknown) => void): void {
    this.click = listener;
  }

  draw(make: (theme: Theme) => Drawing): void {
    this.make = make;
    this.redraw();
  }

  setHeight(height: number): void {
    this.host.style.height = `${height}px`;
  }

  /** Whether the plot is too narrow for long labels. */
  narrow(): boolean {
    return this.host.clientWidth > 0 && this.host.clientWidth < 560;
  }

  /** Resolves when all drawing requested so far is done. */
  settled(): Promise<void> {
    return this.busy;
  }

  private redraw(): void {
    this.busy = this.busy.then(() => this.drawNow()).catch((fault: unknown) => {
      this.host.textContent = `The plot cannot be drawn: ${fault instanceof Error ? fault.message : String(fault)}`;
    });
  }

  private async drawNow(): Promise<void> {
    if (this.make === null) return;
    const plotly = await loadPlotly();
    const drawing = this.complete(this.make(this.page.dark() ? themes.dark : themes.light), this.page.dark() ? themes.dark : themes.light);
    this.withZoom(drawing.layout);
    await plotly.react(this.host, drawing.traces as Plotly.Data[], drawing.layout, {
      displayModeBar: false, responsive: true, doubleClick: false, showTips: false,
    } as Partial<Plotly.Config>);
    if (!this.ready) {
      this.ready = true;
      this.host.on?.("plotly_relayout", (event: Record<string, unknown>) => this.moved(event));
      this.host.on?.("plotly_doubleclick", () => this.reset());
      this.host.on?.("plotly_click", (event: { points?: { customdata?: unknown }[] }) => {
        const data = event.points?.[0]?.customdata;
        if (data !== undefined && data !== null) this.click?.(data);
      });
    }
  }

  private complete(drawing: Drawing, theme: Theme): Drawing {
    return {
      traces: drawing.traces,
      layout: {
        autosize: true,
        paper_bgcolor: theme.ground,
        plot_bgcolor: theme.ground,
        font: { family: font, size: 12, color: theme.ink },
        margin: { l: 60, r: 16, t: 14, b: 48 },
        hovermode: "closest",
        hoverlabel: { bgcolor: theme.dark ? "#2b3037" : "#ffffff", bordercolor: theme.faint, font: { family: font, size: 12, color: theme.ink }, align: "left" },
        showlegend: false,
        dragmode: this.drag,
        ...drawing.layout,
      },
    };
  }

  private zoom(): [number, number, number, number] | null {
    const numbers = this.zoomKey === "" ? [] : this.page.get(this.zoomKey).split(",").map(Number);
    const [a, b, c, d] = numbers;
    if (numbers.length !== 4 || numbers.some((one) => !Number.isFinite(one))) return null;
    return [a as number, b as number, c as number, d as number];
  }

  private withZoom(layout: Layout): void {
    const zoom = this.zoom();
    if (zoom === null) return;
    layout.xaxis = { ...layout.xaxis, range: [zoom[0], zoom[1]], autorange: false };
    layout.yaxis = { ...layout.yaxis, range: [zoom[2], zoom[3]], autorange: false };
  }

  private applyZoom(): void {
    const zoom = this.zoom();
    const now = this.ranges();
    if (zoom !== null && now !== null && this.text(now) === this.text(zoom)) return;
    this.redraw();
  }

  private text(ranges: readonly number[]): string {
    return ranges.map((one) => String(Number(one.toPrecision(6)))).join(",");
  }

  private ranges(): [number, number, number, number] | null {
    const x = this.host.layout?.xaxis?.range;
    const y = this.host.layout?.yaxis?.range;
    return x === undefined || y === undefined ? null : [Number(x[0]), Number(x[1]), Number(y[0]), Number(y[1])];
  }

  private moved(event: Record<string, unknown>): void {
    if (this.zoomKey === "" || !Object.keys(event).some((key) => /^[xy]axis\./.test(key))) return;
    const all = event["xaxis.autorange"] === true || event["yaxis.autorange"] === true;
    const ranges = this.ranges();
    this.page.set({ [this.zoomKey]: all || ranges === null ? "" : this.text(ranges) });
  }

  private async relayout(ranges: [number, number, number, number]): Promise<void> {
    const plotly = await loadPlotly();
    await plotly.relayout(this.host, { "xaxis.range": [ranges[0], ranges[1]], "yaxis.range": [ranges[2], ranges[3]] } as Layout);
  }

  private scale(factor: number): void {
    const now = this.ranges();
    if (now === null) return;
    const around = (a: number, b: number): Range => {
      const middle = (a + b) / 2;
      return [middle + (a - middle) * factor, middle + (b - middle) * factor];
    };
    void this.relayout([...around(now[0], now[1]), ...around(now[2], now[3])]);
  }

  private move(right: number, up: number): void {
    const now = this.ranges();
    if (now === null) return;
    const x = (now[1] - now[0]) * right;
    const y = (now[3] - now[2]) * up;
    void this.relayout([now[0] + x, now[1] + x, now[2] + y, now[3] + y]);
  }

  /** Shows the whole range. */
  private reset(): void {
    if (this.zoomKey !== "" && this.page.get(this.zoomKey) !== "") this.page.set({ [this.zoomKey]: "" });
    else this.redraw();
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target !== this.host) return;
    const acts: Record<string, () => void> = {
      ArrowLeft: () => this.move(-0.15, 0), ArrowRight: () => this.move(0.15, 0), ArrowUp: () => this.move(0, 0.15),
      ArrowDown: () => this.move(0, -0.15), "+": () => this.scale(1 / 1.5), "=": () => this.scale(1 / 1.5),
      "-": () => this.scale(1.5), "0": () => this.reset(),
    };
    const act = acts[event.key];
    if (act === undefined) return;
    event.preventDefault();
    act();
  }

  private setDrag(drag: "zoom" | "pan"): void {
    this.drag = drag;
    this.showDrag();
    void loadPlotly().then((plotly) => {
      if (this.ready) void plotly.relayout(this.host, { dragmode: drag });
    });
  }

  private showDrag(): void {
    this.dragButtons.forEach((button, i) => button.setAttribute("aria-pressed", String(this.drag === (i === 0 ? "zoom" : "pan"))));
  }

  /** Saves the plot with a legend, which on the page is a separate element. */
  private async save(format: "svg" | "png"): Promise<void> {
    if (this.make === null) return;
    const plotly = await loadPlotly();
    const drawing = this.complete(this.make(themes.light), themes.light);
    this.withZoom(drawing.layout);
    const entries = drawing.traces.filter((trace) => trace.showlegend !== false && (trace.name ?? "") !== "").length;
    const width = 720;
    const height = 480;
    const layout: Layout = {
      ...drawing.layout, autosize: false, width, height: height + 22 * Math.ceil(entries / 3),
      showlegend: entries > 0, legend: { orientation: "h", y: -0.16, yanchor: "top", x: 0, font: { size: 11 } },
    };
    try {
      await plotly.downloadImage({ data: drawing.traces, layout } as never, {
        format, filename: this.file(), width, height: layout.height ?? height, ...(format === "png" ? { scale: 3 } : {}),
      } as never);
      this.page.announce(`${format.toUpperCase()} saved`);
    } catch (fault) {
      this.page.announce(`Cannot save the picture: ${String(fault)}`);
    }
  }
}
