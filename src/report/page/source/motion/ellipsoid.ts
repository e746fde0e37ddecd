// Poinsot's construction in angular velocities. The tip of w stays on the body-fixed ellipsoid
// I_1 w_1^2 + I_2 w_2^2 + I_3 w_3^2 = 2E with semi-axes sqrt(2E / I_i); its path there is the polhode. The ellipsoid
// rolls without slipping on the plane w . L = 2E, at the distance 2E / |L| from its centre; the tip's path in this plane
// is the herpolhode.

import { across, dot, length, rotate, type Quaternion, type Vector, unit } from "./algebra.ts";

export const twiceEnergy = (moments: Vector, w: Vector): number =>
  moments[0] * w[0] * w[0] + moments[1] * w[1] * w[1] + moments[2] * w[2] * w[2];

/** Angular momentum in principal axes. */
export const angularMomentum = (moments: Vector, w: Vector): Vector => [moments[0] * w[0], moments[1] * w[1], moments[2] * w[2]];

export function semiAxes(moments: Vector, energyTwice: number): Vector {
  const axis = (I: number): number => (I > 0 ? Math.sqrt(energyTwice / I) : 0);
  return [axis(moments[0]), axis(moments[1]), axis(moments[2])];
}

/** R(principal)^T v: from body axes to principal axes. */
export function toPrincipal(principal: Quaternion, v: Vector): Vector {
  return rotate([principal[0], -principal[1], -principal[2], -principal[3]], v);
}

/** The closed polhode through w; the last point equals the first. A single point if w is at rest in the body (along a
 * principal axis, or for a sphere). With i the axis that it encircles, and j and k the others,
 *   I_j (I_i - I_j) w_j^2 + I_k (I_i - I_k) w_k^2 = 2E I_i - L^2,
 * an ellipse, and w_i follows from the energy. i has the largest moment if L^2 > 2E I_middle, else the smallest. */
export function polhode(moments: Vector, w: Vector, count = 256): Vector[] {
  const order = ([0, 1, 2] as (0 | 1 | 2)[]).sort((a, b) => moments[a] - moments[b]);
  const [small, middle, large] = order as [0 | 1 | 2, 0 | 1 | 2, 0 | 1 | 2];
  const energyTwice = twiceEnergy(moments, w);
  // L^2 - 2E I_middle without cancellation: the sum of I_n (I_n - I_middle) w_n^2
  const excess = order.reduce<number>((sum, n) => sum + moments[n] * (moments[n] - moments[middle]) * w[n] * w[n], 0);
  const i = excess > 0 ? large : small;
  const [j, k] = order.filter((n) => n !== i) as [0 | 1 | 2, 0 | 1 | 2];
  const factor = (n: 0 | 1 | 2): number => moments[n] * Math.abs(moments[i] - moments[n]);
  const right = factor(j) * w[j] * w[j] + factor(k) * w[k] * w[k];
  if (!(right > 0) || !(factor(j) > 0) || !(factor(k) > 0) || !(moments[i] > 0)) return [w];
  const a = Math.sqrt(right / factor(j));
  const b = Math.sqrt(right / factor(k));
  const side = w[i] < 0 ? -1 : 1;
  const points: Vector[] = [];
  for (let n = 0; n <= count; ++n) {
    const angle = (2 * Math.PI * n) / count;
    const point: [number, number, number] = [0, 0, 0];
    point[j] = a * Math.cos(angle);
    point[k] = b * Math.sin(angle);
    const rest = energyTwice - moments[j] * point[j] * point[j] - moments[k] * point[k] * point[k];
    point[i] = side * Math.sqrt(Math.max(0, rest) / moments[i]);
    points.push(point);
  }
  return points;
}

/** Smallest and largest radius of the herpolhode, rad/s. |w|^2 is extremal where the polhode crosses its planes of
 * symmetry, where one component is zero; for the other two components i and j,
 *   w_i^2 = (L^2 - 2E I_j) / (I_i (I_i - I_j)),
 * and the radius is sqrt(|w|^2 - (2E / |L|)^2). */
export function herpolhodeRadii(moments: Vector, w: Vector): [number, number] {
  const energyTwice = twiceEnergy(moments, w);
  const L = length(angularMomentum(moments, w));
  if (!(L > 0)) return [0, 0];
  const height = energyTwice / L;
  const radii = polhodeVertices(moments, w).map((v) => Math.sqrt(Math.max(0, dot(v, v) - height * height)));
  return [Math.min(...radii), Math.max(...radii)];
}

function polhodeVertices(moments: Vector, w: Vector): Vector[] {
  const curve = polhode(moments, w, 4);
  return curve.length === 1 ? curve : curve.slice(0, 4);
}

/** Axes of the invariable plane: two perpendicular to L, and the direction of L. */
export interface InvariablePlane {
  x: Vector;
  y: Vector;
  normal: Vector;
  distance: number; // rad/s: 2E / |L|
}

export function invariablePlane(L: Vector, energyTwice: number): InvariablePlane {
  const [x, y] = across(L);
  return { x, y, normal: unit(L), distance: length(L) > 0 ? energyTwice / length(L) : 0 };
}

export const onPlane = (plane: InvariablePlane, w: Vector): [number, number] => [dot(plane.x, w), dot(plane.y, w)];

/** Angular momentum in world axes: R(q) I w. `principal` maps principal to body axes. */
export function worldMomentum(attitude: Quaternion, principal: Quaternion, moments: Vector, w: Vector): Vector {
  return rotate(attitude, rotate(principal, angularMomentum(moments, toPrincipal(principal, w))));
}

/** Outline of an ellipsoid in parallel projection along the unit vector n, where the normal (x_i / a_i^2) is
 * perpendicular to n. In u_i = x_i / a_i it is the unit circle perpendicular to the vector (n_i / a_i). */
export function outline(axes: Vector, n: Vector, count = 96): Vector[] {
  const pole: Vector = [n[0] / (axes[0] || 1), n[1] / (axes[1] || 1), n[2] / (axes[2] || 1)];
  const [first, second] = across(pole);
  return circle(first, second, count).map((u) => [u[0] * axes[0], u[1] * axes[1], u[2] * axes[2]]);
}

/** Whether a point of the ellipsoid is on the side that is visible from the direction n. */
export function isSeen(axes: Vector, n: Vector, point: Vector): boolean {
  const term = (i: 0 | 1 | 2): number => (axes[i] > 0 ? (n[i] * point[i]) / (axes[i] * axes[i]) : 0);
  return term(0) + term(1) + term(2) >= 0;
}

export function circle(first: Vector, second: Vector, count: number): Vector[] {
  return Array.from({ length: count + 1 }, (_, i) => {
    const angle = (2 * Math.PI * i) / count;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [c * first[0] + s * second[0], c * first[1] + s * second[1], c * first[2] + s * second[2]];
  });
}
