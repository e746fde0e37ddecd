// Finds the flips of a body that rotates about its intermediate axis.

import type { Motion } from "../../src/report/page/source/data.ts";
import { toPrincipal } from "../../src/report/page/source/motion/ellipsoid.ts";
import { Keyframes } from "../../src/report/page/source/motion/interpolation.ts";
import { inertiaOf } from "../../src/report/page/source/motion/spin.ts";

/** Times at which w along the axis of the intermediate moment changes its sign, s. */
export function flips(motion: Motion): number[] {
  const keyframes = new Keyframes(motion.truth);
  const { moments, principal } = inertiaOf(motion, 0);
  const middle = [0, 1, 2].sort((a, b) => (moments[a] ?? 0) - (moments[b] ?? 0))[1] ?? 1;
  const along = (t: number): number => toPrincipal(principal, keyframes.at(0, t).angularVelocity)[middle] ?? 0;
  const times = keyframes.dense(8);
  const made: number[] = [];
  for (let i = 1; i < times.length; ++i) {
    const [a, b] = [times[i - 1] ?? 0, times[i] ?? 0];
    const [before, after] = [along(a), along(b)];
    if (before * after < 0) made.push(a + ((b - a) * before) / (before - after));
  }
  return made;
}
