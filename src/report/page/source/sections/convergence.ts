import { CurvePlot, type Curve } from "../curve_plot.ts";
import { Choice, element, fill } from "../dom.ts";
import { quantity, significant } from "../format.ts";
import { TableView } from "../table_view.ts";
import { chosenScene, methodLabel, methodName, otherScenes, sceneName, standIn, standInNote, type Section, type Tools } from "../tools.ts";
import { curvesOf, hoverOf, measures, positive } from "./work_precision.ts";
import type { Order, ReportData } from "../data.ts";
import { settingKinds, type Row } from "../rows.ts";
import { oneLine, sceneLabel, shorten } from "../text.ts";

/** Largest accepted difference between the fitted and the claimed order. */
export const mostOrderDifference = 0.2;

export function isOff(order: Order, atFloor = false): boolean {
  return !atFloor && order.claimed !== null && order.observed !== null && order.claimed > 0 && Math.abs(order.claimed - order.observed) > mostOrderDifference;
}

/** Whether all fitted errors are at the rounding floor, so that no order can be observed. */
export function isAtFloor(order: Order, curve: Curve | undefined, floor: number | null): boolean {
  if (curve === undefined || floor === null || order.from === null || order.to === null) return false;
  const [low, high] = [Math.min(order.from, order.to) * 0.999, Math.max(order.from, order.to) * 1.001];
  const errors = curve.y.filter((y, i) => y !== null && (curve.x[i] ?? -1) >= low && (curve.x[i] ?? -1) <= high);
  return errors.length > 0 && errors.every((y) => (y ?? 0) <= 100 * floor);
}

function experimentsOf(data: ReportData): Set<number> {
  const found = new Set(data.orders.map((order) => order.experiment));
  data.experiments.forEach((experiment, e) => {
    if (experiment.kind === "convergence") found.add(e);
  });
  return found;
}

/** Reference lines of given slopes from the coarse end down to the smallest error. */
export function guidesOf(curves: readonly Curve[], slopes: readonly number[], name: (slope: number) => string): { x: number[]; y: number[]; label: string }[] {
  const points = curves.flatMap((curve) => curve.x.flatMap((x, i) => (x !== null && (curve.y[i] ?? null) !== null ? [{ x, y: curve.y[i] as number }] : [])));
  if (points.length < 2) return [];
  const coarse = Math.max(...points.map((point) => point.x));
  const fine = Math.min(...points.map((point) => point.x));
  const low = Math.min(...points.map((point) => point.y));
  // start at the largest error of the coarsest settings
  const top = Math.max(...points.filter((point) => point.x >= coarse / 4).map((point) => Math.min(point.y, 1)));
  if (!(coarse > fine) || !(top > low)) return [];
  return slopes.map((slope) => {
    const end = Math.max(fine, coarse * (low / top) ** (1 / slope));
    return { x: [end, coarse], y: [top * (end / coarse) ** slope, top], label: name(slope) };
  });
}

function standard(curves: readonly Curve[], off: readonly number[], tools: Tools): number[] {
  const smallest = new Map<number, number>();
  for (const curve of curves) {
    for (const y of curve.y) if (y !== null) smallest.set(curve.method, Math.min(smallest.get(curve.method) ?? Infinity, y));
  }
  const ranked = [...smallest.entries()].sort((a, b) => a[1] - b[1]).map(([method]) => method);
  const families = new Set<number>();
  const best = ranked.filter((method) => {
    const family = tools.data.methods[method]?.family ?? -1;
    return !families.has(family) && families.add(family);
  });
  return [...new Set([...off.slice(0, 3), ...best, ...ranked])];
}

