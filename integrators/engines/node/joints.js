// Joints between bodies: coordinates and forces, from the motions of the bodies; limits and gears as engines take them.
import {add, conjugate, cross, normalized, product, rotate, scaled, subtract} from './algebra.js';
import {Unsupported} from './errors.js';

// A frame of the world at the start, in the axes of a body or of the world.
export const within = (bodies, index, frame) => index < 0 ? frame : product(conjugate(bodies[index].q), frame);

// The coordinate of a revolute (between -pi and pi) or prismatic joint, zero at the start, and its rate.
export function jointCoordinate(bodies, joint, motions) {
  const rest = {q: [1, 0, 0, 0], w: [0, 0, 0], p: [0, 0, 0], v: [0, 0, 0]};
  const parent = motions[joint.parent] ?? rest, child = motions[joint.child];
  const up = normalized(parent.q), down = normalized(child.q), axis = rotate(up, joint.parent_axes[0]);
  const along = (a) => a[0] * axis[0] + a[1] * axis[1] + a[2] * axis[2];
  if (joint.type === 'revolute') {
    const start = within(bodies, joint.parent, bodies[joint.child].q);
    const turn = product(product(conjugate(up), down), conjugate(start)), [a, b, c] = joint.parent_axes[0];
    const sine = a * turn[1] + b * turn[2] + c * turn[3];
    return {
      x: 2 * Math.atan2(turn[0] < 0 ? -sine : sine, Math.abs(turn[0])), rate: along(subtract(child.w, parent.w))
    };
  }
  const arm = rotate(down, joint.child_point), place = add(child.p, arm);
  const behind = add(parent.p, rotate(up, joint.parent_point));
  const carried = add(parent.v, cross(parent.w, subtract(place, parent.p)));
  return {x: along(subtract(place, behind)), rate: along(subtract(add(child.v, cross(child.w, arm)), carried))};
}

// Passes a generalized force on a joint to `apply(index, force, torque)` as opposite loads on its bodies.
export function applyJointForce({type, parent, child, child_axes: [axis]}, force, motions, apply) {
  const along = scaled(force, rotate(normalized(motions[child].q), axis)), back = scaled(-1, along), none = [0, 0, 0];
  if (type === 'revolute') {
    apply(child, none, along);
    if (parent >= 0) apply(parent, none, back);
  } else {
    apply(child, along, none);
    if (parent >= 0) apply(parent, back, cross(subtract(motions[child].p, motions[parent].p), back));
  }
}

// Motors of joints as forces that are constant during a step. A motor acts in the steps whose middle is in its window.
export class MotorForces {
  constructor(motors) { this.motors = motors, this.time = this.middle = 0; }
  enterStep(h) { this.middle = this.time + 0.5 * h, this.time += h; }
  // The forces that act, by index of the joint.
  byJoint() {
    const forces = new Map();
    for (const {joint, force, from, until = Infinity} of this.motors)
      if (from <= this.middle && this.middle < until) forces.set(joint, (forces.get(joint) ?? 0) + force);
    return forces;
  }
}

// Motors, springs and dampers of joints as forces on bodies.
export class JointForces extends MotorForces {
  constructor({bodies, joints, motors = []}) {
    super(motors);
    this.bodies = bodies, this.joints = joints;
    this.loaded = joints.map((joint, i) => ({joint, i})).filter(
        ({joint, i}) => joint.stiffness || joint.damping || motors.some((motor) => motor.joint === i));
  }
  // Applies them to a Mechanism for its next step, of length h.
  applyTo(mechanism, h) {
    this.enterStep(h);
    if (!this.loaded.length) return;
    const forces = this.byJoint(), motions = mechanism.motions();
    const apply = (...load) => mechanism.apply(...load);
    for (const {joint, i} of this.loaded) {
      const {stiffness = 0, rest = 0, damping = 0} = joint;
      const {x, rate} = jointCoordinate(this.bodies, joint, motions);
      applyJointForce(joint, (forces.get(i) ?? 0) - stiffness * (x - rest) - damping * rate, motions, apply);
    }
  }
}

const far = 1e6;

// Limits as numbers: a missing limit is far away.
export const boundsOf = ({lower, upper}) => ({lower: lower ?? -far, upper: upper ?? far});

// The limits of a revolute joint, for an engine that measures its angle between -pi and pi.
export function angleBounds(engine, limits) {
  const {lower, upper} = boundsOf(limits);
  if (lower < -Math.PI || upper > Math.PI)
    throw new Unsupported(`${engine} supports limits of revolute joints only on both sides within pi of the start`);
  return {lower, upper};
}

// A coupling for an engine whose gears join bodies that rotate or slide relative to the world: {first, second, ratio} of
// two rotations, or {pinion, rack, travel} with the travel in m per rad. All are joints of `joints`.
export function gearOf(engine, joints, coupling) {
  const first = joints[coupling.first], second = joints[coupling.second], {ratio} = coupling;
  if (first.parent < 0 && second.parent < 0) {
    if (first.type === 'revolute' && second.type === 'revolute') return {first, second, ratio};
    if (first.type === 'revolute' && second.type === 'prismatic') return {pinion: first, rack: second, travel: ratio};
    if (first.type === 'prismatic' && second.type === 'revolute')
      return {pinion: second, rack: first, travel: 1 / ratio};
  }
  throw new Unsupported(
      `${engine} supports couplings only of a revolute and a revolute or prismatic joint, both on the world`);
}
