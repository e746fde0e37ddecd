// A body that touches a plane at one point of an ellipsoid or sphere: contact point, velocities, and the matrix K of the
// contact, as in integrators/contact/contact_point.h and integrators/contact_stepping/contact_points.h.

import { add, conjugate, cross, dot, length, type Quaternion, rotate, scale, subtract, type Vector } from "../motion/algebra.ts";
import { type Body, type Matrix, product, rotationMatrix, transform, transposed } from "./mechanics.ts";

/** The touching shape { c + A u + r b : |u| <= 1, |b| <= 1 }, from the centre of mass, and the plane n . x = offset. */
export interface Contact {
  center: Vector; // m
  axes: Matrix; // A, m
  radius: number; // m
  reach: number; // bound of the distance of the hull's points from the centre of mass, m
  normal: Vector; // unit, world axes
  offset: number; // m
  restitution: number;
  friction: number;
}

/** A body with a contact. `tensor` is about the centre of mass. */
export interface ContactBody extends Body {
  mass: number;
  contact: Contact;
}

/** Attitude, angular velocity (rad/s, body axes), centre of mass (m) and its velocity (m/s, world axes). */
export interface ContactState {
  q: Quaternion;
  w: Vector;
  p: Vector;
  v: Vector;
}

/** The lowest point along the normal (body axes), from the centre of mass, m. */
export function lowestPoint({ center, axes, radius }: Contact, n: Vector): Vector {
  const m = transform(transposed(axes), n);
  const size = length(m);
  const low = subtract(center, scale(radius, n));
  return size > 0 ? subtract(low, scale(1 / size, transform(axes, m))) : low;
}

/** Height of the lowest point over the plane, m. */
export function gapOf({ contact }: ContactBody, { q, p }: ContactState): number {
  const n = rotate(conjugate(q), contact.normal);
  return dot(contact.normal, p) - contact.offset + dot(n, lowestPoint(contact, n));
}

/** Velocity of the body's point at the contact, world axes, m/s. */
export function contactVelocity({ contact }: ContactBody, { q, w, v }: ContactState): Vector {
  const arm = lowestPoint(contact, rotate(conjugate(q), contact.normal));
  return add(v, rotate(q, cross(w, arm)));
}

/** Speed of the slip: of the body's point at the contact along the plane, m/s. */
export function slipOf(body: ContactBody, state: ContactState): number {
  const u = contactVelocity(body, state);
  return length(subtract(u, scale(dot(u, body.contact.normal), body.contact.normal)));
}

/** A start that touches the plane and does not approach it: moved along the normal where it does not. A start that rolls
 * (`rolls`) rolls, too: the velocity follows from the rotation. */
export function touchingStart(body: ContactBody, state: ContactState, rolls: boolean): ContactState {
  const { normal, reach } = body.contact;
  const gap = gapOf(body, state);
  const p = Math.abs(gap) > 1e-12 * reach ? subtract(state.p, scale(gap, normal)) : state.p;
  const u = contactVelocity(body, state);
  const wrong = rolls ? u : scale(dot(u, normal), normal);
  const speed = length(state.v) + reach * length(state.w);
  return { ...state, p, v: length(wrong) > 1e-12 * speed ? subtract(state.v, wrong) : state.v };
}

/** Kinetic and potential energy, J. */
export const contactEnergy = (body: ContactBody, { w, p, v }: ContactState): number =>
  0.5 * dot(w, transform(body.tensor, w)) + 0.5 * body.mass * dot(v, v) - dot(body.weight, p);

/** I^-1 in world axes. */
export function inverseInertiaInWorld(body: ContactBody, q: Quaternion): Matrix {
  const R = rotationMatrix(q);
  return product(R, product(body.inverse, transposed(R)));
}

/** The axes of a contact: the normal and two tangents, as contact_axes() of the program. */
export function contactAxes(n: Vector): [Vector, Vector, Vector] {
  const alongX = n[0] * n[0] > 0.81;
  const e: Vector = [alongX ? 0 : 1, alongX ? 1 : 0, 0];
  const t = subtract(e, scale(dot(n, e), n));
  const first = scale(1 / length(t), t);
  return [n, first, cross(n, first)];
}
