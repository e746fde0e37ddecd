// Reference of a lesson: Taylor series of order 24 with the step of A. Jorba & M. Zou, Experimental Mathematics 14 (2005)
// 99. With g = R^T m g (body axes) the motion is polynomial:
//   w' = I^-1 (I w x w + arm x g),  g' = g x w,  q' = q (0, w) / 2,
// so the coefficients are Cauchy products.

import { add, conjugate, cross, length, norm, normalized, type Quaternion, rotate, scale, type Vector } from "../motion/algebra.ts";
import { type Body, combine, type Sample, timesVector, transform } from "./mechanics.ts";

const order = 24;

interface Series {
  q: Quaternion[];
  w: Vector[];
}

const sum = (a: Quaternion, b: Quaternion): Quaternion => [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]];
const times = (s: number, a: Quaternion): Quaternion => [s * a[0], s * a[1], s * a[2], s * a[3]];

function seriesOf(body: Body, q0: Quaternion, w0: Vector): Series {
  const [q, w] = [[q0], [w0]];
  const g = [rotate(conjugate(q0), body.weight)];
  const L: Vector[] = [];
  const heavy = length(body.weight) > 0 && length(body.arm) > 0;
  for (let k = 0; k < order; ++k) {
    L.push(transform(body.tensor, w[k] as Vector));
    let torque: Vector = heavy ? cross(body.arm, g[k] as Vector) : [0, 0, 0];
    let down: Vector = [0, 0, 0];
    let turn: Quaternion = [0, 0, 0, 0];
    for (let j = 0; j <= k; ++j) {
      const spin = w[k - j] as Vector;
      torque = add(torque, cross(L[j] as Vector, spin));
      if (heavy) down = add(down, cross(g[j] as Vector, spin));
      turn = sum(turn, timesVector(q[j] as Quaternion, spin));
    }
    w.push(scale(1 / (k + 1), transform(body.inverse, torque)));
    g.push(scale(1 / (k + 1), down));
    q.push(times(0.5 / (k + 1), turn));
  }
  return { q, w };
}

/** Step for which the last two terms are e^-2k of the state. */
function stepOf({ q, w }: Series): number {
  let radius = Infinity;
  const size = Math.max(length(w[0] as Vector), 1e-300);
  for (const k of [order - 1, order]) {
    radius = Math.min(radius, (size / length(w[k] as Vector)) ** (1 / k), norm(q[k] as Quaternion) ** (-1 / k));
  }
  return radius / Math.E ** 2;
}

function valueAt({ q, w }: Series, h: number): { q: Quaternion; w: Vector } {
  let [attitude, spin] = [q[order] as Quaternion, w[order] as Vector];
  for (let k = order - 1; k >= 0; --k) {
    attitude = sum(q[k] as Quaternion, times(h, attitude));
    spin = combine(w[k] as Vector, h, spin);
  }
  return { q: normalized(attitude), w: spin };
}

/** The motion at ascending times from t = 0. Ends early if it needs more than `mostSteps` steps. */
export function reference(body: Body, q: Quaternion, w: Vector, at: readonly number[], mostSteps = 20000): Sample[] {
  const samples: Sample[] = [];
  let begin = 0;
  let series = seriesOf(body, normalized(q), w);
  let h = stepOf(series);
  let steps = 0;
  for (const t of at) {
    while (t > begin + h) {
      if (++steps > mostSteps) return samples;
      const next = valueAt(series, h);
      begin += h;
      series = seriesOf(body, next.q, next.w);
      h = stepOf(series);
    }
    samples.push({ t, ...valueAt(series, t - begin) });
  }
  return samples;
}
