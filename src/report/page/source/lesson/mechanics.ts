// A rigid body that is free or has a fixed point, with gravity: its data, its invariants, and 3x3 matrices as rows.

import { add, cross, dot, length, multiply, type Quaternion, rotate, scale, type Vector } from "../motion/algebra.ts";

export type Matrix = readonly [Vector, Vector, Vector];

/** Mass properties and loads. Without a pivot, gravity exerts no torque and `arm` is zero. */
export interface Body {
  tensor: Matrix; // kg m^2, body axes, about the pivot, else about the centre of mass
  inverse: Matrix;
  arm: Vector; // m, body axes: from the pivot to the centre of mass
  weight: Vector; // N, world axes: m g
}

/** Attitude and angular velocity (rad/s, body axes). */
export interface Sample {
  t: number; // s
  q: Quaternion;
  w: Vector;
  at?: { p: Vector; v: Vector }; // contact: centre of mass (m) and its velocity (m/s), world axes
}

export const transform = (m: Matrix, v: Vector): Vector => [dot(m[0], v), dot(m[1], v), dot(m[2], v)];

/** The inverse by cofactors: its columns are the cross products of the rows over the determinant. */
export function inverseOf(m: Matrix): Matrix {
  const [a, b, c] = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
  const d = 1 / dot(m[0], a);
  return [[d * a[0], d * b[0], d * c[0]], [d * a[1], d * b[1], d * c[1]], [d * a[2], d * b[2], d * c[2]]];
}

export const product = (a: Matrix, b: Matrix): Matrix => {
  const row = (r: Vector): Vector => [0, 1, 2].map((j) => r[0] * (b[0][j] ?? 0) + r[1] * (b[1][j] ?? 0) + r[2] * (b[2][j] ?? 0)) as unknown as Vector;
  return [row(a[0]), row(a[1]), row(a[2])];
};

export const transposed = (m: Matrix): Matrix => [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]];

/** The rotation matrix of a unit quaternion, rounded as in the program (src/body/algebra.h). */
export function rotationMatrix([w, x, y, z]: Quaternion): Matrix {
  const [ww, xx, yy, zz] = [w * w, x * x, y * y, z * z];
  const [xy, xz, yz, wx, wy, wz] = [x * y, x * z, y * z, w * x, w * y, w * z];
  return [
    [ww + xx - yy - zz, 2 * (xy - wz), 2 * (xz + wy)],
    [2 * (xy + wz), ww - xx + yy - zz, 2 * (yz - wx)],
    [2 * (xz - wy), 2 * (yz + wx), ww - xx - yy + zz],
  ];
}

/** The matrix of v x. */
export const skew = (v: Vector): Matrix => [[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]];

/** Inertia about a point at the distance -arm from the centre of mass: I + m (|r|^2 1 - r r^T). */
export function aboutPivot(mass: number, central: Matrix, arm: Vector): Matrix {
  const square = dot(arm, arm);
  const row = (i: 0 | 1 | 2): Vector => [0, 1, 2].map((j) => (central[i][j] ?? 0) + mass * ((i === j ? square : 0) - arm[i] * (arm[j] ?? 0))) as unknown as Vector;
  return [row(0), row(1), row(2)];
}

/** The quaternion exp(r / 2) of a rotation by |r| about r. */
export function fromRotationVector(r: Vector): Quaternion {
  const angle = length(r);
  // sin(x/2)/x without division by zero
  const s = angle > 1e-8 ? Math.sin(angle / 2) / angle : 0.5 - (angle * angle) / 48;
  return [Math.cos(angle / 2), s * r[0], s * r[1], s * r[2]];
}

/** q (0, v): the product with a pure quaternion. */
export const timesVector = (q: Quaternion, v: Vector): Quaternion => multiply(q, [0, v[0], v[1], v[2]]);

/** Torque of gravity about the pivot, world axes, N m. */
export const torqueOf = (body: Body, R: Matrix): Vector => cross(transform(R, body.arm), body.weight);

/** Kinetic energy and the potential energy -m g . x, J. */
export const energyOf = (body: Body, { q, w }: Sample): number => 0.5 * dot(w, transform(body.tensor, w)) - dot(body.weight, rotate(q, body.arm));

/** Angular momentum in world axes, N m s. */
export const momentumOf = (body: Body, { q, w }: Sample): Vector => rotate(q, transform(body.tensor, w));

/** What torques leave constant: |L|, or with gravity about a pivot the component of L along gravity. */
export function conservedMomentum(body: Body, sample: Sample): number {
  const L = momentumOf(body, sample);
  const weight = length(body.weight);
  return weight > 0 && length(body.arm) > 0 ? -dot(L, body.weight) / weight : length(L);
}

/** Angle between the body's z axis and the world's, rad. */
export function tiltOf(q: Quaternion): number {
  const axis = rotate(q, [0, 0, 1]);
  return Math.atan2(Math.hypot(axis[0], axis[1]), axis[2]);
}

export const combine = (a: Vector, s: number, b: Vector): Vector => add(a, scale(s, b));
