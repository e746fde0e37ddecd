// Tests the mathematics of the motion view against closed forms. Bundled and run by node's test runner.

import assert from "node:assert/strict";
import { test } from "node:test";
import type { BodyShape, Motion, MotionMethod, Track } from "../../src/report/page/source/data.ts";
import {
  add, angleBetween, cross, dot, length, multiply, norm, normalized, rotate, scale, subtract, type Quaternion, type Vector,
} from "../../src/report/page/source/motion/algebra.ts";
import { errorAt, firstMethods } from "../../src/report/page/source/motion/actors.ts";
import {
  angularMomentum, herpolhodeRadii, invariablePlane, isSeen, onPlane, outline, polhode, semiAxes, toPrincipal, twiceEnergy, worldMomentum,
} from "../../src/report/page/source/motion/ellipsoid.ts";
import { contactAt, frictionOf, plottedContacts, ratioOf, slipOf } from "../../src/report/page/source/motion/contacts.ts";
import { plottedJoints } from "../../src/report/page/source/motion/coordinate_plot.ts";
import { decades, errorAxes, errorCurves } from "../../src/report/page/source/motion/error_plot.ts";
import { azimuthOf } from "../../src/report/page/source/motion/extent.ts";
import { boxOfMoments, frustumCenter, outlineOf, surfaceOf, surfacesOf, tipOf } from "../../src/report/page/source/motion/geometry.ts";
import { eventTimes, impulseText, lookOf, modeAt, modesText, neighbour } from "../../src/report/page/source/motion/mode_strip.ts";
import { attitudeBetween, findInterval, Keyframes, positionBetween } from "../../src/report/page/source/motion/interpolation.ts";
import { linearRange, placeAt, tickText, ticks, valueAt } from "../../src/report/page/source/motion/time_plot.ts";
import { flips } from "./motion_flips.ts";
import { readPng, writePng } from "./motion_png.ts";
import { motionDocument } from "./motion_sample.ts";

const about = (axis: Vector, angle: number): Quaternion => {
  const s = scale(Math.sin(angle / 2) / length(axis), axis);
  return [Math.cos(angle / 2), s[0], s[1], s[2]];
};

// Free precession of a symmetric top (moments I_1, I_1, I_3): with L along z, its axis at the angle theta to it,
//   q(t) = Rz(precession t) Rx(theta) Rz(spin t),  precession = L / I_1,  spin = L cos(theta) (1 / I_3 - 1 / I_1),
// and in body axes w = (L sin(theta) sin(spin t) / I_1, L sin(theta) cos(spin t) / I_1, L cos(theta) / I_3).
const [I1, I3, L, theta] = [2, 3, 4, 0.6];
const precession = L / I1;
const spin = L * Math.cos(theta) * (1 / I3 - 1 / I1);
function top(t: number): { q: Quaternion; w: Vector } {
  const q = multiply(multiply(about([0, 0, 1], precession * t), about([1, 0, 0], theta)), about([0, 0, 1], spin * t));
  const across = (L * Math.sin(theta)) / I1;
  return { q, w: [across * Math.sin(spin * t), across * Math.cos(spin * t), (L * Math.cos(theta)) / I3] };
}

/** Keyframes rounded to the integers of the document. */
function track(times: number[], state: (t: number) => { q: Quaternion; w: Vector; p?: Vector; v?: Vector }): Track {
  const all = times.map(state);
  const w_scale = Math.max(...all.flatMap(({ w }) => w.map(Math.abs))) / 32767;
  const start = all[0]?.p;
  const body = { q: [] as number[], w: [] as number[], w_scale, p: [] as number[], v: [] as number[], p_scale: 1e-4, v_scale: 1e-4, p_start: [...(start ?? [0, 0, 0])] };
  for (const { q, w, p, v } of all) {
    body.q.push(...q.map((x) => Math.round(x * 32767)));
    body.w.push(...w.map((x) => Math.round(x / w_scale)));
    if (p !== undefined && v !== undefined && start !== undefined) {
      body.p.push(...subtract(p, start).map((x) => Math.round(x / 1e-4)));
      body.v.push(...v.map((x) => Math.round(x / 1e-4)));
    }
  }
  return { t: times, bodies: [body] };
}

/** Largest differences from the closed form at the midpoint and at other points of intervals of a given length. */
function offBy(h: number): { attitude: number; rate: number } {
  let [attitude, rate] = [0, 0];
  for (let begin = 0; begin < 4; begin += 0.5) {
    const [a, b] = [top(begin), top(begin + h)];
    for (const s of [0.2, 0.5, 0.7]) {
      const made = attitudeBetween(a.q, a.w, b.q, b.w, h, s);
      const exact = top(begin + s * h);
      assert.ok(Math.abs(norm(made.attitude) - 1) < 1e-14);
      attitude = Math.max(attitude, angleBetween(made.attitude, exact.q));
      rate = Math.max(rate, length(subtract(made.angularVelocity, exact.w)));
    }
  }
  return { attitude, rate };
}

