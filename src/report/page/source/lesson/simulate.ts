// From a lesson and the positions of its sliders to motions and errors.

import type { BodyShape, Lesson, Motion, MotionMethod, Track } from "../data.ts";
import { angleBetween, cross, dot, length, type Quaternion, quaternionAt, subtract, type Vector, vectorAt, rotate, scale } from "../motion/algebra.ts";
import { type ContactBody, contactEnergy, type ContactState, slipOf, touchingStart } from "./contact.ts";
import { contactKernels } from "./contact_kernels.ts";
import { contactReference } from "./contact_reference.ts";
import { type Kernel, kernels } from "./kernels.ts";
import { aboutPivot, type Body, conservedMomentum, energyOf, inverseOf, type Matrix, momentumOf, type Sample, tiltOf } from "./mechanics.ts";
import { reference } from "./taylor.ts";

export type Values = Readonly<Record<string, number>>;

/** Everything that determines the motion. */
export interface Setup {
  body: Body;
  central: Matrix; // kg m^2, about the centre of mass
  q: Quaternion;
  w: Vector; // rad/s, body axes
  duration: number; // s
  step: number; // s, duration / steps
  steps: number;
  gravity: Vector; // m/s^2
  contact: { body: ContactBody; start: ContactState } | null;
}

export const mostSteps = 200_000;
const mostSamples = 1500;
const mostContactSamples = 800;

/** The updates that apply to a lesson. */
export const kernelsOf = (lesson: Lesson): readonly Kernel[] => (lesson.contact === null ? kernels : contactKernels);
export const kernelOf = (lesson: Lesson, name: string): Kernel | undefined => kernelsOf(lesson).find((one) => one.name === name);

/** The value of a quantity in the lesson itself. */
export function valueOf(lesson: Lesson, quantity: string): number {
  const at = "xyz".indexOf(quantity.slice(-1));
  if (/^angular_velocity_[xyz]$/.test(quantity)) return lesson.angular_velocity[at] ?? 0;
  if (/^moment_[xyz]$/.test(quantity)) return lesson.inertia[4 * at] ?? 0;
  if (/^velocity_[xyz]$/.test(quantity)) return lesson.contact?.velocity[at] ?? 0;
  if (quantity === "friction") return lesson.contact?.friction ?? 0;
  if (quantity === "tilt") return tiltOf(quaternionAt(lesson.orientation));
  if (quantity === "gravity") return Math.hypot(...(lesson.gravity ?? [0]));
  return quantity === "step" ? lesson.step : lesson.duration;
}

/** Why no body has these moments, or "". */
export function momentFault(central: Matrix): string {
  const moments = [central[0][0], central[1][1], central[2][2]].sort((a, b) => a - b) as [number, number, number];
  // principal moments are on the diagonal wherever a lesson has sliders for them
  return moments[2] > (moments[0] + moments[1]) * (1 + 1e-12)
    ? "No rigid body has these moments: the largest must be at most the sum of the others."
    : "";
}

export function setupOf(lesson: Lesson, values: Values): Setup {
  const value = (quantity: string): number => values[quantity] ?? valueOf(lesson, quantity);
  const row = (i: number): Vector => [0, 1, 2].map((j) => (i === j ? value(`moment_${"xyz"[i]}`) : (lesson.inertia[3 * i + j] ?? 0))) as unknown as Vector;
  const central: Matrix = [row(0), row(1), row(2)];
  const arm = lesson.arm === null ? null : vectorAt(lesson.arm);
  const tensor = arm === null ? central : aboutPivot(lesson.mass, central, arm);
  const ownGravity = vectorAt(lesson.gravity ?? [0, 0, 0]);
  const gravity = length(ownGravity) > 0 ? scale(value("gravity") / length(ownGravity), ownGravity) : ownGravity;
  const tilt = values.tilt;
  const duration = value("duration");
  const steps = Math.min(mostSteps, Math.max(1, Math.ceil((duration / value("step")) * (1 - 1e-9))));
  const weight = arm === null && lesson.contact === null ? scale(0, gravity) : scale(lesson.mass, gravity);
  const body = { tensor, inverse: inverseOf(tensor), arm: arm ?? [0, 0, 0] as const, weight };
  const q: Quaternion = tilt === undefined ? quaternionAt(lesson.orientation) : [Math.cos(tilt / 2), Math.sin(tilt / 2), 0, 0];
  const w: Vector = [value("angular_velocity_x"), value("angular_velocity_y"), value("angular_velocity_z")];
  const contact = lesson.contact === null ? null : contactOf(lesson, values, { ...body, mass: lesson.mass }, q, w);
  return { body, central, gravity, duration, steps, step: duration / steps, q, w, contact };
}

