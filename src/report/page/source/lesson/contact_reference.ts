// Reference of a lesson with contact: the exact laws of the program's reference (Coulomb friction, sliding and rolling),
// followed from event to event. Between events, extrapolation of the modified midpoint rule (W. B. Gragg 1965, SIAM
// Journal on Numerical Analysis 2, 384) to rounding.
//
// With s the contact point from the centre of mass in body axes, F the force on the body and n the normal:
//   v' = g + F / m,   I w' = I w x w + s x R^T F,   u = v + R (w x s),   u' = b + K F
//   b = g + R (w x (w x s) + (I^-1 (I w x w)) x s + w x s'),   K = 1/m - R [s] I^-1 [s] R^T
// Sliding: F = N (n - mu u_t/|u_t|) with n . u' = 0. Rolling: K F = -b, while |F_t| <= mu N.
// A body that leaves the plane ends the reference: impacts are not followed.

import { add, cross, dot, length, normalized, type Quaternion, rotate, scale, type Vector } from "../motion/algebra.ts";
import { type ContactBody, type ContactState } from "./contact.ts";
import { inverseOf, type Matrix, transform } from "./mechanics.ts";

export type Mode = "slides" | "rolls";

/** A change of the mode, or the end of the contact. */
export interface ContactEvent {
  t: number; // s
  mode: Mode | "lifts_off";
}

export interface ContactMotion {
  samples: ({ t: number } & ContactState)[]; // fewer than asked if the body leaves the plane
  events: ContactEvent[]; // the first is at t = 0
}

/** The contact at a state. Vectors are in body axes. */
interface Dynamics {
  normal: number; // N
  fx: number; // friction, N
  fy: number;
  fz: number;
  ux: number; // velocity at the contact, m/s
  uy: number;
  uz: number;
  slip: number; // |u_t|, m/s
  closing: number; // u_t . du_t/dt, m^2/s^3
  rx: number; // du_t/dt, m/s^2
  ry: number;
  rz: number;
  nx: number; // normal
  ny: number;
  nz: number;
}

const pack = ({ q, w, p, v }: ContactState): number[] => [...q, ...w, ...p, ...v];
function unpack(y: Float64Array): ContactState {
  const vector = (i: number): Vector => [y[i] as number, y[i + 1] as number, y[i + 2] as number];
  return { q: [y[0] as number, ...vector(1)] as Quaternion, w: vector(4), p: vector(7), v: vector(10) };
}

const at = (list: ArrayLike<number>, i: number): number => list[i] as number;
const flat = (m: Matrix): number[] => [...m[0], ...m[1], ...m[2]];

const mostColumns = 9;
const mostSteps = 100_000;

/** Follows one motion. */
class Follower {
  private mode: Mode = "rolls";
  private leaving = false; // slides since a state without slip, in `direction`
  private direction: Vector = [0, 0, 0]; // body axes
  private readonly scales: number[];
  private readonly still: number; // m/s: a slip below this value is zero
  private readonly tensor: number[];
  private readonly inverse: number[];
  private readonly shape: number[];

  constructor(private readonly body: ContactBody, fastest: number) {
    const reach = body.contact.reach;
    const three = (x: number): number[] => [x, x, x];
    this.scales = [1, 1, 1, 1, ...three(fastest / reach), ...three(reach), ...three(fastest)];
    this.still = 1e-12 * fastest;
    [this.tensor, this.inverse, this.shape] = [flat(body.tensor), flat(body.inverse), flat(body.contact.axes)];
  }

