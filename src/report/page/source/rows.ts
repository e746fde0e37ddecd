// Access to result rows singly and by scene, the limit of a run's accuracy, and validation of the document.

import { indexColumns, numberColumns, type ReportData, type Rows } from "./data.ts";
import { significant } from "./format.ts";

export const statuses = ["ok", "unsupported", "diverged", "tolerance not met", "failed"] as const;
export const settingKinds = ["none", "step", "tolerance"] as const;

export interface Row {
  place: number; // index into the columns
  experiment: number;
  scene: number;
  method: number;
  settingKind: number;
  setting: number | null;
  status: number;
  message: string;
  seconds: number | null;
  evaluations: number | null;
  attitude: number | null;
  floor: number | null;
  floor32: number | null;
  cut: boolean;
  formulation: string;
}

export function rowAt(rows: Rows, place: number): Row {
  return {
    place,
    experiment: rows.experiment[place] ?? -1,
    scene: rows.scene[place] ?? -1,
    method: rows.method[place] ?? -1,
    settingKind: rows.setting_kind[place] ?? 0,
    setting: rows.setting[place] ?? null,
    status: rows.status[place] ?? 4,
    message: rows.messages[rows.message[place] ?? 0] ?? "",
    seconds: rows.seconds[place] ?? null,
    evaluations: rows.evaluations[place] ?? null,
    attitude: rows.attitude[place] ?? null,
    floor: rows.floor[place] ?? null,
    floor32: rows.floor32[place] ?? null,
    cut: rows.cut[place] === 1,
    formulation: rows.formulations[rows.formulation[place] ?? 0] ?? "",
  };
}

export type Limit = "unsupported" | "limit" | "instability" | "tolerance" | "failure" | "floor" | "truncation" | "unknown";

/** What limits the accuracy of a run. An error of at most ten times the rounding floor is attributed to rounding. */
export function limitOf(row: Row, precision: string): { kind: Limit; text: string } {
  const told = row.message === "" ? "" : `: ${row.message}`;
  if (row.status === 1) return { kind: "unsupported", text: `unsupported${told}` };
  if (row.cut) return { kind: "limit", text: "limit on run time, steps or evaluations" };
  if (row.status === 2) return { kind: "instability", text: `instability${told}` };
  if (row.status === 3) return { kind: "tolerance", text: `tolerance not met${told}` };
  if (row.status === 4) return { kind: "failure", text: `failed${told}` };
  if (row.attitude === null) return { kind: "unknown", text: "no attitude error" };
  const single = precision === "binary32";
  const floor = single ? row.floor32 : row.floor;
  if (floor !== null && row.attitude <= 10 * floor) {
    return { kind: "floor", text: `rounding floor of ${precision || "binary64"} (${significant(floor)} rad)` };
  }
  return { kind: "truncation", text: "truncation error" };
}

/** "step 1e-3 s", "tolerance 1e-9" or "". */
export function settingText(kind: number, setting: number | null): string {
  if (kind === 0 || setting === null) return kind === 0 ? "" : (settingKinds[kind] ?? "");
  return kind === 1 ? `step ${significant(setting, 4)} s` : `tolerance ${significant(setting, 3)}`;
}

/** Row indices by scene, computed once. */
export class RowIndex {
  private readonly begin: Uint32Array;
  private readonly places: Uint32Array;

  constructor(rows: Rows, scenes: number) {
    this.begin = new Uint32Array(scenes + 1);
    for (let i = 0; i < rows.count; ++i) this.begin[(rows.scene[i] ?? 0) + 1]! += 1;
    for (let s = 0; s < scenes; ++s) this.begin[s + 1]! += this.begin[s]!;
    const next = this.begin.slice();
    this.places = new Uint32Array(rows.count);
    for (let i = 0; i < rows.count; ++i) this.places[next[rows.scene[i] ?? 0]!++] = i;
  }

  ofScene(scene: number): Uint32Array {
    return this.places.subarray(this.begin[scene] ?? 0, this.begin[scene + 1] ?? 0);
  }
}

/** Numeric columns of a document by name. */
export function numbersOf(rows: Rows): Map<string, (number | null)[]> {
  const others = new Set<string>([...indexColumns, "count", "total", "messages", "formulations"]);
  return new Map(Object.entries(rows as Record<string, unknown>).filter(([name]) => !others.has(name))) as Map<string, (number | null)[]>;
}

/** Checks the structure of a document. Returns the first error, or "". */
export function faultOf(value: unknown): string {
  if (typeof value !== "object" || value === null) return "the document is not an object";
  const data = value as ReportData;
  if (data.format !== 1) return `the document's format is ${String(data.format)}; this page supports format 1`;
  for (const key of ["experiments", "families", "methods", "scenes", "findings", "orders", "drift", "maps", "tables", "checks", "motions", "remarks"] as const) {
    if (!Array.isArray(data[key])) return `the document has no list "${key}"`;
  }
  const rows = data.rows;
  if (typeof rows !== "object" || rows === null) return 'the document has no "rows"';
  for (const key of new Set([...indexColumns, ...numberColumns, ...numbersOf(rows).keys()])) {
    const column = (rows as Record<string, unknown>)[key];
    if (!Array.isArray(column) || column.length !== rows.count) return `rows.${key} must have ${rows.count} entries`;
  }
  const within = (key: "experiment" | "scene" | "method", size: number): string => {
    const bad = rows[key].findIndex((place) => !(place >= 0 && place < size));
    return bad < 0 ? "" : `rows.${key}[${bad}] is ${String(rows[key][bad])}, but there are only ${size} ${key}s`;
  };
  return (
    within("experiment", data.experiments.length) ||
    within("scene", data.scenes.length) ||
    within("method", data.methods.length) ||
    (data.methods.some((method) => !data.families[method.family]) ? "a method's family is not in the list of families" : "")
  );
}
