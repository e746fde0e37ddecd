// What every section is given.

import type { ReportData, Table } from "./data.ts";
import type { RowIndex } from "./rows.ts";
import type { Page } from "./state.ts";
import { element } from "./dom.ts";
import { oneLine, shorten } from "./text.ts";
import { colorOf, markOf, swatch } from "./marks.ts";

export interface Tools {
  data: ReportData;
  page: Page;
  index: RowIndex;
}

export interface Section {
  name: string; // in the fragment
  title: string;
  present(data: ReportData): boolean;
  render(host: HTMLElement, tools: Tools): void;
}

/** The chosen scene, -1 where there is none. */
export function chosenScene(tools: Tools): number {
  const name = tools.page.get("scene");
  const found = tools.data.scenes.findIndex((scene) => scene.name === name);
  return found >= 0 ? found : firstScene(tools);
}

/** Experiments that are made for a work-precision diagram. */
export function isSweep(data: ReportData, experiment: number): boolean {
  return /^(sweep|speed)$/.test(data.experiments[experiment]?.kind ?? "");
}

/** The scene to begin with: the one with the largest sweep, or else with most rows; -1 where there is none. */
export function firstScene(tools: Tools): number {
  const { data, index } = tools;
  const known = data.scenes.map((_, scene) => {
    const places = index.ofScene(scene);
    let swept = 0;
    for (const place of places) if (isSweep(data, data.rows.experiment[place] ?? -1)) swept += 1;
    return 1000 * swept + places.length;
  });
  return known.reduce((best, value, scene) => (best < 0 || value > (known[best] ?? 0) ? scene : best), -1);
}

export function sceneName(tools: Tools, scene: number): string {
  return tools.data.scenes[scene]?.name ?? "";
}

export function methodName(tools: Tools, method: number): string {
  return tools.data.methods[method]?.name ?? "";
}

export function precisionOf(tools: Tools, method: number): string {
  return tools.data.methods[method]?.precision ?? "";
}

/** A name as text, shortened, the whole of it in its title. */
export function named(name: string, length = 40): HTMLElement {
  const plain = oneLine(name);
  const short = shorten(plain, length);
  return element("span", { class: "name", title: short === plain ? null : plain.slice(0, 2000) }, short);
}

/** A method with its mark and colour. */
export function methodLabel(tools: Tools, method: number, length = 34): HTMLElement {
  const known = tools.data.methods[method];
  const label = named(known?.name ?? "?", length);
  return element("span", { class: "method" }, methodSwatch(tools, method, true), label);
}

export function methodSwatch(tools: Tools, method: number, lit: boolean): HTMLElement {
  const known = tools.data.methods[method];
  const family = known === undefined ? undefined : tools.data.families[known.family];
  const holder = element("span", { class: "swatches", title: family === undefined ? null : oneLine(family.label).slice(0, 200) });
  // both colours are there, and the style shows the theme's
  holder.append(swatch(markOf(known?.mark ?? 0), colorOf(family, false), lit), swatch(markOf(known?.mark ?? 0), colorOf(family, true), lit));
  holder.children[0]?.classList.add("on-light");
  holder.children[1]?.classList.add("on-dark");
  return holder;
}

/** Where the chosen scene has nothing to show, the scenes that have. */
export function otherScenes(tools: Tools, what: string, scenes: readonly number[]): HTMLElement {
  const shown = scenes.slice(0, 12);
  return element(
    "div",
    { class: "note" },
    element("p", {}, `No ${what} for this scene${scenes.length > 0 ? "; available for:" : "."}`),
    element(
      "p",
      { class: "buttons" },
      ...shown.map((scene) =>
        element("button", { type: "button", onclick: () => tools.page.set({ scene: sceneName(tools, scene) }) }, named(sceneName(tools, scene), 48)),
      ),
      scenes.length > shown.length ? ` and ${scenes.length - shown.length} more` : null,
    ),
  );
}

/** The scene itself if it is among those that have something, else a variation of it that is: name{/key=value}. */
export function standIn(tools: Tools, scene: number, having: readonly number[]): number {
  if (having.includes(scene)) return scene;
  const base = (one: number): string => sceneName(tools, one).replace(/\{.*$/s, "");
  return having.find((one) => base(one) === base(scene)) ?? scene;
}

/** Says which scene is seen where it is not the chosen one. */
export function standInNote(tools: Tools, chosen: number, seen: number): HTMLElement | null {
  return chosen === seen ? null : element("p", { class: "note" }, "Showing ", named(sceneName(tools, seen), 60), ": there are no results for the selected scene itself.");
}

export function columnPlace(table: Table, name: string): number {
  return table.columns.findIndex((column) => column.name === name);
}

/** A cell as a number, null where it is none. */
export function numberIn(row: readonly (string | number | null)[], place: number): number | null {
  const cell = place < 0 ? null : row[place];
  return typeof cell === "number" && Number.isFinite(cell) ? cell : null;
}

export function textIn(row: readonly (string | number | null)[], place: number): string {
  const cell = place < 0 ? null : row[place];
  return cell === null || cell === undefined ? "" : String(cell);
}

export function fileName(...parts: string[]): string {
  return parts
    .map((part) => part.replace(/[^A-Za-z0-9.-]+/g, "_").replace(/^_+|_+$/g, ""))
    .filter((part) => part !== "")
    .join("_")
    .slice(0, 120);
}
