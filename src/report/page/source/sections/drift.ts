import { CurvePlot, type Curve } from "../curve_plot.ts";
import { Choice, element, fill } from "../dom.ts";
import { duration, errorDecades, quantity, significant } from "../format.ts";
import { TableView } from "../table_view.ts";
import { chosenScene, methodLabel, methodName, otherScenes, sceneName, standIn, standInNote, type Section, type Tools } from "../tools.ts";
import type { Drift } from "../data.ts";
import { oneLine, sceneLabel, shorten, type Cell } from "../text.ts";
import { measures as all, positive } from "./work_precision.ts";

type Measure = "attitude" | "omega" | "energy" | "momentum" | "norm";
const measures = all.filter((one) => one.key !== "attitude_final").map((one) => ({ ...one, key: one.key as Measure, title: one.title.replace("largest ", "") }));

/** "1.01 ± 0.05", with the digits that the deviation permits. */
export function exponentText(growth: readonly [number, number] | undefined): string {
  if (growth === undefined) return "";
  const [exponent, deviation] = growth;
  if (!(deviation > 0)) return exponent.toFixed(2);
  const digits = Math.min(4, Math.max(1, 1 - Math.floor(Math.log10(deviation))));
  return `${exponent.toFixed(digits)} ± ${deviation.toFixed(digits)}`;
}

function settingOf(drift: Drift): string {
  return drift.setting === null ? "" : significant(drift.setting, 3);
}

function curvesOf(runs: readonly Drift[], measure: (typeof measures)[number], log: boolean, tools: Tools): Curve[] {
  const seen = new Map<number, number>();
  const several = new Map<number, number>();
  for (const run of runs) several.set(run.method, (several.get(run.method) ?? 0) + 1);
  return runs.flatMap((run): Curve[] => {
    const kept = run.t.flatMap((time, i) => (positive(run[measure.key][i]) !== null && (!log || time > 0) ? [i] : []));
    if (kept.length === 0) return [];
    const place = seen.get(run.method) ?? 0;
    seen.set(run.method, place + 1);
    return [{
      method: run.method, place, variant: (several.get(run.method) ?? 0) > 1 ? `setting ${settingOf(run)}` : "",
      x: kept.map((i) => run.t[i] ?? null), y: kept.map((i) => positive(run[measure.key][i])), failures: [],
      hover: (n) => {
        const i = kept[n] ?? 0;
        return [
          methodName(tools, run.method), run.setting === null ? "" : `setting ${settingOf(run)}`, `at ${duration(run.t[i])}`, `${measure.title}: ${quantity(run[measure.key][i], measure.unit)}`,
          run.growth[measure.key] === undefined ? "" : `grows as t^p, p = ${exponentText(run.growth[measure.key])}`,
        ].filter((line) => line !== "");
      },
    }];
  });
}

