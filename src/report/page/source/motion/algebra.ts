// Vectors and quaternions (w, x, y, z) as arrays. A quaternion maps body vectors to world vectors.

export type Vector = readonly [number, number, number];
export type Quaternion = readonly [number, number, number, number];

export const zero: Vector = [0, 0, 0];
export const identity: Quaternion = [1, 0, 0, 0];

/** The three numbers of a list that start at index `at`. */
export function vectorAt(list: readonly number[], at = 0): Vector {
  return [list[at] ?? 0, list[at + 1] ?? 0, list[at + 2] ?? 0];
}

export function quaternionAt(list: readonly number[], at = 0): Quaternion {
  return [list[at] ?? 1, list[at + 1] ?? 0, list[at + 2] ?? 0, list[at + 3] ?? 0];
}

export const add = (a: Vector, b: Vector): Vector => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (s: number, a: Vector): Vector => [s * a[0], s * a[1], s * a[2]];
export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vector): number => Math.hypot(a[0], a[1], a[2]);

/** Unit vector along a; the x axis if a is zero. */
export function unit(a: Vector): Vector {
  const size = length(a);
  return size > 0 ? scale(1 / size, a) : [1, 0, 0];
}

export const conjugate = (q: Quaternion): Quaternion => [q[0], -q[1], -q[2], -q[3]];

export const multiply = (a: Quaternion, b: Quaternion): Quaternion => [
  a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
  a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
  a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
  a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
];

export const norm = (q: Quaternion): number => Math.hypot(q[0], q[1], q[2], q[3]);

export function normalized(q: Quaternion): Quaternion {
  const size = norm(q);
  return size > 0 ? [q[0] / size, q[1] / size, q[2] / size, q[3] / size] : identity;
}

/** R(q) v = v + 2 s x (s x v + w v), s the vector part of a unit quaternion. */
export function rotate(q: Quaternion, v: Vector): Vector {
  const s: Vector = [q[1], q[2], q[3]];
  return add(v, scale(2, cross(s, add(cross(s, v), scale(q[0], v)))));
}

/** Rotation angle between two attitudes, rad. */
export function angleBetween(a: Quaternion, b: Quaternion): number {
  const [w, x, y, z] = multiply(conjugate(a), b);
  return 2 * Math.atan2(Math.hypot(x, y, z), Math.abs(w));
}

/** Two unit vectors that form a right-handed frame with `axis` as the third. */
export function across(axis: Vector): [Vector, Vector] {
  const n = unit(axis);
  // the coordinate axis with the largest angle to it
  const [x, y, z] = n.map(Math.abs) as [number, number, number];
  const other: Vector = x <= y && x <= z ? [1, 0, 0] : y <= z ? [0, 1, 0] : [0, 0, 1];
  const first = unit(subtract(other, scale(dot(other, n), n)));
  return [first, cross(n, first)];
}
