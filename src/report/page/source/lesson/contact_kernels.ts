// Contact updates of engines and of Moreau and Jean, as in integrators/contact_stepping/contact_impulses.cpp and
// moreau_jean.cpp, for one body with one contact point. tests/report/contact_units.test.ts compares them with the
// program.

import { add, conjugate, cross, dot, length, multiply, normalized, type Quaternion, rotate, scale, subtract, type Vector } from "../motion/algebra.ts";
import { type ContactBody, contactAxes, type ContactState, inverseInertiaInWorld, lowestPoint } from "./contact.ts";
import type { Kernel } from "./kernels.ts";
import { combine, fromRotationVector, inverseOf, type Matrix, product, rotationMatrix, skew, transform, transposed } from "./mechanics.ts";

/** The contact at a fixed configuration. Impulses and velocities are along its axes n, t1, t2. */
interface Constraint {
  axes: [Vector, Vector, Vector];
  moments: [Vector, Vector, Vector]; // r x axis
  turns: [Vector, Vector, Vector]; // I^-1 (r x axis)
  K: Matrix; // 1/kg
  gap: number; // m
  approach: number; // m/s
}

/** Velocity of the centre of mass and angular velocity, world axes. */
interface Twist {
  v: Vector;
  w: Vector;
}

const velocityAlong = (c: Constraint, i: 0 | 1 | 2, u: Twist): number => dot(c.axes[i], u.v) + dot(c.moments[i], u.w);

function applyImpulse(body: ContactBody, c: Constraint, i: 0 | 1 | 2, p: number, u: Twist): void {
  u.v = combine(u.v, p / body.mass, c.axes[i]);
  u.w = combine(u.w, p, c.turns[i]);
}

/** A gap below this value counts as closed, m. */
const rounding = (body: ContactBody, p: Vector): number => 16 * Number.EPSILON * (body.contact.reach + length(p));

/** The contact if its gap is at most `margin`, with the velocity `u`. */
function constraintAt(body: ContactBody, { q, p }: { q: Quaternion; p: Vector }, u: Twist, margin: number): Constraint | null {
  const { normal, offset } = body.contact;
  const n = rotate(conjugate(q), normal);
  const point = lowestPoint(body.contact, n);
  const gap = dot(normal, p) - offset + dot(n, point);
  if (gap > margin) return null;
  const inverse = inverseInertiaInWorld(body, q);
  const arm = rotate(q, point);
  const axes = contactAxes(normal);
  const each = <T>(of: (axis: Vector, i: number) => T): [T, T, T] => axes.map(of) as [T, T, T];
  const moments = each((axis) => cross(arm, axis));
  const turns = each((_, i) => transform(inverse, moments[i] as Vector));
  const K = each((_, i) => each((__, k) => dot(moments[i] as Vector, turns[k] as Vector) + (i === k ? 1 / body.mass : 0)));
  const constraint = { axes, moments, turns, K, gap, approach: 0 };
  constraint.approach = velocityAlong(constraint, 0, u);
  return constraint;
}

interface ImpulseOptions {
  cone: boolean; // friction in a circular cone instead of a pyramid
  split: boolean; // the correction of penetration does not change the velocity
  warm: boolean; // starts from the impulse of the last step
}

const sweeps = 10;
const correctedShare = 0.2;

/** One sweep over the contact: friction, then the normal impulse. `p` is changed. */
function sweep(body: ContactBody, c: Constraint, target: number, { cone }: ImpulseOptions, p: [number, number, number], u: Twist): void {
  const set = (i: 0 | 1 | 2, value: number): void => {
    applyImpulse(body, c, i, value - p[i], u);
    p[i] = value;
  };
  const limit = body.contact.friction * p[0];
  if (body.contact.friction > 0 && !cone) {
    for (const i of [1, 2] as const) set(i, Math.min(limit, Math.max(-limit, p[i] - velocityAlong(c, i, u) / c.K[i][i])));
  } else if (body.contact.friction > 0) {
    const largest = (c.K[1][1] + c.K[2][2]) / 2 + Math.hypot((c.K[1][1] - c.K[2][2]) / 2, c.K[1][2]);
    const tried = [p[1] - velocityAlong(c, 1, u) / largest, p[2] - velocityAlong(c, 2, u) / largest] as const;
    const size = Math.hypot(tried[0], tried[1]);
    const part = size > limit ? limit / size : 1;
    set(1, tried[0] * part);
    set(2, tried[1] * part);
  }
  set(0, Math.max(0, p[0] - (velocityAlong(c, 0, u) - target) / c.K[0][0]));
}

