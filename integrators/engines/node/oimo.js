// Oimo.js.
import {serve, Unsupported} from './serve.js';

let OIMO;

const array = (v) => [v.x, v.y, v.z];

class World {
  constructor(body) {
    if (body.planes.length) throw new Unsupported('Oimo.js does not support planes or convex hulls');
    this.world = new OIMO.World({timestep: 1 / 60, random: false, gravity: body.gravity});
    // a body needs a shape; the mass and inertia computed from it are overwritten
    this.body = this.world.add({type: 'sphere', size: [1], pos: body.p, move: true, density: 1, collidesWith: 0});
    const [w, x, y, z] = body.q;
    this.body.orientation.set(x, y, z, w);
    this.body.mass = body.mass, this.body.inverseMass = 1 / body.mass;
    const [a, b, c] = body.moments;
    this.body.localInertia.set(a, 0, 0, 0, b, 0, 0, 0, c);
    this.body.inverseLocalInertia.set(1 / a, 0, 0, 0, 1 / b, 0, 0, 0, 1 / c);
    this.body.syncShapes();
    if (body.setting === 'best') this.body.allowSleep = false;
    this.setVelocities(body.w, body.v);
    if (body.pivot) throw new Unsupported('this driver does not support pivots');
  }
  motion() {
    const q = this.body.orientation;
    return {
      q: [q.w, q.x, q.y, q.z], p: array(this.body.position), w: array(this.body.angularVelocity),
      v: array(this.body.linearVelocity)
    };
  }
  setVelocities(w, v) {
    this.body.awake();
    this.body.angularVelocity.set(...w), this.body.linearVelocity.set(...v);
  }
  setGravity(g) { this.world.gravity.set(...g); }
  apply() { throw new Unsupported('Oimo.js does not support external torques'); }
  step(h) {
    this.world.timeStep = h;
    this.world.step();
  }
  mass() { return this.body.mass; }
  moments() { return [0, 4, 8].map((i) => this.body.localInertia.elements[i]); }
  free() { this.world.clear(); }
}

await serve({
  engine: 'oimo',
  packageName: 'oimo',
  precision: 'binary64',
  settings: {
    default: 'no gyroscopic term available; slow bodies sleep',
    best: 'no sleeping; no gyroscopic term available'
  },
  load: async () => (OIMO = (await import('oimo')).default, {World})
});
