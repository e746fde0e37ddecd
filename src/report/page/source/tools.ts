// The interface of sections, and their common elements.

import type { ReportData, Table } from "./data.ts";
import type { RowIndex } from "./rows.ts";
import type { Page } from "./state.ts";
import { element } from "./dom.ts";
import { oneLine, sceneLabel, shorten } from "./text.ts";
import { colorOf, markOf, swatch } from "./marks.ts";

export interface Tools {
  data: ReportData;
  page: Page;
  index: RowIndex;
}

export interface Section {
  name: string; // name in the fragment
  title: string;
  present(data: ReportData): boolean;
  render(host: HTMLElement, tools: Tools): void;
}

/** Index of the selected scene, or -1 if there are no scenes. */
export function chosenScene(tools: Tools): number {
  const name = tools.page.get("scene");
  const found = tools.data.scenes.findIndex((scene) => scene.name === name);
  return found >= 0 ? found : firstScene(tools);
}

/** Whether the experiment is intended for a work-precision diagram. */
export function isSweep(data: ReportData, experiment: number): boolean {
  return /^(sweep|speed)$/.test(data.experiments[experiment]?.kind ?? "");
}

/** Index of the initial scene: the one with the largest sweep, else with most rows; -1 if there are no scenes. */
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

/** A shortened name with the full name as tooltip. */
export function named(name: string, length = 40, full = name): HTMLElement {
  const plain = oneLine(full);
  const short = shorten(oneLine(name), length);
  return element("span", { class: "name", title: short === plain ? null : plain.slice(0, 2000) }, short);
}

/** The readable name of a scene with the name in the tables as tooltip. */
export const namedScene = (name: string, length = 40): HTMLElement => named(sceneLabel(name), length, name);

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
  // contains the colours of both themes; the style sheet shows one of them
  holder.append(swatch(markOf(known?.mark ?? 0), colorOf(family, false), lit), swatch(markOf(known?.mark ?? 0), colorOf(family, true), lit));
  holder.children[0]?.classList.add("on-light");
  holder.children[1]?.classList.add("on-dark");
  return holder;
}

/** Note that the selected scene has no data, with buttons for scenes that have. */
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
        element("button", { type: "button", onclick: () => tools.page.set({ scene: sceneName(tools, scene) }) }, namedScene(sceneName(tools, scene), 48)),
      ),
      scenes.length > shown.length ? ` and ${scenes.length - shown.length} more` : null,
    ),
  );
}

/** The scene if it has data, else a variation of it (name{/key=value}) that has, else the scene. */
export function standIn(tools: Tools, scene: number, having: readonly number[]): number {
  if (having.includes(scene)) return scene;
  const base = (one: number): string => sceneName(tools, one).replace(/\{.*$/s, "");
  return having.find((one) => base(one) === base(scene)) ?? scene;
}

/** Note that names the scene shown if it is not the selected one. */
export function standInNote(tools: Tools, chosen: number, seen: number): HTMLElement | null {
  return chosen === seen ? null : element("p", { class: "note" }, "Showing ", namedScene(sceneName(tools, seen), 60), ": there are no results for the selected scene itself.");
}

export function columnPlace(table: Table, name: string): number {
  return table.columns.findIndex((column) => column.name === name);
}

/** A cell as a number, or null. */
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
