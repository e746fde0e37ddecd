// Contacts with planes: their state at a time, and plots of forces, |F|/(mu N) and slip over time.

import type { ContactCurves, Motion } from "../data.ts";
import { oneLine, shorten } from "../text.ts";
import { add, length, scale, type Vector, vectorAt } from "./algebra.ts";
import { PlotFigure, styleOf } from "./plot_figure.ts";
import { placeAt, type TimeCurve } from "./time_plot.ts";

export interface ContactState {
  point: Vector; // m, world
  normal: number; // N
  friction: Vector; // N, world
  slip: Vector; // m/s, world
}

/** The contact at a time; null without contact. */
export function contactAt(contact: ContactCurves, t: number): ContactState | null {
  const place = placeAt(contact, t);
  if (place === null) return null;
  const [k, s] = place;
  const between = (list: readonly number[]): Vector => s === 0 ? vectorAt(list, 3 * k) : add(scale(1 - s, vectorAt(list, 3 * k)), scale(s, vectorAt(list, 3 * k + 3)));
  const { normal_force: normal } = contact;
  return {
    point: between(contact.point), normal: s === 0 ? normal[k] ?? 0 : (1 - s) * (normal[k] ?? 0) + s * (normal[k + 1] ?? 0),
    friction: between(contact.friction_force), slip: between(contact.slip),
  };
}

const sizes = (list: readonly number[], count: number): number[] => Array.from({ length: count }, (_, k) => length(vectorAt(list, 3 * k)));

/** |F| of the samples, N. */
export const frictionOf = (contact: ContactCurves): number[] => sizes(contact.friction_force, contact.t.length);
/** Slip speed of the samples, m/s. */
export const slipOf = (contact: ContactCurves): number[] => sizes(contact.slip, contact.t.length);
/** |F|/(mu N) of the samples; null without friction or normal force. */
export function ratioOf(contact: ContactCurves): (number | null)[] {
  return frictionOf(contact).map((force, k) => {
    const limit = contact.friction * (contact.normal_force[k] ?? 0);
    return limit > 0 ? force / limit : null;
  });
}

/** Largest number of contacts in one plot. */
export const mostContacts = 6;

/** The contacts to plot: all, or if these are too many, those of one body. */
export function plottedContacts(motion: Motion, body: number): ContactCurves[] {
  const { contacts } = motion;
  return (contacts.length <= mostContacts ? contacts : contacts.filter((one) => one.body === body)).slice(0, mostContacts);
}

/** The plots of contacts. */
export class ContactPlots {
  readonly figures: readonly HTMLElement[];
  private readonly force: PlotFigure;
  private readonly ratio: PlotFigure;
  private readonly slip: PlotFigure;

  constructor(go: (time: number, done: boolean) => void) {
    this.force = new PlotFigure("Normal force N and friction |F| at contacts", go);
    this.ratio = new PlotFigure("Friction ratio |F|/(μN)", go);
    this.slip = new PlotFigure("Slip speed at contacts", go);
    this.figures = [this.force, this.ratio, this.slip].map((one) => one.root);
  }

  show(motion: Motion, body: number, dark: boolean): void {
    const contacts = plottedContacts(motion, body);
    const { duration } = motion;
    const marks = [...new Set(motion.timeline?.events.map((event) => event.t) ?? [])];
    const name = (contact: ContactCurves): string => oneLine(motion.timeline?.rows[contact.row]?.name ?? "");
    const prefix = (contact: ContactCurves): string => contacts.length > 1 ? `${name(contact)}: ` : "";
    const curve = (contact: ContactCurves, i: number, label: string, y: readonly (number | null)[]): TimeCurve => ({ name: label, ...styleOf(i, dark), t: contact.t, y, starts: contact.starts });
    const more = motion.contacts.length > contacts.length ? `Contacts of body ${shorten(oneLine(motion.bodies[body]?.name ?? ""), 40)} only.` : "";
    const forces = contacts.flatMap((contact, i) => {
      const two = contacts.length === 1 ? [0, 1] : [i, i];
      const normal = curve(contact, two[0] ?? 0, `${prefix(contact)}N`, contact.normal_force);
      const friction = curve(contact, two[1] ?? 0, `${prefix(contact)}|F|`, frictionOf(contact));
      // solid and dashed, in one colour per contact
      return contact.friction > 0 ? [{ ...normal, dash: "none" }, { ...friction, dash: "5 3" }] : [{ ...normal, dash: "none" }];
    });
    this.force.show(forces, "N", duration, { include: [0], marks, more });
    const rubbing = contacts.filter((contact) => contact.friction > 0);
    const limit = { y: 1, text: "limit of friction", color: dark ? "#a0a8b2" : "#59616b" };
    this.ratio.show(rubbing.map((contact, i) => curve(contact, i, name(contact), ratioOf(contact))), "", duration, { include: [0, 1.08], lines: [limit], marks, more });
    this.slip.show(contacts.map((contact, i) => curve(contact, i, name(contact), slipOf(contact))), "m/s", duration, { include: [0], marks, more });
  }

  resize(): void {
    for (const one of [this.force, this.ratio, this.slip]) one.resize();
  }

  at(time: number): void {
    for (const one of [this.force, this.ratio, this.slip]) one.at(time);
  }
}
