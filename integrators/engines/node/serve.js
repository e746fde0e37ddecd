// Common part of the drivers: the protocol, and the loop over a request's steps.
//
// A driver provides a World: the engine with one body, whose origin is its centre of mass and whose axes are principal.
// new World(body) makes it, with gravity and joint of the engine. Its methods:
//   motion()              {q: [w, x, y, z] body to world, w, p, v} in world axes
//   setVelocities(w, v)   sets the velocities after an impulse
//   setGravity(g)
//   apply(force, torque)  applies loads at the centre of mass during the next step, world axes
//   step(h)
//   mass(), moments()     the engine's values, undefined if not available
//   free()                frees the engine's objects
// For several bodies a driver provides a Mechanism, made from the request's {bodies, joints, loops, gravity, setting},
// {motors, couplings} if there are any, and {balls, planes, contact} if bodies touch each other as balls:
//   motions()             motions of all bodies, in their order
//   apply(index, force, torque)  as for a World, on a body; called only if there are loads given by formulas
//   step(h), free()       as for a World
import fs from 'node:fs';
import path from 'node:path';
import {createRequire} from 'node:module';
import {add, conjugate, cross, normalized, product, rotate, rotateBack, scaled, subtract} from './algebra.js';
import {Unsupported} from './errors.js';
import {FormulaLoads} from './formulas.js';
import {within} from './joints.js';

export * from './algebra.js';
export * from './errors.js';
export {JointForces, MotorForces, angleBounds, boundsOf, gearOf} from './joints.js';

const answers = 3;

// Version of an installed package, such as "1.2.3".
export function versionOf(name) {
  const require = createRequire(import.meta.url);
  let folder = path.dirname(require.resolve(name));
  for (;; folder = path.dirname(folder)) {
    const file = path.join(folder, 'package.json');
    if (!fs.existsSync(file)) continue;
    const description = JSON.parse(fs.readFileSync(file, 'utf8'));
    if (description.name === name) return description.version;
  }
}

function say(line) {
  const bytes = Buffer.from(JSON.stringify(line) + '\n');
  for (let done = 0; done < bytes.length;) {
    try {
      done += fs.writeSync(answers, bytes, done);
    } catch (error) {
      if (error.code !== 'EAGAIN') throw error;
    }
  }
}

// Force on the centre of mass and torque about it, world axes, without gravity.
function loadsOf(piece, at) {
  const q = normalized(at.q);
  let force = [0, 0, 0], torque = [0, 0, 0];
  if (piece.torque_B) torque = add(torque, rotate(q, piece.torque_B));
  if (piece.torque_W) torque = add(torque, piece.torque_W);
  for (const load of piece.forces ?? []) {
    const {vector, arm} = atPoint(load, q, at.p);
    force = add(force, vector), torque = add(torque, cross(arm, vector));
  }
  if (piece.drag) {
    const w = rotateBack(q, at.w);
    torque = subtract(torque, rotate(q, w.map((x, i) => piece.drag.rotational[i] * x)));
    force = subtract(force, scaled(piece.drag.translational, at.v));
  }
  for (const {stiffness, rest} of piece.springs ?? []) {
    const r = product(conjugate(rest), q);
    torque = add(torque, rotate(q, scaled(-2 * stiffness * r[0], r.slice(1))));
  }
  return {force, torque};
}

// A force or an impulse in world axes, and the arm of its point from the centre of mass.
function atPoint(load, q, p) {
  return {
    vector: load.frame === 'body' ? rotate(q, load.vector) : load.vector,
    arm: load.point_frame === 'body' ? rotate(q, load.point) : subtract(load.point, p)
  };
}

function strike(world, body, impulses) {
  const at = world.motion(), q = normalized(at.q);
  let kick = [0, 0, 0], v = at.v;
  for (const impulse of impulses) {
    const {vector, arm} = atPoint(impulse, q, at.p);
    kick = add(kick, cross(arm, vector)), v = add(v, scaled(1 / body.mass, vector));
  }
  const change = rotateBack(q, kick).map((x, i) => x / body.moments[i]);
  world.setVelocities(add(at.w, rotate(q, change)), v);
}

// Half the length of the cylinder that represents a cylinder or a disc.
export const halfHeightOf = (shape) => shape.type === 'disc' ? 1e-3 * shape.radius : shape.half_height;