test("interpolated attitudes converge with order 4, angular velocities with order 3", () => {
  const errors = [0.4, 0.2, 0.1, 0.05].map(offBy);
  for (let i = 1; i < errors.length; ++i) {
    const [coarse, fine] = [errors[i - 1]!, errors[i]!];
    assert.ok(Math.abs(Math.log2(coarse.attitude / fine.attitude) - 4) < 0.15, `attitude: ${coarse.attitude} to ${fine.attitude}`);
    assert.ok(Math.abs(Math.log2(coarse.rate / fine.rate) - 3) < 0.15, `rate: ${coarse.rate} to ${fine.rate}`);
  }
  // remainder h^4 |q''''| / 384 of the cubic; q'''' is at most that of a rotation at (precession + spin) / 2
  const bound = 2 * (0.1 ** 4 / 384) * ((precession + Math.abs(spin)) / 2) ** 4;
  assert.ok(errors[2]!.attitude < bound, `${errors[2]!.attitude} against ${bound}`);
});

test("interpolation reproduces attitude and angular velocity at the keyframes", () => {
  const [a, b] = [top(0.3), top(0.5)];
  for (const [s, exact] of [[0, a], [1, b]] as const) {
    const made = attitudeBetween(a.q, a.w, b.q, b.w, 0.2, s);
    assert.ok(angleBetween(made.attitude, exact.q) < 1e-15);
    assert.ok(length(subtract(made.angularVelocity, exact.w)) < 1e-14);
  }
});

test("an integer track reproduces the motion to within its rounding", () => {
  const h = 0.05;
  const times = Array.from({ length: 81 }, (_, i) => i * h);
  const path = (t: number): { q: Quaternion; w: Vector; p: Vector; v: Vector } => ({ ...top(t), p: [Math.sin(t), 1 + t * t, -t], v: [Math.cos(t), 2 * t, -1] });
  const keyframes = new Keyframes(track(times, path));
  assert.equal(keyframes.end, times[80]);
  // half a unit of each component of q and w; for p, half a unit of p and v plus h^4 / 384 of the sine
  const rounding = 2 * 2 * (0.5 / 32767) * 1.2 + 0.25 * h * (0.5 / 32767) * 5;
  for (let t = 0; t <= 4; t += 0.013) {
    const made = keyframes.at(0, t);
    const exact = path(t);
    assert.ok(Math.abs(norm(made.attitude) - 1) < 1e-14);
    assert.ok(angleBetween(made.attitude, exact.q) < rounding, `attitude at ${t}`);
    assert.ok(length(subtract(made.position, exact.p)) < 2 * Math.sqrt(3) * 0.5e-4, `position at ${t}`);
  }
  // clamped to the ends
  assert.deepEqual(keyframes.at(0, -1), keyframes.at(0, 0));
  assert.deepEqual(keyframes.at(0, 99), keyframes.at(0, times[80]!));
});

test("cubic positions are exact for cubics", () => {
  const p = (t: number): Vector => [t ** 3, 1 - 2 * t ** 2, 3 * t - t ** 3];
  const v = (t: number): Vector => [3 * t * t, -4 * t, 3 - 3 * t * t];
  for (const s of [0, 0.25, 0.6, 1]) {
    const made = positionBetween(p(1), v(1), p(3), v(3), 2, s);
    assert.ok(length(subtract(made, p(1 + 2 * s))) < 1e-13);
  }
});

test("a method's angular velocities are interpolated independently of its attitudes", () => {
  const error = (h: number): number => {
    const times = Array.from({ length: Math.round(4 / h) + 1 }, (_, i) => i * h);
    // attitudes that rotate at twice the given angular velocity
    const keyframes = new Keyframes(track(times, (t) => ({ q: top(2 * t).q, w: top(t).w })), false);
    let worst = 0;
    for (let t = 1; t < 3; t += 0.017) worst = Math.max(worst, length(subtract(keyframes.at(0, t).angularVelocity, top(t).w)));
    assert.ok(length(subtract(keyframes.at(0, times[3]!).angularVelocity, top(times[3]!).w)) < 1e-4);
    return worst;
  };
  // slopes of parabolas have order 2, so values have order 3
  assert.ok(Math.abs(Math.log2(error(0.8) / error(0.4)) - 3) < 0.4, `${error(0.8)} to ${error(0.4)}`);
  assert.ok(error(0.2) < 2e-3);
});

