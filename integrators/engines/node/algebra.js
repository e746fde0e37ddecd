// Vectors as [x, y, z] and quaternions as [w, x, y, z].

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const product = (a, b) => [
  a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
  a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]
];
export const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
export const normalized = (q) => {
  const length = Math.hypot(...q);
  return q.map((x) => x / length);
};
// Rotates a vector from body to world axes, and back; q has unit length.
export const rotate = (q, a) => product(product(q, [0, ...a]), conjugate(q)).slice(1);
export const rotateBack = (q, a) => rotate(conjugate(q), a);