export const drift: Section = {
  name: "drift",
  title: "Drift",
  present: (data) => data.drift.length > 0,
  render(host, tools) {
    const { data, page } = tools;
    const set = (key: string) => (value: string): void => page.set({ [`drift.${key}`]: value, "drift.zoom": "" });
    const measureChoice = new Choice("Error", set("error"));
    const scaleChoice = new Choice("Time", set("time"));
    const experimentChoice = new Choice("Experiment", set("experiment"));
    const chart = new CurvePlot(tools, "drift", "Drift: error over time", () => `drift_${sceneName(tools, chosenScene(tools))}`);
    const message = element("div");
    const below = element("div");
    let table: TableView | null = null;
    host.append(
      element("p", { class: "explain" }, "Growth of errors over time. If a power law error ~ t^p fits, the legend lists the exponent p ± half the difference between the exponents of the first and second half of the run: 0 is no drift, 1 linear and 2 quadratic growth."),
      element("div", { class: "choices" }, experimentChoice.root, measureChoice.root, scaleChoice.root), message, chart.root, below,
    );
    const having = [...new Set(data.drift.map((run) => run.scene))].sort((a, b) => a - b);
    const show = (): void => {
      const chosen = chosenScene(tools);
      const scene = standIn(tools, chosen, having);
      const ofScene = data.drift.filter((run) => run.scene === scene);
      const known = [...new Set(ofScene.map((run) => run.experiment))];
      const experiment = known.find((e) => data.experiments[e]?.name === page.get("drift.experiment")) ?? known[0] ?? -1;
      const runs = ofScene.filter((run) => run.experiment === experiment);
      const measure = measures.find((one) => one.key === page.get("drift.error")) ?? measures[0]!;
      const log = page.get("drift.time") !== "linear";
      experimentChoice.update(known.map((e) => [data.experiments[e]?.name ?? "", shorten(oneLine(data.experiments[e]?.name ?? ""), 40)]), data.experiments[experiment]?.name ?? "");
      measureChoice.update(measures.map((one) => [one.key, one.title]), measure.key);
      scaleChoice.update([["", "logarithmic"], ["linear", "linear"]], log ? "" : "linear");
      const curves = curvesOf(runs, measure, log, tools);
      if (runs.length === 0) fill(message, otherScenes(tools, "errors over time", having));
      else if (curves.length === 0) fill(message, element("p", { class: "note" }, "No run of this scene reports this error."));
      else {
        fill(message, standInNote(tools, chosen, scene),
          runs.some((run) => run.thinned) ? element("p", { class: "faint" }, "Some runs are plotted with fewer points than the directory contains.") : null);
      }
      chart.root.hidden = curves.length === 0;
      if (curves.length > 0) {
        const growth = new Map<number, string>();
        for (const run of runs) if (!growth.has(run.method)) growth.set(run.method, exponentText(run.growth[measure.key]));
        const last = new Map<number, number>();
        for (const curve of curves) last.set(curve.method, Math.min(last.get(curve.method) ?? Infinity, curve.y[curve.y.length - 1] ?? Infinity));
        const decades = errorDecades(curves.flatMap((curve) => curve.y.filter((_, i) => (curve.x[i] ?? 0) > 0)));
        chart.show({
          curves, x: { title: "time (s)", log }, y: { title: `${measure.title}${measure.unit === "" ? "" : ` (${measure.unit})`}`, log: true, ...(decades === null ? {} : { range: [decades[0] - 0.1, decades[1] + 0.1] as [number, number] }) },
          bands: [], guides: [], standard: [...last.entries()].sort((a, b) => a[1] - b[1]).map(([method]) => method),
          detailHead: "exponent",
          detail: (method) => ({ text: growth.get(method) ?? "", flag: "" }),
        });
      }
      if (runs.length === 0) {
        fill(below);
        return;
      }
      const content = {
        caption: `Growth of errors on ${sceneLabel(sceneName(tools, scene))}: exponents p of error ~ t^p`,
        columns: [
          { name: "method", numeric: false }, { name: "setting", numeric: true },
          ...measures.flatMap((one) => [{ name: `${one.key}_exponent`, numeric: true }, { name: `${one.key}_deviation`, numeric: true, hidden: true }]),
          { name: `last_${measure.key}`, numeric: true },
        ],
        rows: runs.map((run): Cell[] => [
          methodName(tools, run.method), run.setting, ...measures.flatMap((one): Cell[] => [run.growth[one.key]?.[0] ?? null, run.growth[one.key]?.[1] ?? null]),
          [...run[measure.key]].reverse().find((value) => value !== null) ?? null,
        ]),
        render: (column: number, cell: Cell): Node | null => {
          const method = column === 0 ? data.methods.findIndex((one) => one.name === cell) : -1;
          return method < 0 ? null : methodLabel(tools, method);
        },
      };
      if (table === null) table = new TableView(page, "growth", content);
      else table.show(content);
      fill(below, table.root);
    };
    page.watch(["scene", "drift.error", "drift.time", "drift.experiment"], show);
    show();
  },
};
