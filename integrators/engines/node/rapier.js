// Rapier.
import {serve} from './serve.js';

let RAPIER;

const vector = ([x, y, z]) => ({x, y, z});
const array = (v) => [v.x, v.y, v.z];

class World {
  constructor(body) {
    this.world = new RAPIER.World(vector(body.gravity));
    const [w, x, y, z] = body.q;
    const description = RAPIER.RigidBodyDesc.dynamic()
                            .setTranslation(...body.p)
                            .setRotation({w, x, y, z})
                            .setLinvel(...body.v)
                            .setAngvel(vector(body.w))
                            .setAdditionalMassProperties(
                                body.mass, {x: 0, y: 0, z: 0}, vector(body.moments), {x: 0, y: 0, z: 0, w: 1});
    if (body.setting === 'best') description.setCanSleep(false);
    this.body = this.world.createRigidBody(description);
    if (body.planes.length) this.addContact(body);
    if (body.pivot) {
      const ground = this.world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
      const joint = RAPIER.JointData.spherical(vector(body.pivot), {x: 0, y: 0, z: 0});
      this.world.createImpulseJoint(joint, this.body, ground, true);
    }
    // the mass of a new body counts from its first step on, unless it is asked for
    this.body.recomputeMassPropertiesFromColliders();
  }
  addContact(body) {
    const {restitution, friction} = body.planes[0];
    const touching = (description) => description.setRestitution(restitution).setFriction(friction);
    const shape = body.ball ? RAPIER.ColliderDesc.ball(body.ball)
                            : RAPIER.ColliderDesc.convexHull(new Float32Array(body.hull.flat()));
    this.world.createCollider(touching(shape).setDensity(0), this.body);
    for (const {normal, offset} of body.planes) {
      // a half-space through the body that carries it
      const place = RAPIER.RigidBodyDesc.fixed().setTranslation(...normal.map((n) => n * offset));
      const space = new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vector(normal)));
      this.world.createCollider(touching(space), this.world.createRigidBody(place));
    }
  }
  motion() {
    const b = this.body, q = b.rotation();
    return {q: [q.w, q.x, q.y, q.z], w: array(b.angvel()), p: array(b.translation()), v: array(b.linvel())};
  }
  setVelocities(w, v) { this.body.setAngvel(vector(w), true), this.body.setLinvel(vector(v), true); }
  setGravity(g) { this.world.gravity = vector(g); }
  apply(force, torque) {
    // they stay until they are taken back
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

await serve({
  engine: 'rapier',
  packageName: '@dimforge/rapier3d-compat',
  precision: 'binary32',
  settings: {
    default: 'the gyroscopic term in four substeps; a slow body falls asleep; no damping; a turn of at most pi/4 a substep',
    best: 'as default, never asleep'
  },
  load: async () => {
    RAPIER = (await import('@dimforge/rapier3d-compat')).default;
    await RAPIER.init();
    return World;
  }
});
