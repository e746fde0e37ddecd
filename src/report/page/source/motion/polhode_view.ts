// Two figures of the angular velocity: the polhode on the inertia ellipsoid, and the herpolhode in the invariable plane
// or, under loads, the curve in world axes. Parallel projection; lines behind the ellipsoid are faint.

import type { Motion } from "../data.ts";
import type { Actor } from "./actors.ts";
import { dot, length, rotate, scale, type Vector } from "./algebra.ts";
import type { Palette } from "./body_view.ts";
import {
  angularMomentum, circle, herpolhodeRadii, invariablePlane, type InvariablePlane, isSeen, onPlane, outline, polhode, semiAxes, toPrincipal,
  twiceEnergy, worldMomentum,
} from "./ellipsoid.ts";
import type { Orbit } from "./orbit.ts";
import { type Inertia, inertiaOf } from "./spin.ts";

/** Dash pattern of an actor's lines by its place, px. */
export const dashOf = (place: number): number[] => [[], [], [7, 4], [2, 3]][place] ?? [];

interface Curve {
  actor: Actor;
  times: number[];
  principal: Vector[]; // w in principal axes
  world: Vector[];
}

export class PolhodeView {
  private curves: Curve[] = [];
  private inertia: Inertia = { moments: [1, 1, 1], principal: [1, 0, 0, 0] };
  private body = 0;
  private free = false;
  private largest = 0;
  private plane: InvariablePlane | null = null;
  private radii: [number, number] = [0, 0];

  constructor(readonly polhodeCanvas: HTMLCanvasElement, readonly worldCanvas: HTMLCanvasElement) {}

  show(motion: Motion, actors: readonly Actor[], body: number): void {
    this.body = body;
    this.inertia = inertiaOf(motion, body);
    // with planes, each impact changes the polhode
    this.free = motion.free && motion.bodies.length === 1 && motion.planes.length === 0;
    this.curves = [];
    this.largest = 0;
    for (const actor of actors) {
      if (actor.keyframes === null) continue;
      const times = actor.keyframes.dense(8);
      const curve: Curve = { actor, times, principal: [], world: [] };
      for (const t of times) {
        const placed = actor.keyframes.at(body, t);
        curve.principal.push(toPrincipal(this.inertia.principal, placed.angularVelocity));
        curve.world.push(rotate(placed.attitude, placed.angularVelocity));
        if (actor.method === null) this.largest = Math.max(this.largest, length(placed.angularVelocity));
      }
      this.curves.push(curve);
    }
    const truth = this.curves.find((curve) => curve.actor.method === null);
    const start = truth?.principal[0];
    this.plane = null;
    if (this.free && truth !== undefined && start !== undefined && truth.actor.keyframes !== null) {
      const placed = truth.actor.keyframes.at(body, 0);
      const L = worldMomentum(placed.attitude, this.inertia.principal, this.inertia.moments, placed.angularVelocity);
      this.plane = invariablePlane(L, twiceEnergy(this.inertia.moments, start));
      this.radii = herpolhodeRadii(this.inertia.moments, start);
    }
  }

  /** Captions of the two figures. */
  captions(): [string, string] {
    const world = this.plane !== null
      ? `Herpolhode: path of ω in the invariable plane, perpendicular to L at the distance 2E/|L| = ${this.plane.distance.toPrecision(3)} rad/s from the centre. Dotted: the two circles that bound it`
      : "Path of ω in world axes";
    const ellipsoid = this.free
      ? "Polhode: path of ω in principal axes, on the ellipsoid ΣIω² = 2E. Thin: the truth's whole closed curve"
      : "Path of ω in principal axes, with the ellipsoid ΣIω² = 2E for the energy at the current time";
    return [ellipsoid, world];
  }

  draw(t: number, orbit: Orbit, palette: Palette, ratio: number): void {
    const ellipsoid = prepare(this.polhodeCanvas, palette, ratio);
    if (ellipsoid !== null) this.drawPolhode(ellipsoid, t, orbit, palette);
    const world = prepare(this.worldCanvas, palette, ratio);
    if (world === null) return;
    if (this.plane !== null) this.drawHerpolhode(world, t, this.plane, palette);
    else this.drawWorld(world, t, orbit, palette);
  }

  private now(curve: Curve, t: number): { principal: Vector; world: Vector } | null {
    const { keyframes } = curve.actor;
    if (keyframes === null) return null;
    const placed = keyframes.at(this.body, t);
    return { principal: toPrincipal(this.inertia.principal, placed.angularVelocity), world: rotate(placed.attitude, placed.angularVelocity) };
  }

