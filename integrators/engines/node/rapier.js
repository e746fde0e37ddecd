// Rapier.
import {serve, framesOf} from './serve.js';

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
    const {restitution, friction} = body.planes[0];
    const touching = (description) => description.setRestitution(restitution).setFriction(friction);
    const shape = body.ball ? RAPIER.ColliderDesc.ball(body.ball)
                            : RAPIER.ColliderDesc.convexHull(new Float32Array(body.hull.flat()));
    this.world.createCollider(touching(shape).setDensity(0), this.body);
    for (const {normal, offset} of body.planes) {
      // a half-space through the origin of its body
      const place = RAPIER.RigidBodyDesc.fixed().setTranslation(...normal.map((n) => n * offset));
      const space = new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vector(normal)));
      this.world.createCollider(touching(space), this.world.createRigidBody(place));
    }
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) { this.body.setAngvel(vector(w), true), this.body.setLinvel(vector(v), true); }
  setGravity(g) { this.world.gravity = vector(g); }
  apply(force, torque) {
    // forces persist until they are reset
    this.body.resetForces(true), this.body.resetTorques(true);
    this.body.addForce(vector(force), true), this.body.addTorque(vector(torque), true);
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

class Mechanism {
  constructor({bodies, joints, loops, gravity, setting}) {
    this.world = new RAPIER.World(vector(gravity));
    this.bodies = bodies.map((body) => {
      const made = this.world.createRigidBody(descriptionOf(body, setting));
      made.recomputeMassPropertiesFromColliders();
      return made;
    });
    this.ground = this.world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
    for (const joint of [...joints, ...loops])
      this.world.createImpulseJoint(
          jointOf(bodies, joint), this.bodies[joint.parent] ?? this.ground, this.bodies[joint.child] ?? this.ground, true);
  }
  motions() { return this.bodies.map(motionOf); }
  step(h) {
    this.world.timestep = h;
    this.world.step();
  }
  free() { this.world.free(); }
}

function jointOf(bodies, joint) {
  const out = vector(joint.parent_point), into = vector(joint.child_point);
  const turn = ([w, x, y, z]) => ({w, x, y, z});
  if (joint.type === 'spherical') return RAPIER.JointData.spherical(out, into);
  if (joint.type === 'revolute')
    return RAPIER.JointData.revoluteWithAxes(out, into, vector(joint.parent_axes[0]), vector(joint.child_axes[0]));
  const [a, b] = framesOf(bodies, joint).map(turn);
  return RAPIER.JointData.fixed(out, a, into, b);
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
  load: async () => {
    RAPIER = (await import('@dimforge/rapier3d-compat')).default;
    await RAPIER.init();
    return {World, Mechanism};
  }
});
