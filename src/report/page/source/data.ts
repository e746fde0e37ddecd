// The page's document, written by src/report/document.cpp. Units are SI and radians; undefined values are null.
// Names come from untrusted files: they are only inserted as text, never as markup.

export interface ReportData {
  format: 1;
  folder: string; // the directory's name without its path
  made: string; // ISO 8601, UTC
  version: string; // polhode's version
  experiments: Experiment[];
  families: Family[];
  methods: Method[];
  scenes: Scene[];
  findings: Finding[]; // at most three, the most important first
  rows: Rows;
  orders: Order[];
  drift: Drift[];
  maps: StabilityMap[];
  tables: Table[];
  comparison: Comparison | null;
  checks: Check[];
  motions: Motion[];
  lessons: Lesson[];
  lesson_page: boolean; // the page of `polhode report --lesson`: only a lesson
  remarks: string[]; // one sentence per omission or reduction
}

/** An experiment of the directory and its provenance (provenance.json). */
export interface Experiment {
  name: string;
  about: string;
  kind: string; // "sweep", "convergence", "drift", ..; "" if unknown
  date: string;
  quick: boolean;
  facts: [string, string][]; // "CPU", "cores", "compiler", "flags", "commit", versions of libraries, ..
}

export interface Family {
  name: string; // "runge_kutta"
  label: string; // "Runge-Kutta"
  color: string; // "#rrggbb" on white
  color_dark: string; // on a dark background
}

export interface Method {
  name: string;
  family: number; // index into families
  mark: number; // index into the marks listed below; one per method of a family
  library: string; // "polhode", "SUNDIALS", "Boost.Odeint", ..
  precision: string; // "binary64", "binary32", ..
  order: number; // claimed order; 0: variable or unknown
  documentation: string; // first sentence
  source: string;
  conserves: string;
}

// Marks in order, by plotly's names: circle square triangle-up diamond triangle-down pentagon, the same with -open,
// then cross-thin-open x-thin-open asterisk-open. Beyond the last mark they repeat with the next dash ("dash", "dot", ..).

export interface Scene {
  name: string; // with its variation: "free_asymmetric{/duration=40000}"
  about: string;
  source: string;
  duration: number | null;
  experiments: number[]; // experiments with rows of this scene
  /** Fastest run within each attitude error (rad), and the fastest run of another method. */
  fastest: { error: number; row: number | null; runner_up: number | null }[]; // indices into `rows`
  floor: number | null; // rounding floor of binary64, rad: kappa 2^-53
  motion: number | null; // index into motions
}

export interface Finding {
  title: string;
  text: string;
  link: string; // URL fragment: "#section=work-precision&scene=free_asymmetric"
}

/** Columns of result rows that are indices, codes or flags. */
export const indexColumns = [
  "experiment", "scene", "method",
  "setting_kind", // 0 none, 1 step (s), 2 tolerance
  "status", // 0 ok, 1 unsupported, 2 diverged, 3 tolerance_not_met, 4 failed
  "message", // index into messages
  "cut", // 1: ended by the limit on run time, steps or evaluations
  "formulation", // index into formulations
] as const;

/** Numeric columns that the page's code names. The page shows further columns of a document in its table of results.
 * `result_column_table()` (src/experiment/run/result.cpp) defines all; a test compares the names. */
export const numberColumns = [
  "setting", "seconds", "evaluations", "attitude_final", "attitude", "omega", "energy", "momentum", "norm", "floor", "floor32",
] as const;

/** Result rows as columns of equal length. */
export type Rows = {
  count: number;
  total: number; // rows in the directory; if more than `count`, a remark describes the reduction
  messages: string[]; // the first is ""
  formulations: string[];
} & Record<(typeof indexColumns)[number], number[]> & Record<(typeof numberColumns)[number], (number | null)[]>;

/** Fitted order of one curve of a convergence experiment. */
export interface Order {
  experiment: number;
  scene: number;
  method: number;
  setting_kind: number;
  claimed: number | null;
  observed: number | null;
  points: number | null; // number of fitted points
  from: number | null; // range of settings
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
  /** Exponents p of error ~ t^p, and half the difference between the exponents of the first and the second half.
   * Measures without a valid fit are absent. */
  growth: Partial<Record<"attitude" | "omega" | "energy" | "momentum" | "norm", [number, number]>>;
  thinned: boolean;
}

