// Ammo: Bullet 2, compiled to JavaScript.
import {serve, JointForces, angleBounds, boundsOf, framesOf, halfHeightOf, Unsupported} from './serve.js';

let Ammo;

const array = (v) => [v.x(), v.y(), v.z()];
const neverAsleep = 4, gyroscopicForce = 2;

// Common base of World and Mechanism.
class Scene {
  constructor(gravity) {
    this.taken = [];
    const configuration = this.take(new Ammo.btDefaultCollisionConfiguration());
    const dispatcher = this.take(new Ammo.btCollisionDispatcher(configuration));
    const broadphase = this.take(new Ammo.btDbvtBroadphase()), solver = this.take(new Ammo.btSequentialImpulseConstraintSolver());
    this.world = this.take(new Ammo.btDiscreteDynamicsWorld(dispatcher, broadphase, solver, configuration));
    this.world.setGravity(this.vector(gravity));
  }
  // Registers an object to be freed. Objects are freed in reverse order.
  take(object) {
    this.taken.push(object);
    return object;
  }
  vector(a) { return this.take(new Ammo.btVector3(...a)); }
  place(p, [w, x, y, z]) {
    return this.take(new Ammo.btTransform(this.take(new Ammo.btQuaternion(x, y, z, w)), this.vector(p)));
  }
  // `groups`: the body's collision group and the groups that it collides with; by default all
  bodyOf(mass, shape, p, q, inertia, groups = []) {
    const motion = this.take(new Ammo.btDefaultMotionState(this.place(p, q)));
    const body =
        this.take(new Ammo.btRigidBody(this.take(new Ammo.btRigidBodyConstructionInfo(mass, motion, shape, inertia))));
    this.world.addRigidBody(body, ...groups);
    return body;
  }
  plane({normal, offset}) {
    const shape = this.take(new Ammo.btStaticPlaneShape(this.vector(normal), offset));
    return this.bodyOf(0, shape, [0, 0, 0], [1, 0, 0, 0], this.vector([0, 0, 0]));
  }
  step(h) { this.world.stepSimulation(h, 0); }
  leave() {
    for (const object of this.taken.reverse()) Ammo.destroy(object);
  }
}

function liven(body, setting) {
  if (setting !== 'best') return;
  body.setActivationState(neverAsleep);
  body.setFlags(gyroscopicForce);
}

function motionOf(body) {
  const place = body.getWorldTransform(), q = place.getRotation();
  return {
    q: [q.w(), q.x(), q.y(), q.z()], p: array(place.getOrigin()), w: array(body.getAngularVelocity()),
    v: array(body.getLinearVelocity())
  };
}

function load(body, force, torque) {
  const push = new Ammo.btVector3(...force), turn = new Ammo.btVector3(...torque);
  body.applyCentralForce(push), body.applyTorque(turn);
  Ammo.destroy(push), Ammo.destroy(turn);
}

class World extends Scene {
  constructor(body) {
    super(body.gravity);
    this.body = this.bodyOf(body.mass, this.shapeOf(body), body.p, body.q, this.vector(body.moments));
    liven(this.body, body.setting);
    this.setVelocities(body.w, body.v);
    // Bullet multiplies the coefficients of both bodies: the planes have 1
    if (body.planes.length) {
      this.body.setRestitution(body.planes[0].restitution), this.body.setFriction(body.planes[0].friction);
    }
    for (const plane of body.planes) {
      const ground = this.plane(plane);
      ground.setRestitution(1), ground.setFriction(1);
    }
    if (body.pivot) {
      this.joint = this.take(new Ammo.btPoint2PointConstraint(this.body, this.vector(body.pivot)));
      this.world.addConstraint(this.joint);
    }
  }
  shapeOf({shapes, ball}) {
    if (!shapes.length || ball) return this.take(new Ammo.btSphereShape(ball ?? 1));
    const compound = this.take(new Ammo.btCompoundShape());
    for (const shape of shapes) {
      const place = shape.type === 'polyhedron' ? this.place([0, 0, 0], [1, 0, 0, 0]) :
                                                  this.place(shape.position, shape.orientation);
      compound.addChildShape(place, this.take(this.convex(shape)));
    }
    return compound;
  }
  convex(shape) {
    if (shape.type === 'ball') return new Ammo.btSphereShape(shape.radius);
    if (shape.type === 'capsule') return new Ammo.btCapsuleShapeZ(shape.radius, 2 * shape.half_height);
    if (shape.type === 'box') return new Ammo.btBoxShape(this.vector(shape.half_extents));
    if (shape.type === 'polyhedron') {
      const hull = new Ammo.btConvexHullShape();
      for (const corner of shape.corners) hull.addPoint(this.vector(corner), true);
      return hull;
    }
    return new Ammo.btCylinderShapeZ(this.vector([shape.radius, shape.radius, halfHeightOf(shape)]));
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) {
    this.body.activate(true);
    this.body.setAngularVelocity(this.vector(w)), this.body.setLinearVelocity(this.vector(v));
  }
  setGravity(g) { this.world.setGravity(this.vector(g)); }
  apply(force, torque) { load(this.body, force, torque); }
  mass() {}
  moments() {}
  free() {
    if (this.joint) this.world.removeConstraint(this.joint);
    this.leave();
  }
}