  /** Writes dy/dt and `contact`. In scalars and body axes, without allocation, because it takes most of the time.
   * `forced`: direction of the slip instead of the state's. */
  private rate(y: ArrayLike<number>, dy: Float64Array, mode: Mode = this.mode, forced: Vector | null = null): void {
    const { body, tensor: I, inverse: J, shape: A } = this;
    const { center, radius, normal, friction } = body.contact;
    const [q0, q1, q2, q3] = [at(y, 0), at(y, 1), at(y, 2), at(y, 3)];
    const [wx, wy, wz] = [at(y, 4), at(y, 5), at(y, 6)];
    // R = body to world
    const unit = 1 / (q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3);
    const [r00, r01, r02] = [(q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3) * unit, 2 * (q1 * q2 - q0 * q3) * unit, 2 * (q1 * q3 + q0 * q2) * unit];
    const [r10, r11, r12] = [2 * (q1 * q2 + q0 * q3) * unit, (q0 * q0 - q1 * q1 + q2 * q2 - q3 * q3) * unit, 2 * (q2 * q3 - q0 * q1) * unit];
    const [r20, r21, r22] = [2 * (q1 * q3 - q0 * q2) * unit, 2 * (q2 * q3 + q0 * q1) * unit, (q0 * q0 - q1 * q1 - q2 * q2 + q3 * q3) * unit];
    const [N0, N1, N2] = normal;
    const [nx, ny, nz] = [r00 * N0 + r10 * N1 + r20 * N2, r01 * N0 + r11 * N1 + r21 * N2, r02 * N0 + r12 * N1 + r22 * N2];
    // contact point s and its velocity over the body, with dn/dt = n x w
    const [tx, ty, tz] = [ny * wz - nz * wy, nz * wx - nx * wz, nx * wy - ny * wx];
    let [sx, sy, sz] = [center[0] - radius * nx, center[1] - radius * ny, center[2] - radius * nz];
    let [ex, ey, ez] = [-radius * tx, -radius * ty, -radius * tz];
    const [mx, my, mz] = [at(A, 0) * nx + at(A, 3) * ny + at(A, 6) * nz, at(A, 1) * nx + at(A, 4) * ny + at(A, 7) * nz, at(A, 2) * nx + at(A, 5) * ny + at(A, 8) * nz];
    const square = mx * mx + my * my + mz * mz;
    if (square > 0) {
      const over = 1 / Math.sqrt(square);
      sx -= over * (at(A, 0) * mx + at(A, 1) * my + at(A, 2) * mz);
      sy -= over * (at(A, 3) * mx + at(A, 4) * my + at(A, 5) * mz);
      sz -= over * (at(A, 6) * mx + at(A, 7) * my + at(A, 8) * mz);
      const [ux, uy, uz] = [at(A, 0) * tx + at(A, 3) * ty + at(A, 6) * tz, at(A, 1) * tx + at(A, 4) * ty + at(A, 7) * tz, at(A, 2) * tx + at(A, 5) * ty + at(A, 8) * tz];
      const share = (mx * ux + my * uy + mz * uz) / square;
      const [bx, by, bz] = [ux - share * mx, uy - share * my, uz - share * mz];
      ex -= over * (at(A, 0) * bx + at(A, 1) * by + at(A, 2) * bz);
      ey -= over * (at(A, 3) * bx + at(A, 4) * by + at(A, 5) * bz);
      ez -= over * (at(A, 6) * bx + at(A, 7) * by + at(A, 8) * bz);
    }
    // I^-1 (I w x w)
    const [lx, ly, lz] = [at(I, 0) * wx + at(I, 1) * wy + at(I, 2) * wz, at(I, 3) * wx + at(I, 4) * wy + at(I, 5) * wz, at(I, 6) * wx + at(I, 7) * wy + at(I, 8) * wz];
    const [cx, cy, cz] = [ly * wz - lz * wy, lz * wx - lx * wz, lx * wy - ly * wx];
    const [fx, fy, fz] = [at(J, 0) * cx + at(J, 1) * cy + at(J, 2) * cz, at(J, 3) * cx + at(J, 4) * cy + at(J, 5) * cz, at(J, 6) * cx + at(J, 7) * cy + at(J, 8) * cz];
    // u = v + w x s, b = g + w x (w x s + s') + f x s
    const [px, py, pz] = [wy * sz - wz * sy, wz * sx - wx * sz, wx * sy - wy * sx];
    const [vx, vy, vz] = [at(y, 10), at(y, 11), at(y, 12)];
    const [ax, ay, az] = [r00 * vx + r10 * vy + r20 * vz + px, r01 * vx + r11 * vy + r21 * vz + py, r02 * vx + r12 * vy + r22 * vz + pz];
    const light = 1 / body.mass;
    const [G0, G1, G2] = body.weight;
    const [gx, gy, gz] = [light * (r00 * G0 + r10 * G1 + r20 * G2), light * (r01 * G0 + r11 * G1 + r21 * G2), light * (r02 * G0 + r12 * G1 + r22 * G2)];
    const [hx, hy, hz] = [px + ex, py + ey, pz + ez];
    const b0 = gx + wy * hz - wz * hy + fy * sz - fz * sy;
    const b1 = gy + wz * hx - wx * hz + fz * sx - fx * sz;
    const b2 = gz + wx * hy - wy * hx + fx * sy - fy * sx;
    const out = ax * nx + ay * ny + az * nz;
    const [slipX, slipY, slipZ] = [ax - out * nx, ay - out * ny, az - out * nz];
    const slip = Math.sqrt(slipX * slipX + slipY * slipY + slipZ * slipZ);
    [this.sx, this.sy, this.sz] = [sx, sy, sz];
    const e = this.effect;
    let [X, Y, Z] = [0, 0, 0];
    if (mode === "rolls") {
      // F = -K^-1 b by cofactors; K is symmetric
      this.apply(1, 0, 0);
      const [k00, k01, k02] = [at(e, 0), at(e, 1), at(e, 2)];
      this.apply(0, 1, 0);
      const [k11, k12] = [at(e, 1), at(e, 2)];
      this.apply(0, 0, 1);
      const k22 = at(e, 2);
      const [i00, i01, i02] = [k11 * k22 - k12 * k12, k02 * k12 - k01 * k22, k01 * k12 - k02 * k11];
      const [i11, i12, i22] = [k00 * k22 - k02 * k02, k01 * k02 - k00 * k12, k00 * k11 - k01 * k01];
      const over = -1 / (k00 * i00 + k01 * i01 + k02 * i02);
      X = over * (i00 * b0 + i01 * b1 + i02 * b2);
      Y = over * (i01 * b0 + i11 * b1 + i12 * b2);
      Z = over * (i02 * b0 + i12 * b1 + i22 * b2);
    } else {
      const along = forced ?? (this.leaving && slip <= this.still ? this.direction : null);
      const part = friction / slip;
      if (along === null) [X, Y, Z] = [nx - part * slipX, ny - part * slipY, nz - part * slipZ];
      else [X, Y, Z] = [nx - friction * along[0], ny - friction * along[1], nz - friction * along[2]];
      this.apply(X, Y, Z);
      const size = -(b0 * nx + b1 * ny + b2 * nz) / (at(e, 0) * nx + at(e, 1) * ny + at(e, 2) * nz);
      [X, Y, Z] = [size * X, size * Y, size * Z];
    }
    this.apply(X, Y, Z);
    dy[0] = -0.5 * (q1 * wx + q2 * wy + q3 * wz);
    dy[1] = 0.5 * (q0 * wx + q2 * wz - q3 * wy);
    dy[2] = 0.5 * (q0 * wy + q3 * wx - q1 * wz);
    dy[3] = 0.5 * (q0 * wz + q1 * wy - q2 * wx);
    [dy[4], dy[5], dy[6]] = [fx + at(e, 3), fy + at(e, 4), fz + at(e, 5)];
    [dy[7], dy[8], dy[9]] = [vx, vy, vz];
    dy[10] = light * (G0 + r00 * X + r01 * Y + r02 * Z);
    dy[11] = light * (G1 + r10 * X + r11 * Y + r12 * Z);
    dy[12] = light * (G2 + r20 * X + r21 * Y + r22 * Z);
    const now = this.contact;
    const [rx, ry, rz] = [b0 + at(e, 0), b1 + at(e, 1), b2 + at(e, 2)];
    const rise = rx * nx + ry * ny + rz * nz;
    now.normal = X * nx + Y * ny + Z * nz;
    [now.fx, now.fy, now.fz] = [X - now.normal * nx, Y - now.normal * ny, Z - now.normal * nz];
    [now.ux, now.uy, now.uz] = [ax, ay, az];
    now.slip = slip;
    now.closing = slipX * rx + slipY * ry + slipZ * rz;
    [now.rx, now.ry, now.rz] = [rx - rise * nx, ry - rise * ny, rz - rise * nz];
    [now.nx, now.ny, now.nz] = [nx, ny, nz];
  }
  private sx = 0;
  private sy = 0;
  private sz = 0;
  private readonly effect = new Float64Array(6);
  /** The effect of a force F: K F = F/m + (I^-1 (s x F)) x s, then I^-1 (s x F). */
  private apply(X: number, Y: number, Z: number): void {
    const { effect, inverse: J, sx, sy, sz } = this;
    const light = 1 / this.body.mass;
    const [mx, my, mz] = [sy * Z - sz * Y, sz * X - sx * Z, sx * Y - sy * X];
    const kx = at(J, 0) * mx + at(J, 1) * my + at(J, 2) * mz;
    const ky = at(J, 3) * mx + at(J, 4) * my + at(J, 5) * mz;
    const kz = at(J, 6) * mx + at(J, 7) * my + at(J, 8) * mz;
    effect[0] = light * X + ky * sz - kz * sy;
    effect[1] = light * Y + kz * sx - kx * sz;
    effect[2] = light * Z + kx * sy - ky * sx;
    effect[3] = kx;
    effect[4] = ky;
    effect[5] = kz;
  }
  private readonly contact: Dynamics = { normal: 0, fx: 0, fy: 0, fz: 0, ux: 0, uy: 0, uz: 0, slip: 0, closing: 0, rx: 0, ry: 0, rz: 0, nx: 0, ny: 0, nz: 0 };
  private readonly scratch = new Float64Array(13);
  private dynamics(y: ArrayLike<number>, mode: Mode = this.mode, forced: Vector | null = null): Dynamics {
    this.rate(y, this.scratch, mode, forced);
    return { ...this.contact };
  }