test("finds the interval of a time, also among repeated times", () => {
  const times = [0, 1, 1, 2, 5];
  assert.deepEqual([-1, 0, 0.5, 1, 1.5, 2, 4.9, 5, 9].map((t) => findInterval(times, t)), [0, 0, 0, 2, 2, 3, 3, 3, 3]);
  assert.equal(findInterval([0], 3), 0);
  assert.equal(findInterval([], 3), 0);
  // at an event, the interval after it
  const turned = about([0, 0, 1], 1);
  const still: Vector = [0, 0, 1e-9];
  const keyframes = new Keyframes(track([0, 1, 1, 2], (t) => ({ q: t < 1 ? [1, 0, 0, 0] : turned, w: still })));
  assert.ok(angleBetween(keyframes.at(0, 1).attitude, turned) < 1e-4);
});

test("accepts no keyframes and a single keyframe", () => {
  assert.deepEqual(new Keyframes({ t: [], bodies: [] }).at(0, 1).attitude, [1, 0, 0, 0]);
  const single = new Keyframes(track([0], top));
  assert.ok(angleBetween(single.at(0, 7).attitude, top(0).q) < 1e-4);
  assert.deepEqual(single.dense(4), [0]);
});

test("dense times ascend, include the keyframes and end at the given time", () => {
  const keyframes = new Keyframes(track([0, 1, 3], top));
  assert.deepEqual(keyframes.dense(2), [0, 0.5, 1, 2, 3]);
  assert.deepEqual(keyframes.dense(2, 1.7), [0, 0.5, 1, 1.7]);
});

test("the box of a box's moments is that box", () => {
  const [mass, a, b, c] = [2.5, 0.3, 0.2, 0.1];
  const moments: Vector = [(mass * (b * b + c * c)) / 3, (mass * (a * a + c * c)) / 3, (mass * (a * a + b * b)) / 3];
  const made = boxOfMoments(mass, moments);
  [a, b, c].forEach((x, i) => assert.ok(Math.abs(made[i]! - x) < 1e-15));
  // a plate gets a thickness; its other extents do not change
  const plate = boxOfMoments(1, [1 / 3, 4 / 3, 5 / 3]);
  assert.ok(Math.abs(plate[0] - 2) < 1e-14 && Math.abs(plate[1] - 1) < 1e-14);
  assert.ok(plate[2] > 0 && plate[2] <= 0.05);
  // moments that violate the triangle inequality by rounding
  assert.ok(boxOfMoments(1, [1, 1, 2 + 1e-15]).every((x) => x > 0));
});

