import { CurvePlot, type Curve } from "../curve_plot.ts";
import { Choice, element, fill } from "../dom.ts";
import { counted, engineering, quantity, significant } from "../format.ts";
import { limitOf, rowAt, settingKinds, settingText, statuses, type Row } from "../rows.ts";
import { front } from "../thin.ts";
import { chosenScene, isSweep, methodLabel, otherScenes, sceneName, type Section, type Tools } from "../tools.ts";
import { oneLine, shorten } from "../text.ts";
import type { Rows } from "../data.ts";

type Measure = "attitude" | "attitude_final" | "omega" | "energy" | "momentum" | "norm";

export const measures: { key: Measure; title: string; unit: string }[] = [
  { key: "attitude", title: "largest attitude error", unit: "rad" },
  { key: "attitude_final", title: "final attitude error", unit: "rad" },
  { key: "omega", title: "angular velocity error, relative", unit: "" },
  { key: "energy", title: "energy error, relative", unit: "" },
  { key: "momentum", title: "angular momentum error, relative", unit: "" },
  { key: "norm", title: "quaternion norm error", unit: "" },
];

/** The value if a logarithmic axis can show it, else null. Zero is plotted at 2^-54. */
export function positive(value: number | null | undefined): number | null {
  if (value === null || value === undefined || !Number.isFinite(value) || value < 0) return null;
  return value === 0 ? 2 ** -54 : value > 1e300 ? null : value;
}

export function hoverOf(tools: Tools, row: Row, error: string): string[] {
  const method = tools.data.methods[row.method];
  return [
    shorten(oneLine(method?.name ?? ""), 60),
    [settingText(row.settingKind, row.setting), row.status === 0 ? "" : (statuses[row.status] ?? "")].filter((part) => part !== "").join(", ") || "no setting",
    error,
    [row.seconds === null ? "" : engineering(row.seconds, "s"), row.evaluations === null ? "" : counted(row.evaluations, "evaluation")].filter((part) => part !== "").join(", "),
    `limited by: ${limitOf(row, method?.precision ?? "").text}`,
    row.formulation === "" ? "" : `formulation: ${row.formulation}`,
  ].filter((line) => line !== "");
}

/** Default selection: the Pareto front, the fastest methods of the scene, the best of each family, then all others by a
 * score of time and error. */
export function standardChoice(tools: Tools, scene: number, curves: readonly Curve[]): number[] {
  const x: number[] = [];
  const y: number[] = [];
  const of: number[] = [];
  const score = new Map<number, number>();
  for (const curve of curves) {
    curve.x.forEach((here, i) => {
      const there = curve.y[i] ?? null;
      if (here === null || there === null || here <= 0 || there <= 0) return;
      x.push(here);
      y.push(there);
      of.push(curve.method);
      score.set(curve.method, Math.min(score.get(curve.method) ?? Infinity, Math.log10(here) + 0.35 * Math.log10(there)));
    });
  }
  const unbeaten = front(x, y).map((i) => of[i] ?? -1);
  const named = (tools.data.scenes[scene]?.fastest ?? []).flatMap((one) => [one.row, one.runner_up]).flatMap((row) => (row === null ? [] : [tools.data.rows.method[row] ?? -1]));
  const ranked = [...score.entries()].sort((a, b) => a[1] - b[1]).map(([method]) => method);
  const families = new Set<number>();
  const best = ranked.filter((method) => {
    const family = tools.data.methods[method]?.family ?? -1;
    return !families.has(family) && families.add(family);
  });
  const rest = curves.map((curve) => curve.method);
  return [...new Set([...unbeaten, ...named, ...best, ...ranked, ...rest])].filter((method) => method >= 0);
}

/** Groups rows of a scene into curves: one per method, kind of setting and formulation, from coarse to fine. */
export function curvesOf(tools: Tools, places: Iterable<number>, x: (row: Row) => number | null, y: (place: number) => number | null, hover: (row: Row) => string[]): Curve[] {
  const groups = new Map<string, Row[]>();
  for (const place of places) {
    const row = rowAt(tools.data.rows, place);
    if (row.status === 1) continue;
    const key = `${row.method}|${row.settingKind}|${row.formulation}`;
    const group = groups.get(key);
    if (group === undefined) groups.set(key, [row]);
    else group.push(row);
  }
  const seen = new Map<number, number>();
  const formulations = new Map<number, Set<string>>();
  for (const group of groups.values()) {
    for (const row of group.slice(0, 1)) formulations.set(row.method, (formulations.get(row.method) ?? new Set()).add(row.formulation));
  }
  return [...groups.values()].map((group) => {
    const [first] = group as [Row, ...Row[]];
    group.sort((a, b) => (b.setting ?? 0) - (a.setting ?? 0) || a.place - b.place);
    const nth = seen.get(first.method) ?? 0;
    seen.set(first.method, nth + 1);
    const good = group.filter((row) => row.status === 0 && x(row) !== null && y(row.place) !== null);
    const bad = group.filter((row) => !good.includes(row) && (row.status !== 0 || row.cut));
    return {
      method: first.method,
      variant: [first.settingKind === 0 ? "" : (settingKinds[first.settingKind] ?? ""), (formulations.get(first.method)?.size ?? 0) > 1 ? first.formulation : ""].filter((part) => part !== "").join(", "),
      place: nth,
      x: good.map(x),
      y: good.map((row) => y(row.place)),
      hover: (i) => (good[i] === undefined ? [] : hover(good[i])),
      failures: bad.map((row) => ({ x: x(row), y: y(row.place), hover: hover(row) })),
    };
  });
}

