// PhysX 5.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import {serve} from './serve.js';

let PhysX, physics, tolerances;

const array = (v) => [v.x, v.y, v.z];
// of PxRigidBodyFlag; this build gives it no name
const gyroscopicForces = 1 << 10;

class World {
  constructor(body) {
    this.taken = [];
    const settings = this.take(new PhysX.PxSceneDesc(tolerances));
    settings.gravity = this.vector(body.gravity);
    settings.cpuDispatcher = this.dispatcher = PhysX.DefaultCpuDispatcherCreate(0);
    settings.filterShader = PhysX.DefaultFilterShader();
    this.scene = physics.createScene(settings);
    this.body = physics.createRigidDynamic(this.place(body.p, body.q));
    // a new body has a mass of 1 and its moments, and no shape to take them from
    this.body.setMass(body.mass);
    this.body.setMassSpaceInertiaTensor(this.vector(body.moments));
    if (body.setting === 'best') {
      this.body.setRigidBodyFlag(gyroscopicForces, true);
      this.body.setLinearDamping(0), this.body.setAngularDamping(0);
      this.body.setMaxLinearVelocity(1e16), this.body.setMaxAngularVelocity(1e16);
      this.body.setSleepThreshold(0), this.body.setStabilizationThreshold(0);
    }
    if (body.planes.length) this.addContact(body);
    this.scene.addActor(this.body);
    this.setVelocities(body.w, body.v);
    if (body.pivot) {
      const one = [1, 0, 0, 0];
      this.joint = PhysX.SphericalJointCreate(
          physics, this.body, this.place(body.pivot, one), PhysX.wrapPointer(0, PhysX.PxRigidActor),
          this.place([0, 0, 0], one));
    }
    this.push = this.vector([0, 0, 0]);
  }
  // What is made of numbers alone has to be given back.
  take(object) {
    this.taken.push(object);
    return object;
  }
  vector(a) { return this.take(new PhysX.PxVec3(...a)); }
  place(p, [w, x, y, z]) {
    return this.take(new PhysX.PxTransform(this.vector(p), this.take(new PhysX.PxQuat(x, y, z, w))));
  }
  addContact(body) {
    const {restitution, friction} = body.planes[0];
    const material = physics.createMaterial(friction, friction, restitution);
    const flags = this.take(new PhysX.PxShapeFlags(
        PhysX.PxShapeFlagEnum.eSIMULATION_SHAPE | PhysX.PxShapeFlagEnum.eSCENE_QUERY_SHAPE));
    const groups = this.take(new PhysX.PxFilterData(1, 1, 0, 0));
    const geometry = this.take(
        body.ball ? new PhysX.PxSphereGeometry(body.ball) : new PhysX.PxConvexMeshGeometry(this.mesh(body.hull)));
    const shape = physics.createShape(geometry, material, true, flags);
    shape.setSimulationFilterData(groups);
    this.body.attachShape(shape);
    this.grounds = body.planes.map(({normal, offset}) => {
      const ground = PhysX.CreatePlane(physics, this.take(new PhysX.PxPlane(this.vector(normal), -offset)), material);
      const side = this.take(new PhysX.PxArray_PxShapePtr(1));
      ground.getShapes(side.begin(), 1, 0);
      side.get(0).setSimulationFilterData(groups);
      this.scene.addActor(ground);
      return ground;
    });
  }
  mesh(corners) {
    const points = this.take(new PhysX.PxArray_PxVec3());
    for (const corner of corners) points.pushBack(this.vector(corner));
    const settings = this.take(new PhysX.PxConvexMeshDesc());
    settings.flags = this.take(new PhysX.PxConvexFlags(PhysX.PxConvexFlagEnum.eCOMPUTE_CONVEX));
    settings.points.count = points.size(), settings.points.stride = 12, settings.points.data = points.begin();
    return PhysX.CreateConvexMesh(this.take(new PhysX.PxCookingParams(tolerances)), settings);
  }
  motion() {
    const {p, q} = this.body.getGlobalPose();
    return {
      q: [q.w, q.x, q.y, q.z], p: array(p), w: array(this.body.getAngularVelocity()),
      v: array(this.body.getLinearVelocity())
    };
  }
  setVelocities(w, v) {
    this.body.setAngularVelocity(this.vector(w), true), this.body.setLinearVelocity(this.vector(v), true);
  }
  setGravity(g) { this.scene.setGravity(this.vector(g)); }
  apply(force, torque) {
    const set = ([x, y, z]) => (this.push.x = x, this.push.y = y, this.push.z = z, this.push);
    this.body.addForce(set(force)), this.body.addTorque(set(torque));
  }
  step(h) {
    this.scene.simulate(h);
    this.scene.fetchResults(true);
  }
  mass() { return this.body.getMass(); }
  moments() { return array(this.body.getMassSpaceInertiaTensor()); }
  free() {
    this.joint?.release();
    this.body.release();
    for (const ground of this.grounds ?? []) ground.release();
    this.scene.release(), this.dispatcher.release?.();
    for (const object of this.taken.reverse()) PhysX.destroy(object);
  }
}

// This build is for browsers and refuses to start where it sees Node: it is shown a window while it starts.
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

await serve({
  engine: 'physx',
  packageName: 'physx-js-webidl',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term; damping 0.05 of w; a slow body falls asleep; up to 100 rad/s',
    best: 'eENABLE_GYROSCOPIC_FORCES; no damping, never asleep, no limit of speed'
  },
  load: async () => {
    PhysX = await started();
    const version = PhysX.PHYSICS_VERSION;
    const foundation = PhysX.CreateFoundation(version, new PhysX.PxDefaultAllocator(), new PhysX.PxDefaultErrorCallback());
    tolerances = new PhysX.PxTolerancesScale();
    physics = PhysX.CreatePhysics(version, foundation, tolerances);
    PhysX.InitExtensions(physics);
    return World;
  }
});
