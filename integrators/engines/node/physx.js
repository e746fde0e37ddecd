// PhysX 5.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import {serve, JointForces, alongX, angleBounds, boundsOf, frameAbout, framesOf, gearOf, isMaximum, rotate} from './serve.js';

let PhysX, physics, tolerances;

const array = (v) => [v.x, v.y, v.z];
// PxRigidBodyFlag value that this build does not name
const gyroscopicForces = 1 << 10;

// Common base of World and Mechanism.
class Scene {
  constructor(gravity, setting) {
    this.taken = [], this.grounds = [];
    const settings = this.take(new PhysX.PxSceneDesc(tolerances));
    settings.gravity = this.vector(gravity);
    if (setting === 'best') settings.bounceThresholdVelocity = 1e-2;
    settings.cpuDispatcher = this.dispatcher = PhysX.DefaultCpuDispatcherCreate(0);
    settings.filterShader = PhysX.DefaultFilterShader();
    this.scene = physics.createScene(settings);
    this.push = this.vector([0, 0, 0]);
  }
  addBody({mass, moments, p, q}, setting) {
    const body = physics.createRigidDynamic(this.place(p, q));
    // a new body has mass 1 and unit moments; there is no shape to compute them from
    body.setMass(mass);
    body.setMassSpaceInertiaTensor(this.vector(moments));
    if (setting === 'best') {
      body.setRigidBodyFlag(gyroscopicForces, true);
      body.setLinearDamping(0), body.setAngularDamping(0);
      body.setMaxLinearVelocity(1e16), body.setMaxAngularVelocity(1e16);
      body.setSleepThreshold(0), body.setStabilizationThreshold(0);
    }
    return body;
  }
  // Registers a temporary object of numbers. It must be freed explicitly.
  take(object) {
    this.taken.push(object);
    return object;
  }
  vector(a) { return this.take(new PhysX.PxVec3(...a)); }
  place(p, [w, x, y, z]) {
    return this.take(new PhysX.PxTransform(this.vector(p), this.take(new PhysX.PxQuat(x, y, z, w))));
  }
  attach(body, part, material) {
    const flags = this.take(new PhysX.PxShapeFlags(
        PhysX.PxShapeFlagEnum.eSIMULATION_SHAPE | PhysX.PxShapeFlagEnum.eSCENE_QUERY_SHAPE));
    const shape = physics.createShape(this.take(this.convex(part)), material, true, flags);
    if (part.position && part.type !== 'polyhedron')
      shape.setLocalPose(this.place(part.position, part.type === 'capsule' ? alongX(part) : part.orientation));
    shape.setSimulationFilterData(this.groups());
    body.attachShape(shape);
  }
  addPlane({normal, offset}, material) {
    const ground = PhysX.CreatePlane(physics, this.take(new PhysX.PxPlane(this.vector(normal), -offset)), material);
    const side = this.take(new PhysX.PxArray_PxShapePtr(1));
    ground.getShapes(side.begin(), 1, 0);
    side.get(0).setSimulationFilterData(this.groups());
    this.scene.addActor(ground);
    this.grounds.push(ground);
  }
  groups() { return this.take(new PhysX.PxFilterData(1, 1, 0, 0)); }
  convex(shape) {
    if (shape.type === 'ball') return new PhysX.PxSphereGeometry(shape.radius);
    if (shape.type === 'capsule') return new PhysX.PxCapsuleGeometry(shape.radius, shape.half_height);
    if (shape.type === 'box') return new PhysX.PxBoxGeometry(...shape.half_extents);
    return new PhysX.PxConvexMeshGeometry(this.mesh(shape.corners));
  }
  mesh(corners) {
    const points = this.take(new PhysX.PxArray_PxVec3());
    for (const corner of corners) points.pushBack(this.vector(corner));
    const settings = this.take(new PhysX.PxConvexMeshDesc());
    settings.flags = this.take(new PhysX.PxConvexFlags(PhysX.PxConvexFlagEnum.eCOMPUTE_CONVEX));
    settings.points.count = points.size(), settings.points.stride = 12, settings.points.data = points.begin();
    return PhysX.CreateConvexMesh(this.take(new PhysX.PxCookingParams(tolerances)), settings);
  }
  load(body, force, torque) {
    const set = ([x, y, z]) => (this.push.x = x, this.push.y = y, this.push.z = z, this.push);
    body.addForce(set(force)), body.addTorque(set(torque));
  }
  step(h) {
    this.scene.simulate(h);
    this.scene.fetchResults(true);
  }
  leave() {
    this.scene.release(), this.dispatcher.release?.();
    for (const object of this.taken.reverse()) PhysX.destroy(object);
  }
}

