// Tests the contact of the page's lessons: updates and reference against the program and against closed forms.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import test from "node:test";
import { gunzipSync } from "node:zlib";
import type { Lesson } from "../../src/report/page/source/data.ts";
import { contactEnergy, type ContactState, gapOf, slipOf } from "../../src/report/page/source/lesson/contact.ts";
import { contactKernels } from "../../src/report/page/source/lesson/contact_kernels.ts";
import { contactReference } from "../../src/report/page/source/lesson/contact_reference.ts";
import { kernelsOf, run, type Setup, setupOf, simulate, truthAt } from "../../src/report/page/source/lesson/simulate.ts";
import { angleBetween, conjugate, length, normalized, rotate, subtract, type Vector } from "../../src/report/page/source/motion/algebra.ts";

const program = process.env.POLHODE_PROGRAM ?? "build/polhode";
const names = ["rolling_ball", "tippe_top", "rattleback"] as const;

/** The lesson as the program writes it into a page. */
const lessonOf = (name: (typeof names)[number]): Lesson => {
  const file = `${process.env.POLHODE_REPORT_WORK ?? "build/report"}/test_${name}.html`;
  execFileSync(program, ["report", "--lesson", name, "--output", file, "--quiet"]);
  const data = /<script id="polhode-data"[^>]*>([^<]*)</.exec(readFileSync(file, "utf8"));
  assert.ok(data?.[1] !== undefined, file);
  return (JSON.parse(gunzipSync(Buffer.from(data[1], "base64")).toString()) as { lessons: Lesson[] }).lessons[0] as Lesson;
};
const lessons = new Map(names.map((name) => [name, existsSync(program) ? lessonOf(name) : null]));
const lesson = (name: (typeof names)[number]): Lesson => {
  const found = lessons.get(name);
  assert.ok(found, `${program} does not exist: build it, or set POLHODE_PROGRAM`);
  return found;
};
const contactOf = (setup: Setup): NonNullable<Setup["contact"]> => setup.contact ?? assert.fail("no contact");

type Row = ContactState & { t: number };

function rowsOf(...options: string[]): Row[] {
  const [head = "", ...lines] = execFileSync(program, options, { encoding: "utf8", maxBuffer: 1e9 }).trim().split("\n").filter((line) => !line.startsWith("#"));
  const columns = head.split(",");
  return lines.map((line) => {
    const cells = line.split(",").map(Number);
    const value = (name: string): number => cells[columns.indexOf(name)] ?? assert.fail(name);
    const vector = (name: string): Vector => [value(`${name}x`), value(`${name}y`), value(`${name}z`)];
    const q = normalized([value("qw"), value("qx"), value("qy"), value("qz")]);
    return { t: value("t"), q, w: rotate(conjugate(q), vector("w")), p: vector("p"), v: vector("v") };
  });
}

/** The largest difference: attitude in rad, beyond one radian relative to the angle by which the body has rotated; the
 * rest relative to the largest angular velocity, distance, and speed of a point of the body. */
function differenceOf(own: readonly Row[], other: readonly Row[], reach: number): number {
  assert.equal(own.length, other.length);
  const largest = (of: (row: Row) => Vector): number => Math.max(...other.map((row) => length(of(row))));
  const [w, p] = [largest((row) => row.w), Math.max(reach, largest((row) => row.p))];
  const v = largest((row) => row.v) + reach * w;
  return Math.max(...own.map((row, i) => {
    const one = other[i] as Row;
    assert.ok(Math.abs(row.t - one.t) < 1e-12);
    const angle = angleBetween(row.q, one.q) / Math.max(1, w * row.t);
    return Math.max(angle, length(subtract(row.w, one.w)) / w, length(subtract(row.p, one.p)) / p, length(subtract(row.v, one.v)) / v);
  }));
}

for (const name of names) {
  for (const kernel of contactKernels) {
    test(`${kernel.name} on ${name} agrees with the program to 1e-12`, () => {
      const one = lesson(name);
      const setup = setupOf({ ...one, duration: 100 * one.step }, {});
      const own = run(kernel, setup, setup.steps).map(({ t, q, w, at }) => ({ t, q, w, ...(at ?? assert.fail("no position")) }));
      const other = rowsOf("solve", one.scene, "--method", kernel.name, "--step", String(setup.step), "--samples", String(setup.steps), "--duration", String(setup.duration));
      const difference = differenceOf(own, other, contactOf(setup).body.contact.reach);
      assert.ok(difference <= 1e-12, `${difference}`);
    });
  }

  test(`the reference on ${name} agrees with the program's truth to 1e-12`, () => {
    const one = lesson(name);
    const setup = setupOf(one, {});
    const truth = rowsOf("truth", one.scene, "--samples", "40", "--duration", String(setup.duration));
    const { body, start } = contactOf(setup);
    const { samples } = contactReference(body, start, truth.map(({ t }) => t));
    const difference = differenceOf(samples, truth, body.contact.reach);
    assert.ok(difference <= 1e-12, `${difference}`);
  });
}

