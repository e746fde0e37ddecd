// MuJoCo, current version.
import {serve, MotorForces, add, conjugate, cross, frameAbout, halfHeightOf, normalized, product, rotate, rotateBack, scaled, subtract, Unsupported} from './serve.js';

let mujoco;

const integrators = {default: 'Euler', elliptic: 'Euler', implicit: 'implicit', implicitfast: 'implicitfast', rk4: 'RK4', stiff: 'implicit'};

function advance(model, data, h) {
  model.opt.timestep = h;
  mujoco.mj_step(model, data);
  if (!(data.time > 0)) throw new Error('MuJoCo detected an invalid state and reset the simulation');
}

class World {
  constructor(body) {
    if (body.planes.some((plane) => plane.restitution > 0))
      throw new Unsupported("MuJoCo's contacts have no coefficient of restitution");
    this.pivot = body.pivot;
    const joint = body.pivot ? `<joint type="ball" pos="${body.pivot.join(' ')}"/>` : '<freejoint/>';
    const place = body.pivot ? scaled(-1, body.pivot) : body.p;
    this.model = mujoco.MjModel.from_xml_string(`<mujoco><option integrator="${integrators[body.setting]}"
        cone="${body.setting === 'elliptic' ? 'elliptic' : 'pyramidal'}"/><worldbody>${body.planes.map(planeText).join('')}
        <body pos="${place.join(' ')}">${joint}<inertial pos="0 0 0" mass="${body.mass}"
        diaginertia="${body.moments.join(' ')}"/>${
        body.shapes.map((shape) => geomText(shape, body.planes[0].friction)).join('')}</body></worldbody></mujoco>`);
    this.data = new mujoco.MjData(this.model);
    this.first = body.pivot ? 0 : 3;
    this.setGravity(body.gravity);
    this.data.qpos.set(body.q, this.first);
    if (!body.pivot) this.data.qpos.set(body.p, 0);
    this.setVelocities(body.w, body.v);
  }
  // quaternion and velocities of the body; the angular velocity is in body axes
  motion() {
    const {qpos, qvel} = this.data, first = this.first;
    const q = Array.from(qpos.subarray(first, first + 4)), unit = normalized(q);
    const w = rotate(unit, Array.from(qvel.subarray(first, first + 3)));
    if (!this.pivot) return {q, w, p: Array.from(qpos.subarray(0, 3)), v: Array.from(qvel.subarray(0, 3))};
    const p = scaled(-1, rotate(unit, this.pivot));
    return {q, w, p, v: cross(w, p)};
  }
  setVelocities(w, v) {
    const q = normalized(Array.from(this.data.qpos.subarray(this.first, this.first + 4)));
    this.data.qvel.set(rotateBack(q, w), this.first);
    if (!this.pivot) this.data.qvel.set(v, 0);
  }
  setGravity(g) { this.model.opt.gravity.set(g); }
  apply(force, torque) {
    this.data.xfrc_applied.set([...force, ...torque], 6);
    this.pushed = true;
  }
  step(h) {
    advance(this.model, this.data, h);
    if (!this.pushed) return;
    this.data.xfrc_applied.fill(0), this.pushed = false;
  }
  mass() { return this.model.body_mass[1]; }
  moments() { return Array.from(this.model.body_inertia.subarray(3, 6)); }
  free() { this.data.delete(), this.model.delete(); }
}

// A shape as a geom. Its friction is sliding friction alone: contacts have three dimensions.
function geomText(shape, friction) {
  const {type, position, orientation, radius} = shape;
  const size = shape.half_extents ?? shape.semi_axes ?? (type === 'ball' ? [radius] : [radius, halfHeightOf(shape)]);
  const name = {ball: 'sphere', disc: 'cylinder'}[type] ?? type;
  return `<geom type="${name}" size="${size.join(' ')}" pos="${position.join(' ')}" quat="${
      orientation.join(' ')}" friction="${friction} 0 0"/>`;
}
function planeText({normal, offset, friction}) {
  return `<geom type="plane" size="0 0 1" pos="${scaled(offset, normal).join(' ')}" quat="${
      frameAbout(normal).join(' ')}" friction="${friction} 0 0"/>`;
}

