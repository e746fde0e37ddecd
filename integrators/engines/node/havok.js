// Havok, as packaged by Babylon.js.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import {serve, JointForces, add, angleBounds, boundsOf, cross, framesOf, halfHeightOf, isMaximum, rotate, scaled} from './serve.js';

let havok;

// Every call returns [result, ..]. Returns the values after a successful result.
function good(answer) {
  const [result, ...values] = Array.isArray(answer) ? answer : [answer];
  if (result !== havok.Result.RESULT_OK) throw new Error('a Havok call failed');
  return values[0];
}

// Common base of World and Mechanism.
class Scene {
  constructor(gravity) {
    this.world = good(havok.HP_World_Create());
    this.shapes = [];
    this.setGravity(gravity);
  }
  setGravity(g) { good(havok.HP_World_SetGravity(this.world, g)); }
  bodyAt(motion, p, [w, x, y, z]) {
    const body = good(havok.HP_Body_Create());
    good(havok.HP_Body_SetMotionType(body, motion));
    good(havok.HP_Body_SetQTransform(body, [p, [x, y, z, w]]));
    return body;
  }
  addBody({mass, moments, p, q, w, v}, setting, change = () => {}) {
    const body = this.bodyAt(havok.MotionType.DYNAMIC, p, q);
    change(body);
    // the inertia is given per unit mass
    good(havok.HP_Body_SetMassProperties(body, [[0, 0, 0], mass, moments.map((x) => x / mass), [0, 0, 0, 1]]));
    if (setting === 'best') {
      good(havok.HP_Body_SetLinearDamping(body, 0)), good(havok.HP_Body_SetAngularDamping(body, 0));
      good(havok.HP_World_SetSpeedLimit(this.world, 1e30, 1e30));
      good(havok.HP_Body_SetActivationControl(body, havok.ActivationControl.ALWAYS_ACTIVE));
    }
    good(havok.HP_World_AddBody(this.world, body, false));
    good(havok.HP_Body_SetAngularVelocity(body, w)), good(havok.HP_Body_SetLinearVelocity(body, v));
    return body;
  }
  // An anchor is a point and the first two axes of the joint's frame.
  join(parent, parentAnchor, child, childAnchor, axes) {
    const joint = good(havok.HP_Constraint_Create());
    good(havok.HP_Constraint_SetParentBody(joint, parent)), good(havok.HP_Constraint_SetChildBody(joint, child));
    good(havok.HP_Constraint_SetAnchorInParent(joint, ...parentAnchor));
    good(havok.HP_Constraint_SetAnchorInChild(joint, ...childAnchor));
    for (const axis of axes)
      good(havok.HP_Constraint_SetAxisMode(
          joint, havok.ConstraintAxis[axis], havok.ConstraintAxisLimitMode.LOCKED));
    good(havok.HP_Constraint_SetEnabled(joint, 1));
    return joint;
  }
  // Gives the shape a material; `modes` combine its friction and restitution with those of the other body.
  touching(shape, {friction, restitution}, modes = [havok.MaterialCombine.GEOMETRIC_MEAN, havok.MaterialCombine.GEOMETRIC_MEAN]) {
    good(havok.HP_Shape_SetMaterial(shape, [friction, friction, restitution, ...modes]));
    this.shapes.push(shape);
    return shape;
  }
  // Havok has no planes: a block of 100 m with its upper face in the plane.
  addPlane(plane, modes) {
    const {normal, offset} = plane;
    const ground = this.bodyAt(havok.MotionType.STATIC, scaled(offset - 50, normal), towards(normal));
    const block = good(havok.HP_Shape_CreateBox([0, 0, 0], [0, 0, 0, 1], [100, 100, 100]));
    good(havok.HP_Body_SetShape(ground, this.touching(block, plane, modes)));
    good(havok.HP_World_AddBody(this.world, ground, false));
  }
  // Babylon.js converts a force to the impulse of one step, which is applied before the step.
  kick(body, h, {force, torque}) {
    good(havok.HP_Body_ApplyImpulse(body, motionOf(body).p, scaled(h, force)));
    good(havok.HP_Body_ApplyAngularImpulse(body, scaled(h, torque)));
  }
  advance(h) {
    good(havok.HP_World_SetIdealStepTime(this.world, h));
    good(havok.HP_World_Step(this.world, h));
  }
}

