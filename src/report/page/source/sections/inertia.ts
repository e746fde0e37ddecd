import { Choice, element, fill } from "../dom.ts";
import { counted, engineering, significant } from "../format.ts";
import { swatch } from "../marks.ts";
import { axis, Plot, type Trace } from "../plot.ts";
import { TableView } from "../table_view.ts";
import { columnPlace, fileName, numberIn, textIn, type Section } from "../tools.ts";
import { oneLine, plotText, shorten } from "../text.ts";
import type { ReportData, Table } from "../data.ts";
import { positive } from "./work_precision.ts";

// distinguishable with colour blindness: after Okabe & Ito 2008, lighter on a dark background
export const palette: { light: string; dark: string }[] = [
  { light: "#0072b2", dark: "#56b4e9" }, { light: "#b04a00", dark: "#ff9d4d" }, { light: "#00795a", dark: "#3fd1a5" }, { light: "#1c2127", dark: "#e6e9ed" },
  { light: "#9c3f76", dark: "#e79ac6" }, { light: "#8a6d00", dark: "#e6c200" }, { light: "#7f4f24", dark: "#d9a676" }, { light: "#5b6570", dark: "#a0a8b2" },
];
const symbols = ["circle", "square", "triangle-up", "diamond", "triangle-down", "pentagon"];

function inertiaTable(data: ReportData): Table | undefined {
  return data.tables.find((table) => table.name === "inertia" && ["shape", "way", "seconds_median", "inertia_error"].every((name) => columnPlace(table, name) >= 0));
}

export const inertia: Section = {
  name: "inertia",
  title: "Inertia",
  present: (data) => inertiaTable(data) !== undefined,
  render(host, tools) {
    const table = inertiaTable(tools.data);
    if (table === undefined) return;
    const place = { shape: columnPlace(table, "shape"), way: columnPlace(table, "way"), pieces: columnPlace(table, "pieces"), seconds: columnPlace(table, "seconds_median"), error: columnPlace(table, "inertia_error") };
    const shapes = [...new Set(table.rows.map((row) => textIn(row, place.shape)))];
    const ways = [...new Set(table.rows.map((row) => textIn(row, place.way)))];
    const chosen = (): string => (shapes.includes(tools.page.get("inertia.shape")) ? tools.page.get("inertia.shape") : (shapes[0] ?? ""));
    const choice = new Choice("Shape", (value) => tools.page.set({ "inertia.shape": value, "inertia.zoom": "" }));
    const plot = new Plot(tools.page, "Error of the moments of inertia against run time, by method", "inertia.zoom", () => fileName(tools.data.folder, "inertia", chosen()), 400);
    const legend = element("ul", { class: "inline-legend" });
    host.append(element("p", { class: "explain" }, "Error of the computed moments of inertia against run time, for the selected shape."), element("div", { class: "choices" }, choice.root), legend, plot.root);
    const show = (): void => {
      const shape = chosen();
      choice.update(shapes.map((one) => [one, shorten(oneLine(one), 40)]), shape);
      const rows = table.rows.filter((row) => textIn(row, place.shape) === shape);
      const here = ways.filter((way) => rows.some((row) => textIn(row, place.way) === way));
      const look = (way: string): { light: string; dark: string; symbol: string } => {
        const at = ways.indexOf(way);
        return { ...(palette[at % palette.length] ?? { light: "#000000", dark: "#ffffff" }), symbol: (symbols[at % symbols.length] ?? "circle") + (Math.floor(at / palette.length) % 2 === 1 ? "-open" : "") };
      };
      fill(legend, ...here.map((way) => {
        const { light, dark, symbol } = look(way);
        const [onLight, onDark] = [swatch({ symbol, dash: "solid" }, light, true), swatch({ symbol, dash: "solid" }, dark, true)];
        onLight.classList.add("on-light");
        onDark.classList.add("on-dark");
        return element("li", {}, onLight, onDark, ` ${shorten(oneLine(way), 40).replace(/_/g, " ")}`);
      }));
      plot.draw((theme) => ({
        traces: here.map((way): Trace => {
          const points = rows.filter((row) => textIn(row, place.way) === way && (numberIn(row, place.seconds) ?? 0) > 0 && positive(numberIn(row, place.error)) !== null)
            .sort((a, b) => (numberIn(a, place.pieces) ?? 0) - (numberIn(b, place.pieces) ?? 0));
          const color = theme.dark ? look(way).dark : look(way).light;
          return {
            type: "scatter", mode: "lines+markers", name: plotText(way.replace(/_/g, " "), 40), x: points.map((row) => numberIn(row, place.seconds)), y: points.map((row) => positive(numberIn(row, place.error))),
            text: points.map((row) => [way, numberIn(row, place.pieces) === null ? "" : counted(numberIn(row, place.pieces) ?? 0, "piece"), `error ${significant(numberIn(row, place.error))}`, engineering(numberIn(row, place.seconds), "s")].filter((line) => line !== "").map((line) => plotText(line)).join("<br>")),
            hoverinfo: "text", line: { color, width: 1.6 }, marker: { color, size: 8, symbol: look(way).symbol, line: { color, width: 1.3 } },
          } as Trace;
        }),
        layout: { xaxis: axis(theme, "run time (s)", true), yaxis: axis(theme, "relative error of the inertia", true) },
      }));
    };
    tools.page.watch(["inertia.shape"], show);
    show();
    host.append(new TableView(tools.page, "inertia", { caption: table.title || table.name, columns: table.columns, rows: table.rows, total: table.total }).root);
  },
};
