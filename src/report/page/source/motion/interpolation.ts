// Interpolation of the motion between keyframes as defined in data.ts. `thinning` of a motion bounds its error.

import type { Track } from "../data.ts";
import { identity, length, normalized, type Quaternion, scale, subtract, type Vector, vectorAt, zero } from "./algebra.ts";

export interface Placement {
  attitude: Quaternion; // body to world
  angularVelocity: Vector; // rad/s, body axes
  position: Vector; // m, centre of mass, world
}

/** Index k of the interval [t_k, t_k+1] that contains t, by bisection; 0 to n - 2. */
export function findInterval(times: readonly number[], t: number): number {
  let low = 0;
  let high = Math.max(0, times.length - 2);
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if ((times[middle] ?? 0) <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Weights of (value, h slope) at both ends in the cubic Hermite polynomial at s in 0..1. */
export function hermite(s: number): [number, number, number, number] {
  const r = 1 - s;
  return [r * r * (1 + 2 * s), s * r * r, s * s * (1 + 2 * r), -s * s * r];
}

/** Weights of (value, h slope) at both ends in the derivative of the cubic Hermite polynomial with respect to s. */
export function hermiteSlope(s: number): [number, number, number, number] {
  const r = 1 - s;
  return [-6 * s * r, r * (1 - 3 * s), 6 * s * r, s * (3 * s - 2)];
}

/** q' = q (0, w) / 2, w in body axes. */
export function attitudeRate(q: Quaternion, w: Vector): Quaternion {
  return [
    0.5 * (-q[1] * w[0] - q[2] * w[1] - q[3] * w[2]),
    0.5 * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]),
    0.5 * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]),
    0.5 * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]),
  ];
}

/** For a uniform rotation by `angle` over the interval: angular velocity of the cubic at s relative to the true one. It
 * differs from 1 by up to a few per cent if keyframes are far apart. With u = angle / 2 the cubic goes from 1 to e^iu
 * with the slopes iu and iu e^iu; the ratio is Im(r* r') / (u |r|^2). */
export function evenTurnRate(angle: number, s: number): number {
  const u = angle / 2;
  if (!(u > 1e-3)) return 1;
  const [c, e] = [Math.cos(u), Math.sin(u)];
  const at = (w: [number, number, number, number]): [number, number] => [w[0] + w[2] * c - w[3] * u * e, w[1] * u + w[2] * e + w[3] * u * c];
  const [x, y] = at(hermite(s));
  const [dx, dy] = at(hermiteSlope(s));
  return (x * dy - y * dx) / (u * (x * x + y * y));
}

/** Attitude and angular velocity at the fraction s (0..1) of an interval h. The attitude is the normalised cubic r(s)
 * through both ends with their rates. The angular velocity is that of the cubic, 2 vec(r* r') / (h |r|^2), divided by
 * evenTurnRate(); at the keyframes it equals their angular velocities. */
export function attitudeBetween(
  from: Quaternion, fromW: Vector, to: Quaternion, toW: Vector, h: number, s: number,
): { attitude: Quaternion; angularVelocity: Vector } {
  const a = attitudeRate(from, fromW);
  const b = attitudeRate(to, toW);
  const weights = hermite(s);
  const slopes = hermiteSlope(s);
  const combine = (c: [number, number, number, number], i: 0 | 1 | 2 | 3): number =>
    c[0] * from[i] + c[1] * h * a[i] + c[2] * to[i] + c[3] * h * b[i];
  const r: Quaternion = [combine(weights, 0), combine(weights, 1), combine(weights, 2), combine(weights, 3)];
  const d: Quaternion = [combine(slopes, 0), combine(slopes, 1), combine(slopes, 2), combine(slopes, 3)];
  const square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3];
  const turn = (0.5 * (length(fromW) + length(toW))) * h;
  const factor = square > 0 && h > 0 ? 2 / (square * h * evenTurnRate(turn, s)) : 0;
  // vec(r* d)
  const angularVelocity = scale(factor, [
    r[0] * d[1] - r[1] * d[0] - r[2] * d[3] + r[3] * d[2],
    r[0] * d[2] - r[2] * d[0] - r[3] * d[1] + r[1] * d[3],
    r[0] * d[3] - r[3] * d[0] - r[1] * d[2] + r[2] * d[1],
  ]);
  return { attitude: normalized(r), angularVelocity };
}

export function positionBetween(from: Vector, fromV: Vector, to: Vector, toV: Vector, h: number, s: number): Vector {
  const c = hermite(s);
  const at = (i: 0 | 1 | 2): number => c[0] * from[i] + c[1] * h * fromV[i] + c[2] * to[i] + c[3] * h * toV[i];
  return [at(0), at(1), at(2)];
}

