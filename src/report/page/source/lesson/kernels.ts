// Updates of games and textbooks, as in integrators/game/gyroscopic.cpp, engine_updates.cpp and baraff_witkin.cpp, with
// the same names. tests/report/lesson_units.test.ts compares each with the program.
//
// A step of length h of the engine updates: w += h I_W^-1 tau at the old attitude; the gyroscopic term in body axes;
// q = exp(h w) q with the new w in world axes.

import { add, conjugate, cross, length, multiply, normalized, type Quaternion, rotate, scale, subtract, type Vector } from "../motion/algebra.ts";
import { type Body, combine, fromRotationVector, inverseOf, type Matrix, product, rotationMatrix, skew, torqueOf, transform, transposed } from "./mechanics.ts";

/** A method that advances one motion. */
export interface Stepper {
  step(h: number): void;
  q(): Quaternion;
  w(): Vector; // rad/s, body axes
  at?(): { p: Vector; v: Vector }; // contact updates: centre of mass and its velocity, world axes
}

export interface Kernel {
  name: string;
  about: string;
  start(body: Body, q: Quaternion, w: Vector, at?: { p: Vector; v: Vector }): Stepper;
}

type Term = (body: Body, w: Vector, h: number) => Vector;

/** 1 + h I^-1 M, inverted. */
function solveNear(body: Body, m: Matrix, h: number, right: Vector): Vector {
  const J = product(body.inverse, m).map((row, i) => row.map((x, j) => h * x + (i === j ? 1 : 0))) as unknown as Matrix;
  return transform(inverseOf(J), right);
}

const minus = (a: Matrix, b: Matrix): Matrix => [subtract(a[0], b[0]), subtract(a[1], b[1]), subtract(a[2], b[2])];
const negative = (a: Matrix): Matrix => [scale(-1, a[0]), scale(-1, a[1]), scale(-1, a[2])];

/** h I^-1 (L x w) with L = I w. */
const gyroscopicChange = (body: Body, w: Vector, h: number): Vector => scale(h, transform(body.inverse, cross(transform(body.tensor, w), w)));
/** skew(w) I - skew(I w), the derivative of w x I w. */
const gyroscopicSlope = (body: Body, w: Vector): Matrix => minus(product(skew(w), body.tensor), skew(transform(body.tensor, w)));

const none: Term = (_, w) => w;
const explicit: Term = (body, w, h) => add(w, gyroscopicChange(body, w, h));
const oneNewtonStep: Term = (body, w, h) => add(w, solveNear(body, gyroscopicSlope(body, w), h, gyroscopicChange(body, w, h)));
const linearlyImplicit: Term = (body, w, h) => add(w, solveNear(body, negative(skew(transform(body.tensor, w))), h, gyroscopicChange(body, w, h)));

/** m - w + (h/2) I^-1 (m x I m) = 0 by Newton's method to rounding; the result is 2 m - w. */
const midpoint: Term = (body, w, h) => {
  let mean = w;
  let before = Infinity;
  for (let i = 0; i < 20; ++i) {
    const change = solveNear(body, gyroscopicSlope(body, mean), h / 2, subtract(subtract(mean, w), gyroscopicChange(body, mean, h / 2)));
    mean = subtract(mean, change);
    const size = length(change);
    if (!(size < before)) break;
    before = size;
  }
  return subtract(scale(2, mean), w);
};

const rescaledMomentum: Term = (body, w, h) => {
  const L = transform(body.tensor, w);
  const after = combine(L, h, cross(L, w));
  return length(after) > 0 ? transform(body.inverse, scale(length(L) / length(after), after)) : w;
};

/** exp(h w) q, w in world axes. */
const turned = (q: Quaternion, w: Vector, h: number): Quaternion => normalized(multiply(fromRotationVector(scale(h, w)), q));

/** q + (h/2) (0, w) q, normalised. */
function turnedFirstOrder(q: Quaternion, w: Vector, h: number): Quaternion {
  const d = multiply([0, w[0], w[1], w[2]], q);
  return normalized([q[0] + (h / 2) * d[0], q[1] + (h / 2) * d[1], q[2] + (h / 2) * d[2], q[3] + (h / 2) * d[3]]);
}