// Whether a rule "maximum of both bodies" gives the coefficient of a ball with a plane; otherwise "minimum" does, if the
// ball has the coefficient of two balls and the plane its own.
export const isMaximum = (contact, plane, coefficient) => plane[coefficient] >= contact[coefficient];

// A rotation from z to the axis of an engine's capsules and cylinders, and the orientation of a shape with it.
const half = Math.SQRT1_2;
export const alongY = (shape) => product(shape.orientation, [half, half, 0, 0]);
export const alongX = (shape) => product(shape.orientation, [half, 0, -half, 0]);

// The smallest rotation to axes with z along `z`, and with x along `x` if given, which must be perpendicular to z.
export function frameAbout(z, x) {
  if (!x) {
    const least = z.map(Math.abs).indexOf(Math.min(...z.map(Math.abs)));
    x = [0, 0, 0];
    x[least] = 1;
    x = normalized(subtract(x, scaled(z[least], z)));
  }
  const y = cross(z, x);
  const candidates = [
    [1 + x[0] + y[1] + z[2], y[2] - z[1], z[0] - x[2], x[1] - y[0]],
    [y[2] - z[1], 1 + x[0] - y[1] - z[2], y[0] + x[1], z[0] + x[2]],
    [z[0] - x[2], y[0] + x[1], 1 - x[0] + y[1] - z[2], z[1] + y[2]],
    [x[1] - y[0], z[0] + x[2], z[1] + y[2], 1 - x[0] - y[1] + z[2]]
  ];
  return normalized(candidates.reduce((a, b) => Math.hypot(...b) > Math.hypot(...a) ? b : a));
}

// A joint's frame in either body: revolute about `main`, prismatic along it, fixed along the world's axes.
export function framesOf(bodies, joint, main = 'z') {
  const axis = joint.axes[0];
  let frame = [1, 0, 0, 0];
  if (axis && main === 'z') frame = frameAbout(axis);
  if (axis && main === 'x') frame = frameAbout(rotate(frameAbout(axis), [1, 0, 0]), axis);
  return [within(bodies, joint.parent, frame), within(bodies, joint.child, frame)];
}

// The pieces with one more at each of `times`, which has the loads of the piece before it.
function addEvents(pieces, times) {
  const all = [];
  let next = 0;
  for (const begin of [...times, Infinity]) {
    while (next < pieces.length && pieces[next].begin <= begin) all.push(pieces[next++]);
    if (begin < Infinity && all.at(-1).begin < begin) all.push({...all.at(-1), begin, impulses: undefined});
  }
  return all;
}

const row = ({q, w, p, v}) => [...q, ...w, ...p, ...v];
const zero = [0, 0, 0];

// Runs a request and fills `samples` if given. Returns seconds and steps.
function march(world, request, samples) {
  const {duration, samples: count, steps_per_sample: perSample} = request;
  const pieces = addEvents(request.pieces, request.formulas?.times ?? []);
  const isLoaded = pieces.map((p) => Boolean(p.torque_B || p.torque_W || p.forces || p.drag || p.springs));
  const formulas = request.formulas && new FormulaLoads(request.formulas);
  let next = 0, steps = 0;
  const enter = () => {
    const piece = pieces[next++];
    world.setGravity(piece.gravity ?? zero);
    if (piece.impulses) strike(world, request, piece.impulses);
  };
  const due = (t) => next < pieces.length && pieces[next].begin <= t;
  const step = (t, h) => {
    if (isLoaded[next - 1] || formulas) {
      const at = world.motion();
      let {force, torque} = loadsOf(pieces[next - 1], at);
      if (formulas) {
        const [load] = formulas.evaluate(t, h, [at]);
        force = add(force, load.force), torque = add(torque, load.torque);
      }
      world.apply(force, torque);
    }
    world.step(h);
    ++steps;
  };
  const timeOf = (k) => k === count ? duration : duration * k / count;
  const start = performance.now();
  while (due(0)) enter();
  samples?.push(row(world.motion()));
  for (let k = 1; k <= count; ++k) {
    const begin = timeOf(k - 1), end = timeOf(k), h = (end - begin) / perSample;
    for (let i = 0; i < perSample; ++i) {
      let t = i === 0 ? begin : begin + i * h;
      const stop = i + 1 === perSample ? end : begin + (i + 1) * h;
      if (!due(stop)) {
        step(t, h);
        continue;
      }
      // an event within a step splits the step
      while (due(stop)) {
        const event = pieces[next].begin;
        if (event > t) step(t, event - t);
        t = event;
        while (due(event)) enter();
      }
      if (stop > t) step(t, stop - t);
    }
    samples?.push(row(world.motion()));
  }
  return {seconds: (performance.now() - start) / 1e3, steps};
}

