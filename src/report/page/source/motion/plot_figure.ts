// A plot over time with its caption and a legend of current values.

import { element, fill, vector } from "../dom.ts";
import { significant } from "../format.ts";
import { oneLine, shorten } from "../text.ts";
import { linearRange, type TimeCurve, TimePlot } from "./time_plot.ts";

// for the light and the dark theme
const curveColors = [["#00518a", "#7cc0ff"], ["#a14e00", "#f0a35a"], ["#5b3fa0", "#b9a4f0"], ["#1b7f3b", "#7fd79b"], ["#a4141d", "#ff8f8f"], ["#59616b", "#a0a8b2"]] as const;
const curveDashes = ["none", "7 4", "2 3", "9 3 2 3", "12 3", "4 2"] as const;

/** Colour and dash of the i-th curve of a plot. */
export const styleOf = (i: number, dark: boolean): { color: string; dash: string } =>
  ({ color: curveColors[i % curveColors.length]?.[dark ? 1 : 0] ?? "#59616b", dash: curveDashes[i % curveDashes.length] ?? "none" });

/** A plot with caption and a legend that shows the current values. */
export class PlotFigure {
  readonly root: HTMLElement;
  private readonly plot: TimePlot;
  private readonly legend = element("ul", { class: "motion-legend" });
  private readonly caption = element("figcaption");
  private values: HTMLElement[] = [];
  private unit = "";

  constructor(private readonly title: string, go: (time: number, done: boolean) => void) {
    this.plot = new TimePlot(title, go, 190);
    this.root = element("figure", { class: "motion-figure", hidden: true }, this.plot.root as unknown as HTMLElement, this.caption, this.legend);
  }

  /** Shows the curves; hidden without any. `more`: text after the title. */
  show(curves: readonly TimeCurve[], unit: string, duration: number, options: { include?: readonly number[]; lines?: readonly { y: number; text: string; color: string }[]; marks?: readonly number[]; more?: string } = {}): void {
    this.root.hidden = curves.length === 0;
    if (curves.length === 0) return;
    const { include = [], lines = [], marks = [], more = "" } = options;
    this.unit = unit;
    this.plot.show(curves, { unit, log: false, range: linearRange(curves.flatMap((curve) => curve.y), [...include, ...lines.map((line) => line.y)]), lines, marks, empty: "" }, duration);
    this.caption.textContent = `${this.title}${unit === "" ? "" : ` (${unit})`}${more === "" ? "" : `. ${more}`}`;
    this.values = curves.map(() => element("span", { class: "value" }));
    fill(this.legend, ...curves.map((curve, i) => element("li", {},
      vector("svg", { class: "motion-sample", width: "24", height: "10", viewBox: "0 0 24 10", "aria-hidden": "true" },
        vector("path", { d: "M0 5H24", stroke: curve.color, "stroke-width": "2.2", "stroke-dasharray": curve.dash })) as unknown as HTMLElement,
      element("span", { class: "name", title: curve.name }, shorten(oneLine(curve.name), 40)), this.values[i])));
  }

  resize(): void {
    if (!this.root.hidden) this.plot.resize();
  }

  at(time: number): void {
    if (this.root.hidden) return;
    this.plot.at(time).forEach((value, i) => {
      const place = this.values[i];
      if (place !== undefined) place.textContent = value === null ? "–" : `${significant(value)}${this.unit === "" ? "" : ` ${this.unit}`}`;
    });
  }
}
