import { DotPlot } from "../dot_plot.ts";
import { element } from "../dom.ts";
import { count, counted, significant } from "../format.ts";
import { TableView } from "../table_view.ts";
import { methodLabel, methodName, type Section } from "../tools.ts";
import { oneLine, shorten } from "../text.ts";
import type { Experiment } from "../data.ts";

/** Facts of the provenance that differ between the two directories. */
function differences(here: readonly Experiment[], there: readonly Experiment[]): [string, string, string][] {
  const facts = (experiments: readonly Experiment[]): Map<string, Set<string>> => {
    const found = new Map<string, Set<string>>();
    for (const experiment of experiments) for (const [name, value] of experiment.facts) found.set(name, (found.get(name) ?? new Set()).add(value));
    return found;
  };
  const [left, right] = [facts(here), facts(there)];
  const text = (values: Set<string> | undefined): string => (values === undefined ? "not recorded" : [...values].sort().join("; "));
  return [...new Set([...left.keys(), ...right.keys()])].flatMap((name): [string, string, string][] =>
    text(left.get(name)) === text(right.get(name)) ? [] : [[name, text(left.get(name)), text(right.get(name))]]);
}

export const comparison: Section = {
  name: "comparison",
  title: "Comparison",
  present: (data) => data.comparison !== null,
  render(host, tools) {
    const compared = tools.data.comparison;
    if (compared === null) return;
    const here = shorten(oneLine(tools.data.folder), 40);
    const there = shorten(oneLine(compared.folder), 40);
    const interval = compared.all.low === null || compared.all.high === null ? "" : ` (95 % confidence interval ${significant(compared.all.low)} to ${significant(compared.all.high)})`;
    host.append(
      element("p", { class: "lead" }, `Run time of ${there} / run time of ${here} at the same settings: ${significant(compared.all.ratio)}${interval}, over ${counted(compared.all.scenes, "scene")}.`),
      element("p", {}, `A ratio above 1 means that ${here} is faster. The errors agree to the last bit in ${count(compared.same_bits)} of ${counted(compared.matched, "matched row")}. Unmatched rows: ${count(compared.only_here)} in ${here}, ${count(compared.only_there)} in ${there}.`),
      element("p", { class: "explain" }, shorten(oneLine(compared.how), 400)),
    );
    const compares = new Set(tools.data.comparison?.pairs.map((pair) => tools.data.rows.experiment[pair.row]));
    const differing = differences(tools.data.experiments.filter((_, e) => compares.size === 0 || compares.has(e)), compared.experiments);
    if (differing.length > 0) {
      host.append(new TableView(tools.page, "", {
        caption: "Differences in provenance between the two directories", columns: ["item", here, there === here ? `${there} (other)` : there].map((name) => ({ name, numeric: false })), rows: differing,
      }).root);
    }
    const order = [...compared.methods].sort((a, b) => b.ratio - a.ratio);
    const plot = new DotPlot(tools, "Ratio of run times by method, with intervals", () => "comparison");
    host.append(plot.root);
    plot.show(
      order.map((one) => ({
        label: methodName(tools, one.method), value: one.ratio, low: one.low, high: one.high, method: one.method,
        hover: [`${counted(one.scenes, "scene")}, ${counted(one.pairs, "pair")}`, one.error_ratio === null ? "" : `ratio of errors ${significant(one.error_ratio, 4)}`].filter((line) => line !== ""),
      })),
      `run time of ${there} / run time of ${here}`, true, true, "ratio of run times",
    );
    const view = new TableView(tools.page, "comparison", {
      caption: `Run time of ${there} / run time of ${here}`,
      columns: [
        { name: "method", numeric: false }, { name: "ratio", numeric: true }, { name: "low", numeric: true }, { name: "high", numeric: true },
        { name: "scenes", numeric: true, integral: true }, { name: "pairs", numeric: true, integral: true }, { name: "error_ratio", numeric: true },
      ],
      rows: order.map((one) => [methodName(tools, one.method), one.ratio, one.low, one.high, one.scenes, one.pairs, one.error_ratio]),
      render: (column, cell) => {
        if (column !== 0) return null;
        const method = tools.data.methods.findIndex((one) => one.name === cell);
        return method < 0 ? null : methodLabel(tools, method);
      },
    });
    host.append(view.root);
  },
};