  private drawPolhode(sheet: Sheet, t: number, orbit: Orbit, palette: Palette): void {
    const truth = this.curves.find((curve) => curve.actor.method === null);
    const current = truth === undefined ? null : this.now(truth, t);
    if (truth === undefined || current === null) return;
    const { moments } = this.inertia;
    const start = truth.principal[0] ?? current.principal;
    const axes = semiAxes(moments, twiceEnergy(moments, this.free ? start : current.principal));
    const n = orbit.direction();
    const [right, upward] = orbit.axes();
    const reach = Math.max(...(this.free ? axes : [...axes, this.largest]), 1e-300);
    // above the centre, because buttons are below
    const middle = 0.46 * sheet.height;
    const factor = (0.38 * Math.min(sheet.width, sheet.height) * orbit.zoom) / reach;
    const place = (v: Vector): [number, number] => [sheet.width / 2 + factor * dot(right, v), middle - factor * dot(upward, v)];
    const { context } = sheet;

    // the ellipsoid: its outline, filled, and its three principal sections
    const rim = outline(axes, n).map(place);
    context.beginPath();
    rim.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    const [lightX, lightY] = [sheet.width / 2 - 0.3 * factor * reach, middle - 0.35 * factor * reach];
    const shade = context.createRadialGradient(lightX, lightY, 0, lightX, lightY, 1.6 * factor * reach);
    const tones = palette.dark ? ["#3a424c", "#20252b"] : ["#f4f6f8", "#cfd6de"];
    shade.addColorStop(0, tones[0] ?? "");
    shade.addColorStop(1, tones[1] ?? "");
    context.fillStyle = shade;
    context.fill();
    sheet.style(palette.muted, 1);
    context.stroke();
    const sections: [Vector, Vector][] = [[[axes[0], 0, 0], [0, axes[1], 0]], [[0, axes[1], 0], [0, 0, axes[2]]], [[0, 0, axes[2]], [axes[0], 0, 0]]];
    for (const [a, b] of sections) {
      const points = circle(a, b, 96);
      sheet.style(palette.muted, 0.8);
      sheet.surfaceCurve(points, place, (v) => isSeen(axes, n, v), 0.6, 0.2);
    }
    for (const i of [0, 1, 2] as const) {
      const end: [number, number, number] = [0, 0, 0];
      end[i] = axes[i];
      const tip: Vector = scale(1.12, end);
      sheet.style(palette.muted, 1.2);
      context.globalAlpha = isSeen(axes, n, end) ? 1 : 0.35;
      context.beginPath();
      context.moveTo(...place(end));
      context.lineTo(...place(tip));
      context.stroke();
      sheet.text(["1", "2", "3"][i] ?? "", ...place(scale(1.19, end)), palette.muted);
      context.globalAlpha = 1;
    }

    const seen = (v: Vector): boolean => isSeen(axes, n, v);
    if (this.free) {
      sheet.style(palette.ink, 1);
      sheet.surfaceCurve(polhode(moments, start), place, seen, 0.55, 0.25);
    }
    for (const curve of this.curves) {
      if (curve.actor.isTruth && curve.actor.method !== null) continue;
      sheet.style(curve.actor.method === null ? palette.ink : curve.actor.color, curve.actor.method === null ? 2.2 : 1.7, dashOf(curve.actor.place));
      sheet.surfaceCurve(until(curve, curve.principal, t), place, seen, 1, 0.3);
    }
    for (const curve of this.curves) {
      const at = this.now(curve, t);
      if (at !== null) sheet.point(place(at.principal), curve.actor, palette, seen(at.principal) ? 1 : 0.5);
    }
  }

  private drawHerpolhode(sheet: Sheet, t: number, plane: InvariablePlane, palette: Palette): void {
    const { context } = sheet;
    let reach = this.radii[1];
    const flat = this.curves.map((curve) => until(curve, curve.world, t).map((w) => onPlane(plane, w)));
    for (const curve of this.curves) for (const w of curve.world) reach = Math.max(reach, Math.min(Math.hypot(...onPlane(plane, w)), 1.3 * this.radii[1]));
    if (!(reach > 1e-9 * this.largest)) reach = this.largest || 1;
    const factor = (0.44 * Math.min(sheet.width, sheet.height)) / reach;
    const place = ([x, y]: readonly [number, number]): [number, number] => [sheet.width / 2 + factor * x, sheet.height / 2 - factor * y];
    for (const radius of this.radii) {
      sheet.style(palette.muted, 1, [2, 4]);
      context.beginPath();
      context.arc(sheet.width / 2, sheet.height / 2, factor * radius, 0, 2 * Math.PI);
      context.stroke();
    }
    // intersection of L with the plane
    sheet.style(palette.muted, 1);
    context.beginPath();
    context.moveTo(sheet.width / 2 - 5, sheet.height / 2);
    context.lineTo(sheet.width / 2 + 5, sheet.height / 2);
    context.moveTo(sheet.width / 2, sheet.height / 2 - 5);
    context.lineTo(sheet.width / 2, sheet.height / 2 + 5);
    context.stroke();
    sheet.text("L", sheet.width / 2 + 11, sheet.height / 2 - 9, palette.muted);
    this.curves.forEach((curve, i) => {
      if (curve.actor.isTruth && curve.actor.method !== null) return;
      const points = flat[i] ?? [];
      sheet.style(curve.actor.method === null ? palette.ink : curve.actor.color, curve.actor.method === null ? 1.6 : 1.3, dashOf(curve.actor.place));
      context.beginPath();
      points.forEach((point, k) => (k === 0 ? context.moveTo(...place(point)) : context.lineTo(...place(point))));
      context.stroke();
    });
    for (const curve of this.curves) {
      const at = this.now(curve, t);
      if (at !== null) sheet.point(place(onPlane(plane, at.world)), curve.actor, palette, 1);
    }
  }

