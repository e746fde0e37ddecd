// Ammo: Bullet 2, compiled to JavaScript.
import {serve} from './serve.js';

let Ammo;

const array = (v) => [v.x(), v.y(), v.z()];
const neverAsleep = 4, gyroscopicForce = 2;

class World {
  constructor(body) {
    this.taken = [];
    const configuration = this.take(new Ammo.btDefaultCollisionConfiguration());
    const dispatcher = this.take(new Ammo.btCollisionDispatcher(configuration));
    const broadphase = this.take(new Ammo.btDbvtBroadphase()), solver = this.take(new Ammo.btSequentialImpulseConstraintSolver());
    this.world = this.take(new Ammo.btDiscreteDynamicsWorld(dispatcher, broadphase, solver, configuration));
    this.setGravity(body.gravity);
    this.body = this.bodyOf(body.mass, this.shapeOf(body), body.p, body.q, this.vector(body.moments));
    if (body.setting === 'best') {
      this.body.setActivationState(neverAsleep);
      this.body.setFlags(gyroscopicForce);
    }
    this.setVelocities(body.w, body.v);
    // the coefficients of the two that touch are multiplied: the planes' are 1
    if (body.planes.length) {
      this.body.setRestitution(body.planes[0].restitution), this.body.setFriction(body.planes[0].friction);
    }
    for (const {normal, offset} of body.planes) {
      const shape = this.take(new Ammo.btStaticPlaneShape(this.vector(normal), offset));
      const ground = this.bodyOf(0, shape, [0, 0, 0], [1, 0, 0, 0], this.vector([0, 0, 0]));
      ground.setRestitution(1), ground.setFriction(1);
    }
    if (body.pivot) {
      this.joint = this.take(new Ammo.btPoint2PointConstraint(this.body, this.vector(body.pivot)));
      this.world.addConstraint(this.joint);
    }
  }
  // What was made is given back, the last first.
  take(object) {
    this.taken.push(object);
    return object;
  }
  vector(a) { return this.take(new Ammo.btVector3(...a)); }
  shapeOf(body) {
    if (!body.hull.length) return this.take(new Ammo.btSphereShape(body.ball ?? 1));
    const hull = this.take(new Ammo.btConvexHullShape());
    for (const corner of body.hull) hull.addPoint(this.vector(corner), true);
    return hull;
  }
  bodyOf(mass, shape, p, [w, x, y, z], inertia) {
    const place = this.take(new Ammo.btTransform(this.take(new Ammo.btQuaternion(x, y, z, w)), this.vector(p)));
    const motion = this.take(new Ammo.btDefaultMotionState(place));
    const body =
        this.take(new Ammo.btRigidBody(this.take(new Ammo.btRigidBodyConstructionInfo(mass, motion, shape, inertia))));
    this.world.addRigidBody(body);
    return body;
  }
  motion() {
    const place = this.body.getWorldTransform(), q = place.getRotation();
    return {
      q: [q.w(), q.x(), q.y(), q.z()], p: array(place.getOrigin()), w: array(this.body.getAngularVelocity()),
      v: array(this.body.getLinearVelocity())
    };
  }
  setVelocities(w, v) {
    this.body.activate(true);
    this.body.setAngularVelocity(this.vector(w)), this.body.setLinearVelocity(this.vector(v));
  }
  setGravity(g) { this.world.setGravity(this.vector(g)); }
  apply(force, torque) {
    const push = new Ammo.btVector3(...force), turn = new Ammo.btVector3(...torque);
    this.body.applyCentralForce(push), this.body.applyTorque(turn);
    Ammo.destroy(push), Ammo.destroy(turn);
  }
  step(h) { this.world.stepSimulation(h, 0); }
  mass() {}
  moments() {}
  free() {
    if (this.joint) this.world.removeConstraint(this.joint);
    for (const object of this.taken.reverse()) Ammo.destroy(object);
  }
}

await serve({
  engine: 'ammo',
  packageName: 'ammojs-typed',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term; a slow body falls asleep; no damping; a turn of at most pi/4 a step',
    best: 'the gyroscopic term by an explicit step (setFlags(1)), never asleep'
  },
  load: async () => {
    Ammo = await (await import('ammojs-typed')).default();
    return World;
  }
});
