// cannon-es.
import {serve, JointForces, add as plus, rotate} from './serve.js';

let CANNON;

const vector = (a) => new CANNON.Vec3(...a);
const array = (v) => [v.x, v.y, v.z];

// Sets the body's moments, which the engine otherwise estimates from the shapes.
function giveMoments(body, moments) {
  body.updateMassProperties = () => {};
  body.inertia.set(...moments);
  body.invInertia.set(...moments.map((x) => 1 / x));
  body.updateSolveMassProperties();
  body.updateInertiaWorld(true);
}

function motionOf({quaternion: q, angularVelocity, position, velocity}) {
  return {q: [q.w, q.x, q.y, q.z], w: array(angularVelocity), p: array(position), v: array(velocity)};
}

function groundOf({normal, offset}, material) {
  const ground = new CANNON.Body({mass: 0, material, shape: new CANNON.Plane()});
  ground.position.set(...normal.map((n) => n * offset));
  ground.quaternion.setFromVectors(new CANNON.Vec3(0, 0, 1), vector(normal));
  return ground;
}

function load(body, force, torque) {
  body.force.vadd(vector(force), body.force);
  body.torque.vadd(vector(torque), body.torque);
}

class World {
  constructor(body) {
    this.world = new CANNON.World({gravity: vector(body.gravity)});
    const [w, x, y, z] = body.q;
    this.body = new CANNON.Body({
      mass: body.mass, position: vector(body.p), velocity: vector(body.v), angularVelocity: vector(body.w),
      quaternion: new CANNON.Quaternion(x, y, z, w)
    });
    if (body.setting === 'best') this.body.linearDamping = this.body.angularDamping = 0;
    if (body.planes.length) this.addContact(body);
    giveMoments(this.body, body.moments);
    this.world.addBody(this.body);
    if (body.pivot) {
      const ground = new CANNON.Body({mass: 0});
      this.world.addBody(ground);
      this.world.addConstraint(
          new CANNON.PointToPointConstraint(this.body, vector(body.pivot), ground, new CANNON.Vec3(), 1e30));
    }
  }
  addContact(body) {
    const {restitution, friction} = body.planes[0];
    const material = new CANNON.Material();
    this.world.addContactMaterial(new CANNON.ContactMaterial(material, material, {restitution, friction}));
    this.body.material = material;
    for (const shape of body.shapes) this.addShape(shape);
    for (const plane of body.planes) this.world.addBody(groundOf(plane, material));
  }
  addShape(shape) {
    const [w, x, y, z] = shape.orientation, turn = new CANNON.Quaternion(x, y, z, w);
    const add = (made, position) => this.body.addShape(made, vector(position), turn);
    if (shape.type === 'box') return add(new CANNON.Box(vector(shape.half_extents)), shape.position);
    // on planes, a capsule touches as the balls at its ends
    const ends = shape.type === 'capsule' ? [-shape.half_height, shape.half_height] : [0];
    for (const end of ends)
      add(new CANNON.Sphere(shape.radius), plus(shape.position, rotate(shape.orientation, [0, 0, end])));
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) { this.body.angularVelocity.set(...w), this.body.velocity.set(...v); }
  setGravity(g) { this.world.gravity.set(...g); }
  apply(force, torque) { load(this.body, force, torque); }
  step(h) { this.world.step(h); }
  mass() { return this.body.mass; }
  moments() { return array(this.body.invInertia).map((x) => 1 / x); }
  free() {}
}

class Mechanism {
  constructor({bodies, joints, loops, gravity, setting, balls, planes, contact, motors}) {
    this.forces = new JointForces({bodies, joints, motors}), this.hingesWithFriction = [];
    this.world = new CANNON.World({gravity: vector(gravity)});
    this.bodies = bodies.map((known) => {
      const [w, x, y, z] = known.q;
      const body = new CANNON.Body({
        mass: known.mass, position: vector(known.p), velocity: vector(known.v), angularVelocity: vector(known.w),
        quaternion: new CANNON.Quaternion(x, y, z, w)
      });
      if (setting === 'best') body.linearDamping = body.angularDamping = 0;
      giveMoments(body, known.moments);
      this.world.addBody(body);
      return body;
    });
    this.ground = new CANNON.Body({mass: 0});
    this.world.addBody(this.ground);
    for (const joint of [...joints, ...loops]) this.world.addConstraint(this.jointOf(joint));
    if (balls) this.addBalls(balls, planes, contact);
  }
  addBalls(radii, planes, contact) {
    const ball = new CANNON.Material(), ground = new CANNON.Material();
    this.world.addContactMaterial(new CANNON.ContactMaterial(ball, ball, contact));
    this.bodies.forEach((body, i) => {
      body.addShape(new CANNON.Sphere(radii[i]));
      body.material = ball;
    });
    for (const {restitution, friction} of planes.slice(0, 1))
      this.world.addContactMaterial(new CANNON.ContactMaterial(ball, ground, {restitution, friction}));
    for (const plane of planes) this.world.addBody(groundOf(plane, ground));
  }
  jointOf(joint) {
    const {type, parent, child, parent_point: pivotA, child_point: pivotB, parent_axes: [axisA], child_axes: [axisB]} = joint;
    const a = this.bodies[parent] ?? this.ground, b = this.bodies[child] ?? this.ground, maxForce = 1e30;
    if (type === 'spherical')
      return new CANNON.PointToPointConstraint(a, vector(pivotA), b, vector(pivotB), maxForce);
    const options = {pivotA: vector(pivotA), pivotB: vector(pivotB), axisA: vector(axisA), axisB: vector(axisB), maxForce};
    const hinge = new CANNON.HingeConstraint(a, b, options);
    if (joint.friction) {
      hinge.enableMotor(), hinge.setMotorSpeed(0);
      this.hingesWithFriction.push({hinge, friction: joint.friction});
    }
    return hinge;
  }
  motions() { return this.bodies.map(motionOf); }
  apply(index, force, torque) { load(this.bodies[index], force, torque); }
  step(h) {
    // cannon-es limits the impulse of a step, although it names the limit maxForce
    for (const {hinge, friction} of this.hingesWithFriction) hinge.setMotorMaxForce(friction * h);
    this.forces.applyTo(this, h);
    this.world.step(h);
  }
  free() {}
}

await serve({
  engine: 'cannon_es',
  packageName: 'cannon-es',
  precision: 'binary64',
  settings: {
    default: 'linear and angular damping 0.01; no gyroscopic term available; attitude by the first-order update',
    best: 'no damping; no gyroscopic term available'
  },
  joints: ['revolute', 'spherical'],
  loops: ['revolute', 'spherical'],
  laws: ['friction', 'springs', 'motors'],
  contacts: true,
  shapes: ['ball', 'capsule', 'box', 'several'],
  load: async () => (CANNON = await import('cannon-es'), {World, Mechanism})
});
