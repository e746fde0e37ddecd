// What the page shows: the document that `polhode report` puts into it (src/report/document.cpp writes it).
// Units are SI and radians; what does not exist is null. Names are texts from files of anyone's making: they are only
// ever set as text, never as markup.

export interface ReportData {
  format: 1;
  folder: string; // the folder's name, without the way to it
  made: string; // ISO 8601, UTC
  version: string; // of polhode
  experiments: Experiment[];
  families: Family[];
  methods: Method[];
  scenes: Scene[];
  findings: Finding[]; // at most three, the first first
  rows: Rows;
  orders: Order[];
  drift: Drift[];
  maps: StabilityMap[];
  tables: Table[];
  comparison: Comparison | null;
  checks: Check[];
  motions: Motion[];
  remarks: string[]; // what was thinned or left out, a sentence each
}

/** An experiment of the folder and where its numbers come from (provenance.json). */
export interface Experiment {
  name: string;
  about: string;
  kind: string; // "sweep", "convergence", "drift", ..; "" where it is not known
  date: string;
  quick: boolean;
  facts: [string, string][]; // "CPU", "cores", "compiler", "flags", "commit", versions of libraries, ..
}

export interface Family {
  name: string; // "runge_kutta"
  label: string; // "Runge-Kutta"
  color: string; // "#rrggbb" on white
  color_dark: string; // on a dark ground
}

export interface Method {
  name: string;
  family: number; // index into families
  mark: number; // index into the marks, see below; the place within its family
  library: string; // "polhode", "SUNDIALS", "Boost.Odeint", ..
  precision: string; // "binary64", "binary32", ..
  order: number; // claimed; 0: variable, or not known
  documentation: string; // its first sentence
  source: string;
  conserves: string;
}

// Marks in order, in plotly's names; a mark beyond the last begins anew with a dash ("solid", "dash", "dot", ..):
// circle square triangle-up diamond triangle-down pentagon, the same with -open, then cross-thin-open x-thin-open
// asterisk-open

export interface Scene {
  name: string; // with its variation: "free_asymmetric{/duration=40000}"
  about: string;
  source: string;
  duration: number | null;
  experiments: number[]; // that have rows of it
  /** the fastest run within each attitude error, rad */
  fastest: { error: number; row: number | null; runner_up: number | null }[]; // rows of `rows`
  floor: number | null; // conditioning floor in binary64, rad: kappa 2^-53
  motion: number | null; // index into motions
}

export interface Finding {
  title: string;
  text: string;
  link: string; // a fragment: "#section=work-precision&scene=free_asymmetric"
}

/** Columns of result rows that are indices, codes or flags. */
export const indexColumns = [
  "experiment", "scene", "method",
  "setting_kind", // 0 none, 1 step (s), 2 tolerance
  "status", // 0 ok, 1 unsupported, 2 diverged, 3 tolerance_not_met, 4 failed
  "message", // index into messages
  "cut", // 1: ended by the limit on a run's time, steps or evaluations
  "formulation", // index into formulations
] as const;

/** Columns of numbers that the page's code names. A document may have more: the page shows each as a column of its table
 * of results. `result_column_table()` (src/experiment/run/result.cpp) defines them; a test compares. */
export const numberColumns = [
  "setting", "seconds", "evaluations", "attitude_final", "attitude", "omega", "energy", "momentum", "norm", "floor", "floor32",
] as const;

/** Result rows as columns of one length. */
export type Rows = {
  count: number;
  total: number; // in the folder; more than `count`: thinned, and a remark says how
  messages: string[]; // the first is ""
  formulations: string[];
} & Record<(typeof indexColumns)[number], number[]> & Record<(typeof numberColumns)[number], (number | null)[]>;

/** The fitted order of one curve of a convergence experiment. */
export interface Order {
  experiment: number;
  scene: number;
  method: number;
  setting_kind: number;
  claimed: number | null;
  observed: number | null;
  points: number | null; // that the fit went through
  from: number | null; // settings
  to: number | null;
}

/** Errors over time of one run. */
export interface Drift {
  experiment: number;
  scene: number;
  method: number;
  setting: number | null;
  t: number[];
  attitude: (number | null)[];
  omega: (number | null)[];
  energy: (number | null)[];
  momentum: (number | null)[];
  norm: (number | null)[];
  /** exponents p of error ~ t^p and half the difference between those of the first and second half; null where no fit holds */
  growth: Partial<Record<"attitude" | "omega" | "energy" | "momentum" | "norm", [number, number]>>;
  thinned: boolean;
}

/** What came of each pair of step and parameter of one method. */
export interface StabilityMap {
  method: number;
  map: string; // "spin", "stiffness"
  x_label: string;
  y_label: string;
  x: number[];
  y: number[];
  outcome: number[]; // outcome[j * x.length + i]: index into outcomes; -1: not run
  outcomes: string[]; // from best to worst
}