/** Outcome of one method for each pair of step and parameter. */
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

/** Any other table of the directory. */
export interface Table {
  name: string; // file name without .csv
  title: string;
  experiment: string;
  columns: { name: string; numeric: boolean; integral: boolean }[];
  rows: (string | number | null)[][];
  total: number; // rows in the file
}

/** Run times and errors of two directories at the same settings. A ratio is the other directory's value over this
 * one's: above 1, this one is faster. */
export interface Comparison {
  folder: string;
  experiments: Experiment[];
  same_bits: number; // matched rows with attitude errors that are equal to the last bit
  matched: number;
  only_here: number;
  only_there: number;
  methods: {
    method: number;
    scenes: number;
    pairs: number;
    ratio: number; // geometric mean of the scenes' geometric means
    low: number | null; // 95 % confidence interval; null for fewer than three scenes
    high: number | null;
    error_ratio: number | null; // geometric mean of attitude errors
  }[];
  pairs: { row: number; seconds: number; error: number | null }[]; // index into `rows`, the other directory's values
  all: { ratio: number; low: number | null; high: number | null; scenes: number };
  how: string; // how ratio and interval are computed
}

/** Comparison of one user trajectory with the truth. */
export interface Check {
  file: string;
  scene: number;
  verdict: string; // "passed", "failed", or why the file was not checked
  passed: boolean | null;
  blocks: { name: string; error: number | null; unit: string; limit: number | null; passed: boolean | null; at: number | null }[];
  lines: string[]; // text report of `polhode check`
  diagnoses: string[]; // diagnosed faults and the matching update
  remarks: string[]; // on the file and its floors; why no diagnosis was made, and what to record instead
  t: number[];
  errors: { name: string; unit: string; values: (number | null)[] }[];
  motion_method: number | null; // index of the trajectory in the `methods` of the scene's motion
}

/** The motion of one scene. Points of bodies are in m, from the body's centre of mass, in body axes. */
export interface Motion {
  scene: number;
  duration: number; // s, of the motion shown
  whole: number; // s, of the scene
  thinning: { angle: number; length: number }; // rad, m: error bound of the interpolation between keyframes
  bodies: BodyShape[];
  joints: { name: string; type: string; parent: number; child: number; parent_point: number[]; child_point: number[]; axis: number[] | null }[]; // bodies: -1 is the world; points: from the centre of mass or the world's origin
  pivot: number[] | null; // point of the body, from its centre of mass, that is fixed at the world's origin
  planes: { normal: number[]; offset: number }[];
  gravity: number[] | null; // m/s^2, world
  moving: boolean; // whether any centre of mass moves
  free: boolean; // no torque: the polhode stays on the ellipsoid
  about: { moments: number[]; principal: number[] } | null; // inertia of a single body about its pivot or centre
  energy: number; // J, rotational energy of a single body at the start; 0 for several bodies
  truth: Track;
  how: string; // how the truth was computed, and its error bound
  timeline: Timeline | null; // modes and events of contacts, or of joints with limits or friction
  contacts: ContactCurves[];
  coordinates: JointCurves | null;
  remark: string; // why contacts or coordinates are not shown; may be empty
  methods: MotionMethod[];
}

/** Modes and events over time. */
export interface Timeline {
  rows: {
    name: string; // a plane, two bodies, a body and a plane, or joints that are coupled
    unit: string; // unit of the impulses
    modes: { from: number; to: number; mode: string }[]; // s; ascending, without overlap; none for pairs of spheres
  }[];
  events: TimelineEvent[]; // ascending
  total: number; // number of events of the motion; if more than events.length, the later ones are omitted
}

export interface TimelineEvent {
  t: number; // s
  row: number; // index into the rows of the timeline
  kind: string; // "impact", "lands", "rolls", "slides", "lifts_off", .., "rests", "leaves", "sticks", "slips"
  normal: number | null; // normal impulse, or impulse on a joint's coordinate
  tangential: number | null; // size of the tangential impulse
}

/** Contact of a body with a plane. Between samples of an interval all values are interpolated linearly. */
export interface ContactCurves {
  row: number; // index into the rows of the timeline
  body: number;
  plane: number;
  friction: number; // coefficient
  starts: number[]; // index of the first sample of each interval of contact
  t: number[]; // s
  point: number[]; // m, world, three numbers per sample
  normal_force: number[]; // N
  friction_force: number[]; // N, world, three numbers per sample
  slip: number[]; // m/s, world, three numbers per sample: velocity of the body's point in contact
}

