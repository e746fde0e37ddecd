import { Choice, element, fill } from "../dom.ts";
import { DotPlot, type Dot } from "../dot_plot.ts";
import { TableView } from "../table_view.ts";
import { chosenScene, columnPlace, numberIn, sceneName, textIn, type Section, type Tools } from "../tools.ts";
import { oneLine, sceneLabel, shorten } from "../text.ts";
import type { ReportData, Table } from "../data.ts";

function gainTables(data: ReportData): Table[] {
  return data.tables.filter((table) => /_gain$/.test(table.name) && ["scene", "method", "gain"].every((name) => columnPlace(table, name) >= 0));
}

function one(host: HTMLElement, tools: Tools, table: Table): void {
  const place = { scene: columnPlace(table, "scene"), method: columnPlace(table, "method"), gain: columnPlace(table, "gain"), kind: columnPlace(table, "setting_kind"), left: columnPlace(table, "left_out") };
  const scenes = [...new Set(table.rows.map((row) => textIn(row, place.scene)))];
  const key = `gain.${shorten(table.name, 60)}`;
  const choice = new Choice("Scene", (value) => {
    if (tools.data.scenes.some((scene) => scene.name === value)) tools.page.set({ scene: value, [key]: "" });
    else tools.page.set({ [key]: value });
  });
  const left = element("p", { class: "explain" });
  const plot = new DotPlot(tools, `Gain in run time by method: ${shorten(oneLine(table.name), 60)}`, () => table.name);
  const methods = new Map(tools.data.methods.map((method, m) => [method.name, m]));
  host.append(element("h3", {}, shorten(oneLine(table.title || table.name), 160)), element("div", { class: "choices" }, choice.root), left, plot.root);
  const show = (): void => {
    const asked = tools.page.get(key) || sceneName(tools, chosenScene(tools));
    const withGain = scenes.filter((scene) => table.rows.some((row) => textIn(row, place.scene) === scene && numberIn(row, place.gain) !== null));
    const scene = scenes.includes(asked) ? asked : (withGain[0] ?? scenes[0] ?? "");
    choice.update(scenes.map((name) => [name, shorten(sceneLabel(name), 48)]), scene);
    const rows = table.rows.filter((row) => textIn(row, place.scene) === scene);
    const texts = [...new Set(rows.map((row) => textIn(row, place.left)).filter((text) => text !== ""))];
    left.textContent = texts.length > 0 ? `Omitted: ${shorten(oneLine(texts.join("; ")), 300)}.` : "";
    const dots = rows.flatMap((row): Dot[] => {
      const value = numberIn(row, place.gain);
      if (value === null) return [];
      const kind = textIn(row, place.kind);
      return [{ label: textIn(row, place.method) + (kind === "" || kind === "step" ? "" : `, ${kind}`), value, low: 1, high: value, hover: [], method: methods.get(textIn(row, place.method)) ?? -1 }];
    });
    plot.show(dots.sort((a, b) => b.value - a.value), "gain: run time of the full formulation / run time of the reduced formulation", true, false, "gain in run time");
    if (dots.length === 0) left.textContent = `${left.textContent} No gain was measured for this scene.`;
  };
  tools.page.watch(["scene", key], show);
  show();
}

export const gains: Section = {
  name: "gains",
  title: "Reduced formulation",
  present: (data) => gainTables(data).length > 0,
  render(host, tools) {
    for (const table of gainTables(tools.data)) {
      one(host, tools, table);
      const view = element("details", { class: "numbers" }, element("summary", {}, "Table"));
      let drawn = false;
      view.addEventListener("toggle", () => {
        if (!view.open || drawn) return;
        drawn = true;
        fill(view, view.firstElementChild, new TableView(tools.page, `gains.${shorten(table.name, 60)}`, { caption: table.title || table.name, columns: table.columns, rows: table.rows, total: table.total }).root);
      });
      host.append(view);
    }
  },
};
