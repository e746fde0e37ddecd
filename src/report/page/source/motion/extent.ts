// The extent of the view: the sizes of the bodies and the range of their motion.

import type { Motion } from "../data.ts";
import { add, length, subtract, type Vector, vectorAt, zero } from "./algebra.ts";
import { tipOf, type Surface } from "./geometry.ts";
import type { Keyframes } from "./interpolation.ts";

export interface Extent {
  size: number; // m, extent of the largest body from its centre of mass
  center: Vector; // m, centre of the view if it does not follow the bodies
  radius: number; // m, of the view
  azimuth: number; // rad, of the camera
  follows: boolean; // the camera follows the bodies, because their motion is too large for a fixed view
}

// a larger motion, in sizes of the largest body, makes the camera follow
const furthestInSizes = 12;

const usualAzimuth = 0.7;

/** Camera azimuth. Motion in a vertical plane is viewed from the front, slightly from the side. With C the covariance
 * of the centres' x and y, the major axis is at the angle atan2(2 C_xy, C_xx - C_yy) / 2. */
export function azimuthOf(points: readonly Vector[]): number {
  const count = points.length;
  if (count === 0) return usualAzimuth;
  const [mx, my] = [0, 1].map((i) => points.reduce((sum, p) => sum + (p[i] ?? 0), 0) / count) as [number, number];
  let [xx, xy, yy] = [0, 0, 0];
  for (const [x, y] of points) {
    xx += (x - mx) * (x - mx);
    xy += (x - mx) * (y - my);
    yy += (y - my) * (y - my);
  }
  const middle = (xx + yy) / 2;
  const apart = Math.hypot((xx - yy) / 2, xy);
  // not in a vertical plane
  if (!(apart > 0.9 * middle)) return usualAzimuth;
  const along = 0.5 * Math.atan2(2 * xy, xx - yy);
  return along - Math.PI / 2 + 0.4;
}

export function extentOf(motion: Motion, truth: Keyframes, surfaces: readonly Surface[][]): Extent {
  const sizes = surfaces.map((one, body) => {
    const points = [tipOf(one)];
    for (const joint of motion.joints) {
      if (joint.child === body) points.push(vectorAt(joint.child_point));
      if (joint.parent === body) points.push(vectorAt(joint.parent_point));
    }
    if (motion.pivot !== null) points.push(vectorAt(motion.pivot));
    return Math.max(...points.map(length));
  });
  const size = Math.max(...sizes, 1e-30);
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  const times = truth.dense(4);
  const azimuth = azimuthOf(times.flatMap((t) => motion.bodies.map((_, body) => truth.at(body, t).position)));
  for (const t of times) {
    for (let body = 0; body < motion.bodies.length; ++body) {
      const p = truth.at(body, t).position;
      for (const i of [0, 1, 2] as const) {
        low[i] = Math.min(low[i], p[i] - (sizes[body] ?? 0));
        high[i] = Math.max(high[i], p[i] + (sizes[body] ?? 0));
      }
    }
  }
  if (!(high[0] >= low[0])) return { size, center: zero, radius: size, azimuth, follows: false };
  const span = length(subtract(high, low)) / 2;
  if (span <= furthestInSizes * size) {
    let center: Vector = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2];
    if (motion.pivot !== null) center = zero;
    let radius = 0;
    for (const t of times) {
      for (let body = 0; body < motion.bodies.length; ++body) {
        radius = Math.max(radius, length(subtract(truth.at(body, t).position, center)) + (sizes[body] ?? 0));
      }
    }
    // a body without translation: its size
    return { size, center, radius: radius > 0 ? radius : size, azimuth, follows: false };
  }
  let radius = 0;
  for (const t of times) {
    const middle = middleOf(motion, truth, t);
    for (let body = 0; body < motion.bodies.length; ++body) {
      radius = Math.max(radius, length(subtract(truth.at(body, t).position, middle)) + (sizes[body] ?? 0));
    }
  }
  return { size, center: zero, radius, azimuth, follows: true };
}

/** The mean of the centres of mass. */
export function middleOf(motion: Motion, truth: Keyframes, t: number): Vector {
  let sum: Vector = zero;
  for (let body = 0; body < motion.bodies.length; ++body) sum = add(sum, truth.at(body, t).position);
  const count = Math.max(1, motion.bodies.length);
  return [sum[0] / count, sum[1] / count, sum[2] / count];
}