/** h I^-1 of one Newton step of the gyroscopic term (gyroscopic_term.h). */
function gyroscopicStep(body: ContactBody, w: Vector, h: number): Vector {
  const L = transform(body.tensor, w);
  const slope = product(skew(w), body.tensor);
  const turn = skew(L);
  const J = product(body.inverse, slope.map((row, i) => scale(h, subtract(row, turn[i] as Vector))) as unknown as Matrix);
  const near = J.map((row, i) => row.map((x, k) => x + (i === k ? 1 : 0))) as unknown as Matrix;
  return add(w, transform(inverseOf(near), scale(h, transform(body.inverse, cross(L, w)))));
}

const contactKernel = (name: string, about: string, start: (body: ContactBody, state: ContactState) => { step(h: number): void; state(): ContactState }): Kernel => ({
  name, about,
  start(given, q, w, at) {
    const body = given as ContactBody;
    const made = start(body, { q, w, ...(at ?? { p: [0, 0, 0], v: [0, 0, 0] }) });
    return { step: made.step, q: () => made.state().q, w: () => made.state().w, at: () => made.state() };
  },
});

function contactImpulses(name: string, about: string, options: ImpulseOptions): Kernel {
  return contactKernel(name, about, (body, state) => {
    let { q, p } = state;
    let [v, w] = [state.v, rotate(q, state.w)]; // world axes
    let stored: [number, number, number] = [0, 0, 0];
    return {
      step(h) {
        const R = rotationMatrix(q);
        const c = constraintAt(body, { q, p }, { v, w }, rounding(body, p));
        const u: Twist = { v: combine(v, h / body.mass, body.weight), w: transform(R, gyroscopicStep(body, transform(transposed(R), w), h)) };
        const impulse: [number, number, number] = [0, 0, 0];
        const correction: Twist = { v: [0, 0, 0], w: [0, 0, 0] };
        if (c !== null) {
          if (options.warm) {
            impulse.splice(0, 3, ...stored);
            for (const i of [0, 1, 2] as const) applyImpulse(body, c, i, impulse[i], u);
          }
          const push = (-correctedShare * c.gap) / h;
          const target = Math.max(0, -body.contact.restitution * c.approach, options.split ? 0 : push);
          for (let i = 0; i < sweeps; ++i) sweep(body, c, target, options, impulse, u);
          let pushed = 0;
          for (let i = 0; options.split && i < sweeps; ++i) {
            const next = Math.max(0, pushed - (velocityAlong(c, 0, correction) - push) / c.K[0][0]);
            applyImpulse(body, c, 0, next - pushed, correction);
            pushed = next;
          }
        }
        stored = c === null ? [0, 0, 0] : impulse;
        ({ v, w } = u);
        q = normalized(multiply(fromRotationVector(scale(h, add(w, correction.w))), q));
        p = combine(p, h, add(v, correction.v));
      },
      state: () => ({ q, w: rotate(conjugate(q), w), p, v }),
    };
  });
}

/** The solution of (K + diag(0, a, a)) p = -b. */
function solveWithSlip(K: Matrix, a: number, b: Vector): Vector {
  const M: Matrix = [K[0], [K[1][0], K[1][1] + a, K[1][2]], [K[2][0], K[2][1], K[2][2] + a]];
  return scale(-1, transform(inverseOf(M), b));
}

