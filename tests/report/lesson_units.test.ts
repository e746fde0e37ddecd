// Tests the computations of the page's lessons: updates and reference against the program and against closed forms.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import test from "node:test";
import type { Lesson } from "../../src/report/page/source/data.ts";
import { angleBetween, conjugate, dot, length, normalized, rotate, subtract, type Vector } from "../../src/report/page/source/motion/algebra.ts";
import { kernels } from "../../src/report/page/source/lesson/kernels.ts";
import { aboutPivot, conservedMomentum, energyOf, inverseOf, momentumOf, product, type Sample, tiltOf } from "../../src/report/page/source/lesson/mechanics.ts";
import { errorOfSteps, errorsOf, momentFault, run, setupOf, simulate, valueOf } from "../../src/report/page/source/lesson/simulate.ts";
import { rangeOf } from "../../src/report/page/source/lesson/graph.ts";
import { parseValues, sliderPosition, sliderValue } from "../../src/report/page/source/lesson/lesson.ts";
import { reference } from "../../src/report/page/source/lesson/taylor.ts";
import { freeLesson, topLesson } from "./lesson_sample.ts";

const program = process.env.POLHODE_PROGRAM ?? "build/polhode";
const lessons: [string, Lesson][] = [["free_asymmetric", freeLesson()], ["lagrange_top", topLesson()]];

/** Samples of a trajectory or truth that the program writes as CSV. */
function samplesOf(...options: string[]): Sample[] {
  assert.ok(existsSync(program), `${program} does not exist: build it, or set POLHODE_PROGRAM`);
  const [head = "", ...lines] = execFileSync(program, options, { encoding: "utf8", maxBuffer: 1e9 }).trim().split("\n").filter((line) => !line.startsWith("#"));
  const columns = head.split(",");
  return lines.map((line) => {
    const cells = line.split(",").map(Number);
    const value = (name: string): number => {
      const cell = cells[columns.indexOf(name)];
      assert.ok(cell !== undefined && Number.isFinite(cell), `${name} in ${line}`);
      return cell;
    };
    const q = normalized([value("qw"), value("qx"), value("qy"), value("qz")]);
    // the file has world axes
    return { t: value("t"), q, w: rotate(conjugate(q), [value("wx"), value("wy"), value("wz")]) };
  });
}

function assertNear(own: readonly Sample[], other: readonly Sample[], tolerance: number, what: string): void {
  assert.equal(own.length, other.length, what);
  own.forEach((sample, i) => {
    const one = other[i] as Sample;
    assert.ok(Math.abs(sample.t - one.t) < 1e-12, `${what}: times`);
    const [angle, rate] = [angleBetween(sample.q, one.q), length(subtract(sample.w, one.w)) / Math.max(1, length(one.w))];
    assert.ok(angle <= tolerance, `${what}: attitude ${angle} rad at ${sample.t} s`);
    assert.ok(rate <= tolerance, `${what}: angular velocity ${rate} at ${sample.t} s`);
  });
}

for (const [scene, lesson] of lessons) {
  for (const kernel of kernels) {
    test(`${kernel.name} on ${scene} agrees with the program to 1e-12`, () => {
      // w gains a few roundings eps per step, so after n steps the attitudes differ by about n^2 h |w| eps = 1e-13 rad
      const setup = setupOf({ ...lesson, duration: 100 * lesson.step }, {});
      const own = run(kernel, setup, setup.steps);
      const other = samplesOf("solve", scene, "--method", kernel.name, "--step", String(setup.step), "--samples", String(setup.steps), "--duration", String(setup.duration));
      assertNear(own, other, 1e-12, kernel.name);
    });
  }

  test(`the reference on ${scene} agrees with the program's truth to 1e-12`, () => {
    const setup = setupOf(lesson, {});
    const truth = samplesOf("truth", scene, "--samples", "50", "--duration", String(setup.duration));
    assertNear(reference(setup.body, setup.q, setup.w, truth.map(({ t }) => t)), truth, 1e-12, "reference");
  });
}