class Mechanism extends Scene {
  constructor({bodies, joints, loops, gravity, setting, balls, planes, contact, motors}) {
    super(gravity);
    this.forces = new JointForces({bodies, joints, motors}), this.frictions = [];
    // bodies collide only as balls
    this.made = bodies.map((known, i) => {
      const shape = this.take(new Ammo.btSphereShape(balls ? balls[i] : 0.01));
      const body =
          this.bodyOf(known.mass, shape, known.p, known.q, this.vector(known.moments), balls ? [] : [1, 0]);
      liven(body, setting);
      body.setAngularVelocity(this.vector(known.w)), body.setLinearVelocity(this.vector(known.v));
      return body;
    });
    if (balls) this.addPlanes(planes, contact);
    const still = this.take(new Ammo.btSphereShape(0.01));
    this.ground = this.bodyOf(0, still, [0, 0, 0], [1, 0, 0, 0], this.vector([0, 0, 0]), [1, 0]);
    this.joints = [...joints, ...loops].map((joint) => {
      const made = this.take(this.jointOf(bodies, joint, setting));
      this.world.addConstraint(made, true);
      return made;
    });
  }
  // Bullet multiplies the coefficients of both bodies.
  addPlanes(planes, contact) {
    const own = {friction: Math.sqrt(contact.friction), restitution: Math.sqrt(contact.restitution)};
    for (const body of this.made) body.setRestitution(own.restitution), body.setFriction(own.friction);
    const rest = (plane, name) => {
      if (!own[name] && plane[name])
        throw new Unsupported(`Bullet's rule for ${name} cannot represent balls without it on a plane with it`);
      return own[name] ? plane[name] / own[name] : 0;
    };
    for (const plane of planes) {
      const ground = this.plane(plane);
      ground.setRestitution(rest(plane, 'restitution')), ground.setFriction(rest(plane, 'friction'));
    }
  }
  jointOf(bodies, joint, setting) {
    const a = this.made[joint.parent] ?? this.ground, b = this.made[joint.child] ?? this.ground;
    if (joint.type === 'spherical')
      return new Ammo.btPoint2PointConstraint(a, b, this.vector(joint.parent_point), this.vector(joint.child_point));
    const [out, into] = framesOf(bodies, joint, joint.type === 'prismatic' ? 'x' : 'z');
    const frames = [this.place(joint.parent_point, out), this.place(joint.child_point, into)];
    if (joint.type === 'revolute') return this.hingeOf(a, b, frames, joint, setting);
    const slider = new Ammo.btSliderConstraint(a, b, ...frames, true);
    const {lower, upper} = joint.limits ? this.sliderBounds(joint.limits) : {lower: 1, upper: -1};
    slider.setLowerLinLimit(lower), slider.setUpperLinLimit(upper);
    slider.setLowerAngLimit(0), slider.setUpperAngLimit(0);
    if (joint.friction) {
      slider.setPoweredLinMotor(true), slider.setTargetLinMotorVelocity(0);
      // this version multiplies the largest force by the steps per second to get the largest impulse of a step
      this.frictions.push((h) => slider.setMaxLinMotorForce(joint.friction * h * h));
    }
    return slider;
  }
  // the restitution of a slider has no effect
  sliderBounds(limits) {
    if (limits.restitution > 0) throw new Unsupported('Ammo supports restitution only at the limits of revolute joints');
    return boundsOf(limits);
  }
  // Bullet measures the angle of the parent relative to the child. The arguments after the limits are the softness, 0.9
  // by default; the bias factor, 0.3 by default, which multiplies the restitution; and the restitution. Friction is a
  // motor to velocity 0 with a largest impulse per step.
  hingeOf(a, b, frames, {limits, friction}, setting) {
    const hinge = new Ammo.btHingeConstraint(a, b, ...frames);
    if (limits) {
      const {lower, upper} = angleBounds('Ammo', limits);
      hinge.setLimit(-upper, -lower, 0.9, setting === 'default' ? 0.3 : 1, limits.restitution);
    }
    if (friction) {
      hinge.enableAngularMotor(true, 0, 0);
      this.frictions.push((h) => hinge.setMaxMotorImpulse(friction * h));
    }
    return hinge;
  }
  motions() { return this.made.map(motionOf); }
  apply(index, force, torque) {
    this.made[index].activate(true);
    load(this.made[index], force, torque);
  }
  step(h) {
    for (const setFriction of this.frictions) setFriction(h);
    this.forces.applyTo(this, h);
    super.step(h);
  }
  free() {
    for (const joint of this.joints) this.world.removeConstraint(joint);
    this.leave();
  }
}

await serve({
  engine: 'ammo',
  packageName: 'ammojs-typed',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term; slow bodies sleep; no damping; at most pi/4 of rotation per step',
    best: 'gyroscopic term by an explicit step (setFlags(1)), no sleeping'
  },
  // fixed joints are not supported: this build's constraint fails, by 1.1 rad on a welded pendulum in 0.25 s
  joints: ['revolute', 'prismatic', 'spherical'],
  loops: ['revolute', 'spherical'],
  laws: ['limits', 'restitution', 'friction', 'springs', 'motors'],
  contacts: true,
  shapes: ['ball', 'capsule', 'cylinder', 'disc', 'box', 'polyhedron', 'several'],
  load: async () => {
    Ammo = await (await import('ammojs-typed')).default();
    return {World, Mechanism};
  }
});