test("a bowling ball rolls from 2 |u| / (7 mu g) on, with the velocity (5 v + 2 r w x n) / 7", () => {
  const setup = setupOf(lesson("rolling_ball"), {});
  const { body, start } = contactOf(setup);
  const { samples, events } = contactReference(body, start, [0, setup.duration]);
  const rolls = (2 * slipOf(body, start)) / (7 * 0.12 * 9.8);
  assert.deepEqual(events.map(({ mode }) => mode), ["slides", "rolls"]);
  assert.ok(Math.abs((events[1]?.t ?? 0) - rolls) < 1e-12);
  const w = rotate(start.q, start.w);
  const last = samples[1] as Row;
  assert.ok(Math.abs(last.v[0] - (5 * start.v[0] + 2 * 0.109 * w[1]) / 7) < 1e-12);
  assert.ok(Math.abs(last.v[1] - (5 * start.v[1] - 2 * 0.109 * w[0]) / 7) < 1e-12);
});

test("a rattleback that rolls conserves its energy, keeps the contact, and reverses its spin", () => {
  const setup = setupOf(lesson("rattleback"), {});
  const { body, start } = contactOf(setup);
  const { samples, events } = contactReference(body, start, [0, 1, 2, setup.duration]);
  assert.deepEqual(events, [{ t: 0, mode: "rolls" }]);
  for (const sample of samples) {
    assert.ok(Math.abs(contactEnergy(body, sample) / contactEnergy(body, start) - 1) < 1e-12);
    assert.ok(Math.abs(gapOf(body, sample)) < 1e-14 && slipOf(body, sample) < 1e-12);
  }
  const spins = samples.map(({ q, w }) => rotate(q, w)[2]);
  assert.ok((spins[0] ?? 0) > 2.9 && (spins[3] ?? 0) < -0.5, `${spins}`);
});

// Jellett: L . (u + a n), where u is the plane's normal, n the body's axis, a = offset of the centre of mass / radius
test("a tippe top keeps Jellett's constant, and does not rise without friction", () => {
  const one = lesson("tippe_top");
  const setup = setupOf(one, {});
  const { body, start } = contactOf(setup);
  const jellett = ({ q, w }: ContactState): number => {
    const offset = -(body.contact.center[2] ?? 0) / body.contact.radius; // centre of mass below the middle
    const L = [body.tensor[0][0] * w[0], body.tensor[1][1] * w[1], body.tensor[2][2] * w[2]] as const;
    const up = rotate(conjugate(q), [0, 0, 1]);
    return L[0] * up[0] + L[1] * up[1] + L[2] * (up[2] + offset);
  };
  const { samples } = contactReference(body, start, [0, 0.3, 0.6, 1]);
  for (const sample of samples) assert.ok(Math.abs(jellett(sample) / jellett(start) - 1) < 1e-12, `${jellett(sample) / jellett(start) - 1}`);
  const tilt = (row: ContactState): number => Math.acos(rotate(row.q, [0, 0, 1])[2]);
  assert.ok(tilt(samples[3] as Row) > 2);
  const smooth = setupOf(one, { friction: 0 });
  const free = contactOf(smooth);
  for (const sample of contactReference(free.body, free.start, [0, 0.5, 1]).samples) assert.ok(tilt(sample) < 0.5);
});

test("sliders keep the start on the plane, and a rolling start rolls", () => {
  const stone = setupOf(lesson("rattleback"), { angular_velocity_x: 1, angular_velocity_z: -3 });
  const rolling = contactOf(stone);
  assert.ok(slipOf(rolling.body, rolling.start) < 1e-15);
  const ball = setupOf(lesson("rolling_ball"), { velocity_x: 3, friction: 0.4 });
  const thrown = contactOf(ball);
  assert.equal(thrown.start.v[0], 3);
  assert.equal(thrown.body.contact.friction, 0.4);
  assert.ok(Math.abs(gapOf(thrown.body, thrown.start)) < 1e-16);
  const tilted = contactOf(setupOf(lesson("tippe_top"), { tilt: 0.7 }));
  assert.ok(Math.abs(gapOf(tilted.body, tilted.start)) < 1e-16);
});

test("a body that leaves the plane ends the motion with its time", () => {
  const fast = { ...lesson("rattleback"), duration: 2 };
  const values = { angular_velocity_x: 2, angular_velocity_y: 40 };
  const { left } = truthAt(setupOf(fast, values), [0, 1, 2]);
  assert.ok(left !== null && left < 2);
  const { motion, update, truth } = simulate(fast, values, contactKernels[0] as (typeof contactKernels)[number]);
  assert.equal(update.length, truth.length);
  assert.ok(motion.duration <= left && motion.whole === 2);
});

test("the view has the plane and the positions", () => {
  const one = lesson("rolling_ball");
  const { motion, update } = simulate(one, {}, kernelsOf(one)[0] as (typeof contactKernels)[number]);
  assert.deepEqual(motion.planes, [{ normal: [0, 0, 1], offset: 0 }]);
  const { p } = motion.truth.bodies[0] as (typeof motion.truth.bodies)[number];
  assert.equal(p.length, 3 * motion.truth.t.length);
  for (let i = 2; i < p.length; i += 3) assert.ok(Math.abs((p[i] ?? 0) - 0.109) < 1e-12);
  assert.equal(motion.methods[0]?.status, 0);
  assert.ok(update.length > 100);
});