  /** The mode at a state without slip, and the direction in which it starts to slip. */
  private settle(y: Float64Array): void {
    const rolling = this.dynamics(y, "rolls");
    this.leaving = false;
    this.mode = "rolls";
    const held = Math.hypot(rolling.fx, rolling.fy, rolling.fz);
    if (held <= this.body.contact.friction * rolling.normal * (1 + 1e-12)) {
      this.stop(y, rolling);
      return;
    }
    this.mode = "slides";
    this.leaving = true;
    const n: Vector = [rolling.nx, rolling.ny, rolling.nz];
    const first: Vector = [-rolling.fx / held, -rolling.fy / held, -rolling.fz / held];
    const second = cross(n, first);
    // the slip starts along d if its rate is along d: the component of the rate across d vanishes
    const along = (angle: number): Vector => add(scale(Math.cos(angle), first), scale(Math.sin(angle), second));
    const turn = (angle: number): number => {
      const { rx, ry, rz } = this.dynamics(y, "slides", along(angle));
      return dot(cross(along(angle), [rx, ry, rz]), n);
    };
    let [low, high] = [-Math.PI / 2, Math.PI / 2];
    const sign = Math.sign(turn(low));
    for (let i = 0; i < 60; ++i) {
      const middle = (low + high) / 2;
      if (Math.sign(turn(middle)) === sign) low = middle;
      else high = middle;
    }
    this.direction = along((low + high) / 2);
  }

