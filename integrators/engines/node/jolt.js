// Jolt Physics.
import {serve, Unsupported} from './serve.js';

let Jolt;

const array = (v) => [v.GetX(), v.GetY(), v.GetZ()];
const moving = 0, still = 1;

class World {
  constructor(body) {
    this.taken = [];
    const settings = new Jolt.JoltSettings();
    const pairs = new Jolt.ObjectLayerPairFilterTable(2);
    pairs.EnableCollision(still, moving);
    const phases = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
    phases.MapObjectToBroadPhaseLayer(moving, new Jolt.BroadPhaseLayer(moving));
    phases.MapObjectToBroadPhaseLayer(still, new Jolt.BroadPhaseLayer(still));
    settings.mObjectLayerPairFilter = pairs;
    settings.mBroadPhaseLayerInterface = phases;
    settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(phases, 2, pairs, 2);
    settings.mMaxWorkerThreads = 0;
    this.jolt = new Jolt.JoltInterface(settings);
    Jolt.destroy(settings);
    this.system = this.jolt.GetPhysicsSystem();
    this.bodies = this.system.GetBodyInterface();
    this.setGravity(body.gravity);
    const [w, x, y, z] = body.q;
    const made = new Jolt.BodyCreationSettings(
        this.shapeOf(body), this.place(body.p), this.take(new Jolt.Quat(x, y, z, w)), Jolt.EMotionType_Dynamic, moving);
    made.mOverrideMassProperties = Jolt.EOverrideMassProperties_CalculateInertia;
    made.mMassPropertiesOverride.mMass = body.mass;
    made.mLinearVelocity = this.vector(body.v);
    made.mAngularVelocity = this.vector(body.w);
    if (body.setting === 'best') {
      made.mApplyGyroscopicForce = true;
      made.mAllowSleeping = false;
      made.mLinearDamping = made.mAngularDamping = 0;
      made.mMaxLinearVelocity = made.mMaxAngularVelocity = 1e30;
    }
    if (body.planes.length) made.mRestitution = body.planes[0].restitution, made.mFriction = body.planes[0].friction;
    this.body = this.bodies.CreateBody(made);
    Jolt.destroy(made);
    // in place of the inertia of the shape
    const inverse = this.vector(body.moments.map((x) => 1 / x));
    this.body.GetMotionProperties().SetInverseInertia(inverse, this.take(new Jolt.Quat(0, 0, 0, 1)));
    this.bodies.AddBody(this.body.GetID(), Jolt.EActivation_Activate);
    for (const plane of body.planes) this.addPlane(plane);
    if (body.pivot) {
      const joint = new Jolt.PointConstraintSettings();
      joint.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
      joint.mPoint1 = this.place(body.pivot), joint.mPoint2 = this.place([0, 0, 0]);
      this.system.AddConstraint(joint.Create(this.body, Jolt.Body.prototype.sFixedToWorld));
    }
  }
  // What is made of numbers alone has to be given back, once nobody looks at it any more.
  take(object) {
    this.taken.push(object);
    return object;
  }
  vector(a) { return this.take(new Jolt.Vec3(...a)); }
  place(a) { return this.take(new Jolt.RVec3(...a)); }
  shapeOf(body) {
    if (body.ball || !body.hull.length) return new Jolt.SphereShape(body.ball ?? 0.1);
    const settings = new Jolt.ConvexHullShapeSettings();
    for (const corner of body.hull) settings.mPoints.push_back(this.vector(corner));
    // Jolt rounds edges off; this body has none that are round
    settings.mMaxConvexRadius = 0;
    const made = settings.Create();
    if (made.HasError()) throw new Unsupported(`Jolt makes no hull of it: ${made.GetError().c_str()}`);
    return made.Get();
  }
  addPlane({normal, offset, restitution, friction}) {
    const shape = new Jolt.PlaneShape(this.take(new Jolt.Plane(this.vector(normal), -offset)), undefined, 1e4);
    const settings = new Jolt.BodyCreationSettings(
        shape, this.place([0, 0, 0]), this.take(new Jolt.Quat(0, 0, 0, 1)), Jolt.EMotionType_Static, still);
    settings.mRestitution = restitution, settings.mFriction = friction;
    this.bodies.AddBody(this.bodies.CreateBody(settings).GetID(), Jolt.EActivation_DontActivate);
    Jolt.destroy(settings);
  }
  motion() {
    const q = this.body.GetRotation();
    return {
      q: [q.GetW(), q.GetX(), q.GetY(), q.GetZ()], w: array(this.body.GetAngularVelocity()),
      p: array(this.body.GetCenterOfMassPosition()), v: array(this.body.GetLinearVelocity())
    };
  }
  setVelocities(w, v) {
    const id = this.body.GetID();
    this.bodies.ActivateBody(id);
    this.body.SetAngularVelocity(this.vector(w)), this.body.SetLinearVelocity(this.vector(v));
  }
  setGravity(g) { this.system.SetGravity(this.vector(g)); }
  apply(force, torque) {
    const push = new Jolt.Vec3(...force), turn = new Jolt.Vec3(...torque);
    this.bodies.ActivateBody(this.body.GetID());
    this.body.AddForce(push), this.body.AddTorque(turn);
    Jolt.destroy(push), Jolt.destroy(turn);
  }
  step(h) { this.jolt.Step(h, 1); }
  mass() { return 1 / this.body.GetMotionProperties().GetInverseMass(); }
  moments() {
    return array(this.body.GetMotionProperties().GetInverseInertiaDiagonal()).map((x) => 1 / x);
  }
  free() {
    for (const object of this.taken) Jolt.destroy(object);
    Jolt.destroy(this.jolt);
  }
}

await serve({
  engine: 'jolt',
  packageName: 'jolt-physics',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term; damping 0.05 of either velocity; a slow body falls asleep; up to 47 rad/s and 500 m/s',
    best: 'the gyroscopic term on (mApplyGyroscopicForce); no damping, never asleep, no limit of speed'
  },
  load: async () => {
    Jolt = await (await import('jolt-physics/wasm-compat')).default();
    return World;
  }
});
