// Loads given by formulas, evaluated from the engine's state at the start of each step.
//
// FormulaLoads evaluates the operations in a request's `formulas` (README.md) in binary64 and sums the loads of each body
// as a force at its centre of mass and a torque, in world axes. drivers/formula_loads.h is the same in C++.
import {add, conjugate, cross, normalized, product, rotate, rotateBack, subtract} from './algebra.js';
import {applyJointForce, jointCoordinate} from './joints.js';

const functions = {
  sqrt: Math.sqrt, sin: Math.sin, cos: Math.cos, exp: Math.exp, log: Math.log, atan2: Math.atan2, asin: Math.asin,
  acos: Math.acos, tanh: Math.tanh, sinh: Math.sinh, cbrt: Math.cbrt, power: Math.pow, negate: (a) => -a,
  add: (a, b) => a + b, subtract: (a, b) => a - b, multiply: (a, b) => a * b, divide: (a, b) => a / b
};
const tests = {
  positive: (x) => x > 0, not_negative: (x) => x >= 0, negative: (x) => x < 0, not_positive: (x) => x <= 0
};

const numbersPerBody = 13;

export class FormulaLoads {
  // `mechanism`: the bodies and joints of a request for several bodies
  constructor(formulas, {bodies, joints = []} = {}) {
    const {operations, switches, holds, loads, axes, coordinates} = formulas;
    Object.assign(this, {bodies, joints, switches, holds, loads});
    this.times = formulas.times, this.nextTime = 0;
    this.back = axes.map(conjugate), this.starts = coordinates;
    this.firstJoint = 1 + numbersPerBody * axes.length;
    this.inputs = new Float64Array(this.firstJoint + 2 * coordinates.length + holds.length);
    this.values = new Float64Array(operations.length);
    this.steps = operations.map((operation) => this.stepOf(operation));
    this.due = holds.map(() => 0);
    const read = operations.filter(([name]) => name === 'input').map(([, input]) => (input - this.firstJoint) >> 1);
    this.jointsRead = coordinates.map((_, j) => j).filter((j) => read.includes(j));
    coordinates.forEach((x, j) => this.inputs[this.firstJoint + 2 * j] = x);
  }
  // An operation as a function that returns its value.
  stepOf([name, a, b, c, d]) {
    const {values, inputs} = this;
    if (name === 'number') return () => a;
    if (name === 'input') return () => inputs[a];
    if (name === 'choose') {
      const [argument, threshold] = this.switches[a], passes = tests[b];
      return () => values[passes(values[argument] - (threshold === null ? 0 : values[threshold])) ? c : d];
    }
    const compute = functions[name];
    if (!compute) throw new Error(`unknown operation ${name} of a formula`);
    return b === undefined ? () => compute(values[a]) : () => compute(values[a], values[b]);
  }
  // The ends of the parts of a step from t to `stop`: the times at which a load begins, ends or is sampled, and `stop`.
  // Steps are given in increasing order.
  split(t, stop) {
    const ends = [];
    for (; this.times[this.nextTime] < stop; ++this.nextTime)
      if (this.times[this.nextTime] > t) ends.push(this.times[this.nextTime]);
    return [...ends, stop];
  }
  // The loads {force, torque} on all bodies for a step from t to t + h. `motions`: of all bodies at t. Values of a period
  // are sampled in the first step that starts at a multiple of it or later. A load acts in the steps whose middle is in
  // its window.
  evaluate(t, h, motions) {
    this.attitudes = motions.map(({q}, b) => product(normalized(q), this.back[b]));
    this.setInputs(t, motions);
    this.sample(t, h);
    this.compute(this.steps.length);
    const middle = t + 0.5 * h, sums = motions.map(() => ({force: [0, 0, 0], torque: [0, 0, 0]}));
    for (const load of this.loads)
      if ((load.from ?? -Infinity) <= middle && middle < (load.until ?? Infinity)) this.addLoad(load, t, motions, sums);
    return sums;
  }
  setInputs(t, motions) {
    const {inputs} = this;
    inputs[0] = t;
    motions.forEach(({w, p, v}, b) => {
      const q = this.attitudes[b];
      inputs.set([...rotateBack(q, w), ...q, ...p, ...v], 1 + numbersPerBody * b);
    });
    for (const j of this.jointsRead) {
      const joint = this.joints[j], {x, rate} = jointCoordinate(this.bodies, joint, motions);
      const input = this.firstJoint + 2 * j, now = x + this.starts[j], turn = 2 * Math.PI;
      // counts full revolutions
      const turns = joint.type === 'revolute' ? Math.round((inputs[input] - now) / turn) : 0;
      inputs[input] = now + turn * turns, inputs[input + 1] = rate;
    }
  }
  sample(t, h) {
    // steps start at the multiples only up to rounding
    const reached = t + 1e-6 * h;
    this.holds.forEach(({value, period, input}, i) => {
      if (reached < this.due[i] * period) return;
      this.due[i] = Math.floor(reached / period) + 1;
      this.compute(value + 1);
      this.inputs[input] = this.values[value];
    });
  }
  compute(count) {
    for (let i = 0; i < count; ++i) this.values[i] = this.steps[i]();
  }
  addLoad({type, body, joint, frame, value, point, point_frame: pointFrame}, t, motions, sums) {
    const numbers = value.map((node) => this.values[node]);
    if (!numbers.every(Number.isFinite))
      throw new Error(`a formula has no finite value at t = ${Number(t.toPrecision(6))} s`);
    const push = (index, force, torque) => {
      sums[index] = {force: add(sums[index].force, force), torque: add(sums[index].torque, torque)};
    };
    if (type === 'motor') return applyJointForce(this.joints[joint], numbers[0], motions, push);
    const q = this.attitudes[body], inWorld = frame === 'body' ? rotate(q, numbers) : numbers;
    if (type === 'torque') return push(body, [0, 0, 0], inWorld);
    if (!point) return push(body, inWorld, [0, 0, 0]);
    const arm = pointFrame === 'body' ? rotate(q, point) : subtract(point, motions[body].p);
    push(body, inWorld, cross(arm, inWorld));
  }
}