  private drawWorld(sheet: Sheet, t: number, orbit: Orbit, palette: Palette): void {
    const { context } = sheet;
    const [right, upward] = orbit.axes();
    const reach = this.largest || 1;
    const factor = (0.4 * Math.min(sheet.width, sheet.height) * orbit.zoom) / reach;
    const place = (v: Vector): [number, number] => [sheet.width / 2 + factor * dot(right, v), sheet.height / 2 - factor * dot(upward, v)];
    const names = ["x", "y", "z"];
    for (const i of [0, 1, 2] as const) {
      const end: [number, number, number] = [0, 0, 0];
      end[i] = reach;
      sheet.style(palette.muted, 1);
      context.globalAlpha = 0.7;
      context.beginPath();
      context.moveTo(...place(scale(-1, end)));
      context.lineTo(...place(end));
      context.stroke();
      context.globalAlpha = 1;
      sheet.text(names[i] ?? "", ...place(scale(1.08, end)), palette.muted);
    }
    for (const curve of this.curves) {
      if (curve.actor.isTruth && curve.actor.method !== null) continue;
      sheet.style(curve.actor.method === null ? palette.ink : curve.actor.color, curve.actor.method === null ? 1.8 : 1.4, dashOf(curve.actor.place));
      context.beginPath();
      until(curve, curve.world, t).forEach((w, k) => (k === 0 ? context.moveTo(...place(w)) : context.lineTo(...place(w))));
      context.stroke();
    }
    for (const curve of this.curves) {
      const at = this.now(curve, t);
      if (at === null) continue;
      sheet.style(palette.muted, 1);
      context.beginPath();
      context.moveTo(...place([0, 0, 0]));
      context.lineTo(...place(at.world));
      context.stroke();
      sheet.point(place(at.world), curve.actor, palette, 1);
    }
  }

  /** Values at a time, for screen readers. */
  describe(t: number): string {
    const truth = this.curves.find((curve) => curve.actor.method === null);
    const at = truth === undefined ? null : this.now(truth, t);
    if (at === null) return "";
    const L = length(angularMomentum(this.inertia.moments, at.principal));
    return `angular velocity ${length(at.principal).toPrecision(3)} rad/s, angular momentum ${L.toPrecision(3)} kg m²/s`;
  }
}

/** Points of a curve up to a time. */
function until(curve: Curve, points: Vector[], t: number): Vector[] {
  let count = curve.times.findIndex((one) => one > t);
  if (count < 0) count = points.length;
  return points.slice(0, count);
}

/** Drawing on a canvas in CSS pixels. */
class Sheet {
  constructor(readonly context: CanvasRenderingContext2D, readonly width: number, readonly height: number) {}

  style(color: string, width: number, dash: number[] = []): void {
    this.context.strokeStyle = color;
    this.context.lineWidth = width;
    this.context.setLineDash(dash);
    this.context.lineJoin = "round";
  }

  /** Draws a curve on a surface; the far side is faint. */
  surfaceCurve(points: Vector[], place: (v: Vector) => [number, number], seen: (v: Vector) => boolean, near: number, far: number): void {
    const { context } = this;
    for (const wanted of [false, true]) {
      context.globalAlpha = wanted ? near : far;
      context.beginPath();
      let drawing = false;
      points.forEach((point, i) => {
        const here = seen(point) === wanted;
        const before = points[i - 1];
        if (here && !drawing && before !== undefined) context.moveTo(...place(before));
        else if (here && !drawing) context.moveTo(...place(point));
        if (here) context.lineTo(...place(point));
        drawing = here;
      });
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  text(text: string, x: number, y: number, color: string): void {
    const { context } = this;
    context.fillStyle = color;
    context.font = "600 13px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, x, y);
  }

  /** Marks the current point: a filled disc for the truth, rings of increasing size for methods. */
  point([x, y]: [number, number], actor: Actor, palette: Palette, opacity: number): void {
    const { context } = this;
    context.globalAlpha = opacity;
    this.style(actor.method === null ? palette.ink : actor.color, 2);
    context.beginPath();
    context.arc(x, y, actor.method === null ? 3.5 : 3.5 + 2.5 * actor.place, 0, 2 * Math.PI);
    if (actor.method === null) {
      context.fillStyle = palette.ink;
      context.fill();
    } else context.stroke();
    context.globalAlpha = 1;
  }
}

function prepare(canvas: HTMLCanvasElement, palette: Palette, ratio: number): Sheet | null {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const context = canvas.getContext("2d");
  if (context === null || width < 2 || height < 2) return null;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  context.setTransform(w / width, 0, 0, h / height, 0, 0);
  context.fillStyle = palette.ground;
  context.fillRect(0, 0, width, height);
  return new Sheet(context, width, height);
}
