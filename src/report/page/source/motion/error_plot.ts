// Attitude errors of methods over time, on a logarithmic scale.

import { errorDecades } from "../format.ts";
import type { Actor } from "./actors.ts";
import { dashOf } from "./polhode_view.ts";
import type { TimeAxes, TimeCurve } from "./time_plot.ts";

export const errorTitle = "Attitude error over time, logarithmic";

/** Exponents of the decades that contain the errors; [-16, 0] if there are none. */
export const decades = (errors: readonly (number | null)[]): [number, number] => errorDecades(errors) ?? [-16, 0];

/** One curve per method with errors. */
export function errorCurves(actors: readonly Actor[]): TimeCurve[] {
  return actors.flatMap(({ name, method, color, place, endsEarly, end }) => method === null || method.t.length === 0 ? [] : [{
    name, color, dash: dashOf(place).join(" ") || "none", t: method.t, y: method.attitude, ended: endsEarly && end > 0,
  }]);
}

/** Their axes. The range omits t = 0, where only rounding of the start remains, many decades below. */
export function errorAxes(curves: readonly TimeCurve[]): TimeAxes {
  const range = decades(curves.flatMap((curve) => curve.y.filter((_, i) => (curve.t[i] ?? 0) > 0)));
  return { unit: "rad", log: true, range, numbers: true, empty: "no method with errors over time is selected" };
}
