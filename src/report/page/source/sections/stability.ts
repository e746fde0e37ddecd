import { Choice, element, fill, vector } from "../dom.ts";
import { significant } from "../format.ts";
import { TableView } from "../table_view.ts";
import { fileName, methodLabel, methodName, type Section } from "../tools.ts";
import { oneLine, shorten } from "../text.ts";
import type { StabilityMap } from "../data.ts";

/** From light to dark, as in the printed maps; distinguishable in greyscale. */
const shades = ["#f4f4dc", "#b9e2e6", "#e8b04a", "#6ea3d8", "#b8702a", "#46669e", "#7d2a1e", "#1d1a33"];

/** Shade of an outcome; the outcomes are spread over all shades. */
export function shadeOf(outcome: number, outcomes: number): string {
  const last = shades.length - 1;
  return shades[outcomes < 2 ? 0 : Math.min(last, Math.round((outcome * last) / (outcomes - 1)))] ?? "#1d1a33";
}

/** Share of each outcome among the cells that were run. */
export function sharesOf(map: StabilityMap): { run: number; shares: number[] } {
  const counts = map.outcomes.map(() => 0);
  let run = 0;
  for (const outcome of map.outcome) {
    if (outcome < 0 || outcome >= counts.length) continue;
    counts[outcome]! += 1;
    run += 1;
  }
  return { run, shares: counts.map((one) => (run === 0 ? 0 : one / run)) };
}

function percent(share: number): string {
  return `${(100 * share).toFixed(share > 0 && share < 0.01 ? 1 : 0)} %`;
}

function inWords(map: StabilityMap): string {
  const { run, shares } = sharesOf(map);
  if (run === 0) return "not run";
  return map.outcomes.flatMap((name, i) => ((shares[i] ?? 0) > 0 ? [`${percent(shares[i] ?? 0)} ${shorten(oneLine(name), 40)}`] : [])).join(", ");
}

/** Canvas with one pixel per cell, enlarged by the style sheet; y points upward. */
function cells(map: StabilityMap): HTMLCanvasElement {
  const canvas = element("canvas", { width: Math.max(1, map.x.length), height: Math.max(1, map.y.length), class: "cells" });
  const context = canvas.getContext("2d");
  if (context === null) return canvas;
  for (let j = 0; j < map.y.length; ++j) {
    for (let i = 0; i < map.x.length; ++i) {
      const outcome = map.outcome[j * map.x.length + i] ?? -1;
      if (outcome < 0) continue;
      context.fillStyle = shadeOf(outcome, map.outcomes.length);
      context.fillRect(i, map.y.length - 1 - j, 1, 1);
    }
  }
  return canvas;
}

/** Indices of the labels along an axis: at powers of ten if there are at least two, else evenly spaced. */
export function tickPlaces(values: readonly number[], most: number): number[] {
  const { length } = values;
  const powers = values.flatMap((value, i) => (/^1(\.0)?e/.test(value.toExponential(1)) ? [i] : []));
  if (powers.length >= 2 && powers.length <= most) return powers;
  if (length <= most) return Array.from({ length }, (_, i) => i);
  return Array.from({ length: most }, (_, k) => Math.round((k * (length - 1)) / (most - 1)));
}

function ticks(values: readonly number[], most: number, vertical: boolean): HTMLElement {
  return element(
    "div", { class: vertical ? "ticks-y" : "ticks-x", "aria-hidden": "true" },
    ...tickPlaces(values, most).map((i) => {
      const share = ((i + 0.5) / values.length) * 100;
      return element("span", { style: vertical ? `bottom:${share}%` : `left:${share}%` }, significant(values[i], 2));
    }),
  );
}