const nameOf = (index) => index < 0 ? 'world' : `b${index}`;
const bodyType = 1;  // mjtObj value

const jointName = (index) => `j${index}`;
const jointType = 3;  // mjtObj value

// Limits, friction, armature, spring and damper of a joint as attributes. MuJoCo has no limits on one side.
function lawsText({limits, friction, armature, stiffness, rest, damping}) {
  const attributes = {frictionloss: friction, armature, stiffness, springref: rest, damping};
  const all = Object.entries(attributes).map(([name, value]) => value ? ` ${name}="${value}"` : '').join('');
  return limits ? `${all} limited="true" range="${limits.lower ?? -1e9} ${limits.upper ?? 1e9}"` : all;
}

// The stiffest soft constraints that MuJoCo permits: a time constant of two steps and an impedance of 0.9999.
function stiffen({jnt_solref, jnt_solimp, dof_solref, dof_solimp, eq_solref, eq_solimp}, h) {
  for (const solref of [jnt_solref, dof_solref, eq_solref])
    for (let i = 0; i < solref.length; i += 2) solref[i] = 2 * h, solref[i + 1] = 1;
  for (const solimp of [jnt_solimp, dof_solimp, eq_solimp])
    for (let i = 0; i < solimp.length; i += 5) solimp[i] = solimp[i + 1] = 0.9999;
}

function jointsText(joint, index) {
  if (!joint) return '<freejoint/>';
  if (joint.type === 'fixed') return '';
  const type = {spherical: 'ball', prismatic: 'slide'}[joint.type] ?? 'hinge', pos = joint.child_point.join(' ');
  if (!joint.child_axes.length) return `<joint type="${type}" pos="${pos}"/>`;
  if (joint.child_axes.length === 1)
    return `<joint name="${jointName(index)}" type="${type}" pos="${pos}" axis="${joint.child_axes[0].join(' ')}"${
        lawsText(joint)}/>`;
  return joint.child_axes.map((axis) => `<joint type="${type}" pos="${pos}" axis="${axis.join(' ')}"/>`).join('');
}

// A hinge that closes a loop constrains two points of its axis.
function closureText({parent, child, parent_point, child_point, parent_axes, child_axes}) {
  const [first, second, point, axes] =
      parent >= 0 ? [parent, child, parent_point, parent_axes] : [child, -1, child_point, child_axes];
  const other = second < 0 ? '' : `body2="${nameOf(second)}"`;
  return [point, ...axes.map((axis) => add(point, axis))]
      .map((anchor) => `<connect body1="${nameOf(first)}" ${other} anchor="${anchor.join(' ')}"/>`)
      .join('');
}

