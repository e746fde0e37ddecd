// Angular velocity and angular momentum of a body.

import type { Motion } from "../data.ts";
import { type Quaternion, quaternionAt, rotate, type Vector, vectorAt } from "./algebra.ts";
import { worldMomentum } from "./ellipsoid.ts";
import type { Keyframes } from "./interpolation.ts";

/** Principal moments and axes about the pivot or, without a pivot, about the centre of mass. */
export interface Inertia {
  moments: Vector;
  principal: Quaternion; // principal to body axes
}

export function inertiaOf(motion: Motion, body: number): Inertia {
  const shape = motion.bodies[body];
  const about = motion.about ?? shape;
  if (about === undefined) return { moments: [1, 1, 1], principal: [1, 0, 0, 0] };
  return { moments: vectorAt(about.moments), principal: quaternionAt(about.principal) };
}

/** Angular velocity and angular momentum in world axes. */
export function spinAt(keyframes: Keyframes, inertia: Inertia, body: number, t: number): { w: Vector; L: Vector } {
  const placed = keyframes.at(body, t);
  return {
    w: rotate(placed.attitude, placed.angularVelocity),
    L: worldMomentum(placed.attitude, inertia.principal, inertia.moments, placed.angularVelocity),
  };
}