/** The body with its contact, and its start on the plane. */
function contactOf(lesson: Lesson, values: Values, body: Body & { mass: number }, q: Quaternion, w: Vector): Setup["contact"] {
  const given = lesson.contact as NonNullable<Lesson["contact"]>;
  const row = (i: number): Vector => vectorAt(given.axes, 3 * i);
  const made = (friction: number): ContactBody => ({
    ...body, contact: { ...given, center: vectorAt(given.center), axes: [row(0), row(1), row(2)], normal: vectorAt(given.normal), friction },
  });
  const own: ContactState = { q: quaternionAt(lesson.orientation), w: vectorAt(lesson.angular_velocity), p: vectorAt(given.position), v: vectorAt(given.velocity) };
  const contact = made(values.friction ?? given.friction);
  const moved = ["velocity_x", "velocity_y", "velocity_z"].some((name) => values[name] !== undefined);
  const rolls = !moved && slipOf(contact, own) <= 1e-9 * (length(own.v) + given.reach * length(own.w));
  const v: Vector = [values.velocity_x ?? own.v[0], values.velocity_y ?? own.v[1], values.velocity_z ?? own.v[2]];
  return { body: contact, start: touchingStart(contact, { q, w, p: own.p, v }, rolls) };
}

/** Quantities of the graphs at a sample. */
export const energyAt = ({ body, contact }: Setup, sample: Sample): number =>
  contact === null || sample.at === undefined ? energyOf(body, sample) : contactEnergy(contact.body, { ...sample, ...sample.at });
/** What the loads leave constant without a plane; with a plane, the angular momentum about the centre of mass along its normal. */
export const momentumAt = ({ body, contact }: Setup, sample: Sample): number => (contact === null ? conservedMomentum(body, sample) : dot(contact.body.contact.normal, momentumOf(body, sample)));
export const slipAt = ({ contact }: Setup, sample: Sample): number => (contact === null || sample.at === undefined ? 0 : slipOf(contact.body, { ...sample, ...sample.at }));
/** Angular velocity about the plane's normal, rad/s. */
export const spinAt = ({ contact }: Setup, { q, w }: Sample): number => (contact === null ? 0 : dot(contact.body.contact.normal, rotate(q, w)));
/** Height of the centre of mass over the plane, m. */
export const heightAt = ({ contact }: Setup, { at }: Sample): number => (contact === null || at === undefined ? 0 : dot(contact.body.contact.normal, at.p) - contact.body.contact.offset);

/** The reference at ascending times. With a plane it ends where the body leaves the plane; `left` is this time, s. */
export function truthAt(setup: Setup, times: readonly number[]): { samples: Sample[]; left: number | null } {
  if (setup.contact === null) return { samples: reference(setup.body, setup.q, setup.w, times), left: null };
  const { samples, events } = contactReference(setup.contact.body, setup.contact.start, times);
  return {
    samples: samples.map(({ t, q, w, p, v }) => ({ t, q, w, at: { p, v } })),
    left: events.find(({ mode }) => mode === "lifts_off")?.t ?? null,
  };
}

const isFinite = ({ q, w, at }: Sample): boolean => [...q, ...w, ...(at?.p ?? []), ...(at?.v ?? [])].every((x) => Math.abs(x) < 1e100);

/** Samples of a run after every `stride` steps and at the end; shorter if it diverges. */
export function run(kernel: Kernel, setup: Setup, most = setup.contact === null ? mostSamples : mostContactSamples): Sample[] {
  const { steps, step } = setup;
  const stride = Math.max(1, Math.ceil(steps / most));
  const { contact } = setup;
  const stepper = contact === null ? kernel.start(setup.body, setup.q, setup.w) : kernel.start(contact.body, setup.q, setup.w, contact.start);
  const sampled = (t: number): Sample => {
    const at = stepper.at?.();
    return { t, q: stepper.q(), w: stepper.w(), ...(at === undefined ? {} : { at: { p: at.p, v: at.v } }) };
  };
  const samples: Sample[] = [sampled(0)];
  for (let i = 1; i <= steps; ++i) {
    stepper.step(step);
    if (i % stride !== 0 && i !== steps) continue;
    const sample = sampled(i === steps ? setup.duration : i * step);
    if (!isFinite(sample)) break;
    samples.push(sample);
  }
  return samples;
}

/** Times for the drawing of the truth: every tenth of a radian. */
export function drawnTimes(setup: Setup): number[] {
  const turn = Math.max(length(setup.w), 0.1) * setup.duration;
  const count = Math.min(setup.contact === null ? mostSamples : mostContactSamples, Math.max(100, Math.ceil(turn / 0.1)));
  return Array.from({ length: count + 1 }, (_, i) => (i / count) * setup.duration);
}

function trackOf(samples: readonly Sample[], arm: Vector): Track {
  const moves = length(arm) > 0 || samples[0]?.at !== undefined;
  const p = samples.flatMap(({ q, at }) => at?.p ?? rotate(q, arm));
  const v = samples.flatMap(({ q, w, at }) => at?.v ?? rotate(q, cross(w, arm)));
  return {
    t: samples.map(({ t }) => t),
    bodies: [{
      q: samples.flatMap(({ q }) => q), w: samples.flatMap(({ w }) => w), w_scale: 1,
      p: moves ? p : [], v: moves ? v : [], p_scale: 1, v_scale: 1, p_start: [0, 0, 0],
    }],
  };
}