class Mechanism {
  constructor({bodies, joints, loops, gravity, setting, motors = [], couplings = []}) {
    this.isStiff = setting === 'stiff';
    const couplingText = ({first, second, ratio}) => `<joint joint1="${jointName(second)}" joint2="${
        jointName(first)}" polycoef="0 ${ratio} 0 0 0"/>`;
    const carrier = (i) => joints.find(({child}) => child === i);
    const bodyText = (i) => {
      const joint = carrier(i), body = bodies[i], base = joint && joint.parent >= 0 ? bodies[joint.parent] : undefined;
      const up = base ? conjugate(base.q) : [1, 0, 0, 0];
      const place = base ? rotate(up, subtract(body.p, base.p)) : body.p;
      const children = joints.filter(({parent}) => parent === i).map(({child}) => bodyText(child));
      return `<body name="${nameOf(i)}" pos="${place.join(' ')}" quat="${product(up, body.q).join(' ')}">${
          jointsText(joint, joints.indexOf(joint))}<inertial pos="0 0 0" mass="${body.mass}" diaginertia="${body.moments.join(' ')}"/>${
          children.join('')}</body>`;
    };
    const all = bodies.map((_, i) => i), roots = all.filter((i) => !(carrier(i)?.parent >= 0));
    this.model = mujoco.MjModel.from_xml_string(`<mujoco><compiler angle="radian"/><option integrator="${
        integrators[setting]}" gravity="${gravity.join(' ')}"/><worldbody>${roots.map(bodyText).join('')}</worldbody><equality>${
        loops.map(closureText).join('')}${couplings.map(couplingText).join('')}</equality></mujoco>`);
    this.data = new mujoco.MjData(this.model);
    this.forces = new MotorForces(motors);
    this.dofs = motors.map(
        ({joint}) => this.model.jnt_dofadr[mujoco.mj_name2id(this.model, jointType, jointName(joint))]);
    this.ids = all.map((i) => mujoco.mj_name2id(this.model, bodyType, nameOf(i)));
    for (const i of all) {
      const joint = carrier(i), body = bodies[i], first = this.model.body_dofadr[this.ids[i]];
      const turning = rotateBack(body.q, joint ? joint.turning : body.w);
      if (!joint) this.data.qvel.set([...body.v, ...turning], first);
      else if (joint.type === 'spherical') this.data.qvel.set(turning, first);
      else if (joint.rates.length) this.data.qvel.set(joint.rates, first);
    }
  }
  // after a step, MuJoCo's positions and velocities of bodies are still those at its start
  motions() {
    const {model, data} = this;
    mujoco.mj_kinematics(model, data), mujoco.mj_comPos(model, data), mujoco.mj_comVel(model, data);
    const {xquat, cvel, xipos, subtree_com: centers} = data, {body_rootid: roots} = model;
    const three = (list, at) => Array.from(list.subarray(at, at + 3));
    return this.ids.map((id) => {
      const w = three(cvel, 6 * id), p = three(xipos, 3 * id), center = three(centers, 3 * roots[id]);
      const v = add(three(cvel, 6 * id + 3), cross(w, subtract(p, center)));
      return {q: Array.from(xquat.subarray(4 * id, 4 * id + 4)), w, p, v};
    });
  }
  apply(index, force, torque) { this.data.xfrc_applied.set([...force, ...torque], 6 * this.ids[index]); }
  step(h) {
    if (this.isStiff) stiffen(this.model, h);
    this.forces.enterStep(h);
    const forces = this.forces.byJoint();
    this.forces.motors.forEach(({joint}, i) => this.data.qfrc_applied[this.dofs[i]] = forces.get(joint) ?? 0);
    advance(this.model, this.data, h);
  }
  free() { this.data.delete(), this.model.delete(); }
}

await serve({
  engine: 'mujoco_wasm',
  packageName: '@mujoco/mujoco',
  precision: 'binary64',
  settings: {
    default: 'integrator Euler: semi-implicit, gyroscopic term explicit; no damping; pyramidal friction cone',
    elliptic: 'as default, with the elliptic friction cone',
    implicit: 'integrator implicit',
    implicitfast: 'integrator implicitfast',
    rk4: 'integrator RK4',
    stiff: 'as implicit, with limits, friction and couplings of joints as stiff as MuJoCo permits at the step: solref 2 h, solimp 0.9999'
  },
  joints: ['revolute', 'prismatic', 'spherical', 'universal', 'fixed'],
  loops: ['revolute', 'spherical'],
  laws: ['limits', 'friction', 'armature', 'springs', 'motors', 'couplings'],
  shapes: ['ball', 'capsule', 'cylinder', 'disc', 'ellipsoid', 'box', 'several'],
  load: async () => {
    mujoco = await (await import('@mujoco/mujoco')).default();
    return {World, Mechanism};
  }
});