function motionOf(body) {
  const {p, q} = body.getGlobalPose();
  return {
    q: [q.w, q.x, q.y, q.z], p: array(p), w: array(body.getAngularVelocity()), v: array(body.getLinearVelocity())
  };
}
function setVelocities(body, w, v) { body.setAngularVelocity(w, true), body.setLinearVelocity(v, true); }

class World extends Scene {
  constructor(body) {
    super(body.gravity, body.setting);
    this.body = this.addBody(body, body.setting);
    if (body.planes.length) this.addContact(body);
    this.scene.addActor(this.body);
    this.setVelocities(body.w, body.v);
    if (body.pivot) {
      const one = [1, 0, 0, 0];
      this.joint = PhysX.SphericalJointCreate(
          physics, this.body, this.place(body.pivot, one), PhysX.wrapPointer(0, PhysX.PxRigidActor),
          this.place([0, 0, 0], one));
    }
  }
  addContact(body) {
    const {restitution, friction} = body.planes[0];
    const material = physics.createMaterial(friction, friction, restitution);
    for (const part of body.shapes) this.attach(this.body, part, material);
    for (const plane of body.planes) this.addPlane(plane, material);
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) {
    setVelocities(this.body, this.vector(w), this.vector(v));
  }
  setGravity(g) { this.scene.setGravity(this.vector(g)); }
  apply(force, torque) { this.load(this.body, force, torque); }
  mass() { return this.body.getMass(); }
  moments() { return array(this.body.getMassSpaceInertiaTensor()); }
  free() {
    this.joint?.release();
    this.body.release();
    for (const ground of this.grounds) ground.release();
    this.leave();
  }
}

// This build is for browsers and refuses to start under Node: a fake `window` exists while it starts.
async function started() {
  const require = createRequire(import.meta.url);
  const wasmBinary = fs.readFileSync(require.resolve('physx-js-webidl/physx-js-webidl.wasm'));
  const {process: node} = globalThis;
  const {default: start} = await import('physx-js-webidl');
  globalThis.process = undefined;
  globalThis.window = {location: {href: ''}, encodeURIComponent};
  try {
    return await start({wasmBinary});
  } finally {
    globalThis.process = node;
    delete globalThis.window;
  }
}