function motionOf(body) {
  const [p, [x, y, z, w]] = good(havok.HP_Body_GetQTransform(body));
  return {
    q: [w, x, y, z], w: good(havok.HP_Body_GetAngularVelocity(body)), p, v: good(havok.HP_Body_GetLinearVelocity(body))
  };
}

class World extends Scene {
  constructor(body) {
    super(body.gravity);
    this.mass_ = body.mass;
    this.body = this.addBody(body, body.setting, (made) => {
      this.body = made;
      if (body.planes.length) this.addContact(body);
    });
    if (body.pivot) this.addJoint(body.pivot);
  }
  addContact(body) {
    const shapes = body.shapes.map((shape) => this.touching(this.convex(shape), body.planes[0]));
    good(havok.HP_Body_SetShape(this.body, this.joined(shapes)));
    for (const plane of body.planes) this.addPlane(plane);
  }
  // a container has the materials of its children
  joined(shapes) {
    if (shapes.length === 1) return shapes[0];
    const all = good(havok.HP_Shape_CreateContainer());
    for (const shape of shapes) good(havok.HP_Shape_AddChild(all, shape, [[0, 0, 0], [0, 0, 0, 1], [1, 1, 1]]));
    this.shapes.push(all);
    return all;
  }
  convex(shape) {
    const {type, position, orientation, radius} = shape, [w, x, y, z] = orientation;
    if (type === 'ball') return good(havok.HP_Shape_CreateSphere(position, radius));
    if (type === 'box')
      return good(havok.HP_Shape_CreateBox(position, [x, y, z, w], scaled(2, shape.half_extents)));
    if (type === 'polyhedron') return this.hull(shape.corners);
    const make = type === 'capsule' ? 'HP_Shape_CreateCapsule' : 'HP_Shape_CreateCylinder';
    const end = (sign) => add(position, rotate(orientation, [0, 0, sign * halfHeightOf(shape)]));
    return good(havok[make](end(-1), end(1), radius));
  }
  hull(corners) {
    const numbers = new Float32Array(corners.flat()), at = havok._malloc(4 * numbers.length);
    havok.HEAPF32.set(numbers, at / 4);
    const shape = good(havok.HP_Shape_CreateConvexHull(at, corners.length));
    havok._free(at);
    return shape;
  }
  addJoint(pivot) {
    const ground = this.bodyAt(havok.MotionType.STATIC, [0, 0, 0], [1, 0, 0, 0]);
    good(havok.HP_World_AddBody(this.world, ground, false));
    const axes = [[1, 0, 0], [0, 1, 0]];
    this.join(ground, [[0, 0, 0], ...axes], this.body, [pivot, ...axes], locked.spherical);
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) {
    good(havok.HP_Body_SetAngularVelocity(this.body, w)), good(havok.HP_Body_SetLinearVelocity(this.body, v));
  }
  apply(force, torque) { this.push = {force, torque}; }
  step(h) {
    if (this.push) this.kick(this.body, h, this.push);
    this.push = undefined;
    this.advance(h);
  }
  mass() { return good(havok.HP_Body_GetMassProperties(this.body))[1]; }
  moments() {
    const [, mass, perMass] = good(havok.HP_Body_GetMassProperties(this.body));
    return scaled(mass, perMass);
  }
  free() {
    havok.HP_World_Release(this.world), havok.HP_Body_Release(this.body);
    for (const shape of this.shapes) havok.HP_Shape_Release(shape);
  }
}

// The smallest rotation of z into a direction.
function towards(normal) {
  const half = add(normal, [0, 0, 1]), length = Math.hypot(...half);
  if (!(length > 0)) return [0, 1, 0, 0];
  const middle = scaled(1 / length, half);
  return [middle[2], ...cross([0, 0, 1], middle)];
}