/** Slope at b of the parabola through a, b and c, with the intervals h and k between them. */
export function middleSlope(a: Vector, b: Vector, c: Vector, h: number, k: number): Vector {
  const at = (i: 0 | 1 | 2): number => ((b[i] - a[i]) / h) * (k / (h + k)) + ((c[i] - b[i]) / k) * (h / (h + k));
  return [at(0), at(1), at(2)];
}

/** The keyframes of a track. If `consistent` (the truth), the angular velocity between keyframes is that of the
 * interpolated attitude. A method's attitudes and angular velocities may be inconsistent: its angular velocities are
 * interpolated by a separate cubic. */
export class Keyframes {
  readonly times: readonly number[];
  readonly end: number; // s, time of the last keyframe

  constructor(private readonly track: Track, private readonly consistent = true) {
    this.times = track.t;
    this.end = track.t[track.t.length - 1] ?? 0;
  }

  /** Estimated from three neighbouring keyframes; from two at the ends and at jumps. */
  private angularAcceleration(body: number, k: number): Vector {
    const t = (i: number): number => this.times[i] ?? 0;
    const w = (i: number): Vector => this.angularVelocity(body, i);
    const last = this.times.length - 1;
    const [before, after] = [k > 0 ? t(k) - t(k - 1) : 0, k < last ? t(k + 1) - t(k) : 0];
    if (before > 0 && after > 0) return middleSlope(w(k - 1), w(k), w(k + 1), before, after);
    if (before > 0) return scale(1 / before, subtract(w(k), w(k - 1)));
    return after > 0 ? scale(1 / after, subtract(w(k + 1), w(k))) : zero;
  }

  attitude(body: number, k: number): Quaternion {
    const q = this.track.bodies[body]?.q ?? [];
    return normalized([q[4 * k] ?? 1, q[4 * k + 1] ?? 0, q[4 * k + 2] ?? 0, q[4 * k + 3] ?? 0]);
  }

  angularVelocity(body: number, k: number): Vector {
    const one = this.track.bodies[body];
    return one === undefined ? zero : scale(one.w_scale, vectorAt(one.w, 3 * k));
  }

  position(body: number, k: number): Vector {
    const one = this.track.bodies[body];
    if (one === undefined) return zero;
    const [x, y, z] = scale(one.p_scale, vectorAt(one.p, 3 * k));
    return [(one.p_start[0] ?? 0) + x, (one.p_start[1] ?? 0) + y, (one.p_start[2] ?? 0) + z];
  }

  velocity(body: number, k: number): Vector {
    const one = this.track.bodies[body];
    return one === undefined ? zero : scale(one.v_scale, vectorAt(one.v, 3 * k));
  }

  /** Placement of a body at a time; clamped to the first and the last keyframe. */
  at(body: number, t: number): Placement {
    const { times } = this;
    const last = times.length - 1;
    if (last < 0) return { attitude: identity, angularVelocity: zero, position: zero };
    const single = last === 0 || t <= (times[0] ?? 0) ? 0 : t >= this.end ? last : -1;
    if (single >= 0) {
      return {
        attitude: this.attitude(body, single),
        angularVelocity: this.angularVelocity(body, single),
        position: this.position(body, single),
      };
    }
    const k = findInterval(times, t);
    const begin = times[k] ?? 0;
    const h = (times[k + 1] ?? 0) - begin;
    const s = h > 0 ? (t - begin) / h : 0;
    const turned = attitudeBetween(
      this.attitude(body, k), this.angularVelocity(body, k),
      this.attitude(body, k + 1), this.angularVelocity(body, k + 1), h, s,
    );
    const moves = (this.track.bodies[body]?.p.length ?? 0) > 0;
    const position = moves
      ? positionBetween(this.position(body, k), this.velocity(body, k), this.position(body, k + 1), this.velocity(body, k + 1), h, s)
      : this.position(body, 0);
    if (this.consistent) return { ...turned, position };
    const angularVelocity = positionBetween(
      this.angularVelocity(body, k), this.angularAcceleration(body, k), this.angularVelocity(body, k + 1), this.angularAcceleration(body, k + 1), h, s,
    );
    return { attitude: turned.attitude, angularVelocity, position };
  }

  /** Times for drawing curves: each interval divided into `parts`, up to the time `until`. */
  dense(parts: number, until = this.end): number[] {
    const made: number[] = [];
    for (let k = 0; k + 1 < this.times.length; ++k) {
      const begin = this.times[k] ?? 0;
      const h = (this.times[k + 1] ?? 0) - begin;
      for (let i = 0; i < parts; ++i) {
        const t = begin + (i / parts) * h;
        if (t >= until) return [...made, until];
        made.push(t);
      }
    }
    made.push(Math.min(until, this.end));
    return made;
  }
}