test("draws a body without a shape as the box of its moments, in the principal frame", () => {
  const turn = about([0, 0, 1], Math.PI / 2);
  const [a, b, c] = [0.3, 0.2, 0.1];
  const body: BodyShape = { name: "", mass: 1, moments: [(b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3], principal: [...turn], parts: [], vertices: null, faces: null, points: null };
  const [surface] = surfacesOf(body);
  surface!.geometry.computeBoundingBox();
  const { max } = surface!.geometry.boundingBox!;
  // the first and longest axis is along the body's y
  assert.ok(Math.abs(max.x - b) < 1e-7 && Math.abs(max.y - a) < 1e-7 && Math.abs(max.z - c) < 1e-7);
  assert.ok(Math.abs(length(tipOf([surface!])) - Math.hypot(a, b, c)) < 1e-7);
});

/** Volume and centroid of a closed surface, by tetrahedra from the origin. */
function solidOf(type: string, sizes: Record<string, number | number[]>): { volume: number; center: Vector } {
  const surface = surfaceOf({ type, sizes, position: [0, 0, 0], orientation: [1, 0, 0, 0], hole: false });
  assert.ok(surface !== null, type);
  const positions = surface.getAttribute("position");
  let volume = 0;
  let moment: Vector = [0, 0, 0];
  const at = (i: number): Vector => [positions.getX(i), positions.getY(i), positions.getZ(i)];
  for (let i = 0; i < positions.count; i += 3) {
    const [a, b, c] = [at(i), at(i + 1), at(i + 2)];
    const part = dot(a, cross(b, c)) / 6;
    volume += part;
    moment = add(moment, scale(part / 4, add(a, add(b, c))));
  }
  assert.equal(surface.getAttribute("color").count, positions.count);
  assert.ok(outlineOf({ type, sizes, position: [], orientation: [], hole: false }, surface).length >= 36, `${type} has an outline`);
  return { volume, center: scale(1 / volume, moment) };
}

test("shapes have the volume, centre of mass and axis that scene files define", () => {
  const p = Math.PI;
  const shapes: [string, Record<string, number | number[]>, number][] = [
    ["box", { half_extents: [0.3, 0.2, 0.1] }, 0.048],
    ["sphere", { radius: 0.3 }, (4 / 3) * p * 0.027],
    ["hollow_sphere", { outer_radius: 0.3, inner_radius: 0.1 }, (4 / 3) * p * 0.027],
    ["cylinder", { radius: 0.2, half_height: 0.3 }, p * 0.04 * 0.6],
    ["hollow_cylinder", { outer_radius: 0.3, inner_radius: 0.2, half_height: 0.25 }, p * 0.05 * 0.5],
    ["capsule", { radius: 0.2, half_height: 0.3 }, p * 0.04 * 0.6 + (4 / 3) * p * 0.008],
    ["cone", { radius: 0.3, height: 0.8 }, (p * 0.09 * 0.8) / 3],
    ["ellipsoid", { semi_axes: [0.4, 0.3, 0.2] }, (4 / 3) * p * 0.024],
    ["torus", { major_radius: 0.4, minor_radius: 0.1 }, 2 * p * p * 0.4 * 0.01],
    ["frustum", { bottom_radius: 0.3, top_radius: 0.1, height: 0.6 }, (p * 0.6 * (0.09 + 0.03 + 0.01)) / 3],
    ["tetrahedron", { vertices: [0.3, 0, 0, -0.1, 0.2, 0, -0.1, -0.2, 0, -0.1, 0, 0.4] }, (0.4 * 0.4 * 0.4) / 6],
    ["tetrahedron", { vertices: [-0.1, 0.2, 0, 0.3, 0, 0, -0.1, -0.2, 0, -0.1, 0, 0.4] }, (0.4 * 0.4 * 0.4) / 6],
  ];
  for (const [type, sizes, volume] of shapes) {
    const solid = solidOf(type, sizes);
    // area of a regular n-gon over the circle's: sin(2 pi / n) / (2 pi / n), 0.9971 for 48; torus 24 by 96: 0.9886 0.9993
    assert.ok(Math.abs(solid.volume / volume - 1) < 0.0125, `${type}: ${solid.volume} for ${volume}`);
    const center: Vector = type === "tetrahedron" ? [0, 0, 0.1] : [0, 0, 0];
    assert.ok(length(subtract(solid.center, center)) < 2e-4, `${type}: centre ${solid.center.join(" ")}`);
  }
  for (const [type, sizes] of [["rod", { length: 2 }], ["disc", { radius: 1 }], ["plate", { half_extents: [1, 0.5] }]] as const) {
    const solid = solidOf(type, sizes as unknown as Record<string, number | number[]>);
    assert.ok(solid.volume > 0 && solid.volume < 0.2, `${type} is thin`);
  }
  // axis and base: the cone's tip is at 3/4 of its height above the origin
  const cone = surfacesOf({ name: "", mass: 1, moments: [1, 1, 1], principal: [1, 0, 0, 0], parts: [{ type: "cone", sizes: { radius: 0.3, height: 0.8 }, position: [0, 0, 0], orientation: [1, 0, 0, 0], hole: false }], vertices: null, faces: null, points: null });
  assert.ok(length(subtract(tipOf(cone), [0, 0, 0.6])) < 1e-6);
  assert.ok(Math.abs(frustumCenter(1, 0, 4) - 1) < 1e-15 && Math.abs(frustumCenter(1, 1, 4) - 2) < 1e-15);
  assert.equal(surfaceOf({ type: "no such shape", sizes: {}, position: [], orientation: [], hole: false }), null);
});

/** Euler's equations without torque, and the attitude, by RK4. */
function free(moments: Vector, w0: Vector, h: number, count: number): { q: Quaternion; w: Vector }[] {
  type State = number[];
  const rate = (y: State): State => {
    const w: Vector = [y[4]!, y[5]!, y[6]!];
    const d = cross(angularMomentum(moments, w), w);
    const q = multiply([y[0]!, y[1]!, y[2]!, y[3]!], [0, ...w]);
    return [...q.map((x) => x / 2), d[0] / moments[0], d[1] / moments[1], d[2] / moments[2]];
  };
  const along = (y: State, s: number, d: State): State => y.map((x, i) => x + s * d[i]!);
  let y: State = [1, 0, 0, 0, ...w0];
  const made: { q: Quaternion; w: Vector }[] = [];
  for (let i = 0; i <= count; ++i) {
    made.push({ q: normalized([y[0]!, y[1]!, y[2]!, y[3]!]), w: [y[4]!, y[5]!, y[6]!] });
    const a = rate(y);
    const b = rate(along(y, h / 2, a));
    const c = rate(along(y, h / 2, b));
    const d = rate(along(y, h, c));
    y = y.map((x, k) => x + (h / 6) * (a[k]! + 2 * b[k]! + 2 * c[k]! + d[k]!));
  }
  return made;
}

test("the polhode conserves energy and momentum and contains the body's motion", () => {
  for (const [moments, w] of [[[1, 2, 3], [1, 0.3, 2]], [[1, 2, 3], [2, 0.3, -0.4]], [[3, 1, 2], [0.1, -2, 0.3]], [[2, 2, 3], [0.5, 0, 1]], [[1, 3, 3], [1, 0.5, 0.2]]] as [Vector, Vector][]) {
    const curve = polhode(moments, w);
    assert.ok(curve.length > 200);
    const [E, M] = [twiceEnergy(moments, w), length(angularMomentum(moments, w))];
    for (const point of curve) {
      assert.ok(Math.abs(twiceEnergy(moments, point) / E - 1) < 1e-13);
      assert.ok(Math.abs(length(angularMomentum(moments, point)) / M - 1) < 1e-13);
    }
    assert.ok(length(subtract(curve[0]!, curve[curve.length - 1]!)) < 1e-13);
    // each point of the motion is within half the spacing of the curve's points, plus the sagitta, of one of them
    const step = Math.max(...curve.slice(1).map((point, i) => length(subtract(point, curve[i]!))));
    for (const { w: at } of free(moments, w, 1e-3, 4000).filter((_, i) => i % 50 === 0)) {
      const nearest = Math.min(...curve.map((point) => length(subtract(point, at))));
      assert.ok(nearest <= 0.51 * step, `${nearest} with points ${step} apart`);
    }
  }
  // stationary rotation: about a principal axis, and of a sphere
  assert.deepEqual(polhode([1, 2, 3], [0, 0, 2]), [[0, 0, 2]]);
  assert.deepEqual(polhode([2, 2, 2], [1, 2, 3]), [[1, 2, 3]]);
  assert.deepEqual(polhode([1, 1, 3], [1, 0, 0]), [[1, 0, 0]]);
});

test("the herpolhode lies in the invariable plane, between its two circles, and touches both", () => {
  for (const [moments, w] of [[[1, 2, 3], [1, 0.3, 2]], [[1, 2, 3], [2, 0.3, -0.4]], [[2, 2, 3], [0.5, 0.4, 1]]] as [Vector, Vector][]) {
    const [least, greatest] = herpolhodeRadii(moments, w);
    const motion = free(moments, w, 1e-3, 20000);
    const momentum = worldMomentum(motion[0]!.q, [1, 0, 0, 0], moments, w);
    const plane = invariablePlane(momentum, twiceEnergy(moments, w));
    assert.ok(Math.abs(plane.distance - twiceEnergy(moments, w) / length(momentum)) < 1e-15);
    let [low, high] = [Infinity, 0];
    for (const { q, w: at } of motion) {
      const world = rotate(q, at);
      // the error of RK4 at this step is 1e-11
      assert.ok(Math.abs(dot(plane.normal, world) - plane.distance) < 1e-9);
      const radius = Math.hypot(...onPlane(plane, world));
      [low, high] = [Math.min(low, radius), Math.max(high, radius)];
    }
    // the circle is touched between two steps, so the extremum is missed by the square of the angle between them
    assert.ok(low >= least - 1e-9 && low < least + 1e-5, `${low} from ${least}`);
    assert.ok(high <= greatest + 1e-9 && high > greatest - 1e-5, `${high} to ${greatest}`);
  }
  // symmetric body: a circle; components of w across the axis and along it: L w_across (1/I_1 - 1/I_3) cos(theta) ..
  const [least, greatest] = herpolhodeRadii([I1, I1, I3], top(0).w);
  // w = (L / I_1) along L plus L cos(theta) (1 / I_3 - 1 / I_1) along the axis, which is at the angle theta to L
  const closed = Math.abs(spin) * Math.sin(theta);
  assert.ok(Math.abs(least - closed) < 1e-13 && Math.abs(greatest - closed) < 1e-13);
  assert.deepEqual(herpolhodeRadii([1, 2, 3], [0, 0, 0]), [0, 0]);
});

test("angular momentum in world axes is constant", () => {
  const start = worldMomentum(top(0).q, [1, 0, 0, 0], [I1, I1, I3], top(0).w);
  for (const t of [0, 0.7, 2.1]) {
    const now = worldMomentum(top(t).q, [1, 0, 0, 0], [I1, I1, I3], top(t).w);
    assert.ok(length(subtract(now, [0, 0, L])) < 1e-14 && length(subtract(now, start)) < 1e-14);
  }
  // the same body with rotated principal axes: I = R D R^T
  const principal = about([1, 2, 3], 0.8);
  const w: Vector = [0.3, -1, 2];
  const expected = rotate(principal, angularMomentum([1, 2, 3], toPrincipal(principal, w)));
  assert.ok(length(subtract(worldMomentum([1, 0, 0, 0], principal, [1, 2, 3], w), expected)) < 1e-15);
  assert.ok(Math.abs(dot(w, expected) - twiceEnergy([1, 2, 3], toPrincipal(principal, w))) < 1e-14);
});

test("the outline lies on the ellipsoid, where the normal is perpendicular to the line of sight", () => {
  const axes = semiAxes([1, 2, 3], 6);
  assert.deepEqual(axes.map((a) => a * a).map((a) => Math.round(a * 1e12) / 1e12), [6, 3, 2]);
  const n = scale(1 / Math.hypot(1, 2, 0.5), [1, 2, 0.5]);
  for (const point of outline(axes, n)) {
    const normal: Vector = [point[0] / 6, point[1] / 3, point[2] / 2];
    assert.ok(Math.abs(dot(point, normal) - 1) < 1e-13 && Math.abs(dot(normal, n)) < 1e-14);
  }
  assert.ok(isSeen(axes, n, [0, axes[1], 0]) && !isSeen(axes, n, [0, -axes[1], 0]));
});

test("interpolates errors between samples, and returns none beyond the last", () => {
  const method = { t: [0, 1, 2], attitude: [0, 1e-4, 1e-2] } as MotionMethod;
  assert.ok(Math.abs(errorAt(method, 1.5)! - 1e-3) < 1e-15);
  assert.equal(errorAt(method, 0.5), 0.5e-4);
  assert.ok(Math.abs(errorAt(method, 2)! - 1e-2) < 1e-15);
  assert.equal(errorAt(method, 2.1), null);
  assert.equal(errorAt({ ...method, attitude: [0, 1, null] }, 1.5), 1);
  assert.equal(errorAt({ ...method, t: [], attitude: [] }, 0), null);
});

test("first selects a user's trajectory, or the largest error, then the smallest visible error", () => {
  const seen = {} as Track;
  const one = (label: string, method: number, difference: number, track: Track | null): MotionMethod =>
    ({ label, method, difference, track, setting_kind: 0, setting: null, status: 0, message: "", t: [], attitude: [] });
  const methods = [one("exact", 0, 1e-9, null), one("middle", 1, 0.1, seen), one("far", 2, 2, seen), one("near", 3, 0.01, seen)];
  const labels = (list: MotionMethod[]): string[] => firstMethods({ methods: list } as Motion).map((method) => method.label);
  assert.deepEqual(labels(methods), ["far", "near"]);
  assert.deepEqual(labels([...methods, one("mine.csv", -1, 0.5, seen)]), ["mine.csv", "near"]);
  assert.deepEqual(labels([one("not run", 0, 0, null), { ...one("exact", 1, 1e-9, null), t: [0, 1], attitude: [0, 1e-9] }]), ["exact"]);
  assert.deepEqual(labels([one("not run", 0, 0, null)]), []);
  assert.deepEqual(labels([]), []);
});

test("ticks and decades", () => {
  assert.deepEqual(ticks(0, 10, 5), [0, 2, 4, 6, 8, 10]);
  assert.deepEqual(ticks(0, 0, 5), [0]);
  assert.ok(ticks(0, 7.3e-9, 6).length <= 7);
  assert.deepEqual(decades([0, null, 3e-5, 0.2, Infinity]), [-5, 0]);
  assert.deepEqual(decades([1e-3]), [-3, -2]);
  assert.deepEqual(decades([0, null]), [-16, 0]);
});

test("views motion in a vertical plane from the front", () => {
  const plane = Array.from({ length: 20 }, (_, i): Vector => [Math.cos(i) * Math.cos(1), Math.cos(i) * Math.sin(1), Math.sin(i)]);
  const azimuth = azimuthOf(plane);
  // the line of sight is at 0.4 rad to the normal of the plane
  assert.ok(Math.abs(Math.abs(Math.cos(azimuth) * -Math.sin(1) + Math.sin(azimuth) * Math.cos(1)) - Math.cos(0.4)) < 1e-12);
  const round = Array.from({ length: 20 }, (_, i): Vector => [Math.cos(i), Math.sin(i), 0]);
  assert.equal(azimuthOf(round), azimuthOf([]));
});

test("the T-handle flips at the times given by Jacobi's elliptic functions", () => {
  const [A, B, C] = [2.2375e-4, 3.75e-4, 5.7625e-4];
  const w: Vector = [0.01, 15, 0.02];
  const E2 = twiceEnergy([A, B, C], w);
  const L2 = dot(angularMomentum([A, B, C], w), angularMomentum([A, B, C], w));
  // Landau and Lifshitz, section 37: w_2 ~ sn(rate t, m), zero every 2 K(m) / rate, for L^2 > 2E B; else with A and C
  // exchanged
  const [a, c] = L2 > E2 * B ? [A, C] : [C, A];
  const rate = Math.sqrt(((c - B) * (L2 - E2 * a)) / (A * B * C));
  const m = ((B - a) * (E2 * c - L2)) / ((c - B) * (L2 - E2 * a));
  // K(m) = pi / (2 agm(1, sqrt(1 - m)))
  let [x, y] = [1, Math.sqrt(1 - m)];
  for (let i = 0; i < 30; ++i) [x, y] = [(x + y) / 2, Math.sqrt(x * y)];
  const between = Math.PI / x / rate;
  const found = flips(motionDocument().motions[0]!);
  assert.ok(found.length >= 4, `${found.length} flips`);
  // angular velocities are rounded to 15 / 32767 rad/s, and zero is crossed at about 30 rad/s^2
  for (let i = 1; i < found.length; ++i) assert.ok(Math.abs(found[i]! - found[i - 1]! - between) < 2e-3, `${found[i]! - found[i - 1]!} for ${between}`);
});

test("writes PNG pictures without loss, with and without a palette", () => {
  for (const colors of [5, 256, 300]) {
    const [width, height] = [40, 30];
    const rgba = new Uint8Array(4 * width * height);
    for (let i = 0; i < width * height; ++i) {
      const color = (i * 7) % colors;
      rgba.set([color & 255, (color * 3) & 255, color >> 4, 255], 4 * i);
    }
    const file = writePng({ width, height, rgba });
    const read = readPng(file);
    assert.deepEqual([read.width, read.height], [width, height]);
    assert.ok(Buffer.from(read.rgba).equals(Buffer.from(rgba)), `${colors} colours`);
    assert.equal(file[25], colors <= 256 ? 3 : 2);
  }
  assert.throws(() => readPng(new Uint8Array(20)), /not a PNG/);
});

const motionNamed = (name: string): Motion => {
  const { scenes, motions } = motionDocument();
  const found = motions[scenes.find((one) => one.name === name)?.motion ?? -1];
  assert.ok(found, name);
  return found;
};

test("curves in several segments have no values between them", () => {
  const curve = { t: [0, 1, 2, 3], y: [1, 3, 10, 20], starts: [0, 2] };
  assert.equal(valueAt(curve, 0.25, false), 1.5);
  assert.equal(valueAt(curve, 1, false), 3);
  assert.equal(valueAt(curve, 1.5, false), null);
  assert.equal(valueAt(curve, 2.5, false), 15);
  assert.ok(Math.abs((valueAt(curve, 2.5, true) ?? 0) - Math.sqrt(200)) < 1e-12);
  assert.equal(valueAt(curve, -0.1, false), null);
  assert.equal(valueAt(curve, 3.1, false), null);
  assert.deepEqual(placeAt({ t: [2], starts: [0] }, 2), [0, 0]);
  assert.equal(placeAt({ t: [], starts: [] }, 0), null);
  // a jump: two samples almost at one time
  const jump = { t: [0, 1, 1 + 1e-9, 2], y: [0, 1, -1, 0] };
  assert.equal(valueAt(jump, 1, false), 1);
  assert.ok(Math.abs((valueAt(jump, 1.5, false) ?? 0) + 0.5) < 1e-8);
});

test("ranges contain all values and limits, and are not empty", () => {
  const [low, high] = linearRange([0.2, null, -0.1, NaN], [0.5]);
  assert.ok(low < -0.1 && high > 0.5 && high - low < 0.7);
  const [bottom, top] = linearRange([3, 3]);
  assert.ok(bottom < 3 && top > 3);
  assert.deepEqual(linearRange([null]), [0, 1]);
  assert.equal(tickText(0.25, 0.05), "0.25");
  assert.equal(tickText(1000.5, 0.5), "1000.5");
});

test("the contact of a sliding ball has the closed form at all times", () => {
  const [ball] = motionNamed("sliding_ball").contacts;
  assert.ok(ball);
  const [mu, g, u, m] = [0.25, 9.8, 3.5, 2];
  const rolls = (2 * u) / (7 * mu * g);
  for (const t of [0.001, 0.1, 0.25, 0.4, rolls - 1e-3]) {
    const state = contactAt(ball, t);
    assert.ok(state);
    assert.ok(Math.abs(state.slip[0] - (u - 3.5 * mu * g * t)) < 1e-12);
    assert.ok(Math.abs(state.point[0] - (u * t - 0.5 * mu * g * t * t)) < 5e-4);
    assert.ok(Math.abs(state.normal - m * g) < 1e-12 && Math.abs(state.friction[0] + mu * m * g) < 1e-12);
  }
  const rolling = contactAt(ball, rolls + 0.1);
  assert.ok(rolling);
  assert.deepEqual([rolling.friction, rolling.slip], [[0, 0, 0], [0, 0, 0]]);
  // the force jumps at the end of the slip and is not interpolated across it
  for (const t of [rolls - 1e-6, rolls, rolls + 1e-6]) assert.ok([-mu * m * g, 0].includes(contactAt(ball, t)?.friction[0] ?? NaN), `${t}`);
  assert.equal(contactAt(ball, 1.01), null);
  assert.ok(ratioOf(ball).slice(0, 21).every((one) => Math.abs((one ?? 0) - 1) < 1e-12));
  assert.ok(ratioOf(ball).slice(21).every((one) => one === 0));
  assert.deepEqual(ratioOf({ ...ball, friction: 0 })[0], null);
  assert.ok(Math.abs((slipOf(ball)[0] ?? 0) - u) < 1e-4);
  assert.ok(Math.abs((frictionOf(ball)[5] ?? 0) - mu * m * g) < 1e-12);
});

test("modes and events at a time", () => {
  const { timeline } = motionNamed("sliding_ball");
  assert.ok(timeline);
  const rolls = timeline.events[0]?.t ?? 0;
  const [row] = timeline.rows;
  assert.ok(row);
  assert.equal(modeAt(row, 0), "sliding");
  assert.equal(modeAt(row, rolls), "rolling");
  assert.equal(modeAt(row, 1.01), "");
  assert.equal(modesText(timeline, 0.1), "lane sliding");
  const many = { ...timeline, rows: [row, { ...row, name: "wall", modes: [{ from: 0, to: 1, mode: "flight" }] }] };
  assert.equal(modesText(many, 0.1), "lane sliding");
  const times = eventTimes(motionNamed("slider").timeline ?? timeline);
  assert.deepEqual(times, [0.5, 1.5, 3.5, 7.5]);
  assert.equal(neighbour(times, 1, 1), 1.5);
  assert.equal(neighbour(times, 1.5, 1), 3.5);
  assert.equal(neighbour(times, 1.5, -1), 0.5);
  assert.equal(neighbour(times, 0.5, -1), null);
  assert.equal(neighbour(times, 8, 1), null);
  assert.match(impulseText({ t: 0, row: 0, kind: "impact", normal: 2, tangential: 0.5 }, "N s"), /^2\sN s, 0\.5\sN s tangential$/);
  assert.equal(impulseText({ t: 0, row: 0, kind: "rolls", normal: 0, tangential: null }, "N s"), "");
});

test("kinds of modes differ in colour and in filling", () => {
  const looks = ["flight", "sliding", "rolling", "sticks", "at lower limit"].map(lookOf);
  assert.equal(new Set(looks.map((look) => look.colors[0])).size, 5);
  assert.equal(new Set(looks.slice(0, 4).map((look) => look.fill)).size, 4);
  assert.deepEqual(lookOf("sliding_without_spin"), lookOf("slides"));
  assert.deepEqual(lookOf("resting"), lookOf("sticks"));
});

test("plots at most six contacts or joints, else those of one body", () => {
  const ball = motionNamed("sliding_ball");
  const [contact] = ball.contacts;
  assert.ok(contact);
  const many = { ...ball, contacts: Array.from({ length: 9 }, (_, i) => ({ ...contact, body: i % 3 })) };
  assert.equal(plottedContacts(ball, 5).length, 1);
  assert.deepEqual(plottedContacts(many, 1).map((one) => one.body), [1, 1, 1]);
  const slider = motionNamed("slider");
  const curve = slider.coordinates?.curves[0];
  assert.ok(curve);
  assert.equal(plottedJoints(slider, 0).length, 1);
  assert.equal(plottedJoints({ ...slider, coordinates: { t: [], total: 20, curves: Array.from({ length: 16 }, (_, i) => ({ ...curve, joint: i % 2 })) } }, 0).length, 6);
  assert.equal(plottedJoints(ball, 0).length, 0);
});

test("error curves and the range of their decades", () => {
  const method = { label: "rk4", t: [0, 1, 2], attitude: [1e-17, 2e-6, 3e-4] } as MotionMethod;
  const actor = { name: "rk4", method, color: "#000000", place: 2, endsEarly: true, end: 2 } as Parameters<typeof errorCurves>[0][number];
  const curves = errorCurves([actor, { ...actor, method: null }, { ...actor, method: { ...method, t: [], attitude: [] } }]);
  assert.equal(curves.length, 1);
  assert.deepEqual([curves[0]?.dash, curves[0]?.ended], ["7 4", true]);
  assert.deepEqual(errorAxes(curves).range, [-6, -3]);
});