test("the separatrix motion of the reference is the closed form", () => {
  // I = (3, 4, 6), w = (2 sech, (3/sqrt 2) tanh, sech)(t / sqrt 2)
  const lesson = { ...freeLesson(), inertia: [3, 0, 0, 0, 4, 0, 0, 0, 6], angular_velocity: [2, 0, 1], duration: 6 };
  const setup = setupOf(lesson, {});
  for (const { t, w } of reference(setup.body, setup.q, setup.w, [0.5, 1, 3, 6])) {
    const [s, h] = [1 / Math.cosh(t / Math.SQRT2), Math.tanh(t / Math.SQRT2)];
    const exact: Vector = [2 * s, (3 / Math.SQRT2) * h, s];
    assert.ok(length(subtract(w, exact)) < 1e-13, `${t} s: ${length(subtract(w, exact))}`);
  }
});

test("the reference conserves energy and momentum to rounding", () => {
  for (const [, lesson] of lessons) {
    const { body, q, w, duration } = setupOf(lesson, {});
    const samples = reference(body, q, w, [0, duration / 3, duration]);
    const first = samples[0] as Sample;
    for (const sample of samples) {
      assert.ok(Math.abs(energyOf(body, sample) / energyOf(body, first) - 1) < 1e-13);
      assert.ok(Math.abs(conservedMomentum(body, sample) / conservedMomentum(body, first) - 1) < 1e-13);
    }
  }
  const { body, q, w } = setupOf(freeLesson(), {});
  const [first, last] = reference(body, q, w, [0, 10]) as [Sample, Sample];
  assert.ok(length(subtract(momentumOf(body, last), momentumOf(body, first))) < 1e-13);
});

test("errors decrease with the order of the update", () => {
  const orders: Record<string, number> = { gyroscopic_explicit: 1, gyroscopic_implicit: 1, gyroscopic_rescaled_momentum: 1, momentum_exponential_map: 1, baraff_witkin_euler: 1, baraff_witkin_rk4: 4 };
  const setup = setupOf({ ...freeLesson(), duration: 4 }, {});
  for (const [name, order] of Object.entries(orders)) {
    const kernel = kernels.find((one) => one.name === name);
    assert.ok(kernel !== undefined);
    const [coarse, fine] = [800, 1600].map((steps) => errorOfSteps(kernel, setup, steps)) as [number, number];
    assert.ok(Math.abs(Math.log2(coarse / fine) - order) < 0.15, `${name}: ${Math.log2(coarse / fine)}`);
  }
  // without the gyroscopic term, the update converges to another motion
  const none = kernels[0];
  assert.equal(none?.name, "gyroscopic_none");
  const [coarse, fine] = [800, 1600].map((steps) => errorOfSteps(none as NonNullable<typeof none>, setup, steps)) as [number, number];
  assert.ok(coarse > 0.5 && Math.abs(coarse / fine - 1) < 0.01);
});

test("the explicit term gains energy, the implicit one loses energy, the midpoint rule keeps it", () => {
  const final = (name: string): number => {
    const setup = setupOf({ ...freeLesson(), duration: 30 }, {});
    const kernel = kernels.find((one) => one.name === name) as (typeof kernels)[number];
    const samples = run(kernel, setup);
    return energyOf(setup.body, samples[samples.length - 1] as Sample) / energyOf(setup.body, samples[0] as Sample);
  };
  assert.ok(final("gyroscopic_explicit") > 1.01);
  assert.ok(final("gyroscopic_implicit") < 0.99);
  assert.ok(Math.abs(final("midpoint_gyroscopic") - 1) < 1e-12);
});

