// Plots of joint coordinates and rates over time, with limits as lines and events as marks. Angles and displacements
// have separate plots.

import type { JointCurves, Motion } from "../data.ts";
import { oneLine, shorten } from "../text.ts";
import { PlotFigure, styleOf } from "./plot_figure.ts";
import type { TimeCurve } from "./time_plot.ts";

type JointCurve = JointCurves["curves"][number];

export const mostJoints = 6;

/** The curves to plot: all, or if these are too many, those of the joints of one body. */
export function plottedJoints(motion: Motion, body: number): JointCurve[] {
  const curves = motion.coordinates?.curves ?? [];
  const ofBody = (curve: JointCurve): boolean => {
    const joint = motion.joints[curve.joint];
    return joint !== undefined && (joint.parent === body || joint.child === body);
  };
  return (curves.length <= mostJoints ? curves : curves.filter(ofBody)).slice(0, mostJoints);
}

export class CoordinatePlots {
  readonly figures: readonly HTMLElement[];
  private readonly all: readonly { unit: string; coordinate: PlotFigure; rate: PlotFigure }[];

  constructor(go: (time: number, done: boolean) => void) {
    this.all = [
      { unit: "rad", coordinate: new PlotFigure("Joint angles", go), rate: new PlotFigure("Rates of joint angles", go) },
      { unit: "m", coordinate: new PlotFigure("Joint displacements", go), rate: new PlotFigure("Speeds of joint displacements", go) },
    ];
    this.figures = this.all.flatMap(({ coordinate, rate }) => [coordinate.root, rate.root]);
  }

  show(motion: Motion, body: number, dark: boolean): void {
    const chosen = plottedJoints(motion, body);
    const t = motion.coordinates?.t ?? [];
    const marks = [...new Set(motion.timeline?.events.map((event) => event.t) ?? [])];
    const more = chosen.length < (motion.coordinates?.total ?? 0) ? `${chosen.length} of ${motion.coordinates?.total ?? 0} coordinates; choose a body above for its joints.` : "";
    for (const { unit, coordinate, rate } of this.all) {
      const curves = chosen.filter((curve) => curve.unit === unit);
      const curve = (one: JointCurve, i: number, y: readonly (number | null)[]): TimeCurve => ({ name: oneLine(one.name), ...styleOf(i, dark), t, y });
      // many names of limits would cover each other
      const named = curves.filter((one) => one.lower !== null || one.upper !== null).length <= 2;
      const lines = curves.flatMap((one, i) => [["lower", one.lower], ["upper", one.upper]].flatMap(([side, y]) =>
        typeof y !== "number" ? [] : [{ y, text: !named ? "" : curves.length > 1 ? `${shorten(oneLine(one.name), 20)}: ${side ?? ""} limit` : `${side ?? ""} limit`, color: styleOf(i, dark).color }]));
      coordinate.show(curves.map((one, i) => curve(one, i, one.x)), unit, motion.duration, { lines, marks, more: named ? more : `Dashed horizontal lines are limits. ${more}` });
      rate.show(curves.map((one, i) => curve(one, i, one.rate)), `${unit}/s`, motion.duration, { include: [0], marks, more });
    }
  }

  resize(): void {
    for (const { coordinate, rate } of this.all) {
      coordinate.resize();
      rate.resize();
    }
  }

  at(time: number): void {
    for (const { coordinate, rate } of this.all) {
      coordinate.at(time);
      rate.at(time);
    }
  }
}