// Like march(), for several bodies.
function marchMechanism(world, request, samples) {
  const {duration, samples: count, steps_per_sample: perSample} = request;
  const formulas = request.formulas && new FormulaLoads(request.formulas, request);
  if (formulas && !world.apply) throw new Unsupported('this driver does not support loads on several bodies');
  const moment = () => samples?.push(world.motions().map(row));
  const timeOf = (k) => k === count ? duration : duration * k / count;
  let steps = 0;
  const start = performance.now();
  moment();
  for (let k = 1; k <= count; ++k) {
    const begin = timeOf(k - 1), h = (timeOf(k) - begin) / perSample;
    for (let i = 0; i < perSample; ++i) {
      if (!formulas) {
        world.step(h), ++steps;
        continue;
      }
      let t = begin + i * h;
      for (const end of formulas.split(t, i + 1 === perSample ? timeOf(k) : begin + (i + 1) * h)) {
        formulas.evaluate(t, end - t, world.motions())
            .forEach(({force, torque}, index) => world.apply(index, force, torque));
        world.step(end - t), ++steps;
        t = end;
      }
    }
    moment();
  }
  return {seconds: (performance.now() - start) / 1e3, steps};
}

function answerForSeveral(Mechanism, request) {
  if (!Mechanism) throw new Unsupported('this driver supports only scenes of one body');
  const samples = [];
  let seconds = 0, steps = 0;
  for (let i = 0; i < request.repetitions; ++i) {
    const world = new Mechanism(request);
    try {
      const run = marchMechanism(world, request, i + 1 === request.repetitions ? samples : undefined);
      seconds += run.seconds, steps = run.steps;
    } finally {
      world.free();
    }
  }
  return {status: 'ok', message: '', seconds: seconds / request.repetitions, steps, samples};
}

function answerTo({World, Mechanism}, settings, line) {
  const request = JSON.parse(line);
  if (!(request.setting in settings)) throw new Error(`unknown setting ${request.setting}`);
  if (request.bodies) return answerForSeveral(Mechanism, request);
  const gravity = request.pieces[0].gravity ?? zero;
  const samples = [];
  let seconds = 0, steps = 0, readback;
  for (let i = 0; i < request.repetitions; ++i) {
    const world = new World({...request, gravity});
    try {
      readback ??= {...world.motion(), mass: world.mass(), moments: world.moments()};
      const run = march(world, request, i + 1 === request.repetitions ? samples : undefined);
      seconds += run.seconds, steps = run.steps;
    } finally {
      world.free();
    }
  }
  return {status: 'ok', message: '', seconds: seconds / request.repetitions, steps, samples, readback};
}

// Answers requests until input ends. `load` returns {World, Mechanism}, or throws if the package is missing. `joints`
// and `loops` are the types that its Mechanism supports, `laws` its laws of joints (README.md), `shapes` those that its World supports on planes. `contacts`:
// its Mechanism supports balls.
export async function serve(
    {engine, packageName, precision, settings, load, joints = [], loops = [], laws = [], shapes = [], contacts = false}) {
  let loaded;
  try {
    loaded = {version: versionOf(packageName), ...await load()};
  } catch (error) {
    const missing = error.code === 'MODULE_NOT_FOUND' || error.code === 'ERR_MODULE_NOT_FOUND' ?
        `the npm package ${packageName} is not installed; run experiments/run engines to install it` :
        `the npm package ${packageName} cannot be loaded (${error.code ?? error.message})`;
    say({engine, precision, settings, missing: missing.split('\n')[0]});
    return;
  }
  say({engine, version: loaded.version, precision, settings, joints, loops, laws, shapes, contacts, formulas: true});
  let unread = '';
  process.stdin.setEncoding('utf8');
  for await (const chunk of process.stdin) {
    unread += chunk;
    for (let end; (end = unread.indexOf('\n')) >= 0; unread = unread.slice(end + 1)) {
      try {
        say(answerTo(loaded, settings, unread.slice(0, end)));
      } catch (error) {
        const status = error instanceof Unsupported ? 'unsupported' : 'failed';
        say({status, message: String(error?.message ?? error).split('\n')[0]});
      }
    }
  }
}