class Mechanism extends Scene {
  constructor({bodies, joints, loops, gravity, setting, balls, planes, contact, motors, couplings = []}) {
    super(gravity, setting);
    this.forces = new JointForces({bodies, joints, motors});
    const material = contact && physics.createMaterial(contact.friction, contact.friction, contact.restitution);
    this.made = bodies.map((known, i) => {
      const body = this.addBody(known, setting);
      if (balls) this.attach(body, {type: 'ball', radius: balls[i]}, material);
      this.scene.addActor(body);
      setVelocities(body, this.vector(known.w), this.vector(known.v));
      return body;
    });
    for (const plane of planes ?? []) this.addPlane(plane, groundMaterial(plane, contact));
    this.joints = [...joints, ...loops].map((joint) => {
      // only the general joint has a drive along an axis
      const make = {
        revolute: PhysX.RevoluteJointCreate, prismatic: joint.friction ? PhysX.D6JointCreate : PhysX.PrismaticJointCreate,
        spherical: PhysX.SphericalJointCreate, fixed: PhysX.FixedJointCreate
      }[joint.type];
      const at = (index) => this.made[index] ?? PhysX.wrapPointer(0, PhysX.PxRigidActor);
      const [out, into] = framesOf(bodies, joint, 'x');
      const made = make.call(
          PhysX, physics, at(joint.parent), this.place(joint.parent_point, out), at(joint.child),
          this.place(joint.child_point, into));
      this.setLaws(made, joint);
      return made;
    });
    for (const coupling of couplings) this.addGear(gearOf('PhysX', joints, coupling), joints);
  }
  // Friction is a drive to velocity 0 with a largest force.
  setLaws(made, {type, limits, friction}) {
    if (friction) made.setConstraintFlag(PhysX.PxConstraintFlagEnum.eDRIVE_LIMITS_ARE_FORCES, true);
    if (type === 'revolute') {
      const flag = PhysX.PxRevoluteJointFlagEnum;
      if (limits) made.setLimit(this.limitOf(limits, type)), made.setRevoluteJointFlag(flag.eLIMIT_ENABLED, true);
      if (friction) made.setDriveForceLimit(friction), made.setRevoluteJointFlag(flag.eDRIVE_ENABLED, true);
    } else if (friction) {
      const {eX} = PhysX.PxD6AxisEnum, {eFREE, eLIMITED} = PhysX.PxD6MotionEnum;
      made.setMotion(eX, limits ? eLIMITED : eFREE);
      if (limits) made.setLinearLimit(eX, this.limitOf(limits, type));
      made.setDrive(PhysX.PxD6DriveEnum.eX, this.take(new PhysX.PxD6JointDrive(0, 1e9, friction)));
    } else if (limits) {
      made.setLimit(this.limitOf(limits, type));
      made.setPrismaticJointFlag(PhysX.PxPrismaticJointFlagEnum.eLIMIT_ENABLED, true);
    }
  }
  limitOf(limits, type) {
    const isHinge = type === 'revolute', {lower, upper} = isHinge ? angleBounds('PhysX', limits) : boundsOf(limits);
    const made = this.take(
        isHinge ? new PhysX.PxJointAngularLimitPair(lower, upper) :
                  new PhysX.PxJointLinearLimitPair(lower, upper, this.take(new PhysX.PxSpring(0, 0))));
    made.restitution = limits.restitution;
    return made;
  }
  // Frames of a gear have the axis of their joint as x. PhysX's ratios are negative for bodies that rotate in the same
  // sense.
  addGear({first, second, ratio, pinion, rack, travel}, joints) {
    const one = pinion ?? first, other = rack ?? second;
    const make = rack ? PhysX.RackAndPinionJointCreate : PhysX.GearJointCreate;
    const ends = [one, other].flatMap(({child, child_point: point, child_axes: [axis]}) => [
      this.made[child], this.place(point, frameAbout(rotate(frameAbout(axis), [1, 0, 0]), axis))
    ]);
    const gear = make.call(PhysX, physics, ...ends), [a, b] = [one, other].map((joint) => this.joints[joints.indexOf(joint)]);
    if (rack) gear.setJoints(a, b), gear.setRatio(-1 / travel);
    else gear.setHinges(a, b), gear.setGearRatio(-ratio);
    this.joints.push(gear);
  }
  motions() { return this.made.map(motionOf); }
  apply(index, force, torque) { this.load(this.made[index], force, torque); }
  step(h) {
    this.forces.applyTo(this, h);
    super.step(h);
  }
  free() {
    for (const joint of this.joints) joint.release();
    for (const body of [...this.made, ...this.grounds]) body.release();
    this.leave();
  }
}

// PhysX applies the combine mode with the larger number, here the plane's.
function groundMaterial(plane, contact) {
  const material = physics.createMaterial(plane.friction, plane.friction, plane.restitution);
  const {eMAX, eMIN} = PhysX.PxCombineModeEnum;
  material.setFrictionCombineMode(isMaximum(contact, plane, 'friction') ? eMAX : eMIN);
  material.setRestitutionCombineMode(isMaximum(contact, plane, 'restitution') ? eMAX : eMIN);
  return material;
}

await serve({
  engine: 'physx',
  packageName: 'physx-js-webidl',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term; angular damping 0.05; slow bodies sleep; speed limit 100 rad/s; no bounce below 2 m/s',
    best: 'gyroscopic term on (eENABLE_GYROSCOPIC_FORCES); no damping, no sleeping, no speed limit; bounces from 0.01 m/s on'
  },
  joints: ['revolute', 'prismatic', 'spherical', 'fixed'],
  loops: ['revolute', 'spherical'],
  laws: ['limits', 'restitution', 'friction', 'springs', 'motors', 'couplings'],
  contacts: true,
  shapes: ['ball', 'capsule', 'box', 'polyhedron', 'several'],
  load: async () => {
    PhysX = await started();
    const version = PhysX.PHYSICS_VERSION;
    const foundation = PhysX.CreateFoundation(version, new PhysX.PxDefaultAllocator(), new PhysX.PxDefaultErrorCallback());
    tolerances = new PhysX.PxTolerancesScale();
    physics = PhysX.CreatePhysics(version, foundation, tolerances);
    PhysX.InitExtensions(physics);
    return {World, Mechanism};
  }
});
