// MuJoCo of today.
import {serve, cross, normalized, rotate, rotateBack, scaled, Unsupported} from './serve.js';

let mujoco;

const integrators = {default: 'Euler', implicit: 'implicit', implicitfast: 'implicitfast', rk4: 'RK4'};

class World {
  constructor(body) {
    if (body.planes.length) throw new Unsupported("MuJoCo's contacts know no coefficient of restitution");
    this.pivot = body.pivot;
    const joint = body.pivot ? `<joint type="ball" pos="${body.pivot.join(' ')}"/>` : '<freejoint/>';
    const place = body.pivot ? scaled(-1, body.pivot) : body.p;
    this.model = mujoco.MjModel.from_xml_string(`<mujoco><option integrator="${integrators[body.setting]}"/><worldbody>
        <body pos="${place.join(' ')}">${joint}<inertial pos="0 0 0" mass="${body.mass}"
        diaginertia="${body.moments.join(' ')}"/></body></worldbody></mujoco>`);
    this.data = new mujoco.MjData(this.model);
    this.first = body.pivot ? 0 : 3;
    this.setGravity(body.gravity);
    this.data.qpos.set(body.q, this.first);
    if (!body.pivot) this.data.qpos.set(body.p, 0);
    this.setVelocities(body.w, body.v);
  }
  // the body's own quaternion, and velocities: of rotation in body axes
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
    this.model.opt.timestep = h;
    mujoco.mj_step(this.model, this.data);
    if (!(this.data.time > 0)) throw new Error('MuJoCo found its state to be bad and began anew');
    if (!this.pushed) return;
    this.data.xfrc_applied.fill(0), this.pushed = false;
  }
  mass() { return this.model.body_mass[1]; }
  moments() { return Array.from(this.model.body_inertia.subarray(3, 6)); }
  free() { this.data.delete(), this.model.delete(); }
}

await serve({
  engine: 'mujoco_wasm',
  packageName: '@mujoco/mujoco',
  precision: 'binary64',
  settings: {
    default: 'its Euler: semi-implicit, the gyroscopic term explicit; no damping',
    implicit: 'its integrator "implicit"',
    implicitfast: 'its integrator "implicitfast"',
    rk4: 'its integrator "RK4"'
  },
  load: async () => {
    mujoco = await (await import('@mujoco/mujoco')).default();
    return World;
  }
});
