// Lessons for tests: a free body and a heavy top.

import type { BodyShape, Lesson } from "../../src/report/page/source/data.ts";

const shape = (name: string, mass: number, moments: number[]): BodyShape => ({ name, mass, moments, principal: [1, 0, 0, 0], parts: [], vertices: null, faces: null, points: null });

/** The scene free_asymmetric. */
export const freeLesson = (): Lesson => ({
  name: "gyroscopic_term", title: "The gyroscopic term", text: ["First paragraph.", "Second paragraph."], scene: "free_asymmetric", duration: 10, mass: 1,
  inertia: [1, 0, 0, 0, 2, 0, 0, 0, 3], arm: null, gravity: null, contact: null, orientation: [1, 0, 0, 0], angular_velocity: [1, 1, 1], update: "gyroscopic_explicit", step: 1 / 60,
  sliders: [{ quantity: "step", from: 1e-3, to: 0.1 }, { quantity: "angular_velocity_y", from: -5, to: 5 }, { quantity: "moment_y", from: 1, to: 4 }],
  graphs: ["energy", "momentum", "angular_velocity", "step_error"], show: "", shape: shape("free_asymmetric", 1, [1, 2, 3]), about: { moments: [1, 2, 3], principal: [1, 0, 0, 0] },
});

/** The scene lagrange_top. */
export const topLesson = (): Lesson => ({
  ...freeLesson(), name: "spinning_top", title: "The spinning top", scene: "lagrange_top", duration: 5, inertia: [0.75, 0, 0, 0, 0.75, 0, 0, 0, 0.5], arm: [0, 0, 0.5],
  gravity: [0, 0, -10], orientation: [0.9689124217106447, 0.24740395925452294, 0, 0], angular_velocity: [0, 0, 20], update: "gyroscopic_none", step: 0.005,
  sliders: [{ quantity: "tilt", from: 0, to: 1.5 }, { quantity: "angular_velocity_z", from: 0, to: 40 }, { quantity: "gravity", from: 0, to: 20 }, { quantity: "step", from: 1e-3, to: 0.1 }],
  graphs: ["energy", "momentum", "tilt"], shape: shape("lagrange_top", 1, [0.75, 0.75, 0.5]), about: { moments: [1, 1, 0.5], principal: [1, 0, 0, 0] },
});