function engine(name: string, about: string, term: Term, turn = turned, substeps = 1): Kernel {
  return {
    name, about,
    start(body, start, angularVelocity) {
      let q = start;
      let w = rotate(q, angularVelocity); // world axes
      return {
        step(step) {
          const h = step / substeps;
          const torque = torqueOf(body, rotationMatrix(q));
          for (let i = 0; i < substeps; ++i) {
            const R = rotationMatrix(q);
            const back = transposed(R);
            w = combine(w, h, transform(R, transform(body.inverse, transform(back, torque))));
            w = transform(R, term(body, transform(back, w), h));
            q = turn(q, w, h);
          }
        },
        q: () => q,
        w: () => rotate(conjugate(q), w),
      };
    },
  };
}

/** L += h tau; w = I_W^-1 L at the old attitude; q = exp(h w) q. */
const momentumUpdate: Kernel = {
  name: "momentum_exponential_map",
  about: "keeps the angular momentum in world axes; w = I⁻¹L at the old attitude",
  start(body, start, angularVelocity) {
    let q = start;
    let L = rotate(q, transform(body.tensor, angularVelocity));
    const spin = (): Vector => transform(body.inverse, transform(transposed(rotationMatrix(q)), L));
    return {
      step(h) {
        const R = rotationMatrix(q);
        L = combine(L, h, torqueOf(body, R));
        q = turned(q, transform(R, spin()), h);
      },
      q: () => q,
      w: spin,
    };
  },
};

/** State q (not normalised) and L in world axes: dq/dt = (0, w) q / 2, dL/dt = tau. */
function baraffWitkin(name: string, about: string, scheme: "euler" | "rk4"): Kernel {
  type Rate = { q: Quaternion; L: Vector };
  return {
    name, about,
    start(body, start, angularVelocity) {
      let q = start;
      let L = rotate(q, transform(body.tensor, angularVelocity));
      const rate = (y: Rate): Rate => {
        const R = rotationMatrix(normalized(y.q));
        const w = transform(R, transform(body.inverse, transform(transposed(R), y.L)));
        return { q: multiply([0, w[0] / 2, w[1] / 2, w[2] / 2], y.q), L: torqueOf(body, R) };
      };
      const moved = (y: Rate, h: number, k: Rate): Rate => ({
        q: [y.q[0] + h * k.q[0], y.q[1] + h * k.q[1], y.q[2] + h * k.q[2], y.q[3] + h * k.q[3]], L: combine(y.L, h, k.L),
      });
      return {
        step(h) {
          let y: Rate = { q, L };
          const k1 = rate(y);
          if (scheme === "euler") y = moved(y, h, k1);
          else {
            const k2 = rate(moved(y, h / 2, k1));
            const k3 = rate(moved(y, h / 2, k2));
            const k4 = rate(moved(y, h, k3));
            y = moved(moved(moved(moved(y, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
          }
          ({ q, L } = y);
        },
        q: () => normalized(q),
        w: () => transform(body.inverse, rotate(conjugate(normalized(q)), L)),
      };
    },
  };
}

/** All updates without contact. */
export const kernels: readonly Kernel[] = [
  engine("gyroscopic_none", "no gyroscopic term", none),
  engine("gyroscopic_explicit", "gyroscopic term by an explicit Euler step", explicit),
  engine("gyroscopic_implicit", "gyroscopic term by one Newton step of implicit Euler", oneNewtonStep),
  engine("gyroscopic_linearly_implicit", "gyroscopic term by one linear system", linearlyImplicit),
  engine("midpoint_gyroscopic", "gyroscopic term by the implicit midpoint rule", midpoint),
  engine("gyroscopic_rescaled_momentum", "momentum in body axes, rescaled to its length", rescaledMomentum),
  engine("gyroscopic_substepped", "the same in four substeps", rescaledMomentum, turned, 4),
  engine("first_order_quaternion", "explicit gyroscopic term and first-order quaternion", explicit, turnedFirstOrder),
  momentumUpdate,
  baraffWitkin("baraff_witkin_euler", "q and L by explicit Euler steps", "euler"),
  baraffWitkin("baraff_witkin_rk4", "q and L by the classical Runge–Kutta method of order 4", "rk4"),
];
