import { Choice, element, fill } from "../dom.ts";
import { settingKinds, statuses, limitOf, numbersOf, rowAt } from "../rows.ts";
import { TableView, type Content } from "../table_view.ts";
import { count } from "../format.ts";
import { oneLine, shorten, type Cell } from "../text.ts";
import type { ReportData } from "../data.ts";
import type { Section, Tools } from "../tools.ts";

const shown = new Set(["seconds", "evaluations", "attitude", "energy", "momentum"]);
const integral = new Set(["steps", "evaluations"]);

/** The result rows as the content of a table. */
export function resultContent(data: ReportData): Content {
  const rows = data.rows;
  const numbers = [...numbersOf(rows)].filter(([name]) => name !== "setting");
  const lines: Cell[][] = [];
  for (let i = 0; i < rows.count; ++i) {
    const row = rowAt(rows, i);
    lines.push([
      data.experiments[row.experiment]?.name ?? "", data.scenes[row.scene]?.name ?? "", data.methods[row.method]?.name ?? "",
      settingKinds[row.settingKind] ?? "", row.setting, statuses[row.status] ?? "",
      ...numbers.map(([, values]) => values[i] ?? null),
      limitOf(row, data.methods[row.method]?.precision ?? "").text, row.formulation, row.message,
    ]);
  }
  return {
    caption: "All results",
    columns: [
      { name: "experiment", numeric: false }, { name: "scene", numeric: false }, { name: "method", numeric: false },
      { name: "setting_kind", numeric: false, hidden: true }, { name: "setting", numeric: true }, { name: "status", numeric: false },
      ...numbers.map(([name]) => ({ name, numeric: true, integral: integral.has(name), hidden: !shown.has(name) })),
      { name: "limited_by", numeric: false }, { name: "formulation", numeric: false, hidden: true }, { name: "message", numeric: false, hidden: true },
    ],
    rows: lines,
    total: rows.total,
  };
}

export const tables: Section = {
  name: "tables",
  title: "Tables",
  present: (data) => data.tables.length > 0 || data.rows.count > 0,
  render(host, tools: Tools) {
    const { data, page } = tools;
    const choice = new Choice("Table", (value) => page.set({ table: value }));
    const about = element("p", { class: "explain" });
    const place = element("div");
    const results = data.rows.count > 0;
    const all: [string, string][] = [
      ...(results ? [["", `All results (${count(data.rows.total)} rows)`] as [string, string]] : []),
      ...data.tables.map((table, i): [string, string] => [i === 0 && !results ? "" : table.name, `${shorten(oneLine(table.name), 44)} (${count(table.total)})`]),
    ];
    const views = new Map<string, TableView>();
    host.append(element("div", { class: "choices" }, choice.root), about, place);
    const show = (): void => {
      const asked = page.get("table");
      const table = data.tables.find((one) => one.name === asked) ?? (results ? undefined : data.tables[0]);
      choice.update(all, table === undefined || (!results && table === data.tables[0]) ? "" : table.name);
      const key = table === undefined ? "" : table.name;
      let view = views.get(key);
      if (view === undefined) {
        const content: Content = table === undefined ? resultContent(data) : { caption: table.title || table.name, columns: table.columns, rows: table.rows, total: table.total };
        view = new TableView(page, table === undefined ? "results" : `table.${shorten(table.name, 80)}`, content);
        views.set(key, view);
      }
      about.textContent = table === undefined ? "" : [table.title, table.experiment === "" ? "" : `Experiment: ${table.experiment}.`].map((text) => shorten(oneLine(text), 400)).filter((text) => text !== "").join(" ");
      fill(place, view.root);
    };
    page.watch(["table"], show);
    show();
  },
};