/** Lists unsupported methods, grouped by reason. */
export function unsupportedList(tools: Tools, places: Iterable<number>): HTMLElement | null {
  const reasons = new Map<string, Set<number>>();
  for (const place of places) {
    if (tools.data.rows.status[place] !== 1) continue;
    const row = rowAt(tools.data.rows, place);
    reasons.set(row.message, (reasons.get(row.message) ?? new Set()).add(row.method));
  }
  if (reasons.size === 0) return null;
  const methods = new Set([...reasons.values()].flatMap((some) => [...some]));
  return element(
    "details",
    { class: "unsupported" },
    element("summary", {}, `${counted(methods.size, "method does", "methods do")} not support this scene`),
    element("ul", {}, ...[...reasons.entries()].slice(0, 60).map(([reason, some]) =>
      element("li", {}, element("span", { class: "reason" }, reason === "" ? "no reason given" : shorten(oneLine(reason), 240)), ": ",
        ...[...some].slice(0, 60).flatMap((method, i) => [i > 0 ? ", " : "", methodLabel(tools, method)])))),
  );
}

export function options(values: readonly string[], all: string): [string, string][] {
  return [["", all], ...[...new Set(values)].filter((value) => value !== "").sort().map((value): [string, string] => [value, shorten(oneLine(value), 48)])];
}