/** Coordinates of joints over time. */
export interface JointCurves {
  t: number[]; // s; around events at most 1e-9 of the duration apart
  curves: { name: string; joint: number; unit: string; lower: number | null; upper: number | null; x: (number | null)[]; rate: (number | null)[] }[];
  total: number; // number of coordinates of the scene
}

/** A lesson: a body that is free, has a fixed point, or slides and rolls on a plane. The page computes its motion for any
 * position of its sliders. */
export interface Lesson {
  name: string;
  title: string;
  text: string[]; // paragraphs
  scene: string; // name of the scene that it starts from
  duration: number; // s
  mass: number;
  inertia: number[]; // kg m^2, about the centre of mass, body axes, nine numbers
  arm: number[] | null; // m, from the pivot to the centre of mass, body axes; null: free
  gravity: number[] | null; // m/s^2, world
  orientation: number[]; // w, x, y, z
  angular_velocity: number[]; // rad/s, body axes
  contact: LessonContact | null; // null: without a plane
  update: string; // name of a kernel of lesson/kernels.ts or lesson/contact_kernels.ts
  step: number; // s
  sliders: { quantity: string; from: number; to: number }[]; // quantities: valueOf() of lesson/simulate.ts
  graphs: string[]; // "energy", "momentum", "angular_velocity", "tilt", "step_error", with a plane "slip", "spin", "height"
  show: string; // what the view shows at first, as the key motion_show
  shape: BodyShape;
  about: { moments: number[]; principal: number[] }; // inertia about the pivot or the centre of mass
}

/** The shape { c + A u + r b : |u| <= 1, |b| <= 1 } that touches the plane n . x = offset, and the start of the body. */
export interface LessonContact {
  center: number[]; // c, m, from the centre of mass, body axes
  axes: number[]; // A, m, nine numbers
  radius: number; // r, m
  reach: number; // bound of the distance of the hull's points from the centre of mass, m
  normal: number[]; // n, unit, world axes
  offset: number; // m
  restitution: number;
  friction: number;
  position: number[]; // centre of mass, m
  velocity: number[]; // m/s
}

export interface BodyShape {
  name: string;
  mass: number;
  moments: number[]; // principal, kg m^2
  principal: number[]; // quaternion, principal to body axes
  parts: Part[]; // parts of the shape; if there is no shape, draw a box with these moments
  vertices: number[] | null; // vertices of a mesh, three numbers each
  faces: number[] | null; // faces of a mesh, three indices each
  points: number[] | null; // point masses, three numbers each
}

export interface Part {
  type: string; // "box", "sphere", "cylinder", "capsule", "cone", .. with the keys of scene files
  sizes: Record<string, number | number[]>; // "half_extents", "radius", "half_height", ..
  position: number[]; // origin of the shape, from the body's centre of mass, body axes
  orientation: number[]; // w, x, y, z, shape to body axes
  hole: boolean; // negative density
}

/** Keyframes. Interpolation (motion/interpolation.ts): positions by the cubic Hermite polynomial of p and v; attitudes
 * by that of the four quaternion components with the derivative q' = q (0, w) / 2, then normalised; angular velocities
 * from the interpolated attitude or from neighbouring values of w. Integers are scaled: x = integer * scale. */
export interface Track {
  t: number[]; // s
  bodies: {
    q: number[]; // four integers per keyframe, to be normalised: w, x, y, z, body to world
    w: number[]; // three integers per keyframe: angular velocity, body axes
    w_scale: number; // rad/s
    p: number[]; // three integers per keyframe: centre of mass, world; empty if it does not move
    v: number[]; // three integers per keyframe: velocity of the centre of mass, world; empty if it does not move
    p_scale: number; // m
    v_scale: number; // m/s
    p_start: number[]; // m, offset of all positions
  }[];
}

export interface MotionMethod {
  method: number; // index into methods; -1: a user trajectory
  label: string; // the method's name, or the file name of a user trajectory
  setting_kind: number;
  setting: number | null;
  status: number; // as in rows
  message: string;
  /** null if `difference` is invisible: draw the truth's track; also null if there is no motion to draw */
  track: Track | null;
  difference: number | null; // rad, largest attitude error over the motion shown
  t: number[]; // s, times of the errors
  attitude: (number | null)[]; // rad, of the worst body
}
