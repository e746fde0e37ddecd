// The motions shown: the truth and up to three methods, each with colour, mark and keyframes.

import type { Motion, MotionMethod, ReportData } from "../data.ts";
import { quantity } from "../format.ts";
import { markOf, methodColor, type Mark } from "../marks.ts";
import { oneLine, shorten } from "../text.ts";
import { Keyframes } from "./interpolation.ts";
import { valueAt } from "./time_plot.ts";

export const mostMethods = 3;

export interface Actor {
  name: string;
  method: MotionMethod | null; // null: the truth
  mark: Mark;
  color: string; // for the current theme
  place: number; // 0: the truth; 1, 2, 3: methods; selects the dash of lines
  keyframes: Keyframes | null; // null: no motion to draw
  isTruth: boolean; // drawn from the truth's keyframes
  end: number; // s, time of the last sample
  endsEarly: boolean;
}

export function neutral(dark: boolean): string {
  return dark ? "#b8bec6" : "#8c949e";
}

export function settingOf(method: MotionMethod): string {
  if (method.setting === null) return "";
  if (method.setting_kind === 1) return `step ${quantity(method.setting, "s")}`;
  return method.setting_kind === 2 ? `tolerance ${quantity(method.setting, "")}` : "";
}

/** Name for display; file names may have any length. */
const nameOf = (method: MotionMethod): string => shorten(oneLine(method.label), 60);

/** Name and setting. */
export function titleOf(method: MotionMethod): string {
  const setting = settingOf(method);
  const name = nameOf(method);
  return setting === "" ? name : `${name}, ${setting}`;
}

export function truthActor(motion: Motion, dark: boolean): Actor {
  const keyframes = new Keyframes(motion.truth);
  return {
    name: "truth", method: null, mark: { symbol: "circle", dash: "solid" }, color: neutral(dark), place: 0, keyframes, isTruth: true,
    end: keyframes.end, endsEarly: false,
  };
}

export function methodActor(data: ReportData, motion: Motion, method: MotionMethod, truth: Keyframes, place: number, dark: boolean): Actor {
  const known = data.methods[method.method];
  const own = method.track !== null && method.track.t.length > 0 ? new Keyframes(method.track, false) : null;
  // a successful run without a track is visually indistinguishable from the truth
  const isTruth = own === null && isDrawn(method);
  const end = own?.end ?? (isTruth ? truth.end : 0);
  return {
    name: nameOf(method), method, mark: known === undefined ? { symbol: "circle-open", dash: "solid" } : markOf(known.mark),
    color: known === undefined ? (dark ? "#7cc0ff" : "#00518a") : methodColor(data, known, dark),
    place, keyframes: own ?? (isTruth ? truth : null), isTruth, end,
    endsEarly: end < motion.duration * (1 - 1e-6),
  };
}

/** Methods of a motion by label. Ignores unknown labels. */
export function chosenMethods(motion: Motion, labels: readonly string[]): MotionMethod[] {
  const found: MotionMethod[] = [];
  for (const label of labels) {
    const method = motion.methods.find((one) => one.label === label);
    if (method !== undefined && !found.includes(method) && found.length < mostMethods) found.push(method);
  }
  return found;
}

/** Whether the method can be drawn, from its own keyframes or from the truth's. */
export const isDrawn = (method: MotionMethod): boolean => method.track !== null || (method.status === 0 && method.t.length > 0);

/** Default selection: a user trajectory or else the method with the largest error, and the method with the smallest
 * visible error. */
export function firstMethods(motion: Motion): MotionMethod[] {
  const seen = motion.methods.filter((one) => one.track !== null);
  const own = seen.filter((one) => one.method < 0);
  const others = seen.filter((one) => one.method >= 0).sort((a, b) => (b.difference ?? 0) - (a.difference ?? 0));
  const first = own[0] ?? others[0] ?? motion.methods.find(isDrawn);
  const second = [...others].reverse().find((one) => one !== first);
  return [first, second].filter((one) => one !== undefined);
}

/** Error at a time, by logarithmic interpolation between samples; null beyond the last sample. */
export const errorAt = (method: MotionMethod, t: number): number | null => valueAt({ t: method.t, y: method.attitude }, t, true);