/** The map as SVG. */
function svgText(map: StabilityMap, title: string): string {
  const size = 8;
  const [width, height] = [map.x.length * size, map.y.length * size];
  const root = vector("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${width + 90} ${height + 76 + 16 * map.outcomes.length}`, width: String(width + 90), height: String(height + 76 + 16 * map.outcomes.length), "font-family": "sans-serif", "font-size": "11" });
  const text = (x: number, y: number, what: string, more: Record<string, string> = {}): void => {
    const made = vector("text", { x: String(x), y: String(y), ...more });
    made.textContent = oneLine(what);
    root.append(made);
  };
  root.append(vector("rect", { width: "100%", height: "100%", fill: "#ffffff" }));
  text(70, 14, title, { "font-weight": "bold" });
  for (let j = 0; j < map.y.length; ++j) {
    for (let i = 0; i < map.x.length; ++i) {
      const outcome = map.outcome[j * map.x.length + i] ?? -1;
      if (outcome >= 0) root.append(vector("rect", { x: String(70 + i * size), y: String(22 + (map.y.length - 1 - j) * size), width: String(size), height: String(size), fill: shadeOf(outcome, map.outcomes.length) }));
    }
  }
  root.append(vector("rect", { x: "70", y: "22", width: String(width), height: String(height), fill: "none", stroke: "#000000" }));
  for (const i of tickPlaces(map.x, 5)) text(70 + (i + 0.5) * size, height + 36, significant(map.x[i], 2), { "text-anchor": "middle" });
  for (const j of tickPlaces(map.y, 5)) text(66, 22 + (map.y.length - 0.5 - j) * size + 4, significant(map.y[j], 2), { "text-anchor": "end" });
  text(70 + width / 2, height + 52, map.x_label, { "text-anchor": "middle" });
  text(14, 22 + height / 2, map.y_label, { "text-anchor": "middle", transform: `rotate(-90 14 ${22 + height / 2})` });
  map.outcomes.forEach((name, o) => {
    const y = height + 64 + 16 * o;
    root.append(vector("rect", { x: "70", y: String(y), width: "12", height: "12", fill: shadeOf(o, map.outcomes.length), stroke: "#555555" }));
    text(88, y + 10, name);
  });
  return new XMLSerializer().serializeToString(root);
}

export const stability: Section = {
  name: "stability",
  title: "Stability maps",
  present: (data) => data.maps.length > 0,
  render(host, tools) {
    const { data, page } = tools;
    const mapChoice = new Choice("Map", (value) => page.set({ "stability.map": value, "stability.method": "" }));
    const familyChoice = new Choice("Family", (value) => page.set({ "stability.family": value, "stability.method": "" }));
    const legend = element("ul", { class: "shades" });
    const multiples = element("div", { class: "multiples" });
    const large = element("div");
    const below = element("div");
    let table: TableView | null = null;
    host.append(
      element("p", { class: "explain" }, "Outcome for each pair of step and parameter, from light (best) to dark (worst). Select a map to enlarge it and to read its cells. The table lists the share of each outcome."),
      element("div", { class: "choices" }, mapChoice.root, familyChoice.root), legend, element("div", { class: "maps" }, multiples, large), below,
    );

    const enlarge = (map: StabilityMap): HTMLElement => {
      const readout = element("p", { class: "readout", "aria-live": "polite" }, "Point at a cell, or move with the arrow keys.");
      const cursor = element("div", { class: "cursor", hidden: true });
      let [column, row] = [0, 0];
      const read = (): void => {
        const outcome = map.outcome[row * map.x.length + column] ?? -1;
        cursor.hidden = false;
        cursor.style.cssText = `left:${(100 * column) / map.x.length}%;bottom:${(100 * row) / map.y.length}%;width:${100 / map.x.length}%;height:${100 / map.y.length}%`;
        readout.textContent = `${shorten(oneLine(map.x_label), 40)} ${significant(map.x[column], 3)}, ${shorten(oneLine(map.y_label), 40)} ${significant(map.y[row], 3)}: ${outcome < 0 ? "not run" : shorten(oneLine(map.outcomes[outcome] ?? ""), 60)}`;
      };
      const canvas = cells(map);
      const frame = element(
        "div",
        {
          class: "frame", tabindex: 0, role: "group", "aria-label": `Stability of ${shorten(oneLine(methodName(tools, map.method)), 60)}: ${inWords(map)}. Use the arrow keys to read cells.`,
          onkeydown: (event: KeyboardEvent) => {
            const move: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
            const by = move[event.key];
            if (by === undefined) return;
            event.preventDefault();
            column = Math.min(map.x.length - 1, Math.max(0, column + by[0]));
            row = Math.min(map.y.length - 1, Math.max(0, row + by[1]));
            read();
          },
          onpointermove: (event: PointerEvent) => {
            const box = canvas.getBoundingClientRect();
            column = Math.min(map.x.length - 1, Math.max(0, Math.floor(((event.clientX - box.left) / box.width) * map.x.length)));
            row = Math.min(map.y.length - 1, Math.max(0, Math.floor(((box.bottom - event.clientY) / box.height) * map.y.length)));
            read();
          },
        },
        canvas, cursor,
      );
      const save = element("button", {
        type: "button", title: "Save as SVG with a white background",
        onclick: () => {
          const address = URL.createObjectURL(new Blob([svgText(map, methodName(tools, map.method))], { type: "image/svg+xml" }));
          element("a", { href: address, download: `${fileName(data.folder, "stability", map.map, methodName(tools, map.method))}.svg` }).click();
          window.setTimeout(() => URL.revokeObjectURL(address), 10000);
        },
      }, "SVG");
      return element(
        "figure", { class: "map-large" },
        element("figcaption", {}, methodLabel(tools, map.method), element("span", { class: "gap" }), save),
        element("div", { class: "with-ticks" },
          element("div", { class: "label-y" }, shorten(oneLine(map.y_label), 60)), ticks(map.y, 7, true), frame, ticks(map.x, 6, false), element("div", { class: "label-x" }, shorten(oneLine(map.x_label), 60))),
        readout,
      );
    };

    const show = (): void => {
      const names = [...new Set(data.maps.map((map) => map.map))];
      const name = names.includes(page.get("stability.map")) ? page.get("stability.map") : (names[0] ?? "");
      const ofMap = data.maps.filter((map) => map.map === name);
      const families = [...new Set(ofMap.map((map) => data.methods[map.method]?.family ?? -1))].sort((a, b) => a - b);
      const family = families.find((f) => data.families[f]?.name === page.get("stability.family")) ?? families[0] ?? -1;
      const shown = ofMap.filter((map) => data.methods[map.method]?.family === family);
      mapChoice.update(names.map((one) => [one, shorten(oneLine(one), 40)]), name);
      familyChoice.update(families.map((f) => [data.families[f]?.name ?? "", `${shorten(oneLine(data.families[f]?.label ?? ""), 40)} (${ofMap.filter((map) => data.methods[map.method]?.family === f).length})`]), data.families[family]?.name ?? "");
      const outcomes = shown[0]?.outcomes ?? [];
      fill(legend, ...outcomes.map((outcome, o) => element("li", {}, element("span", { class: "shade", style: `background:${shadeOf(o, outcomes.length)}` }), shorten(oneLine(outcome), 60))),
        shown.some((map) => map.outcome.includes(-1)) ? element("li", {}, element("span", { class: "shade not-run" }), "not run") : null);
      const asked = shown.find((map) => methodName(tools, map.method) === page.get("stability.method")) ?? shown[0];
      fill(multiples, ...shown.slice(0, 40).map((map) =>
        element("button", {
          type: "button", class: "multiple", "aria-pressed": String(map === asked), "data-method": map.method,
          onclick: () => page.set({ "stability.method": methodName(tools, map.method) }),
        }, element("span", { class: "multiple-name" }, methodLabel(tools, map.method, 22)), cells(map), element("span", { class: "unseen" }, `: ${inWords(map)}`))));
      fill(large, asked === undefined ? null : enlarge(asked));
      const all = [...new Set(ofMap.flatMap((map) => map.outcomes))];
      const content = {
        caption: `Shares of outcomes, map ${name}`,
        columns: [{ name: "method", numeric: false }, { name: "family", numeric: false }, ...all.map((outcome) => ({ name: outcome, numeric: true })), { name: "cells run", numeric: true, integral: true }],
        rows: ofMap.map((map) => {
          const { run, shares } = sharesOf(map);
          return [methodName(tools, map.method), data.families[data.methods[map.method]?.family ?? -1]?.label ?? "", ...all.map((outcome) => {
            const place = map.outcomes.indexOf(outcome);
            return place < 0 || run === 0 ? null : (shares[place] ?? null);
          }), run];
        }),
        render: (column: number, cell: unknown): Node | null => {
          const method = column === 0 ? data.methods.findIndex((one) => one.name === cell) : -1;
          return method < 0 ? null : methodLabel(tools, method);
        },
      };
      if (table === null) table = new TableView(page, "shares", content);
      else table.show(content);
      fill(below, table.root);
    };
    page.watch(["stability.map", "stability.family"], show);
    page.watch(["stability.method"], () => {
      const focused = document.activeElement instanceof HTMLElement && multiples.contains(document.activeElement) ? document.activeElement.dataset.method : undefined;
      show();
      if (focused !== undefined) multiples.querySelector<HTMLElement>(`[data-method="${focused}"]`)?.focus();
    });
    show();
  },
};
