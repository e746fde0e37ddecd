import { Choice, element, fill } from "../dom.ts";
import { tableDots } from "../dot_plot.ts";
import { TableView } from "../table_view.ts";
import { type Section, type Tools } from "../tools.ts";
import { oneLine, shorten } from "../text.ts";
import type { ReportData, Table } from "../data.ts";

const leaderboards = (data: ReportData): Table[] => data.tables.filter((table) => /_leaderboard$/.test(table.name));
const mechanismTables = (data: ReportData): Table[] => data.tables.filter((table) => /^(mechanism|jointed|mass_ratio)/.test(table.name));

/** A selected table with a dot plot of one of its columns. */
function pictured(host: HTMLElement, tools: Tools, tables: readonly Table[], key: string, preferred: readonly RegExp[]): void {
  const choice = new Choice("Table", (value) => tools.page.set({ [key]: value }));
  const place = element("div", { class: "body" });
  host.append(element("div", { class: "choices" }, choice.root), place);
  const made = new Map<string, (HTMLElement | null)[]>();
  const show = (): void => {
    const table = tables.find((one) => one.name === tools.page.get(key)) ?? tables[0];
    if (table === undefined) return;
    choice.update(tables.map((one) => [one.name, shorten(oneLine(one.title || one.name), 90)]), table.name);
    let parts = made.get(table.name);
    if (parts === undefined) {
      const name = shorten(table.name, 60);
      parts = [
        tableDots(tools, table, `${key}.drawn.${name}`, preferred),
        new TableView(tools.page, `${key}.${name}`, { caption: table.title || table.name, columns: table.columns, rows: table.rows, total: table.total }).root,
      ];
      made.set(table.name, parts);
    }
    fill(place, ...parts);
  };
  tools.page.watch([key], show);
  show();
}

export const engines: Section = {
  name: "engines",
  title: "Engines",
  present: (data) => leaderboards(data).length > 0,
  render(host, tools) {
    host.append(element("p", { class: "explain" }, "Physics engines, ranked over all scenes. Click a column header to sort the table; the plot shows the selected column."));
    pictured(host, tools, leaderboards(tools.data), "engines", [/^attitude_error$/, /error/]);
  },
};

export const mechanisms: Section = {
  name: "mechanisms",
  title: "Mechanisms",
  present: (data) => mechanismTables(data).length > 0,
  render(host, tools) {
    const order = (table: Table): number => (/margins/.test(table.name) ? 0 : /methods|orders/.test(table.name) ? 1 : 2);
    const tables = [...mechanismTables(tools.data)].sort((a, b) => order(a) - order(b));
    host.append(element("p", { class: "explain" }, "Several bodies connected by joints. A ratio above 1 means that polhode's method is faster."));
    pictured(host, tools, tables, "mechanisms", [/^(ratio|factor)$/, /joint_gap/, /error/, /seconds/]);
  },
};