  /** Removes the rest of the velocity at the contact by an impulse, -K^-1 u. `apply` knows the contact point of y. */
  private stop(y: Float64Array, { ux, uy, uz }: Dynamics): void {
    const row = (X: number, Y: number, Z: number): Vector => {
      this.apply(X, Y, Z);
      return [at(this.effect, 0), at(this.effect, 1), at(this.effect, 2)];
    };
    const [X, Y, Z] = transform(inverseOf([row(1, 0, 0), row(0, 1, 0), row(0, 0, 1)]), [-ux, -uy, -uz]);
    this.apply(X, Y, Z);
    const P = rotate(normalized(unpack(y).q), [X, Y, Z]);
    for (let i = 0; i < 3; ++i) {
      y[4 + i] = at(y, 4 + i) + at(this.effect, 3 + i);
      y[10 + i] = at(y, 10 + i) + at(P, i) / this.body.mass;
    }
  }

  /** The change of the state in h by Gragg's rule: the modified midpoint rule in 2 (k + 1) parts, smoothed. */
  private midpoint(y: Float64Array, first: Float64Array, h: number, k: number): Float64Array {
    const parts = 2 * (k + 1);
    const part = h / parts;
    const n = y.length;
    const { state, rates } = this;
    // changes, so that rounding is relative to them
    let last: Float64Array = new Float64Array(n);
    let now: Float64Array = new Float64Array(n);
    for (let i = 0; i < n; ++i) now[i] = part * at(first, i);
    for (let j = 1; j <= parts; ++j) {
      for (let i = 0; i < n; ++i) state[i] = at(y, i) + at(now, i);
      this.rate(state, rates);
      if (j === parts) break;
      for (let i = 0; i < n; ++i) last[i] = at(last, i) + 2 * part * at(rates, i);
      const swap = last;
      last = now;
      now = swap;
    }
    for (let i = 0; i < n; ++i) now[i] = (at(now, i) + at(last, i) + part * at(rates, i)) / 2;
    return now;
  }
  private readonly state = new Float64Array(13);
  private readonly rates = new Float64Array(13);