test("sliders change the setup", () => {
  const top = topLesson();
  const tilted = setupOf(top, { tilt: 0.3, gravity: 5, angular_velocity_z: 7, moment_x: 0.8, step: 0.01, duration: 1 });
  assert.ok(Math.abs(tiltOf(tilted.q) - 0.3) < 1e-15);
  assert.deepEqual([...tilted.body.weight], [0, 0, -5]);
  assert.deepEqual([...tilted.w], [0, 0, 7]);
  assert.equal(tilted.body.tensor[0][0], 0.8 + 0.25);
  assert.equal(tilted.steps, 100);
  for (const { quantity } of top.sliders) assert.equal(typeof valueOf(top, quantity), "number");
  assert.ok(Math.abs(valueOf(top, "tilt") - 0.5) < 1e-12);
  assert.equal(momentFault([[1, 0, 0], [0, 2, 0], [0, 0, 3]]), "");
  assert.match(momentFault([[1, 0, 0], [0, 2, 0], [0, 0, 3.1]]), /largest/);
});

test("the inverse, the parallel axis theorem, and the motion for the view", () => {
  const I = aboutPivot(2, [[1, 0, 0], [0, 2, 0], [0, 0, 3]], [0, 1, 0.5]);
  // 2 (|r|^2 1 - r r^T) with r = (0, 1, 1/2)
  assert.deepEqual(I.map((row) => [...row]), [[3.5, 0, 0], [0, 2.5, -1], [0, -1, 5]]);
  product(I, inverseOf(I)).forEach((row, i) => row.forEach((x, j) => assert.ok(Math.abs(x - (i === j ? 1 : 0)) < 1e-15)));
  const kernel = kernels[1] as (typeof kernels)[number];
  const { motion, update, truth } = simulate(topLesson(), {}, kernel);
  assert.equal(update.length, truth.length);
  assert.equal(motion.methods[0]?.status, 0);
  assert.ok(Math.abs((motion.methods[0]?.difference ?? 0) - Math.max(...errorsOf(update, truth))) === 0);
  // the centre of mass stays at its distance from the pivot
  const { p, v } = motion.truth.bodies[0] as (typeof motion.truth.bodies)[number];
  for (let k = 0; k < p.length; k += 3) {
    assert.ok(Math.abs(Math.hypot(p[k] ?? 0, p[k + 1] ?? 0, p[k + 2] ?? 0) - 0.5) < 1e-14);
    assert.ok(Math.abs(dot([p[k] ?? 0, p[k + 1] ?? 0, p[k + 2] ?? 0], [v[k] ?? 0, v[k + 1] ?? 0, v[k + 2] ?? 0])) < 1e-12);
  }
  // a diverging run ends early and says so
  const wild = simulate({ ...freeLesson(), angular_velocity: [100, 100, 100], step: 1, duration: 200 }, {}, kernel);
  assert.equal(wild.motion.methods[0]?.status, 2);
  assert.ok((wild.update[wild.update.length - 1]?.t ?? 0) < 200);
});

test("positions and values of sliders, and their text in the address", () => {
  const lesson = topLesson();
  for (const slider of lesson.sliders) {
    assert.equal(sliderValue(slider, 0), slider.from);
    assert.equal(sliderValue(slider, 200), slider.to);
    for (const position of [0, 37, 100, 200]) assert.ok(Math.abs(sliderPosition(slider, sliderValue(slider, position)) - position) <= 1);
  }
  const step = lesson.sliders.find(({ quantity }) => quantity === "step") as Lesson["sliders"][number];
  assert.equal(sliderValue(step, 100), 0.01); // the geometric mean of 1e-3 and 0.1
  assert.deepEqual(parseValues(lesson, "tilt:0.3,step:0.02"), { tilt: 0.3, step: 0.02 });
  assert.deepEqual(parseValues(lesson, "tilt:9,mass:1,step:x,gravity:,__proto__:1"), {});
});

test("ranges of graphs", () => {
  const [low, high] = rangeOf([1, 3], false);
  assert.ok(low < 1 && low > 0.8 && high > 3 && high < 3.2);
  // rounding of a constant does not fill the graph
  const [from, to] = rangeOf([5, 5 + 1e-14], false);
  assert.ok(to - from > 4e-3);
  assert.deepEqual(rangeOf([NaN, -1], true), [0, 1]);
  assert.ok(Math.abs(rangeOf([1e-4, 1], true)[0] + 4.16) < 1e-9);
});
