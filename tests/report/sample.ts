// Sample documents for tests of the page: one that resembles measured data, and hostile ones.

import { indexColumns, numberColumns, type Check, type Drift, type Method, type Motion, type Order, type ReportData, type Rows, type StabilityMap, type Table } from "../../src/report/page/source/data.ts";
import { freeLesson, topLesson } from "./lesson_sample.ts";

/** Reproducible random numbers: a linear congruential generator with the constants of Numerical Recipes. */
function generator(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

export function emptyRows(): Rows {
  const columns = Object.fromEntries([...indexColumns, ...numberColumns].map((name) => [name, []]));
  return { count: 0, total: 0, messages: [""], formulations: [""], ...columns } as unknown as Rows;
}

export function emptyDocument(): ReportData {
  return {
    format: 1, folder: "empty", made: "2026-11-25T02:00:00Z", version: "1.0.0", experiments: [], families: [], methods: [], scenes: [],
    findings: [], rows: emptyRows(), orders: [], drift: [], maps: [], tables: [], comparison: null, checks: [], motions: [], lessons: [], lesson_page: false, remarks: [],
  };
}

interface Line {
  experiment: number;
  scene: number;
  method: number;
  kind: number;
  setting: number | null;
  status?: number;
  message?: string;
  seconds?: number | null;
  evaluations?: number | null;
  error?: number | null;
  floor?: number | null;
  cut?: boolean;
  formulation?: string;
}

function place(list: string[], text: string): number {
  const found = list.indexOf(text);
  return found >= 0 ? found : list.push(text) - 1;
}

export function addRow(rows: Rows, line: Line): number {
  const error = line.error ?? null;
  rows.experiment.push(line.experiment);
  rows.scene.push(line.scene);
  rows.method.push(line.method);
  rows.setting_kind.push(line.kind);
  rows.setting.push(line.setting);
  rows.status.push(line.status ?? 0);
  rows.message.push(place(rows.messages, line.message ?? ""));
  rows.seconds.push(line.seconds ?? null);
  rows.evaluations.push(line.evaluations ?? null);
  rows.attitude.push(error);
  rows.attitude_final.push(error === null ? null : 0.8 * error);
  rows.omega.push(error === null ? null : 0.4 * error);
  rows.energy.push(error === null ? null : 0.05 * error);
  rows.momentum.push(error === null ? null : 0.1 * error);
  rows.norm.push(error === null ? null : 1e-16);
  rows.floor.push(line.floor ?? null);
  rows.floor32.push(line.floor === undefined || line.floor === null ? null : line.floor * 2 ** 29);
  rows.cut.push(line.cut === true ? 1 : 0);
  rows.formulation.push(place(rows.formulations, line.formulation ?? ""));
  rows.count = rows.total = rows.experiment.length;
  return rows.count - 1;
}

const families = [
  { name: "exact", label: "Exact", color: "#1c2127", color_dark: "#e6e9ed" },
  { name: "runge_kutta", label: "Runge-Kutta", color: "#0072b2", color_dark: "#56b4e9" },
  { name: "extrapolation", label: "Extrapolation", color: "#b04a00", color_dark: "#ff9d4d" },
  { name: "multistep", label: "Multistep", color: "#00795a", color_dark: "#3fd1a5" },
  { name: "geometric", label: "Geometric", color: "#9c3f76", color_dark: "#e79ac6" },
  { name: "implicit", label: "Implicit", color: "#7f4f24", color_dark: "#d9a676" },
  { name: "game", label: "Game engines", color: "#8a6d00", color_dark: "#e6c200" },
];

interface Kind {
  name: string;
  family: number;
  library: string;
  order: number;
  constant: number; // error = constant * step^order
  stages: number;
  byTolerance: boolean;
  precision?: string;
}

const kinds: Kind[] = [
  { name: "exact", family: 0, library: "polhode", order: 0, constant: 0, stages: 0, byTolerance: false },
  ...[["euler", 1, 1], ["midpoint_2", 2, 2], ["rk4", 4, 4], ["kutta_nystrom_5", 5, 6], ["verner_6", 6, 8], ["dop853", 8, 12]].map(([name, order, stages]): Kind =>
    ({ name: String(name), family: 1, library: "polhode", order: Number(order), constant: 0.02 * 1.7 ** -Number(order), stages: Number(stages), byTolerance: name === "dop853" })),
  ...["odeint_rk4", "odeint_dopri5", "odeint_fehlberg78"].map((name, i): Kind =>
    ({ name, family: 1, library: "Boost.Odeint", order: [4, 5, 8][i] ?? 4, constant: 0.01 / (i + 1), stages: [4, 6, 13][i] ?? 4, byTolerance: i > 0 })),
  { name: "extrapolation", family: 2, library: "polhode", order: 12, constant: 1e-5, stages: 40, byTolerance: true },
  { name: "odeint_bulirsch_stoer", family: 2, library: "Boost.Odeint", order: 10, constant: 1e-4, stages: 44, byTolerance: true },
  { name: "taylor", family: 2, library: "polhode", order: 16, constant: 3e-7, stages: 30, byTolerance: true },
  ...["adams_4", "adams_6", "cvode_adams", "arkode_erk_8"].map((name, i): Kind =>
    ({ name, family: 3, library: i < 2 ? "polhode" : "SUNDIALS", order: [4, 6, 6, 8][i] ?? 4, constant: 0.2 / (i + 1), stages: [1, 1, 2, 12][i] ?? 1, byTolerance: i > 1 })),
  ...["mclachlan_zanna_2", "mclachlan_zanna_4", "mclachlan_zanna_6", "lie_midpoint", "crouch_grossman_3", "munthe_kaas_4", "buss_3", "symmetric_split_4", "cayley_2"].map((name, i): Kind =>
    ({ name, family: 4, library: "polhode", order: [2, 4, 6, 2, 3, 4, 3, 4, 2][i] ?? 2, constant: 0.03 / (1 + i), stages: [1, 3, 7, 2, 3, 4, 2, 5, 2][i] ?? 1, byTolerance: false })),
  ...["radau", "gauss_4", "gauss_6", "cvode_bdf"].map((name, i): Kind =>
    ({ name, family: 5, library: i === 3 ? "SUNDIALS" : "polhode", order: [5, 4, 6, 5][i] ?? 4, constant: 0.02, stages: [22, 14, 21, 4][i] ?? 4, byTolerance: i === 0 || i === 3 })),
  ...["bullet_explicit", "bullet_implicit", "ode_quickstep"].map((name, i): Kind =>
    ({ name, family: 6, library: ["Bullet", "Bullet", "ODE"][i] ?? "", order: 1, constant: 0.5 + 0.2 * i, stages: 1, byTolerance: false, precision: i === 0 ? "binary32" : "binary64" })),
];

const sceneList: [string, string, number, number][] = [
  ["free_asymmetric", "A torque-free asymmetric body, spun about an axis away from its principal axes.", 10, 2.4e-15],
  ["dzhanibekov", "A body that flips repeatedly about its intermediate axis.", 100, 6e-13],
  ["lagrange_top", "A symmetric heavy top, fast.", 20, 1.1e-14],
  ["stiff_drag", "A body with drag much faster than its motion.", 1, 3e-16],
  ["free_asymmetric{/duration=40000}", "The first scene over a long time.", 40000, 4e-12],
  ["mechanisms/double_pendulum_spatial", "Two bodies on ball joints.", 5, 9.8e-15],
];

export function methodsOfSample(): Method[] {
  const marks = families.map(() => 0);
  return kinds.map((kind) => ({
    name: kind.name, family: kind.family, mark: marks[kind.family]!++, library: kind.library, precision: kind.precision ?? "binary64",
    order: kind.order, documentation: `The method ${kind.name}.`, source: `integrators/own/${kind.name}.cpp`, conserves: kind.family === 4 ? "the momentum's size" : "",
  }));
}

/** A document with data in every section. */
export function richDocument(): ReportData {
  const random = generator(20261125);
  const data = emptyDocument();
  data.folder = "results";
  data.families = families;
  data.methods = methodsOfSample();
  const facts: [string, string][] = [
    ["CPU", "AMD EPYC 7763 64-Core Processor"], ["cores", "2"], ["compiler", "GNU 12.2.0"], ["flags", "-O3 -march=native -fno-math-errno"],
    ["commit", "b452b97"], ["SUNDIALS", "6.4.1, built from source with -O3"], ["system", "Debian GNU/Linux 12"],
  ];
  data.experiments = [
    { name: "work_precision", about: "Every method on every scene.", kind: "sweep", date: "2026-11-20", quick: false, facts },
    { name: "convergence", about: "Do methods have the order they claim?", kind: "convergence", date: "2026-11-20", quick: false, facts: [...facts, ["repeats", "3"]] },
    { name: "drift", about: "How errors grow.", kind: "drift", date: "2026-11-21", quick: true, facts },
    { name: "engines", about: "Physics engines.", kind: "engines", date: "2026-11-21", quick: false, facts },
  ];
  data.scenes = sceneList.map(([name, about, duration, floor], s) => ({
    name, about, source: s === 1 ? "Dzhanibekov 1985" : "", duration, experiments: [], fastest: [], floor, motion: null,
  }));

  data.scenes.forEach((scene, s) => {
    const floor = scene.floor ?? 1e-15;
    const length = Math.min(scene.duration ?? 1, 100);
    kinds.forEach((kind, m) => {
      for (const experiment of s < 2 ? [0, 1] : [0]) {
        if (!scene.experiments.includes(experiment)) scene.experiments.push(experiment);
        if (kind.name === "exact") {
          if (s === 3 || s === 5) addRow(data.rows, { experiment, scene: s, method: m, kind: 0, setting: null, status: 1, message: "only torque-free motion of one body" });
          else addRow(data.rows, { experiment, scene: s, method: m, kind: 0, setting: null, seconds: 5e-7, evaluations: 0, error: floor * (0.5 + random()), floor });
          continue;
        }
        if (s === 5 && kind.family === 4 && m % 2 === 0) {
          addRow(data.rows, { experiment, scene: s, method: m, kind: 1, setting: 0.1, status: 1, message: "mechanisms are not supported" });
          continue;
        }
        for (let n = 0; n < (experiment === 1 ? 12 : 9); ++n) {
          const step = (experiment === 1 ? 0.5 : 0.25) / 2 ** n;
          const setting = kind.byTolerance ? 10 ** -(3 + n) : step;
          const effective = kind.byTolerance ? Math.max(1e-4, (setting / kind.constant / 30) ** (1 / kind.order)) : step;
          const evaluations = Math.ceil((length / effective) * kind.stages);
          const truncation = kind.constant * effective ** kind.order * (0.8 + 0.4 * random()) * Math.sqrt(length);
          const precision = kind.precision === "binary32" ? 2 ** 29 : 1;
          const rounding = precision * floor * (0.7 + 0.6 * random()) * Math.max(1, Math.sqrt(evaluations) / 60);
          const seconds = evaluations * (3.2e-8 + 5e-9 * random()) * (kind.library === "SUNDIALS" ? 3 : 1);
          const line: Line = { experiment, scene: s, method: m, kind: kind.byTolerance ? 2 : 1, setting, seconds, evaluations, error: Math.min(Math.PI, truncation + rounding), floor, formulation: "reduced" };
          if (s === 3 && kind.family !== 5 && n < 3) addRow(data.rows, { ...line, status: 2, message: "the energy grew beyond all bounds", seconds: n === 0 ? null : seconds, error: null });
          else if (kind.byTolerance && n === 8 && s === 1) addRow(data.rows, { ...line, status: 3, message: "the step fell below what binary64 resolves", error: null });
          else if (kind.name === "gauss_6" && n === 0) addRow(data.rows, { ...line, status: 4, message: "Newton's iteration did not converge", seconds: null, evaluations: null, error: null });
          else if (seconds > 0.05) {
            addRow(data.rows, { ...line, cut: true, status: 4, message: "time limit exceeded", error: null });
            break;
          } else addRow(data.rows, line);
        }
      }
    });
    for (const error of [1e-6, 1e-9, 1e-12]) {
      const best = new Map<number, number>();
      for (let i = 0; i < data.rows.count; ++i) {
        const seconds = data.rows.seconds[i] ?? null;
        if (data.rows.scene[i] !== s || data.rows.status[i] !== 0 || seconds === null || !((data.rows.attitude[i] ?? 9) <= error)) continue;
        const method = data.rows.method[i]!;
        const old = best.get(method);
        if (old === undefined || seconds < (data.rows.seconds[old] ?? Infinity)) best.set(method, i);
      }
      const order = [...best.values()].sort((a, b) => (data.rows.seconds[a] ?? 0) - (data.rows.seconds[b] ?? 0));
      scene.fastest.push({ error, row: order[0] ?? null, runner_up: order[1] ?? null });
    }
  });

  data.findings = [
    { title: "exact is 890 times as fast", text: "On free_asymmetric, to 1e-12 rad, exact takes 508 ns and the fastest library 452 µs.", link: "#section=work-precision&scene=free_asymmetric" },
    { title: "3 methods converge below their claimed order", text: "Three of 34 methods converge with an order more than 0.2 below the claimed one.", link: "#section=convergence" },
    { title: "radau wins where the motion is stiff", text: "On stiff_drag it is 5.6 times as fast as the next.", link: "#section=work-precision&scene=stiff_drag&lit=radau,cvode_bdf" },
  ];
  data.remarks = ["The table stability_maps has 120 000 rows; every second value of the step is shown."];

  kinds.forEach((kind, m) => {
    if (kind.order === 0) return;
    for (const scene of [0, 1]) {
      const order: Order = {
        experiment: 1, scene, method: m, setting_kind: kind.byTolerance ? 2 : 1, claimed: kind.byTolerance ? null : kind.order,
        observed: kind.byTolerance ? 0.9 + 0.3 * random() : kind.order + (kind.name === "buss_3" ? -0.9 : 0.06 * (random() - 0.5)), points: 5, from: 0.002, to: 0.06,
      };
      data.orders.push(order);
    }
  });

  [3, 4, 6, 10, 12, 16, 18, 19, 20, 24].forEach((m, i) => {
    for (const scene of [0, 2]) {
      const t: number[] = [];
      const attitude: (number | null)[] = [];
      const energy: (number | null)[] = [];
      const exponent = i % 3 === 0 ? 2 : 1;
      for (let n = 0; n < 120; ++n) {
        t.push(0.1 * 10 ** (n / 30));
        attitude.push(Math.min(Math.PI, 10 ** -(13 - i) * (t[n] ?? 0) ** exponent * (0.9 + 0.2 * random())));
        energy.push(10 ** -(15 - i * 0.6) * (i % 2 === 0 ? (t[n] ?? 0) * (0.8 + 0.4 * random()) : 1 + random()));
      }
      const drift: Drift = {
        experiment: 2, scene, method: m, setting: 0.01, t, attitude, omega: attitude.map((one) => (one === null ? null : 0.3 * one)), energy,
        momentum: energy.map((one) => (one === null ? null : 2 * one)), norm: t.map(() => 2e-16),
        growth: { attitude: [exponent + 0.02 * (random() - 0.5), 0.013], energy: i % 2 === 0 ? [1.01, 0.05] : [0.02, 0.04] }, thinned: false,
      };
      data.drift.push(drift);
    }
  });

  const outcomes = ["accurate", "bounded", "wrong", "diverged"];
  [1, 2, 3, 15, 17, 22].forEach((m, i) => {
    for (const map of ["spin", "stiffness"]) {
      const x = Array.from({ length: 24 }, (_, k) => 10 ** (-3 + k / 8));
      const y = Array.from({ length: 18 }, (_, k) => 10 ** (-1 + k / 6));
      const outcome: number[] = [];
      for (const q of y) for (const p of x) {
        const z = p * q * (1 + i * 0.4);
        outcome.push(z < 0.02 ? 0 : z < 0.3 ? 1 : z < 2 ? 2 : z > 300 ? -1 : 3);
      }
      const one: StabilityMap = { method: m, map, x_label: "step (s)", y_label: map === "spin" ? "spin (rad/s)" : "stiffness (1/s)", x, y, outcome, outcomes };
      data.maps.push(one);
    }
  });

  const table = (name: string, title: string, columns: string[], rows: (string | number | null)[][], integral: string[] = []): Table => ({
    name, title, experiment: name.split("_")[0] ?? "", rows, total: rows.length,
    columns: columns.map((column, c) => ({ name: column, numeric: rows.some((row) => typeof row[c] === "number"), integral: integral.includes(column) })),
  });
  data.tables = [
    table("leave_out_gain", "Gain of the reduced formulation", ["scene", "method", "gain", "left_out"],
      sceneList.slice(0, 4).flatMap(([scene], s) => ["rk4", "dop853", "cvode_adams", "extrapolation"].map((method, i): (string | number | null)[] =>
        [scene, method, s === 3 && i === 0 ? null : 1.1 + 0.6 * s + 0.3 * i + 0.2 * random(), "p and v; gyroscopic term w x Iw"]))),
    table("inertia", "Moments of inertia by several methods", ["shape", "way", "pieces", "seconds_median", "inertia_error"],
      ["box", "torus", "capsule"].flatMap((shape) => [
        [shape, "closed_form", 1, 1e-8, 5e-17],
        ...[64, 512, 4096, 32768].map((n): (string | number | null)[] => [shape, "grid", n, 4.1e-9 * n, n ** (-2 / 3)]),
        ...[12, 48, 192, 768].map((n): (string | number | null)[] => [shape, "mesh", n, 2.2e-9 * n, shape === "box" ? 2e-16 : 0.5 / n]),
        ...[64, 512, 4096].map((n): (string | number | null)[] => [shape, "samples", n, 6e-9 * n, 0.5 * n ** -0.5]),
      ]), ["pieces"]),
    table("engines_leaderboard", "Physics engines, ranked by attitude error", ["place", "engine", "setting", "median_place", "scenes", "attitude_error", "energy_error", "order", "step_nanoseconds", "message"],
      ["simbody", "mujoco", "bullet", "ode", "dart", "rapier"].map((engine, i) => [i + 1, engine, "default", i + 1, 17 + (i % 2), 10 ** (-3 + 0.4 * i), 10 ** (-8 + i), 4.03 - 0.6 * i, 39000 / (1 + 3 * i), i === 5 ? "binary32" : null]), ["place", "scenes"]),
    table("mechanisms_margins", "Run time of polhode and of other libraries at equal error", ["scene", "attitude_error", "own", "own_seconds", "peer", "peer_seconds", "ratio"],
      ["double_pendulum", "four_bar", "spatial_chain"].flatMap((scene, i) => [1e-6, 1e-9].map((error, k): (string | number | null)[] => [scene, error, "taylor", 1e-4 * (i + 1), "cvode_adams", 6e-4 * (i + 1), 1.4 + 2 * i + k])) ),
    table("jointed_methods", "Methods for jointed bodies", ["method", "joint_gap", "attitude_error", "seconds"],
      ["reduced", "sequential_impulses_10", "baumgarte"].map((method, i) => [method, 10 ** (-14 + 5 * i), 10 ** (-9 + 3 * i), 1e-4 * (i + 1)])),
    table("mass_ratio", "Two bodies with different masses", ["method", "ratio", "joint_gap", "attitude_error"],
      ["reduced", "bullet"].flatMap((method, i) => [1, 10, 100, 1000].map((ratio): (string | number | null)[] => [method, ratio, i === 0 ? 1e-14 : 1e-4 * ratio ** 0.5, i === 0 ? 1e-10 : 0.01 * ratio ** 0.3])), ["ratio"]),
    table("long_list", "Many rows", ["name", "value", "count"], Array.from({ length: 350 }, (_, i) => [`row ${i}`, random() * 10 ** ((i % 20) - 15), i]), ["count"]),
  ];

  const matched = data.rows.experiment.flatMap((experiment, i) => (experiment === 0 && data.rows.status[i] === 0 && (data.rows.seconds[i] ?? null) !== null ? [i] : []));
  data.comparison = {
    folder: "before", experiments: data.experiments.slice(0, 1).map((one) => ({ ...one, facts: one.facts.map(([name, value]): [string, string] => [name, name === "commit" ? "1ec48bc" : value]) })), same_bits: matched.length - 7, matched: matched.length, only_here: 3, only_there: 12,
    methods: kinds.slice(0, 24).map((_, m) => {
      const ratio = 10 ** (0.3 * (random() - 0.35));
      return { method: m, scenes: 6, pairs: 50, ratio, low: m === 4 ? null : ratio * 0.96, high: m === 4 ? null : ratio * 1.05, error_ratio: m % 7 === 0 ? 1.02 : 1 };
    }),
    pairs: matched.map((row) => ({ row, seconds: (data.rows.seconds[row] ?? 0) * (1.2 + 0.1 * random()), error: data.rows.attitude[row] ?? null })),
    all: { ratio: 1.21, low: 1.17, high: 1.25, scenes: 6 },
    how: "The interval is Student's confidence interval of the logarithms of the scenes' geometric means.",
  };

  const t = Array.from({ length: 101 }, (_, i) => i / 10);
  const check: Check = {
    file: "engine/free_asymmetric.csv", scene: 0, verdict: "failed", passed: false,
    blocks: [
      { name: "attitude", error: 0.031, unit: "rad", limit: 0.01, passed: false, at: 9.8 },
      { name: "angular velocity", error: 0.0021, unit: "", limit: 0.01, passed: true, at: 4.1 },
      { name: "energy", error: 4e-5, unit: "", limit: null, passed: null, at: 10 },
    ],
    lines: ["101 samples were read; the truth is known to 1e-20."], diagnoses: ["the gyroscopic term w x Iw is missing"], remarks: ["at the float32 floor: the attitude is as accurate as binary32 allows on this scene"],
    t, errors: [{ name: "attitude", unit: "rad", values: t.map((time) => 3.2e-4 * time ** 2 + 1e-7) }, { name: "angular velocity", unit: "", values: t.map((time, i) => (i === 50 ? null : 2e-4 * time + 1e-8)) }],
    motion_method: null,
  };
  data.checks = [
    check,
    { ...check, file: "engine/lagrange_top.csv", scene: 2, verdict: "passed", passed: true, diagnoses: [], remarks: [], blocks: check.blocks.map((block) => ({ ...block, error: 1e-4, passed: block.limit === null ? null : true })), errors: [{ name: "attitude", unit: "rad", values: t.map((time) => 1e-5 * time + 1e-9) }] },
    { ...check, file: "broken.csv", scene: 1, verdict: "the file has no column qw", passed: null, blocks: [], lines: [], diagnoses: [], remarks: [], t: [], errors: [] },
  ];
  data.motions = [motionOf(0)];
  data.lessons = [freeLesson(), topLesson()];
  data.scenes[0]!.motion = 0;
  return data;
}

/** A uniform rotation about a fixed axis. */
function motionOf(scene: number): Motion {
  const t = Array.from({ length: 61 }, (_, i) => i / 10);
  const q = t.flatMap((time) => [Math.round(32767 * Math.cos(time / 2)), 0, 0, Math.round(32767 * Math.sin(time / 2))]);
  return {
    scene, duration: 6, whole: 10, thinning: { angle: 1e-4, length: 1e-4 },
    bodies: [{ name: "body", mass: 1, moments: [1, 2, 3], principal: [1, 0, 0, 0], parts: [], vertices: null, faces: null, points: null }],
    joints: [], pivot: null, planes: [], gravity: null, moving: false, free: true, about: { moments: [1, 2, 3], principal: [1, 0, 0, 0] }, energy: 1.5,
    truth: { t, bodies: [{ q, w: t.flatMap(() => [0, 0, 32767]), w_scale: 1 / 32767, p: [], v: [], p_scale: 1, v_scale: 1, p_start: [0, 0, 0] }] },
    how: "closed form", timeline: null, contacts: [], coordinates: null, remark: "", methods: [{ method: 3, label: "rk4", setting_kind: 1, setting: 0.1, status: 0, message: "", track: null, difference: 1e-7, t, attitude: t.map((time) => 1e-8 * time) }],
  };
}

const nasty = [
  "<script>window.broken=1</script>", "<img src=x onerror=window.broken=1>", '"quotes" & \'apostrophes\'', "</script><b>bold</b>", "<!--", "a,b\\c\nd\te",
  "\u202eright to left", "=1+1", "__proto__", "constructor", "<a href='javascript:window.broken=1'>link</a>", "%{x} $x^2$ {{y}}",
];

/** Names that contain markup and scripts, and names of 10 kB. */
export function hostileNames(): ReportData {
  const data = richDocument();
  const name = (i: number): string => (i % (nasty.length + 1) === nasty.length ? "long ".repeat(2000) + i : `${nasty[i % (nasty.length + 1)]} ${i}`);
  data.folder = nasty[0]!;
  data.version = nasty[1]!;
  data.families = data.families.map((one, i) => ({ ...one, label: name(i), color: i === 0 ? "red;}body{display:none" : one.color }));
  data.methods.forEach((one, i) => Object.assign(one, { name: name(i), library: name(i + 1), documentation: name(i + 2) }));
  data.scenes.forEach((one, i) => Object.assign(one, { name: name(i), about: name(i + 3), source: name(i + 4) }));
  data.experiments.forEach((one, i) => Object.assign(one, { name: name(i), about: name(i + 1), facts: [[name(i), name(i + 1)], ...one.facts] }));
  data.findings = data.findings.map((_, i) => ({ title: name(i), text: name(i + 12), link: "javascript:window.broken=1" }));
  data.rows.messages = data.rows.messages.map((text, i) => (text === "" ? "" : name(i)));
  data.rows.formulations = data.rows.formulations.map((text, i) => (text === "" ? "" : name(i)));
  data.tables.forEach((one, i) => {
    one.title = name(i);
    one.rows = one.rows.map((row, r) => row.map((cell) => (typeof cell === "string" ? name(r) : cell)));
  });
  data.maps.forEach((one) => Object.assign(one, { x_label: name(0), y_label: name(1), outcomes: one.outcomes.map((_, i) => name(i)) }));
  data.checks.forEach((one, i) => Object.assign(one, { file: name(i), verdict: name(i + 1), lines: [name(i)], diagnoses: [name(2)], remarks: [name(3)], errors: one.errors.map((error, k) => ({ ...error, name: name(k), unit: name(1) })) }));
  data.lessons.forEach((one, i) => Object.assign(one, { name: name(i), title: name(i + 1), text: [name(i + 2), name(12)], scene: name(i) }));
  data.remarks = nasty;
  if (data.comparison !== null) Object.assign(data.comparison, { folder: name(12), how: name(0) });
  return data;
}

export function oneRow(): ReportData {
  const data = richDocument();
  const rows = emptyRows();
  addRow(rows, { experiment: 0, scene: 0, method: 3, kind: 1, setting: 0.01, seconds: 1e-4, evaluations: 4000, error: 1e-7, floor: 2e-15 });
  return { ...emptyDocument(), experiments: data.experiments.slice(0, 1), families: data.families, methods: data.methods, scenes: [{ ...data.scenes[0]!, fastest: [{ error: 1e-6, row: 0, runner_up: null }], motion: null, experiments: [0] }], rows };
}

/** All values that may be null are null. */
export function nothingKnown(): ReportData {
  const data = richDocument();
  const rows = emptyRows();
  for (let m = 0; m < 5; ++m) addRow(rows, { experiment: 0, scene: m % 2, method: m, kind: m % 3, setting: null, status: m });
  const nulls = (list: readonly unknown[]): null[] => list.map(() => null);
  return {
    ...data, rows, comparison: data.comparison === null ? null : { ...data.comparison, pairs: [] },
    scenes: data.scenes.map((scene) => ({ ...scene, fastest: scene.fastest.map((one) => ({ ...one, row: null, runner_up: null })), floor: null, duration: null })),
    orders: data.orders.map((order) => ({ ...order, claimed: null, observed: null, points: null, from: null, to: null })),
    drift: data.drift.map((one) => ({ ...one, setting: null, attitude: nulls(one.attitude), omega: nulls(one.omega), energy: nulls(one.energy), momentum: nulls(one.momentum), norm: nulls(one.norm), growth: {} })),
    maps: data.maps.map((one) => ({ ...one, outcome: one.outcome.map(() => -1) })),
    tables: data.tables.map((table) => ({ ...table, rows: table.rows.map((row) => row.map(() => null)) })),
    checks: data.checks.map((one) => ({ ...one, blocks: one.blocks.map((block) => ({ ...block, error: null, limit: null, passed: null, at: null })), errors: one.errors.map((error) => ({ ...error, values: nulls(error.values) })) })),
  };
}

/** `count` rows over 20 scenes and 100 methods. */
export function manyRows(count: number): ReportData {
  const random = generator(7);
  const data = emptyDocument();
  data.folder = "many rows";
  data.families = families;
  data.experiments = [{ name: "sweep", about: "Many rows.", kind: "sweep", date: "2026-11-20", quick: false, facts: [["CPU", "any"]] }];
  const methods = 100;
  const scenes = 20;
  data.methods = Array.from({ length: methods }, (_, m) => ({
    name: `method_${m}`, family: m % families.length, mark: Math.floor(m / families.length), library: m % 3 === 0 ? "SUNDIALS" : "polhode", precision: "binary64", order: 1 + (m % 8), documentation: "", source: "", conserves: "",
  }));
  data.scenes = Array.from({ length: scenes }, (_, s) => ({ name: `scene_${s}`, about: "A scene.", source: "", duration: 10, experiments: [0], fastest: [], floor: 1e-15, motion: null }));
  const settings = Math.ceil(count / methods / scenes);
  for (let i = 0; i < count; ++i) {
    const s = i % scenes;
    const m = Math.floor(i / scenes) % methods;
    const n = Math.floor(i / scenes / methods);
    const order = 1 + (m % 8);
    const step = 0.5 * 10 ** ((-4 * n) / settings);
    const evaluations = Math.ceil((10 / step) * order);
    addRow(data.rows, { experiment: 0, scene: s, method: m, kind: 1, setting: step, seconds: evaluations * 3e-8 * (1 + 0.1 * random()), evaluations, error: 0.1 * step ** order * (0.9 + 0.2 * random()) + 2e-15, floor: 1e-15, formulation: "reduced" });
  }
  return data;
}
