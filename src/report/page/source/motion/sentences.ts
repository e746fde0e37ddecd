// Sentences below the motion view.

import type { Motion } from "../data.ts";
import { duration, engineering, quantity, significant } from "../format.ts";
import { oneLine } from "../text.ts";
import type { Actor } from "./actors.ts";

const statuses = ["finished", "does not support this scene", "diverged", "did not meet its tolerance", "failed"];

const ended = (text: string): string => (/[.!?]$/.test(text) ? text : `${text}.`);

/** Error bound of the interpolation. */
export function thinningSentence(motion: Motion): string {
  const { angle, length } = motion.thinning;
  const place = motion.moving ? ` and ${engineering(length, "m", 2)}` : "";
  return `Interpolated between keyframes to within ${engineering(angle, "rad", 2)}${place}.`;
}

export function windowSentence(motion: Motion): string {
  return motion.duration < motion.whole * (1 - 1e-6)
    ? `Only the first ${duration(motion.duration)} of the scene's ${duration(motion.whole)} are shown.`
    : "";
}

export function truthSentence(motion: Motion): string {
  return motion.how === "" ? "" : ended(`Truth: ${oneLine(motion.how)}`);
}

/** Remark on a method that is not drawn exactly or completely; "" for all others. */
export function methodSentence(actor: Actor): string {
  const { method, name } = actor;
  if (method === null) return "";
  const status = statuses[method.status] ?? "ended with an unknown status";
  const message = oneLine(method.message);
  const why = message === "" ? "" : `: ${message}`;
  if (actor.keyframes === null) return ended(`${name} ${status}${why}; there is no motion to draw`);
  if (actor.isTruth) {
    const far = method.difference === null ? "an unknown distance" : quantity(method.difference, "rad", 2);
    return `${name} is within ${far} of the truth and is drawn as the truth.`;
  }
  if (actor.endsEarly) return ended(`${name} ${method.status === 0 ? "has no samples" : status} after ${significant(actor.end)} s and does not move from then on${why}`);
  if (method.status !== 0) return ended(`${name} ${status}${why}`);
  return "";
}

export function gravitySentence(motion: Motion): string {
  if (motion.gravity === null) return "";
  const [x = 0, y = 0, z = 0] = motion.gravity;
  const size = Math.hypot(x, y, z);
  if (!(size > 0)) return "";
  const names = ["x", "y", "z"];
  const along = [x, y, z].findIndex((one) => Math.abs(one) > size * (1 - 1e-9));
  const way = along >= 0 ? `along ${([x, y, z][along] ?? 0) < 0 ? "−" : "+"}${names[along] ?? ""}` : `along (${[x, y, z].map((one) => significant(one / size)).join(", ")})`;
  return `Gravity: ${significant(size)} m/s² ${way}.`;
}

export function contactSentence(motion: Motion): string {
  return motion.contacts.length === 0 ? "" : "Arrows at contacts: normal force N, friction F and slip velocity u of the truth, each scaled to its largest value.";
}
