// Sample motions for tests of the motion view, integrated here: a T-handle that flips, a top, a double pendulum, every
// shape, and a small body that travels far.

import type { BodyShape, Motion, MotionMethod, Part, ReportData, Track } from "../../src/report/page/source/data.ts";
import {
  add, angleBetween, conjugate, cross, dot, multiply, normalized, rotate, scale, type Quaternion, type Vector,
} from "../../src/report/page/source/motion/algebra.ts";
import { emptyDocument } from "./sample.ts";

interface BodyState {
  q: Quaternion;
  w: Vector;
  p: Vector;
  v: Vector;
}
interface Frame {
  t: number;
  bodies: BodyState[];
}
type Rate = (y: readonly number[]) => number[];
type Step = (rate: Rate, y: readonly number[], h: number) => number[];

const along = (y: readonly number[], s: number, d: readonly number[]): number[] => y.map((x, i) => x + s * (d[i] ?? 0));
const rk4: Step = (rate, y, h) => {
  const a = rate(y);
  const b = rate(along(y, h / 2, a));
  const c = rate(along(y, h / 2, b));
  const d = rate(along(y, h, c));
  return y.map((x, i) => x + (h / 6) * ((a[i] ?? 0) + 2 * (b[i] ?? 0) + 2 * (c[i] ?? 0) + (d[i] ?? 0)));
};
const euler: Step = (rate, y, h) => along(y, h, rate(y));

const attitudeOf = (y: readonly number[]): Quaternion => normalized([y[0] ?? 1, y[1] ?? 0, y[2] ?? 0, y[3] ?? 0]);
const rateOf = (y: readonly number[]): Vector => [y[4] ?? 0, y[5] ?? 0, y[6] ?? 0];

/** Euler's equations with a torque in body axes. */
function eulersEquations(moments: Vector, torque: (q: Quaternion) => Vector = () => [0, 0, 0]): Rate {
  return (y) => {
    const [q, w] = [attitudeOf(y), rateOf(y)];
    const c = add(torque(q), cross([moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]], w));
    return [...multiply(q, [0, ...w]).map((x) => x / 2), c[0] / moments[0], c[1] / moments[1], c[2] / moments[2]];
  };
}

/** Solves a motion at count + 1 times, with `steps` steps between two times. */
function solved(rate: Rate, start: readonly number[], duration: number, count: number, steps: number, step: Step, state: (y: readonly number[], t: number) => BodyState[]): Frame[] {
  const frames: Frame[] = [];
  let y = start;
  for (let k = 0; k <= count; ++k) {
    frames.push({ t: (k * duration) / count, bodies: state(y, (k * duration) / count) });
    for (let s = 0; s < steps; ++s) y = step(rate, y, duration / count / steps);
  }
  return frames;
}

const still = (y: readonly number[]): BodyState[] => [{ q: attitudeOf(y), w: rateOf(y), p: [0, 0, 0], v: [0, 0, 0] }];

/** The track in the format of the program. */
function trackOf(frames: readonly Frame[]): Track {
  const bodies = (frames[0]?.bodies ?? []).map((first, body) => {
    const all = frames.map((frame) => frame.bodies[body] ?? first);
    const grid = (values: number[]): number => Math.max(1e-300, ...values.map(Math.abs)) / 32767;
    const moved = all.map((one) => add(one.p, scale(-1, first.p)));
    const moves = moved.some((p) => dot(p, p) > 0);
    const [w_scale, p_scale, v_scale] = [grid(all.flatMap((one) => [...one.w])), grid(moved.flat()), grid(all.flatMap((one) => [...one.v]))];
    let before: Quaternion = first.q;
    const q = all.flatMap((one) => {
      const side = before[0] * one.q[0] + before[1] * one.q[1] + before[2] * one.q[2] + before[3] * one.q[3] < 0 ? -1 : 1;
      before = [side * one.q[0], side * one.q[1], side * one.q[2], side * one.q[3]];
      return before.map((x) => Math.round(x * 32767));
    });
    const integers = (values: readonly Vector[], unit: number): number[] => values.flatMap((value) => value.map((x) => Math.round(x / unit)));
    return {
      q, w: integers(all.map((one) => one.w), w_scale), w_scale, p: moves ? integers(moved, p_scale) : [], v: moves ? integers(all.map((one) => one.v), v_scale) : [],
      p_scale, v_scale, p_start: [...first.p],
    };
  });
  return { t: frames.map((frame) => Number(frame.t.toPrecision(7))), bodies };
}

