// cannon-es.
import {serve} from './serve.js';

let CANNON;

const vector = (a) => new CANNON.Vec3(...a);
const array = (v) => [v.x, v.y, v.z];

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
    // the moments are the engine's own guess from shapes; here they are given, and the shape leaves them alone
    this.body.updateMassProperties = () => {};
    this.body.inertia.set(...body.moments);
    this.body.invInertia.set(...body.moments.map((x) => 1 / x));
    this.body.updateSolveMassProperties();
    this.body.updateInertiaWorld(true);
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
    this.body.addShape(body.ball ? new CANNON.Sphere(body.ball) : new CANNON.Box(halfSides(body.hull)));
    for (const plane of body.planes) {
      const ground = new CANNON.Body({mass: 0, material, shape: new CANNON.Plane()});
      ground.position.set(...plane.normal.map((n) => n * plane.offset));
      ground.quaternion.setFromVectors(new CANNON.Vec3(0, 0, 1), vector(plane.normal));
      this.world.addBody(ground);
    }
  }
  motion() {
    const b = this.body, q = b.quaternion;
    return {q: [q.w, q.x, q.y, q.z], w: array(b.angularVelocity), p: array(b.position), v: array(b.velocity)};
  }
  setVelocities(w, v) { this.body.angularVelocity.set(...w), this.body.velocity.set(...v); }
  setGravity(g) { this.world.gravity.set(...g); }
  apply(force, torque) {
    this.body.force.vadd(vector(force), this.body.force);
    this.body.torque.vadd(vector(torque), this.body.torque);
  }
  step(h) { this.world.step(h); }
  mass() { return this.body.mass; }
  moments() { return array(this.body.invInertia).map((x) => 1 / x); }
  free() {}
}

// Half the sides of a box that has these corners.
function halfSides(hull) {
  const half = [0, 1, 2].map((i) => Math.max(...hull.map((corner) => Math.abs(corner[i]))));
  return vector(half);
}

await serve({
  engine: 'cannon_es',
  packageName: 'cannon-es',
  precision: 'binary64',
  settings: {
    default: 'damping 0.01 of either velocity; no gyroscopic term to switch on; the attitude by the first-order quaternion',
    best: 'no damping; still no gyroscopic term'
  },
  load: async () => (CANNON = await import('cannon-es'), World)
});
