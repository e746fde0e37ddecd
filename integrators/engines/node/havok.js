// Havok as Babylon.js has it.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import {serve, add, cross, scaled} from './serve.js';

let havok;

// Every call answers with [result, ..]: what follows the result, if it is a good one.
function good(answer) {
  const [result, ...values] = Array.isArray(answer) ? answer : [answer];
  if (result !== havok.Result.RESULT_OK) throw new Error('Havok refuses a call');
  return values[0];
}

class World {
  constructor(body) {
    this.world = good(havok.HP_World_Create());
    this.setGravity(body.gravity);
    this.mass_ = body.mass;
    this.body = this.bodyAt(havok.MotionType.DYNAMIC, body.p, body.q);
    this.shapes = [];
    if (body.planes.length) this.addContact(body);
    // the inertia is that of a body of mass 1
    good(havok.HP_Body_SetMassProperties(
        this.body, [[0, 0, 0], body.mass, body.moments.map((x) => x / body.mass), [0, 0, 0, 1]]));
    if (body.setting === 'best') {
      good(havok.HP_Body_SetLinearDamping(this.body, 0)), good(havok.HP_Body_SetAngularDamping(this.body, 0));
      good(havok.HP_World_SetSpeedLimit(this.world, 1e30, 1e30));
      good(havok.HP_Body_SetActivationControl(this.body, havok.ActivationControl.ALWAYS_ACTIVE));
    }
    good(havok.HP_World_AddBody(this.world, this.body, false));
    this.setVelocities(body.w, body.v);
    if (body.pivot) this.addJoint(body.pivot);
  }
  bodyAt(motion, p, [w, x, y, z]) {
    const body = good(havok.HP_Body_Create());
    good(havok.HP_Body_SetMotionType(body, motion));
    good(havok.HP_Body_SetQTransform(body, [p, [x, y, z, w]]));
    return body;
  }
  addContact(body) {
    const {restitution, friction} = body.planes[0];
    const most = havok.MaterialCombine.MAXIMUM;
    const take = (shape, owner) => {
      good(havok.HP_Shape_SetMaterial(shape, [friction, friction, restitution, most, most]));
      good(havok.HP_Body_SetShape(owner, shape));
      this.shapes.push(shape);
    };
    take(body.ball ? good(havok.HP_Shape_CreateSphere([0, 0, 0], body.ball)) : this.hull(body.hull), this.body);
    for (const {normal, offset} of body.planes) {
      // there are no planes: a block of a hundred metres, with its upper face in the plane
      const ground = this.bodyAt(havok.MotionType.STATIC, scaled(offset - 50, normal), towards(normal));
      take(good(havok.HP_Shape_CreateBox([0, 0, 0], [0, 0, 0, 1], [100, 100, 100])), ground);
      good(havok.HP_World_AddBody(this.world, ground, false));
    }
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
    const joint = good(havok.HP_Constraint_Create());
    good(havok.HP_Constraint_SetParentBody(joint, ground)), good(havok.HP_Constraint_SetChildBody(joint, this.body));
    good(havok.HP_Constraint_SetAnchorInParent(joint, [0, 0, 0], [1, 0, 0], [0, 1, 0]));
    good(havok.HP_Constraint_SetAnchorInChild(joint, pivot, [1, 0, 0], [0, 1, 0]));
    for (const axis of ['LINEAR_X', 'LINEAR_Y', 'LINEAR_Z'])
      good(havok.HP_Constraint_SetAxisMode(
          joint, havok.ConstraintAxis[axis], havok.ConstraintAxisLimitMode.LOCKED));
    good(havok.HP_Constraint_SetEnabled(joint, 1));
  }
  motion() {
    const [p, [x, y, z, w]] = good(havok.HP_Body_GetQTransform(this.body));
    return {
      q: [w, x, y, z], w: good(havok.HP_Body_GetAngularVelocity(this.body)), p,
      v: good(havok.HP_Body_GetLinearVelocity(this.body))
    };
  }
  setVelocities(w, v) {
    good(havok.HP_Body_SetAngularVelocity(this.body, w)), good(havok.HP_Body_SetLinearVelocity(this.body, v));
  }
  setGravity(g) { good(havok.HP_World_SetGravity(this.world, g)); }
  // Babylon.js makes of a force an impulse of one step; the body takes it before it is stepped.
  apply(force, torque) { this.push = {force, torque}; }
  step(h) {
    if (this.push) {
      good(havok.HP_Body_ApplyImpulse(this.body, this.motion().p, scaled(h, this.push.force)));
      good(havok.HP_Body_ApplyAngularImpulse(this.body, scaled(h, this.push.torque)));
      this.push = undefined;
    }
    good(havok.HP_World_SetIdealStepTime(this.world, h));
    good(havok.HP_World_Step(this.world, h));
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

// The shortest turn of z into a direction.
function towards(normal) {
  const half = add(normal, [0, 0, 1]), length = Math.hypot(...half);
  if (!(length > 0)) return [0, 1, 0, 0];
  const middle = scaled(1 / length, half);
  return [middle[2], ...cross([0, 0, 1], middle)];
}

await serve({
  engine: 'havok',
  packageName: '@babylonjs/havok',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term to switch on; damping 0.1 of w; a slow body falls asleep; up to 100 rad/s',
    best: 'no damping, never asleep, no limit of speed; still no gyroscopic term'
  },
  load: async () => {
    const require = createRequire(import.meta.url);
    const binary = require.resolve('@babylonjs/havok/lib/esm/HavokPhysics.wasm');
    havok = await (await import('@babylonjs/havok')).default({wasmBinary: fs.readFileSync(binary)});
    return World;
  }
});