interface Ending {
  status?: number;
  message?: string;
  part?: number; // fraction of the duration with samples
  step?: number;
}

function methodOf(method: number, label: string, truth: readonly Frame[], frames: readonly Frame[], ending: Ending = {}): MotionMethod {
  const { status = 0, message = "", part = 1, step = null } = ending;
  const shown = frames.slice(0, Math.round(frames.length * part));
  const errors = shown.map((frame, k) => Math.max(...frame.bodies.map((body, i) => angleBetween(body.q, truth[k]?.bodies[i]?.q ?? body.q))));
  const every = Math.max(1, Math.floor(shown.length / 120));
  const places = shown.map((_, k) => k).filter((k) => k % every === 0);
  const difference = Math.max(0, ...errors);
  return {
    method, label, setting_kind: step === null ? 2 : 1, setting: step ?? 1e-10, status, message,
    track: shown.length < 2 || (difference <= 2e-3 && status === 0) ? null : trackOf(shown), difference,
    t: places.map((k) => shown[k]?.t ?? 0), attitude: places.map((k) => errors[k] ?? null),
  };
}

const body = (name: string, more: Partial<BodyShape>): BodyShape => ({ name, mass: 1, moments: [1, 1, 1], principal: [1, 0, 0, 0], parts: [], vertices: null, faces: null, points: null, ...more });
const part = (type: string, sizes: Part["sizes"], position: Vector = [0, 0, 0], orientation: Quaternion = [1, 0, 0, 0], hole = false): Part =>
  ({ type, sizes, position: [...position], orientation: [...orientation], hole });
const motion = (more: Partial<Motion> & Pick<Motion, "bodies" | "truth" | "duration">): Motion => ({
  scene: 0, whole: more.duration, thinning: { angle: 1.9e-3, length: 2e-4 }, joints: [], pivot: null, about: null, planes: [], gravity: null, moving: false, timeline: null, contacts: [], coordinates: null, remark: "",
  free: false, energy: 0, how: "Jacobi's elliptic functions; error bound 1.0e-17", methods: [], ...more,
});

const quarter = Math.SQRT1_2;

function tHandle(): Motion {
  const [moments, start, duration, count] = [[2.2375e-4, 3.75e-4, 5.7625e-4] as Vector, [1, 0, 0, 0, 0.01, 15, 0.02], 10.47, 700];
  const rate = eulersEquations(moments);
  const by = (steps: number, step: Step): Frame[] => solved(rate, start, duration, count, steps, step, still);
  const truth = by(20, rk4);
  return motion({
    duration, whole: 20, free: true, energy: 0.0421,
    bodies: [body("t_handle", {
      mass: 0.45, moments: [...moments],
      parts: [part("cylinder", { radius: 0.01, half_height: 0.06 }, [0, -0.01333, 0], [quarter, 0, quarter, 0]), part("cylinder", { radius: 0.01, half_height: 0.03 }, [0, 0.02667, 0], [quarter, quarter, 0, 0])],
    })],
    truth: trackOf(truth),
    methods: [
      methodOf(0, "article_as_written", truth, by(1, euler), { step: duration / count }), methodOf(1, "rk4", truth, by(2, rk4), { step: duration / count / 2 }),
      methodOf(3, "odeint_fehlberg78", truth, by(2, euler), { step: duration / count / 2, status: 2, message: "the energy is beyond all bounds", part: 0.6 }),
      methodOf(2, "cvode_adams", truth, by(10, rk4)), methodOf(4, "radau", truth, [], { status: 4, message: "only motion under loads" }),
    ],
  });
}

function top(): Motion {
  const [about, duration, count, length, weight] = [[1, 1, 0.5] as Vector, 6, 400, 0.5, 9.80665];
  const rate = eulersEquations(about, (q) => cross([0, 0, length], rotate(conjugate(q), [0, 0, -weight])));
  const start = [Math.cos(0.25), Math.sin(0.25), 0, 0, 0, 0, 20];
  const state = (y: readonly number[]): BodyState[] => {
    const [q, w] = [attitudeOf(y), rateOf(y)];
    return [{ q, w, p: rotate(q, [0, 0, length]), v: rotate(q, cross(w, [0, 0, length])) }];
  };
  const truth = solved(rate, start, duration, count, 20, rk4, state);
  return motion({
    duration, whole: 20, moving: true, about: { moments: [...about], principal: [1, 0, 0, 0] }, pivot: [0, 0, -length], gravity: [0, 0, -weight], planes: [{ normal: [0, 0, 1], offset: 0 }], truth: trackOf(truth),
    bodies: [body("lagrange_top", { moments: [0.75, 0.75, 0.5], parts: [part("cone", { radius: 0.45, height: 0.6 }, [0, 0, 0], [0, 1, 0, 0]), part("rod", { length: 1 })] })],
    methods: [methodOf(1, "rk4", truth, solved(rate, start, duration, count, 1, euler, state), { step: duration / count })],
  });
}