/** The impulse with 0 <= p_n, 0 <= u_n, p_n u_n = 0, |p_t| <= mu p_n against the slip (coulomb_cone.h). */
function coulombImpulse(K: Matrix, b: Vector, mu: number): Vector {
  if (!(b[0] < 0)) return [0, 0, 0];
  if (!(mu > 0)) return [-b[0] / K[0][0], 0, 0];
  const k = (K[1][1] + K[2][2]) / 2;
  const cone = (p: Vector): number => mu * p[0] - Math.hypot(p[1], p[2]);
  let p = solveWithSlip(K, 0, b);
  let g = cone(p);
  if (g >= 0 && p[0] >= 0) return p;
  let [low, lowValue, high, highValue] = [0, g, 1, mu * (-b[0] / K[0][0])];
  for (let i = 0; i < 100; ++i) {
    let s = (low * highValue - high * lowValue) / (highValue - lowValue);
    if (!(s > low && s < high)) s = (low + high) / 2;
    if (!(s > low && s < high)) break;
    p = solveWithSlip(K, (k * s) / (1 - s), b);
    const before = g;
    g = cone(p);
    if (!(Math.abs(g) > 2 * Number.EPSILON * mu * Math.abs(p[0]))) break;
    if (g < 0) {
      [low, lowValue] = [s, g];
      if (before < 0) highValue /= 2;
    } else {
      [high, highValue] = [s, g];
      if (before > 0) lowValue /= 2;
    }
  }
  return p;
}

/** The theta scheme with theta = 1/2: averages of both ends, solved by fixed-point iteration to rounding. */
const moreauJean = contactKernel("moreau_jean", "the theta scheme of Moreau and Jean: order 2 while sliding and rolling", (body, start) => {
  let { q, w, p, v } = start; // w in body axes
  const gravity = scale(1 / body.mass, body.weight);
  const rate = (spin: Vector): Vector => transform(body.inverse, cross(transform(body.tensor, spin), spin));
  const reach = body.contact.reach;
  return {
    step(h) {
      const R = rotationMatrix(q);
      const spin = rotate(q, w);
      const tiny = rounding(body, p);
      let c = constraintAt(body, { q, p }, { v, w: spin }, tiny + (h / 2) * (length(v) + reach * length(spin)));
      if (c !== null && c.gap + (h / 2) * c.approach > tiny) c = null;
      const [from, first] = [{ q, w, p, v }, rate(w)];
      let [end, smallest] = [first, Infinity];
      for (let i = 0; i < 100; ++i) {
        const last = { v, w };
        v = combine(from.v, h, gravity);
        w = combine(from.w, h / 2, add(first, end));
        if (c !== null) {
          const u: Twist = { v, w: transform(R, w) };
          const b: Vector = [velocityAlong(c, 0, u) + body.contact.restitution * c.approach, velocityAlong(c, 1, u), velocityAlong(c, 2, u)];
          const impulse = coulombImpulse(c.K, b, body.contact.friction);
          for (const k of [0, 1, 2] as const) applyImpulse(body, c, k, impulse[k], u);
          v = u.v;
          w = transform(transposed(R), u.w);
        }
        q = normalized(multiply(from.q, fromRotationVector(scale(h / 2, add(from.w, w)))));
        p = combine(from.p, h / 2, add(from.v, v));
        if (i > 0) {
          const [dv, dw] = [subtract(v, last.v), subtract(w, last.w)];
          const sizes = [dot(v, v) + h * h * dot(gravity, gravity), dot(w, w) + h * h * dot(first, first)] as const;
          const change = dot(dw, dw) / (1e-300 + sizes[1] + sizes[0] / reach ** 2) + dot(dv, dv) / (1e-300 + sizes[0] + reach ** 2 * sizes[1]);
          if (change === 0 || (smallest < (1024 * Number.EPSILON) ** 2 && change >= smallest)) break;
          smallest = Math.min(smallest, change);
        }
        const next = rate(w);
        if (next.every((x, k) => x === end[k])) break;
        end = next;
      }
    },
    state: () => ({ q, w, p, v }),
  };
});

/** All contact updates of the page. */
export const contactKernels: readonly Kernel[] = [
  contactImpulses("contact_impulses_cone", "sequential impulses with a circular friction cone, as game engines", { cone: true, split: true, warm: true }),
  contactImpulses("contact_impulses_cone_cold", "the same without warm start", { cone: true, split: true, warm: false }),
  contactImpulses("contact_impulses_cone_baumgarte", "penetration corrected by a velocity that remains", { cone: true, split: false, warm: true }),
  contactImpulses("contact_impulses_pyramid", "friction in a pyramid of four sides", { cone: false, split: true, warm: true }),
  moreauJean,
];
