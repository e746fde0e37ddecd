// Integrates MuJoCo's forward dynamics by a Runge-Kutta method of order 4, without MuJoCo's time stepping.
// For MuJoCo 3 (npm's @mujoco/mujoco); motion.c is for MuJoCo 2.2.2. `compute` calls both and documents the jobs.
//   node motion.mjs MODULE [version]      MODULE: the path of mujoco.js
import { readFileSync, readdirSync, statSync } from "node:fs";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const { default: load } = await import(pathToFileURL(process.argv[2]).href);
const complaints = [];
const mujoco = await load({ print: () => {}, printErr: (text) => complaints.push(text) });
if (process.argv[3] === "version") {
  console.log(mujoco.mj_versionString());
  process.exit(0);
}

const duration = 0.5;
const stepsPerHalf = Number(process.env.IMPORT_STEPS ?? 2500); // h = 1e-4 s
const { FREE, BALL } = { FREE: 0, BALL: 1 };
const BODY = 1;
const JOINT = 3;

// the folder of a model, copied into the module's memory once
const copied = new Set();
function copyFolder(folder) {
  if (copied.has(folder)) return;
  copied.add(folder);
  mujoco.FS.mkdirTree(folder);
  for (const name of readdirSync(folder)) {
    const path = join(folder, name);
    if (statSync(path).isDirectory()) copyFolder(path);
    else mujoco.FS.writeFile(path, readFileSync(path));
  }
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
function rotate(q, v) {
  const u = [q[1], q[2], q[3]];
  const c = cross(u, v);
  const cc = cross(u, c);
  return v.map((x, i) => x + 2 * (q[0] * c[i] + cc[i]));
}

function differentiator(m, d) {
  const types = Array.from(m.jnt_type);
  const qs = Array.from(m.jnt_qposadr);
  const vs = Array.from(m.jnt_dofadr);
  return (q, v) => {
    d.qpos.set(q);
    d.qvel.set(v);
    mujoco.mj_forward(m, d);
    const dv = Float64Array.from(d.qacc);
    const dq = new Float64Array(q.length);
    types.forEach((type, j) => {
      let a = qs[j];
      let b = vs[j];
      if (type !== FREE && type !== BALL) {
        dq[a] = v[b];
        return;
      }
      if (type === FREE) {
        for (let i = 0; i < 3; ++i) dq[a + i] = v[b + i];
        a += 3;
        b += 3;
      }
      const [w, x, y, z] = q.subarray(a, a + 4);
      const [p, r, s] = v.subarray(b, b + 3);
      dq[a] = -0.5 * (x * p + y * r + z * s);
      dq[a + 1] = 0.5 * (w * p + y * s - z * r);
      dq[a + 2] = 0.5 * (w * r + z * p - x * s);
      dq[a + 3] = 0.5 * (w * s + x * r - y * p);
    });
    return [dq, dv];
  };
}

const nodes = [0, 0.5, 0.5, 1];
const weights = [1 / 6, 1 / 3, 1 / 3, 1 / 6];
function step(derivative, q, v, h) {
  const newQ = Float64Array.from(q);
  const newV = Float64Array.from(v);
  let dq;
  let dv;
  for (let s = 0; s < 4; ++s) {
    const a = s ? q.map((x, i) => x + h * nodes[s] * dq[i]) : q;
    const b = s ? v.map((x, i) => x + h * nodes[s] * dv[i]) : v;
    [dq, dv] = derivative(a, b);
    for (let i = 0; i < newQ.length; ++i) newQ[i] += h * weights[s] * dq[i];
    for (let i = 0; i < newV.length; ++i) newV[i] += h * weights[s] * dv[i];
  }
  return [newQ, newV];
}

function moment(m, d, t) {
  mujoco.mj_forward(m, d);
  const slice = (x, b, n) => Array.from(x.subarray(n * b, n * b + n));
  const bodies = [];
  for (let b = 1; b < m.nbody; ++b)
    bodies.push({ center_of_mass: slice(d.xipos, b, 3), origin: slice(d.xpos, b, 3), attitude: slice(d.xquat, b, 4) });
  return { t, bodies };
}

// mj_id2name does not return an empty string for a body without a name
const nameOf = (m, b) => (m.names[m.name_bodyadr[b]] ? mujoco.mj_id2name(m, BODY, b) : "");

// removes constructs by name: "armature", "free_damping", "gravcomp", "ball_stiffness", "fluid", "tendon"
function drop(m, what) {
  if (what.includes("armature")) m.dof_armature.fill(0);
  if (what.includes("gravcomp")) m.body_gravcomp.fill(0);
  if (what.includes("fluid")) m.opt.density = m.opt.viscosity = 0;
  if (what.includes("tendon")) {
    m.tendon_stiffness.fill(0);
    m.tendon_damping.fill(0);
  }
  for (let j = 0; j < m.njnt; ++j) {
    const v = m.jnt_dofadr[j];
    if (m.jnt_type[j] === FREE && what.includes("free_damping")) m.dof_damping.fill(0, v, v + 6);
    if (m.jnt_type[j] === BALL && what.includes("ball_stiffness")) m.jnt_stiffness[j] = 0;
  }
}

// format: see motion.c
function start(m, d, text) {
  for (const one of text.split(";").filter(Boolean)) {
    const [kind, name, ...numbers] = one.trim().split(" ");
    const x = numbers.map(Number);
    if (kind !== "free") {
      const j = mujoco.mj_name2id(m, JOINT, name);
      if (j < 0) throw new Error(`no joint ${name}`);
      d.qvel.set(x, m.jnt_dofadr[j]);
      continue;
    }
    const b = mujoco.mj_name2id(m, BODY, name);
    if (b < 0 || m.body_jntnum[b] !== 1 || m.jnt_type[m.body_jntadr[b]] !== FREE || x.length !== 6)
      throw new Error(`no free body ${name}`);
    const now = moment(m, d, 0).bodies[b - 1];
    const turn = rotate(now.attitude, x.slice(0, 3));
    const v = cross(turn, now.origin.map((p, i) => p - now.center_of_mass[i])).map((s, i) => s + x[3 + i]);
    d.qvel.set([...v, ...x.slice(0, 3)], m.jnt_dofadr[m.body_jntadr[b]]);
  }
}

for await (const line of createInterface({ input: process.stdin })) {
  const [id, path, gravity, dropped, begin] = line.split("\t");
  try {
    copyFolder(dirname(path));
    complaints.length = 0;
    const m = mujoco.MjModel.from_xml_path(path);
    if (gravity !== "file") m.opt.gravity.set(gravity.split(" ").map(Number));
    m.opt.disableflags |= 1 | (1 << 4); // constraints, contacts
    drop(m, dropped);
    const d = new mujoco.MjData(m);
    mujoco.mj_setConst(m, d); // dof_M0 also contains the armature
    mujoco.mj_resetData(m, d);
    start(m, d, begin);
    const weld = m.body_weldid;
    const bodies = [];
    for (let b = 1; b < m.nbody; ++b)
      bodies.push({ name: nameOf(m, b), mass: m.body_mass[b], welded_to: weld[b] - 1 });
    const moments = [moment(m, d, 0)];
    const derivative = differentiator(m, d);
    let q = Float64Array.from(d.qpos);
    let v = Float64Array.from(d.qvel);
    for (let half = 1; half <= 2; ++half) {
      for (let i = 0; i < stepsPerHalf; ++i) [q, v] = step(derivative, q, v, (0.5 * duration) / stepsPerHalf);
      d.qpos.set(q);
      d.qvel.set(v);
      moments.push(moment(m, d, 0.5 * duration * half));
    }
    console.log(JSON.stringify({ id, gravity: Array.from(m.opt.gravity), bodies, moments }));
    d.delete();
    m.delete();
  } catch (error) {
    console.log(JSON.stringify({ id, error: `${complaints.join(" ")} ${error.message ?? error}`.trim() }));
  }
}