/** Two uniform rods of length and mass 1, a and b their angles from below:
 *   4/3 a'' + cos(a - b) b'' / 2 = -sin(a - b) b'^2 / 2 - 3/2 g sin a,
 *   b'' / 3 + cos(a - b) a'' / 2 = sin(a - b) a'^2 / 2 - g sin(b) / 2. */
function doublePendulum(): Motion {
  const [g, duration, count] = [9.81, 8, 400];
  const rate: Rate = ([a = 0, b = 0, u = 0, v = 0]) => {
    const [c, s] = [Math.cos(a - b), Math.sin(a - b)];
    const [first, second] = [-0.5 * s * v * v - 1.5 * g * Math.sin(a), 0.5 * s * u * u - 0.5 * g * Math.sin(b)];
    const determinant = 4 / 9 - 0.25 * c * c;
    return [u, v, (first / 3 - 0.5 * c * second) / determinant, ((4 / 3) * second - 0.5 * c * first) / determinant];
  };
  const state = ([a = 0, b = 0, u = 0, v = 0]: readonly number[]): BodyState[] => {
    const attitude = (angle: number): Quaternion => [Math.cos(angle / 2), 0, Math.sin(angle / 2), 0];
    const down = (angle: number, s: number): Vector => [-s * Math.sin(angle), 0, -s * Math.cos(angle)];
    const moved = (angle: number, s: number): Vector => [-s * Math.cos(angle), 0, s * Math.sin(angle)];
    return [
      { q: attitude(a), w: [0, u, 0], p: down(a, 0.5), v: moved(a, 0.5 * u) },
      { q: attitude(b), w: [0, v, 0], p: add(down(a, 1), down(b, 0.5)), v: add(moved(a, u), moved(b, 0.5 * v)) },
    ];
  };
  const by = (second: number): Frame[] => solved(rate, [2, second, 0, 0], duration, count, 20, rk4, state);
  const truth = by(2.2);
  const hinge = { type: "revolute", child_point: [0, 0, 0.5], axis: [0, 1, 0] };
  return motion({
    duration, moving: true, gravity: [0, 0, -g], truth: trackOf(truth), how: "extrapolation in 32 digits; error bound 3.0e-15",
    bodies: ["upper", "lower"].map((name) => body(name, { moments: [0.0833, 0.0833, 0.001], parts: [part("capsule", { radius: 0.06, half_height: 0.44 })] })),
    joints: [{ ...hinge, name: "shoulder", parent: -1, child: 0, parent_point: [0, 0, 0] }, { ...hinge, name: "elbow", parent: 0, child: 1, parent_point: [0, 0, -0.5] }],
    methods: [methodOf(0, "article_as_written", truth, by(2.21), { step: 0.01 }), methodOf(1, "rk4", truth, by(2.201), { step: 0.01 })],
  });
}