const locked = {
  revolute: ['LINEAR_X', 'LINEAR_Y', 'LINEAR_Z', 'ANGULAR_Y', 'ANGULAR_Z'],
  prismatic: ['LINEAR_Y', 'LINEAR_Z', 'ANGULAR_X', 'ANGULAR_Y', 'ANGULAR_Z'],
  spherical: ['LINEAR_X', 'LINEAR_Y', 'LINEAR_Z'],
  fixed: ['LINEAR_X', 'LINEAR_Y', 'LINEAR_Z', 'ANGULAR_X', 'ANGULAR_Y', 'ANGULAR_Z']
};

class Mechanism extends Scene {
  constructor({bodies, joints, loops, gravity, setting, balls, planes, contact, motors}) {
    super(gravity);
    this.forces = new JointForces({bodies, joints, motors});
    this.pushes = [];
    this.made = bodies.map((known, i) => this.addBody(known, setting, (body) => {
      if (!balls) return;
      const ball = good(havok.HP_Shape_CreateSphere([0, 0, 0], balls[i]));
      good(havok.HP_Body_SetShape(body, this.touching(ball, contact)));
    }));
    // Havok applies the combine mode with the larger number, here the plane's
    const {MAXIMUM, MINIMUM} = havok.MaterialCombine;
    for (const plane of planes ?? [])
      this.addPlane(plane, ['friction', 'restitution'].map((name) => isMaximum(contact, plane, name) ? MAXIMUM : MINIMUM));
    this.ground = this.bodyAt(havok.MotionType.STATIC, [0, 0, 0], [1, 0, 0, 0]);
    good(havok.HP_World_AddBody(this.world, this.ground, false));
    for (const joint of [...joints, ...loops]) {
      const at = (index) => this.made[index] ?? this.ground, [out, into] = framesOf(bodies, joint, 'x');
      const anchor = (point, frame) => [point, rotate(frame, [1, 0, 0]), rotate(frame, [0, 1, 0])];
      const made = this.join(
          at(joint.parent), anchor(joint.parent_point, out), at(joint.child), anchor(joint.child_point, into),
          locked[joint.type]);
      this.setLaws(made, joint);
    }
  }
  setLaws(made, {type, limits, friction}) {
    const axis = havok.ConstraintAxis[type === 'revolute' ? 'ANGULAR_X' : 'LINEAR_X'];
    if (limits) {
      const {lower, upper} = type === 'revolute' ? angleBounds('Havok', limits) : boundsOf(limits);
      good(havok.HP_Constraint_SetAxisMode(made, axis, havok.ConstraintAxisLimitMode.LIMITED));
      good(havok.HP_Constraint_SetAxisMinLimit(made, axis, lower));
      good(havok.HP_Constraint_SetAxisMaxLimit(made, axis, upper));
    }
    if (friction) good(havok.HP_Constraint_SetAxisFriction(made, axis, friction));
  }
  motions() { return this.made.map(motionOf); }
  apply(index, force, torque) { this.pushes.push({body: this.made[index], force, torque}); }
  step(h) {
    this.forces.applyTo(this, h);
    for (const push of this.pushes) this.kick(push.body, h, push);
    this.pushes = [];
    this.advance(h);
  }
  free() {
    havok.HP_World_Release(this.world);
    for (const body of this.made) havok.HP_Body_Release(body);
    for (const shape of this.shapes) havok.HP_Shape_Release(shape);
  }
}

await serve({
  engine: 'havok',
  packageName: '@babylonjs/havok',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term available; angular damping 0.1; slow bodies sleep; speed limit 100 rad/s',
    best: 'no damping, no sleeping, no speed limit; no gyroscopic term available'
  },
  joints: ['revolute', 'prismatic', 'spherical', 'fixed'],
  loops: ['revolute', 'spherical'],
  laws: ['limits', 'friction', 'springs', 'motors'],
  contacts: true,
  shapes: ['ball', 'capsule', 'cylinder', 'disc', 'box', 'polyhedron', 'several'],
  load: async () => {
    const require = createRequire(import.meta.url);
    const binary = require.resolve('@babylonjs/havok/lib/esm/HavokPhysics.wasm');
    havok = await (await import('@babylonjs/havok')).default({wasmBinary: fs.readFileSync(binary)});
    return {World, Mechanism};
  }
});