export const workPrecision: Section = {
  name: "work-precision",
  title: "Work-precision",
  present: (data) => data.rows.count > 0,
  render(host, tools) {
    const { data, page } = tools;
    const rows: Rows = data.rows;
    const set = (key: string) => (value: string): void => page.set({ [`work.${key}`]: value, "work.zoom": "" });
    const choices = {
      error: new Choice("Error", set("error")), x: new Choice("x axis", set("x")), experiment: new Choice("Experiment", set("experiment")),
      family: new Choice("Family", set("family")), library: new Choice("Library", set("library")), precision: new Choice("Precision", set("precision")),
      other: new Choice("Comparison", set("other")),
    };
    const chart = new CurvePlot(tools, "work", "Work-precision diagram: error against work", () => `work_precision_${sceneName(tools, chosenScene(tools))}`);
    const message = element("div", {});
    const below = element("div", {});
    host.append(
      element("p", { class: "explain" }, "Each curve is one method, from its coarsest to its finest setting; lower and further left is better. A cross marks a failed run, at the edge of the plot if its error or work is unknown. Click a grey curve to highlight it."),
      element("div", { class: "choices" }, ...Object.values(choices).map((choice) => choice.root)),
      message, chart.root, below,
    );
    const show = (): void => {
      const scene = chosenScene(tools);
      const ofScene = tools.index.ofScene(scene);
      const experiments = data.scenes[scene]?.experiments.filter((e) => data.experiments[e] !== undefined) ?? [];
      const counts = new Map<number, number>();
      for (const place of ofScene) counts.set(rows.experiment[place] ?? -1, (counts.get(rows.experiment[place] ?? -1) ?? 0) + 1);
      const known = [...new Set([...experiments, ...counts.keys()])].filter((e) => counts.has(e));
      const asked = known.find((e) => data.experiments[e]?.name === page.get("work.experiment"));
      // prefer sweeps, which are intended for this diagram, then the experiment with the most rows
      const rank = (e: number): number => (isSweep(data, e) ? 1e9 : 0) + (counts.get(e) ?? 0);
      const experiment = asked ?? [...known].sort((a, b) => rank(b) - rank(a))[0] ?? -1;
      const measure = measures.find((one) => one.key === page.get("work.error")) ?? (measures[0] as (typeof measures)[number]);
      const byEvaluations = page.get("work.x") === "evaluations";
      const places = [...ofScene].filter((place) => rows.experiment[place] === experiment);
      const methods = [...new Set(places.map((place) => rows.method[place] ?? -1))].map((method) => data.methods[method]);
      choices.error.update(measures.map((one) => [one.key, one.title]), measure.key);
      choices.x.update([["", "run time"], ["evaluations", "right-hand-side evaluations"]], byEvaluations ? "evaluations" : "");
      choices.experiment.update(known.map((e) => [data.experiments[e]?.name ?? "", shorten(oneLine(data.experiments[e]?.name ?? ""), 40)]), data.experiments[experiment]?.name ?? "");
      choices.family.update([["", "all families"], ...[...new Set(methods.map((method) => method?.family ?? -1))].sort((a, b) => a - b).map((f): [string, string] => [data.families[f]?.name ?? "", shorten(oneLine(data.families[f]?.label ?? ""), 48)])], page.get("work.family"));
      choices.library.update(options(methods.map((method) => method?.library ?? ""), "all libraries"), page.get("work.library"));
      choices.precision.update(options(methods.map((method) => method?.precision ?? ""), "all precisions"), page.get("work.precision"));
      const canCompare = data.comparison !== null && !byEvaluations && measure.key === "attitude";
      choices.other.update(canCompare ? [["", "dashed, open marks"], ["hidden", "hidden"]] : [], page.get("work.other"));
      const kept = places.filter((place) => {
        const method = data.methods[rows.method[place] ?? -1];
        const wanted = (key: string, value: string): boolean => page.get(`work.${key}`) === "" || page.get(`work.${key}`) === value;
        return method !== undefined && wanted("family", data.families[method.family]?.name ?? "") && wanted("library", method.library) && wanted("precision", method.precision);
      });
      const x = (row: Row): number | null => {
        const value = byEvaluations ? row.evaluations : row.seconds;
        return value !== null && value > 0 ? positive(value) : null;
      };
      const y = (place: number): number | null => positive(rows[measure.key][place]);
      const hover = (row: Row): string[] => hoverOf(tools, row, `${measure.title}: ${quantity(rows[measure.key][row.place], measure.unit) || "unknown"}`);
      const curves = curvesOf(tools, kept, x, y, hover);
      if (canCompare && page.get("work.other") !== "hidden") overlay(tools, curves, kept);
      fill(message);
      if (curves.length === 0) {
        const others = data.scenes.flatMap((_, s) => (tools.index.ofScene(s).length > 0 && s !== scene ? [s] : []));
        if (kept.length === 0 && places.length === 0) fill(message, otherScenes(tools, "results", others));
        else fill(message, element("p", { class: "note" }, places.length > 0 && kept.length === 0 ? "No method matches these filters." : "No run of this selection can be plotted."));
      }
      chart.root.hidden = curves.length === 0;
      const attitude = measure.key === "attitude" || measure.key === "attitude_final";
      const floor = attitude ? (kept.map((place) => rows.floor[place] ?? null).find((one) => one !== null && one > 0) ?? null) : null;
      const floor32 = attitude && kept.some((place) => data.methods[rows.method[place] ?? -1]?.precision === "binary32") ? (kept.map((place) => rows.floor32[place] ?? null).find((one) => one !== null && one > 0) ?? null) : null;
      const bands = [
        floor === null ? null : { from: floor / 10, to: floor, label: `binary64 floor: error caused by rounding the start (${significant(floor)} rad)`, short: `binary64 floor (${significant(floor)} rad)` },
        floor32 === null ? null : { from: floor32 / 10, to: floor32, label: `binary32 floor (${significant(floor32)} rad)`, short: `binary32 floor (${significant(floor32)} rad)` },
      ].filter((one) => one !== null);
      if (curves.length > 0) {
        chart.show({
          curves,
          x: { title: byEvaluations ? "right-hand-side evaluations" : "run time (s)", log: true },
          y: { title: `${measure.title}${measure.unit === "" ? "" : ` (${measure.unit})`}`, log: true },
          bands, guides: [], standard: standardChoice(tools, scene, curves),
        });
      }
      fill(below, unsupportedList(tools, kept));
    };
    page.watch(["scene", "work.error", "work.x", "work.experiment", "work.family", "work.library", "work.precision", "work.other"], show);
    show();
  },
};

/** Adds the other directory's times and errors at the same settings to the curves. */
function overlay(tools: Tools, curves: Curve[], kept: readonly number[]): void {
  const comparison = tools.data.comparison;
  if (comparison === null) return;
  const wanted = new Set(kept);
  const points = new Map<string, { x: number; y: number; setting: number; text: string }[]>();
  for (const pair of comparison.pairs) {
    if (!wanted.has(pair.row)) continue;
    const row = rowAt(tools.data.rows, pair.row);
    const error = positive(pair.error);
    if (error === null || !(pair.seconds > 0)) continue;
    const key = `${row.method}|${row.settingKind === 0 ? "" : (settingKinds[row.settingKind] ?? "")}`;
    const list = points.get(key) ?? [];
    list.push({ x: pair.seconds, y: error, setting: row.setting ?? 0, text: `${shorten(comparison.folder, 40)}: ${settingText(row.settingKind, row.setting)}, ${engineering(pair.seconds, "s")}, ${quantity(error, "rad")}` });
    points.set(key, list);
  }
  for (const curve of curves) {
    const list = points.get(`${curve.method}|${curve.variant.split(", ")[0] ?? ""}`);
    if (list === undefined) continue;
    list.sort((a, b) => b.setting - a.setting);
    curve.other = { x: list.map((one) => one.x), y: list.map((one) => one.y), hover: list.map((one) => one.text) };
  }
}