function everyShape(): Motion {
  const shapes: [string, Part["sizes"]][] = [
    ["box", { half_extents: [0.3, 0.2, 0.1] }], ["sphere", { radius: 0.3 }], ["hollow_sphere", { outer_radius: 0.3, inner_radius: 0.2 }],
    ["cylinder", { radius: 0.2, half_height: 0.3 }], ["hollow_cylinder", { outer_radius: 0.3, inner_radius: 0.2, half_height: 0.2 }],
    ["capsule", { radius: 0.15, half_height: 0.2 }], ["cone", { radius: 0.25, height: 0.6 }], ["ellipsoid", { semi_axes: [0.35, 0.2, 0.12] }],
    ["torus", { major_radius: 0.25, minor_radius: 0.08 }], ["rod", { length: 0.7 }], ["disc", { radius: 0.3 }], ["plate", { half_extents: [0.3, 0.2] }],
    ["tetrahedron", { vertices: [0.3, 0, -0.1, -0.2, 0.25, -0.1, -0.2, -0.25, -0.1, 0, 0, 0.3] }], ["frustum", { bottom_radius: 0.3, top_radius: 0.12, height: 0.5 }],
  ];
  const bodies = [
    ...shapes.map(([type, sizes]) => body(type, { parts: [part(type, sizes)] })),
    body("with a hole", { parts: [part("box", { half_extents: [0.3, 0.3, 0.1] }), part("cylinder", { radius: 0.12, half_height: 0.11 }, [0.1, 0, 0], [1, 0, 0, 0], true)] }),
    body("points", { points: [0.3, 0, 0, -0.3, 0, 0, 0, 0.2, 0, 0, 0, 0.25] }),
    body("mesh", { vertices: [-0.3, -0.3, -0.1, 0.3, -0.3, -0.1, 0.3, 0.3, -0.1, -0.3, 0.3, -0.1, 0, 0, 0.4], faces: [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 0, 2, 1, 0, 3, 2] }),
    body("moments", { moments: [0.02, 0.03, 0.045] }),
  ];
  const tilt: Quaternion = [Math.cos(0.5), Math.sin(0.5), 0, 0];
  const frames = (more: Quaternion): Frame[] => Array.from({ length: 41 }, (_, k) => {
    const t = k / 8;
    const q = multiply(multiply(tilt, [Math.cos(0.6 * t), 0, 0, Math.sin(0.6 * t)]), more);
    return { t, bodies: bodies.map((_one, i): BodyState => ({ q, w: rotate(conjugate(more), [0, 0, 1.2]), p: [(i % 6) * 0.9, 0, -Math.floor(i / 6) * 0.9], v: [0, 0, 0] })) };
  });
  const truth = frames([1, 0, 0, 0]);
  return motion({ duration: 5, moving: true, bodies, truth: trackOf(truth), methods: [methodOf(0, "article_as_written", truth, frames([Math.cos(0.15), Math.sin(0.15), 0, 0]))] });
}

function smallAndFar(): Motion {
  const [duration, count] = [2e-8, 300];
  const rate = eulersEquations([2e-26, 3e-26, 4e-26]);
  const state = (y: readonly number[], t: number): BodyState[] =>
    [{ q: attitudeOf(y), w: rateOf(y), p: [2 * t, 3 * t - 1.5e8 * t * t, 5 * t - 2.5e8 * t * t], v: [2, 3 - 3e8 * t, 5 - 5e8 * t] }];
  const truth = solved(rate, [1, 0, 0, 0, 3e8, 1e8, 2e9], duration, count, 20, rk4, state);
  return motion({ duration, moving: true, gravity: [0, -3e8, -5e8], planes: [{ normal: [0, 0, 1], offset: 0 }], bodies: [body("small", { mass: 1e-7, moments: [2e-26, 3e-26, 4e-26] })], truth: trackOf(truth) });
}

/** A solid ball that slides on level ground without rotation at first: it rolls from t = 2 u / (7 mu g) on, with 5/7 of
 * its initial speed u. */
function slidingBall(): Motion {
  const [radius, mu, g, u, duration, count, mass] = [0.1, 0.25, 9.8, 3.5, 1, 200, 2];
  const rolls = (2 * u) / (7 * mu * g);
  const state = (t: number): BodyState => {
    const s = Math.min(t, rolls);
    const [speed, turn] = [u - mu * g * s, (2.5 * mu * g * s) / radius];
    const [x, angle] = [u * s - 0.5 * mu * g * s * s + speed * (t - s), ((1.25 * mu * g * s * s) / radius) + turn * (t - s)];
    return { q: [Math.cos(angle / 2), 0, Math.sin(angle / 2), 0], w: [0, turn, 0], p: [x, 0, radius], v: [speed, 0, 0] };
  };
  const frames = Array.from({ length: count + 1 }, (_, k) => ({ t: (k * duration) / count, bodies: [state((k * duration) / count)] }));
  // 21 samples in each of two intervals
  const t = [0, 1].flatMap((part) => Array.from({ length: 21 }, (_, k) => (part === 0 ? (rolls * (k + 2e-5)) / 20.00004 : rolls + ((duration - rolls) * (k + 2e-5)) / 20.00004)));
  return motion({
    duration, moving: true, gravity: [0, 0, -g], planes: [{ normal: [0, 0, 1], offset: 0 }], truth: trackOf(frames),
    bodies: [body("sliding_ball", { mass, moments: [0.008, 0.008, 0.008], parts: [part("sphere", { radius })] })],
    timeline: {
      rows: [{ name: "lane", unit: "N s", modes: [{ from: 0, to: rolls, mode: "sliding" }, { from: rolls, to: duration, mode: "rolling" }] }],
      events: [{ t: rolls, row: 0, kind: "rolls", normal: 0, tangential: 0 }], total: 1,
    },
    contacts: [{
      row: 0, body: 0, plane: 0, friction: mu, starts: [0, 21], t, point: t.flatMap((one) => [state(one).p[0], 0, 0]), normal_force: t.map(() => mass * g),
      friction_force: t.flatMap((one) => [one < rolls ? -mu * mass * g : 0, 0, 0]), slip: t.flatMap((one) => [one < rolls ? u - 3.5 * mu * g * one : 0, 0, 0]),
    }],
    methods: [methodOf(1, "rk4", frames, frames, { step: 0.01 })],
  });
}