/** Attitude errors of a run, rad. `truth` has the same times. */
export const errorsOf = (samples: readonly Sample[], truth: readonly Sample[]): number[] => samples.map(({ q }, i) => angleBetween(q, truth[i]?.q ?? q));

/** The shape of the lesson's body, or the box of its moments if these were changed. */
function shapeOf(lesson: Lesson, { central }: Setup): BodyShape {
  const moments = [central[0][0], central[1][1], central[2][2]];
  if (moments.every((one, i) => one === lesson.inertia[4 * i])) return lesson.shape;
  return { name: lesson.shape.name, mass: lesson.mass, moments, principal: [1, 0, 0, 0], parts: [], vertices: null, faces: null, points: null };
}

export interface Results {
  setup: Setup;
  truth: Sample[]; // at the times of the update
  update: Sample[];
  motion: Motion;
  left: number | null; // s: the body leaves the plane, which ends the motion
}

/** Computes the reference and the update, and makes a motion for the view. */
export function simulate(lesson: Lesson, values: Values, kernel: Kernel): Results {
  const setup = setupOf(lesson, values);
  const whole = run(kernel, setup);
  // one reference for the update's times and for the drawing
  const drawn = drawnTimes(setup);
  const times = [...new Set([...whole.map(({ t }) => t), ...drawn])].sort((a, b) => a - b);
  const { samples: all, left } = truthAt(setup, times);
  const at = new Map(all.map((sample) => [sample.t, sample]));
  const update = whole.filter(({ t }) => at.has(t));
  const truth = update.map(({ t }) => at.get(t) as Sample);
  const errors = errorsOf(update, truth);
  const thin = Math.max(1, Math.ceil(update.length / 400));
  const kept = update.map((_, i) => i).filter((i) => i % thin === 0 || i === update.length - 1);
  const complete = (whole[whole.length - 1]?.t ?? 0) >= setup.duration;
  const method: MotionMethod = {
    method: -1, label: kernel.name, setting_kind: 1, setting: setup.step, status: complete ? 0 : 2, message: "",
    track: trackOf(update, setup.body.arm), difference: errors.reduce((most, error) => Math.max(most, error), 0),
    t: kept.map((i) => update[i]?.t ?? 0), attitude: kept.map((i) => errors[i] ?? null),
  };
  const shape = shapeOf(lesson, setup);
  const { tensor, arm } = setup.body;
  const diagonal = [tensor[0][1], tensor[0][2], tensor[1][2]].every((x) => Math.abs(x) <= 1e-15 * tensor[0][0]);
  const moments = [tensor[0][0], tensor[1][1], tensor[2][2]];
  const contact = setup.contact?.body.contact ?? null;
  const ends = left === null ? setup.duration : (all[all.length - 1]?.t ?? 0);
  const motion: Motion = {
    scene: 0, duration: ends, whole: setup.duration, thinning: { angle: 1e-4, length: 1e-4 * (contact?.reach ?? length(arm)) }, bodies: [shape], joints: [],
    pivot: lesson.arm === null ? null : [-arm[0], -arm[1], -arm[2]], planes: contact === null ? [] : [{ normal: [...contact.normal], offset: contact.offset }], gravity: lesson.arm === null && contact === null ? null : [...setup.gravity],
    moving: length(arm) > 0 || contact !== null, free: contact === null && (length(arm) === 0 || length(setup.body.weight) === 0),
    about: diagonal ? { moments, principal: [1, 0, 0, 0] } : lesson.about,
    energy: 0.5 * (setup.w[0] * dotRow(tensor, 0, setup.w) + setup.w[1] * dotRow(tensor, 1, setup.w) + setup.w[2] * dotRow(tensor, 2, setup.w)),
    truth: trackOf(drawn.flatMap((t) => at.get(t) ?? []), arm),
    how: contact === null ? "Taylor series of order 24, computed in this page" : "extrapolation from event to event, computed in this page", timeline: null, contacts: [], coordinates: null, remark: "", methods: [method],
  };
  return { setup, truth, update, motion, left };
}

const dotRow = (m: Matrix, i: 0 | 1 | 2, v: Vector): number => m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];

/** Largest attitude error of a kernel for each number of steps, rad; null if it diverges. */
export function errorOfSteps(kernel: Kernel, setup: Setup, steps: number): number | null {
  const samples = run(kernel, { ...setup, steps, step: setup.duration / steps }, 60);
  if ((samples[samples.length - 1]?.t ?? 0) < setup.duration) return null;
  const truth = reference(setup.body, setup.q, setup.w, samples.map(({ t }) => t));
  return errorsOf(samples, truth).reduce((most, error) => Math.max(most, error), 0);
}

export const differenceOf = (a: Vector, b: Vector): number => length(subtract(a, b));