/** Any other table of the folder. */
export interface Table {
  name: string; // of its file, without .csv
  title: string;
  experiment: string;
  columns: { name: string; numeric: boolean; integral: boolean }[];
  rows: (string | number | null)[][];
  total: number; // rows in the file
}

/** Two folders: run time and errors at the same settings. A ratio is the other's over this one's: above 1, this one is
 * faster. */
export interface Comparison {
  folder: string;
  experiments: Experiment[];
  same_bits: number; // matched rows whose attitude errors are equal to the last bit
  matched: number;
  only_here: number;
  only_there: number;
  methods: {
    method: number;
    scenes: number;
    pairs: number;
    ratio: number; // geometric mean, of the scenes' geometric means
    low: number | null; // 95 % confidence interval; null where there are too few
    high: number | null;
    error_ratio: number | null; // geometric mean of attitude errors
  }[];
  pairs: { row: number; seconds: number; error: number | null }[]; // a row of `rows`, the other's values
  all: { ratio: number; low: number | null; high: number | null; scenes: number };
  how: string; // how the interval is got, a sentence
}

/** The judgement of one trajectory of the user's. */
export interface Check {
  file: string;
  scene: number;
  verdict: string; // "passed", "failed", or why it could not be judged
  passed: boolean | null;
  blocks: { name: string; error: number | null; unit: string; limit: number | null; passed: boolean | null; at: number | null }[];
  lines: string[]; // the report in words
  diagnoses: string[]; // what ails it
  t: number[];
  errors: { name: string; unit: string; values: (number | null)[] }[];
  motion_method: number | null; // place in the scene's motion.methods, where the trajectory is to be seen
}

/** The motion of one scene, for drawing. Body lengths are in m, from each body's centre of mass, in body axes. */
export interface Motion {
  scene: number;
  duration: number; // s, of what is shown
  whole: number; // s, of the scene
  thinning: { angle: number; length: number }; // rad, m: what the keyframes' interpolation is off at most
  bodies: BodyShape[];
  joints: { name: string; type: string; parent: number; child: number; parent_point: number[]; child_point: number[]; axis: number[] | null }[]; // -1: the world; points from the centre of mass (of the world: its origin)
  pivot: number[] | null; // point of the body, from its centre of mass, that is held at the world's origin
  planes: { normal: number[]; offset: number }[];
  gravity: number[] | null; // m/s^2, world
  moving: boolean; // whether any centre of mass moves
  free: boolean; // no torque: the polhode stays on its ellipsoid
  about: { moments: number[]; principal: number[] } | null; // of one body: about the pivot where there is one
  energy: number; // J, of rotation at the start, of one body; 0 of several
  truth: Track;
  how: string; // how the truth was made, and its bound
  methods: MotionMethod[];
}

export interface BodyShape {
  name: string;
  mass: number;
  moments: number[]; // principal, kg m^2
  principal: number[]; // quaternion, principal to body axes
  parts: Part[]; // of the shape; empty: draw a box of these moments
  vertices: number[] | null; // of a mesh, three numbers each
  faces: number[] | null; // of a mesh, three indices each
  points: number[] | null; // of a body of points, three numbers each
}

export interface Part {
  type: string; // "box", "sphere", "cylinder", "capsule", "cone", .. as in scene files, with the same keys
  sizes: Record<string, number | number[]>; // "half_extents", "radius", "half_height", ..
  position: number[]; // of the shape's origin, from the body's centre of mass, body axes
  orientation: number[]; // w, x, y, z, shape to body axes
  hole: boolean; // of negative density
}

/** Keyframes. Between two of them: positions by cubic Hermite from p and v; attitudes by the cubic Hermite of the four
 * quaternion components with derivative q' = q (0, w) / 2, then normalised; w by cubic Hermite without its derivative's
 * knowledge (linear). Integers are scaled: x = integer * scale. */
export interface Track {
  t: number[]; // s
  bodies: {
    q: number[]; // four integers a keyframe, to be divided by their length: w, x, y, z, body to world
    w: number[]; // three integers a keyframe: angular velocity, body axes
    w_scale: number; // rad/s
    p: number[]; // three integers a keyframe: centre of mass, world; empty where it does not move
    v: number[]; // likewise its velocity
    p_scale: number; // m
    v_scale: number; // m/s
    p_start: number[]; // m, to be added
  }[];
}

export interface MotionMethod {
  method: number; // index into methods; -1: a trajectory of the user's
  label: string; // of a user's trajectory its file; else the method's name
  setting_kind: number;
  setting: number | null;
  status: number; // as in rows
  message: string;
  /** null: no further from the truth than `difference`, which is below what a picture shows: draw the truth's */
  track: Track | null;
  difference: number | null; // rad, the largest attitude error over what is shown
  t: number[]; // of the errors
  attitude: (number | null)[]; // rad, of the worst body
}