/** A slider between stops at 0 and 1 m, without forces: each impact halves its speed, until friction holds it. */
function sliderWithStops(): Motion {
  const duration = 8;
  const hits = [0.5, 1.5, 3.5, 7.5]; // s: distances 0.5 m at 1 m/s, then 1 m at 1, 1/2, .. m/s
  const speeds = [1, -1, 0.5, -0.25, 0];
  const at = (t: number): [number, number] => {
    const k = hits.filter((hit) => hit < t).length;
    const before = hits[k - 1];
    return before === undefined ? [0.5 + t, 1] : [(k % 2 === 1 ? 1 : 0) + (speeds[k] ?? 0) * (t - before), speeds[k] ?? 0];
  };
  const times = [...Array.from({ length: 161 }, (_, k) => k / 20), ...hits.map((hit) => hit + 1e-8)].sort((a, b) => a - b);
  const frames = times.map((t) => ({ t, bodies: [{ q: [1, 0, 0, 0] as Quaternion, w: [0, 0, 0] as Vector, p: [at(t)[0], 0, 0] as Vector, v: [at(t)[1], 0, 0] as Vector }] }));
  return motion({
    duration, moving: true, truth: trackOf(frames), bodies: [body("slider", { parts: [part("box", { half_extents: [0.1, 0.1, 0.1] })] })],
    joints: [{ name: "rail", type: "prismatic", parent: -1, child: 0, parent_point: [0, 0, 0], child_point: [0, 0, 0], axis: [1, 0, 0] }],
    timeline: {
      rows: [{ name: "rail", unit: "N s", modes: [{ from: 0, to: 7.5, mode: "free" }, { from: 7.5, to: 8, mode: "at lower limit" }] }],
      events: hits.map((t, k) => ({ t, row: 0, kind: k < 3 ? "impact" : "rests", normal: k < 3 ? (speeds[k + 1] ?? 0) - (speeds[k] ?? 0) : 0.25, tangential: 0 })), total: 6,
    },
    coordinates: { t: times, curves: [{ name: "rail", joint: 0, unit: "m", lower: 0, upper: 1, x: times.map((t) => at(t)[0]), rate: times.map((t) => at(t)[1]) }], total: 1 },
    remark: "Limits are shown as lines.",
  });
}

/** A document with these motions and a scene without motion. */
export function motionDocument(): ReportData {
  const made: [string, Motion | null][] = [
    ["t_handle", tHandle()], ["lagrange_top", top()], ["double_pendulum", doublePendulum()], ["every_shape", everyShape()], ["small_and_far", smallAndFar()], ["sliding_ball", slidingBall()], ["slider", sliderWithStops()], ["unknown", null],
  ];
  const families = [["article", "Articles", "#a14e00", "#f0a35a"], ["runge_kutta", "Runge-Kutta", "#00518a", "#7cc0ff"], ["multistep", "Multistep", "#5b3fa0", "#b9a4f0"]] as const;
  const methods = [["article_as_written", 0, 0], ["rk4", 1, 0], ["cvode_adams", 2, 2], ["odeint_fehlberg78", 1, 7], ["radau", 1, 3]] as const;
  const motions = made.flatMap(([, one]) => (one === null ? [] : [one]));
  motions.forEach((one, scene) => (one.scene = scene));
  return {
    ...emptyDocument(), folder: "motions", motions,
    families: families.map(([name, label, color, color_dark]) => ({ name, label, color, color_dark })),
    methods: methods.map(([name, family, mark]) => ({ name, family, mark, library: "polhode", precision: "binary64", order: 4, documentation: "", source: "", conserves: "" })),
    scenes: made.map(([name, one]) => ({ name, about: "", source: "", duration: one?.whole ?? null, experiments: [], fastest: [], floor: null, motion: one === null ? null : motions.indexOf(one) })),
  };
}