  /** The change in h by extrapolation, with the number of columns; null if it does not converge to rounding. */
  private advanced(y: Float64Array, h: number, rounding = 2e-16): { change: Float64Array; columns: number } | null {
    const first = new Float64Array(y.length);
    this.rate(y, first);
    let above: Float64Array[] = [];
    let best = Infinity;
    for (let k = 0; k < mostColumns; ++k) {
      const row = [this.midpoint(y, first, h, k)];
      for (let j = 1; j <= k; ++j) {
        const ratio = 1 / (((k + 1) / (k + 1 - j)) ** 2 - 1);
        const [left, before] = [row[j - 1] as Float64Array, above[j - 1] as Float64Array];
        const next = new Float64Array(left.length);
        for (let i = 0; i < next.length; ++i) next[i] = at(left, i) + ratio * (at(left, i) - at(before, i));
        row.push(next);
      }
      const [end, near] = [row[k] as Float64Array, above[k - 1]];
      const error = near === undefined ? Infinity : this.difference(end, near, y);
      if (error < 1e-17 || (best < rounding && error >= best)) return { change: end, columns: k + 1 };
      if (k > 0 && !(error < Infinity)) return null;
      best = Math.min(best, error);
      above = row;
    }
    return best < 1e-15 ? { change: above[mostColumns - 1] as Float64Array, columns: mostColumns } : null;
  }
  private after(y: Float64Array, h: number): Float64Array {
    const step = h > 0 ? this.advanced(y, h) : null;
    return step === null ? y : y.map((x, i) => x + at(step.change, i));
  }
  /** The largest difference of two changes, relative to the state. */
  private difference(a: Float64Array, b: Float64Array, y: Float64Array): number {
    let most = 0;
    for (let i = 0; i < a.length; ++i) {
      const one = Math.abs(at(a, i) - at(b, i)) / Math.max(at(this.scales, i), Math.abs(at(y, i)));
      if (!(one <= most)) most = one;
    }
    return most;
  }

  /** What must stay positive in the mode: the normal force, and when rolling the rest of the cone. */
  private margins(y: ArrayLike<number>): number[] {
    const { normal, fx, fy, fz } = this.dynamics(y);
    return this.mode === "rolls" ? [normal, this.body.contact.friction * normal - Math.hypot(fx, fy, fz)] : [normal];
  }

