// Rapier.
import {serve, JointForces, alongY, angleBounds, framesOf, halfHeightOf, isMaximum} from './serve.js';

let RAPIER;

const vector = ([x, y, z]) => ({x, y, z});
const array = (v) => [v.x, v.y, v.z];

function descriptionOf(body, setting) {
  const [w, x, y, z] = body.q;
  const description = RAPIER.RigidBodyDesc.dynamic()
                          .setTranslation(...body.p)
                          .setRotation({w, x, y, z})
                          .setLinvel(...body.v)
                          .setAngvel(vector(body.w))
                          .setAdditionalMassProperties(
                              body.mass, {x: 0, y: 0, z: 0}, vector(body.moments), {x: 0, y: 0, z: 0, w: 1});
  if (setting === 'best') description.setCanSleep(false);
  return description;
}

function motionOf(b) {
  const q = b.rotation();
  return {q: [q.w, q.x, q.y, q.z], w: array(b.angvel()), p: array(b.translation()), v: array(b.linvel())};
}

// Forces persist until they are reset.
function load(body, force, torque) {
  body.addForce(vector(force), true), body.addTorque(vector(torque), true);
}

class World {
  constructor(body) {
    this.world = new RAPIER.World(vector(body.gravity));
    this.body = this.world.createRigidBody(descriptionOf(body, body.setting));
    if (body.planes.length) this.addContact(body);
    if (body.pivot) {
      const ground = this.world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
      const joint = RAPIER.JointData.spherical(vector(body.pivot), {x: 0, y: 0, z: 0});
      this.world.createImpulseJoint(joint, this.body, ground, true);
    }
    // without this call, the mass of a new body is computed only in its first step
    this.body.recomputeMassPropertiesFromColliders();
  }
  addContact(body) {
    for (const shape of body.shapes)
      this.world.createCollider(touching(colliderOf(shape), body.planes[0]).setDensity(0), this.body);
    for (const plane of body.planes) addPlane(this.world, plane);
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) { this.body.setAngvel(vector(w), true), this.body.setLinvel(vector(v), true); }
  setGravity(g) { this.world.gravity = vector(g); }
  apply(force, torque) {
    load(this.body, force, torque);
    this.pushed = true;
  }
  step(h) {
    this.world.timestep = h;
    this.world.step();
    if (!this.pushed) return;
    this.body.resetForces(false), this.body.resetTorques(false);
    this.pushed = false;
  }
  mass() { return this.body.mass(); }
  moments() { return array(this.body.principalInertia()); }
  free() { this.world.free(); }
}

const touching = (description, {restitution, friction}) =>
    description.setRestitution(restitution).setFriction(friction);

// a half-space through the origin of its body
function addPlane(world, plane, change = (space) => space) {
  const place = RAPIER.RigidBodyDesc.fixed().setTranslation(...plane.normal.map((n) => n * plane.offset));
  const space = touching(new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vector(plane.normal))), plane);
  world.createCollider(change(space), world.createRigidBody(place));
}

// Rapier applies the combine rule with the larger number, here the plane's.
function combinedWith(contact, plane) {
  const {Max, Min} = RAPIER.CoefficientCombineRule;
  const rule = (coefficient) => isMaximum(contact, plane, coefficient) ? Max : Min;
  return (space) => space.setFrictionCombineRule(rule('friction')).setRestitutionCombineRule(rule('restitution'));
}

function colliderOf(shape) {
  if (shape.type === 'polyhedron') return RAPIER.ColliderDesc.convexHull(new Float32Array(shape.corners.flat()));
  const isBox = shape.type === 'box', [w, x, y, z] = isBox ? shape.orientation : alongY(shape);
  let made;
  if (isBox) made = RAPIER.ColliderDesc.cuboid(...shape.half_extents);
  else if (shape.type === 'ball') made = RAPIER.ColliderDesc.ball(shape.radius);
  else if (shape.type === 'capsule') made = RAPIER.ColliderDesc.capsule(shape.half_height, shape.radius);
  else made = RAPIER.ColliderDesc.cylinder(halfHeightOf(shape), shape.radius);
  return made.setTranslation(...shape.position).setRotation({w, x, y, z});
}

class Mechanism {
  constructor({bodies, joints, loops, gravity, setting, balls, planes, contact, motors}) {
    this.forces = new JointForces({bodies, joints, motors});
    this.world = new RAPIER.World(vector(gravity));
    this.bodies = bodies.map((body, i) => {
      const made = this.world.createRigidBody(descriptionOf(body, setting));
      if (balls) this.world.createCollider(touching(RAPIER.ColliderDesc.ball(balls[i]), contact).setDensity(0), made);
      made.recomputeMassPropertiesFromColliders();
      return made;
    });
    for (const plane of planes ?? []) addPlane(this.world, plane, combinedWith(contact, plane));
    this.ground = this.world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
    for (const joint of [...joints, ...loops]) {
      const made = this.world.createImpulseJoint(
          jointOf(bodies, joint), this.bodies[joint.parent] ?? this.ground, this.bodies[joint.child] ?? this.ground, true);
      setLaws(made, bodies, joint);
    }
  }
  motions() { return this.bodies.map(motionOf); }
  apply(index, force, torque) {
    load(this.bodies[index], force, torque);
    this.pushed = true;
  }
  step(h) {
    this.forces.applyTo(this, h);
    this.world.timestep = h;
    this.world.step();
    if (!this.pushed) return;
    for (const body of this.bodies) body.resetForces(false), body.resetTorques(false);
    this.pushed = false;
  }
  free() { this.world.free(); }
}

const turn = ([w, x, y, z]) => ({w, x, y, z});

function jointOf(bodies, joint) {
  const out = vector(joint.parent_point), into = vector(joint.child_point);
  if (joint.type === 'spherical') return RAPIER.JointData.spherical(out, into);
  if (joint.type === 'revolute')
    return RAPIER.JointData.revoluteWithAxes(out, into, vector(joint.parent_axes[0]), vector(joint.child_axes[0]));
  const [a, b] = framesOf(bodies, joint).map(turn);
  return RAPIER.JointData.fixed(out, a, into, b);
}

// Limits of a hinge count from the start. Friction is a motor to velocity 0 with a largest torque.
function setLaws(made, bodies, joint) {
  const {limits, friction, parent_point: out, child_point: into} = joint;
  if (limits) {
    const {lower, upper} = angleBounds('Rapier', limits), [a, b] = framesOf(bodies, joint, 'x');
    made.setLocalFrame1(vector(out), turn(a)), made.setLocalFrame2(vector(into), turn(b));
    made.setLimits(lower, upper);
  }
  if (!friction) return;
  made.configureMotorModel(RAPIER.MotorModel.ForceBased);
  made.configureMotorVelocity(0, 1e9), made.setMotorMaxForce(friction);
}

await serve({
  engine: 'rapier',
  packageName: '@dimforge/rapier3d-compat',
  precision: 'binary32',
  settings: {
    default: 'gyroscopic term in four substeps; slow bodies sleep; no damping; at most pi/4 of rotation per substep',
    best: 'as default, without sleeping'
  },
  joints: ['revolute', 'spherical', 'fixed'],
  loops: ['revolute', 'spherical'],
  laws: ['limits', 'friction', 'springs', 'motors'],
  contacts: true,
  shapes: ['ball', 'capsule', 'cylinder', 'disc', 'box', 'polyhedron', 'several'],
  load: async () => {
    RAPIER = (await import('@dimforge/rapier3d-compat')).default;
    await RAPIER.init();
    return {World, Mechanism};
  }
});