export const convergence: Section = {
  name: "convergence",
  title: "Convergence",
  present: (data) => {
    const experiments = experimentsOf(data);
    return data.orders.length > 0 || data.rows.experiment.some((experiment) => experiments.has(experiment));
  },
  render(host, tools) {
    const { data, page } = tools;
    const experiments = experimentsOf(data);
    const set = (key: string) => (value: string): void => page.set({ [`convergence.${key}`]: value, "convergence.zoom": "" });
    const kindChoice = new Choice("x axis", set("kind"));
    const measureChoice = new Choice("Error", set("error"));
    const experimentChoice = new Choice("Experiment", set("experiment"));
    const chart = new CurvePlot(tools, "convergence", "Convergence: error against step or tolerance", () => `convergence_${sceneName(tools, chosenScene(tools))}`);
    const message = element("div");
    const below = element("div");
    let table: TableView | null = null;
    host.append(
      element("p", { class: "explain" }, `The legend lists each method's claimed and fitted order. An exclamation mark flags a difference above ${mostOrderDifference}, unless all fitted errors are at the rounding floor. Dotted lines are reference slopes.`),
      element("div", { class: "choices" }, experimentChoice.root, kindChoice.root, measureChoice.root), message, chart.root, below,
    );
    const having = [...new Set([...data.orders.map((order) => order.scene), ...data.rows.scene.filter((_, i) => experiments.has(data.rows.experiment[i] ?? -1))])].sort((a, b) => a - b);
    const show = (): void => {
      const chosen = chosenScene(tools);
      const scene = standIn(tools, chosen, having);
      const ofScene = [...tools.index.ofScene(scene)].filter((place) => experiments.has(data.rows.experiment[place] ?? -1));
      const known = [...new Set([...ofScene.map((place) => data.rows.experiment[place] ?? -1), ...data.orders.filter((order) => order.scene === scene).map((order) => order.experiment)])];
      const experiment = known.find((e) => data.experiments[e]?.name === page.get("convergence.experiment")) ?? known[0] ?? -1;
      const places = ofScene.filter((place) => data.rows.experiment[place] === experiment);
      const orders = data.orders.filter((order) => order.scene === scene && order.experiment === experiment);
      const kinds = [1, 2].filter((kind) => places.some((place) => data.rows.setting_kind[place] === kind) || orders.some((order) => order.setting_kind === kind));
      const kind = page.get("convergence.kind") === "tolerance" && kinds.includes(2) ? 2 : (kinds[0] ?? 1);
      const measure = measures.find((one) => one.key === page.get("convergence.error")) ?? measures[0]!;
      experimentChoice.update(known.map((e) => [data.experiments[e]?.name ?? "", shorten(oneLine(data.experiments[e]?.name ?? ""), 40)]), data.experiments[experiment]?.name ?? "");
      kindChoice.update(kinds.map((one) => [settingKinds[one] ?? "", settingKinds[one] ?? ""]), settingKinds[kind] ?? "");
      measureChoice.update(measures.map((one) => [one.key, one.title]), measure.key);
      const x = (row: Row): number | null => (row.setting !== null && row.setting > 0 ? row.setting : null);
      const y = (place: number): number | null => positive(data.rows[measure.key][place]);
      const curves = curvesOf(tools, places.filter((place) => data.rows.setting_kind[place] === kind), x, y, (row) => hoverOf(tools, row, `${measure.title}: ${quantity(data.rows[measure.key][row.place], measure.unit) || "unknown"}`))
        .map((curve) => ({ ...curve, variant: curve.variant.split(", ").slice(1).join(", ") }));
      const ofKind = orders.filter((order) => order.setting_kind === kind);
      const floor = places.map((place) => data.rows.floor[place] ?? null).find((one) => one !== null && one > 0) ?? null;
      const atFloor = (order: Order): boolean => isAtFloor(order, curves.find((curve) => curve.method === order.method), floor);
      const byMethod = new Map(ofKind.map((order) => [order.method, order]));
      if (curves.length === 0 && orders.length === 0) fill(message, otherScenes(tools, "convergence results", having));
      else fill(message, standInNote(tools, chosen, scene));
      chart.root.hidden = curves.length === 0;
      if (curves.length > 0) {
        const tolerance = kind === 2;
        chart.show({
          curves,
          x: { title: tolerance ? "tolerance" : "step (s)", log: true },
          y: { title: `${measure.title}${measure.unit === "" ? "" : ` (${measure.unit})`}`, log: true },
          bands: [], guides: guidesOf(curves, tolerance ? [1] : [1, 2, 4, 6, 8], (slope) => (tolerance ? "error ∝ tolerance" : `order ${slope}`)),
          standard: standard(curves, ofKind.filter((order) => isOff(order, atFloor(order))).map((order) => order.method), tools),
          detailHead: ofKind.length === 0 ? undefined : "claimed / fitted",
          detail: (method) => {
            const order = byMethod.get(method);
            if (order === undefined) return null;
            const off = isOff(order, atFloor(order));
            return {
              text: `${order.claimed === null || order.claimed === 0 ? "–" : significant(order.claimed)} / ${order.observed === null ? "–" : order.observed.toFixed(2).replace(/^-0\.00$/, "0.00")}${off ? " !" : ""}`,
              flag: off ? `claimed ${significant(order.claimed)}, fitted ${significant(order.observed)}` : "",
            };
          },
        });
      }
      const content = {
        caption: `Orders of convergence on ${sceneLabel(sceneName(tools, scene))}`,
        columns: [
          { name: "method", numeric: false }, { name: "setting_kind", numeric: false }, { name: "claimed", numeric: true }, { name: "observed", numeric: true },
          { name: "difference", numeric: true }, { name: "points", numeric: true, integral: true }, { name: "from", numeric: true }, { name: "to", numeric: true },
        ],
        rows: orders.map((order) => [
          methodName(tools, order.method), settingKinds[order.setting_kind] ?? "", order.claimed, order.observed,
          order.claimed === null || order.observed === null ? null : order.observed - order.claimed, order.points, order.from, order.to,
        ]),
        render: (column: number, cell: unknown): Node | null => {
          const method = column === 0 ? tools.data.methods.findIndex((one) => one.name === cell) : -1;
          return method < 0 ? null : methodLabel(tools, method);
        },
      };
      if (orders.length === 0) fill(below);
      else {
        if (table === null) table = new TableView(page, "orders", content);
        else table.show(content);
        fill(below, table.root);
      }
    };
    page.watch(["scene", "convergence.kind", "convergence.error", "convergence.experiment"], show);
    show();
  },
};