  /** The part of a step of length h after which a margin vanishes, by regula falsi (Illinois). */
  private crossing(y: Float64Array, h: number, which: number): number {
    const value = (part: number): number => this.margins(this.after(y, part))[which] ?? 0;
    let [low, lowValue, high, highValue] = [0, value(0), h, value(h)];
    for (let i = 0; i < 100 && high - low > 1e-16 * h; ++i) {
      let part = (low * highValue - high * lowValue) / (highValue - lowValue);
      if (!(part > low && part < high)) part = (low + high) / 2;
      if (!(part > low && part < high)) break;
      const now = value(part);
      if (now > 0) {
        [low, lowValue] = [part, now];
        highValue /= 2;
      } else {
        [high, highValue] = [part, now];
        lowValue /= 2;
      }
    }
    return high;
  }

  follow(start: ContactState, times: readonly number[]): ContactMotion {
    const events: ContactEvent[] = [];
    const samples: ContactMotion["samples"] = [];
    const note = (t: number, mode: ContactEvent["mode"]): void => void events.push({ t, mode });
    let t = 0;
    let y: Float64Array = Float64Array.from(pack(start));
    if (this.dynamics(y, "rolls").slip > this.still) this.mode = "slides";
    else this.settle(y);
    note(t, this.mode);
    if (this.dynamics(y).normal < 0) {
      note(t, "lifts_off");
      return { samples, events };
    }
    const shortest = 1e-9 * (times[times.length - 1] ?? 1);
    let h = 1e-3 * (times[times.length - 1] ?? 1);
    let steps = 0;
    const carry = new Float64Array(y.length);
    for (const target of times) {
      while (t < target) {
        if (++steps > mostSteps || !y.every(Number.isFinite)) return { samples, events };
        const now = this.dynamics(y);
        if (now.slip > this.still) this.leaving = false;
        const sticks = this.mode === "slides" && !this.leaving && now.closing < 0 ? -(now.slip ** 2) / now.closing : Infinity;
        if (this.mode === "slides" && !this.leaving && now.slip <= this.still) {
          // the rest of the way is below rounding
          const part = Math.min(sticks, target - t);
          this.rate(y, this.scratch);
          for (let i = 0; i < y.length; ++i) y[i] = at(y, i) + part * at(this.scratch, i);
          t += part;
          this.settle(y);
          note(t, this.mode);
          continue;
        }
        const rest = target - t;
        const tried = Math.min(h, rest, 0.9 * sticks);
        // short steps cannot be divided further
        const step = this.advanced(y, tried, tried > shortest ? 2e-16 : 1e-14);
        if (step === null) {
          h = tried / 2;
          continue;
        }
        const next = y.map((x, i) => x + (at(step.change, i) + at(carry, i)));
        const lost = this.margins(next).findIndex((margin) => margin < 0);
        if (lost >= 0 && (this.margins(y)[lost] ?? 0) > 0) {
          const part = this.crossing(y, tried, lost);
          y = this.after(y, part);
          t += part;
          if (lost === 0) {
            note(t, "lifts_off");
            return { samples, events };
          }
          this.settle(y);
          note(t, this.mode);
          h = Math.min(h, 1e-4 * tried);
          continue;
        }
        // the rounding of the sum is added in the next step (W. Kahan 1965)
        for (let i = 0; i < y.length; ++i) carry[i] = at(step.change, i) + at(carry, i) - (at(next, i) - at(y, i));
        y = next;
        t = tried === rest ? target : t + tried;
        if (step.columns < 6) h = Math.max(h, 1.5 * tried);
        else if (step.columns > 8) h = 0.7 * tried;
      }
      const state = unpack(y);
      samples.push({ t: target, ...state, q: normalized(state.q) });
    }
    return { samples, events };
  }
}

/** The motion at ascending times from t = 0, from a start that touches the plane and does not leave it. */
export function contactReference(body: ContactBody, start: ContactState, at: readonly number[]): ContactMotion {
  const reach = body.contact.reach;
  const gravity = length(body.weight) / body.mass;
  const fastest = Math.max(length(start.v), reach * length(start.w), Math.sqrt(gravity * reach));
  return new Follower(body, fastest).follow({ ...start, q: normalized(start.q) }, at);
}
