import { DotPlot } from "../dot_plot.ts";
import { element } from "../dom.ts";
import { count, counted, significant } from "../format.ts";
import { TableView } from "../table_view.ts";
import { methodLabel, methodName, type Section } from "../tools.ts";
import { oneLine, shorten } from "../text.ts";

export const comparison: Section = {
  name: "comparison",
  title: "Comparison",
  present: (data) => data.comparison !== null,
  render(host, tools) {
    const compared = tools.data.comparison;
    if (compared === null) return;
    const here = shorten(oneLine(tools.data.folder), 40);
    const there = shorten(oneLine(compared.folder), 40);
    const interval = compared.all.low === null || compared.all.high === null ? "" : ` (95 % interval ${significant(compared.all.low)} to ${significant(compared.all.high)})`;
    host.append(
      element("p", { class: "lead" }, `Run time of ${there} over that of ${here}, at the same settings: ${significant(compared.all.ratio)}${interval}, over ${counted(compared.all.scenes, "scene")}.`),
      element("p", {}, `Above 1, ${here} is faster. The errors are the same to the last bit in ${count(compared.same_bits)} of ${counted(compared.matched, "matched row")}; ${count(compared.only_here)} are only in ${here}, ${count(compared.only_there)} only in ${there}.`),
      element("p", { class: "explain" }, shorten(oneLine(compared.how), 400)),
    );
    const order = [...compared.methods].sort((a, b) => b.ratio - a.ratio);
    const plot = new DotPlot(tools, "Ratio of run times by method, with intervals", () => "comparison");
    host.append(plot.root);
    plot.show(
      order.map((one) => ({
        label: methodName(tools, one.method), value: one.ratio, low: one.low, high: one.high, method: one.method,
        hover: [`${counted(one.scenes, "scene")}, ${counted(one.pairs, "pair")}`, one.error_ratio === null ? "" : `errors' ratio ${significant(one.error_ratio, 4)}`].filter((line) => line !== ""),
      })),
      `run time of ${there} / run time of ${here}`, true, true,
    );
    const view = new TableView(tools.page, "comparison", {
      caption: `Run time of ${there} over that of ${here}`,
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
