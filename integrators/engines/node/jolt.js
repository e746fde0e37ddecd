// Jolt Physics.
import {serve, JointForces, alongY, angleBounds, boundsOf, framesOf, gearOf, halfHeightOf, rotate, Unsupported} from './serve.js';

let Jolt;

const array = (v) => [v.GetX(), v.GetY(), v.GetZ()];
const moving = 0, still = 1;

// Common base of World and Mechanism.
class Taking {
  start({gravity, setting}, collide = false) {
    this.taken = [];
    const settings = new Jolt.JoltSettings();
    const pairs = new Jolt.ObjectLayerPairFilterTable(2);
    pairs.EnableCollision(still, moving);
    if (collide) pairs.EnableCollision(moving, moving);
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
    this.setGravity(gravity);
    if (setting !== 'best') return;
    const physics = this.system.GetPhysicsSettings();
    physics.mMinVelocityForRestitution = 1e-2;
    this.system.SetPhysicsSettings(physics);
  }
  addBody(body, setting, shape, change = () => {}) {
    const [w, x, y, z] = body.q;
    const made = new Jolt.BodyCreationSettings(
        shape, this.place(body.p), this.take(new Jolt.Quat(x, y, z, w)), Jolt.EMotionType_Dynamic, moving);
    made.mOverrideMassProperties = Jolt.EOverrideMassProperties_CalculateInertia;
    made.mMassPropertiesOverride.mMass = body.mass;
    made.mLinearVelocity = this.vector(body.v);
    made.mAngularVelocity = this.vector(body.w);
    if (setting === 'best') {
      made.mApplyGyroscopicForce = true;
      made.mAllowSleeping = false;
      made.mLinearDamping = made.mAngularDamping = 0;
      made.mMaxLinearVelocity = made.mMaxAngularVelocity = 1e30;
    }
    change(made);
    const created = this.bodies.CreateBody(made);
    Jolt.destroy(made);
    // overrides the inertia of the shape
    const inverse = this.vector(body.moments.map((x) => 1 / x));
    created.GetMotionProperties().SetInverseInertia(inverse, this.take(new Jolt.Quat(0, 0, 0, 1)));
    this.bodies.AddBody(created.GetID(), Jolt.EActivation_Activate);
    return created;
  }
  // Registers a temporary object of numbers. It must be freed explicitly when it is no longer used.
  take(object) {
    this.taken.push(object);
    return object;
  }
  vector(a) { return this.take(new Jolt.Vec3(...a)); }
  place(a) { return this.take(new Jolt.RVec3(...a)); }
  addPlane({normal, offset, restitution, friction}) {
    const shape = new Jolt.PlaneShape(this.take(new Jolt.Plane(this.vector(normal), -offset)), undefined, 1e4);
    const settings = new Jolt.BodyCreationSettings(
        shape, this.place([0, 0, 0]), this.take(new Jolt.Quat(0, 0, 0, 1)), Jolt.EMotionType_Static, still);
    settings.mRestitution = restitution, settings.mFriction = friction;
    this.bodies.AddBody(this.bodies.CreateBody(settings).GetID(), Jolt.EActivation_DontActivate);
    Jolt.destroy(settings);
  }
  setGravity(g) { this.system.SetGravity(this.vector(g)); }
  load(body, force, torque) {
    const push = new Jolt.Vec3(...force), turn = new Jolt.Vec3(...torque);
    this.bodies.ActivateBody(body.GetID());
    body.AddForce(push), body.AddTorque(turn);
    Jolt.destroy(push), Jolt.destroy(turn);
  }
  step(h) { this.jolt.Step(h, 1); }
  free() {
    for (const object of this.taken) Jolt.destroy(object);
    Jolt.destroy(this.jolt);
  }
  ground() { return Jolt.JoltInterface.prototype.sGetFixedToWorldBody(); }
}

function motionOf(body) {
  const q = body.GetRotation();
  return {
    q: [q.GetW(), q.GetX(), q.GetY(), q.GetZ()], w: array(body.GetAngularVelocity()),
    p: array(body.GetCenterOfMassPosition()), v: array(body.GetLinearVelocity())
  };
}

class World extends Taking {
  constructor(body) {
    super();
    this.start(body);
    this.body = this.addBody(body, body.setting, this.shapeOf(body), (made) => {
      if (body.planes.length) made.mRestitution = body.planes[0].restitution, made.mFriction = body.planes[0].friction;
    });
    for (const plane of body.planes) this.addPlane(plane);
    if (body.pivot) {
      const joint = new Jolt.PointConstraintSettings();
      joint.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
      joint.mPoint1 = this.place(body.pivot), joint.mPoint2 = this.place([0, 0, 0]);
      this.system.AddConstraint(joint.Create(this.body, this.ground()));
    }
  }
  shapeOf({shapes, ball}) {
    if (!shapes.length || ball) return new Jolt.SphereShape(ball ?? 0.1);
    const all = new Jolt.StaticCompoundShapeSettings();
    for (const shape of shapes) {
      const [w, x, y, z] = shape.type === 'box' ? shape.orientation : alongY(shape);
      const isPlaced = shape.type !== 'polyhedron';
      const place = this.vector(isPlaced ? shape.position : [0, 0, 0]);
      const turn = this.take(isPlaced ? new Jolt.Quat(x, y, z, w) : new Jolt.Quat(0, 0, 0, 1));
      if (shapes.length === 1)
        return this.centered(
            isPlaced ? new Jolt.RotatedTranslatedShapeSettings(place, turn, this.convex(shape)) : this.convex(shape));
      all.AddShape(place, turn, this.convex(shape), 0);
    }
    return this.centered(all);
  }
  // no rounding of edges, which is Jolt's default
  convex(shape) {
    if (shape.type === 'ball') return new Jolt.SphereShapeSettings(shape.radius);
    if (shape.type === 'capsule') return new Jolt.CapsuleShapeSettings(shape.half_height, shape.radius);
    if (shape.type === 'box') return new Jolt.BoxShapeSettings(this.vector(shape.half_extents), 0);
    if (shape.type !== 'polyhedron') return new Jolt.CylinderShapeSettings(halfHeightOf(shape), shape.radius, 0);
    const settings = new Jolt.ConvexHullShapeSettings();
    for (const corner of shape.corners) settings.mPoints.push_back(this.vector(corner));
    settings.mMaxConvexRadius = 0;
    return settings;
  }
  // Jolt takes the centre of the shape for the centre of mass
  centered(settings) {
    const made = settings.Create();
    if (made.HasError()) throw new Unsupported(`Jolt cannot build the shape: ${made.GetError().c_str()}`);
    const shape = made.Get(), center = array(shape.GetCenterOfMass());
    return new Jolt.OffsetCenterOfMassShape(shape, this.vector(center.map((x) => -x)));
  }
  motion() { return motionOf(this.body); }
  setVelocities(w, v) {
    const id = this.body.GetID();
    this.bodies.ActivateBody(id);
    this.body.SetAngularVelocity(this.vector(w)), this.body.SetLinearVelocity(this.vector(v));
  }
  apply(force, torque) { this.load(this.body, force, torque); }
  mass() { return 1 / this.body.GetMotionProperties().GetInverseMass(); }
  moments() {
    return array(this.body.GetMotionProperties().GetInverseInertiaDiagonal()).map((x) => 1 / x);
  }
}

class Mechanism extends Taking {
  constructor({bodies, joints, loops, gravity, setting, balls, planes, contact, motors, couplings = []}) {
    super();
    this.start({gravity, setting}, Boolean(balls));
    this.forces = new JointForces({bodies, joints, motors});
    this.made = bodies.map((known, i) => this.addBody(known, setting, new Jolt.SphereShape(balls ? balls[i] : 0.1)));
    if (balls) this.addContacts(planes, contact);
    const constraints = new Map([...joints, ...loops].map((joint) => {
      const at = (index) => this.made[index] ?? this.ground();
      const constraint = this.settingsOf(bodies, joint).Create(at(joint.parent), at(joint.child));
      this.system.AddConstraint(constraint);
      return [joint, constraint];
    }));
    for (const coupling of couplings) this.addGear(gearOf('Jolt', joints, coupling), constraints);
  }
  // Jolt's ratio of gears is minus the rotation of the first body per rotation of the second; that of a rack is the
  // rotation of the pinion per displacement of the rack. The faster gear is the first. Jolt's gears exert the same torque
  // on both bodies, whatever the ratio (GearConstraintPart::ApplyVelocityStep).
  addGear({first, second, ratio, pinion, rack, travel}, constraints) {
    const isSwapped = !rack && Math.abs(ratio) >= 1;
    const [one, other] = rack ? [pinion, rack] : isSwapped ? [second, first] : [first, second];
    const settings = rack ? new Jolt.RackAndPinionConstraintSettings() : new Jolt.GearConstraintSettings();
    settings.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
    const axes = [one, other].map(({child_axes: [axis]}) => this.vector(axis));
    if (rack) [settings.mHingeAxis, settings.mSliderAxis] = axes;
    else [settings.mHingeAxis1, settings.mHingeAxis2] = axes;
    settings.mRatio = rack ? 1 / travel : isSwapped ? -ratio : -1 / ratio;
    const gear = settings.Create(this.made[one.child], this.made[other.child]);
    // the joints correct the drift: Jolt compares their angles between -pi and pi, which needs a whole ratio of gears
    if (rack || Number.isInteger(settings.mRatio))
      Jolt.castObject(gear, rack ? Jolt.RackAndPinionConstraint : Jolt.GearConstraint)
          .SetConstraints(constraints.get(one), constraints.get(other));
    this.system.AddConstraint(gear);
  }
  apply(index, force, torque) { this.load(this.made[index], force, torque); }
  step(h) {
    this.forces.applyTo(this, h);
    super.step(h);
  }
  setLaws(made, {type, limits, friction}) {
    if (limits) {
      const {lower, upper} = type === 'revolute' ? angleBounds('Jolt', limits) : boundsOf(limits);
      made.mLimitsMin = lower, made.mLimitsMax = upper;
    }
    if (!friction) return;
    if (type === 'revolute') made.mMaxFrictionTorque = friction;
    else made.mMaxFrictionForce = friction;
  }
  // a listener replaces Jolt's rules for two bodies by the coefficients of the pair
  addContacts(planes, contact) {
    for (const plane of planes) this.addPlane(plane);
    const listener = this.take(new Jolt.ContactListenerJS());
    const set = (first, second, manifold, settings) => {
      const isStill = [first, second].some((body) => Jolt.wrapPointer(body, Jolt.Body).IsStatic());
      const {friction, restitution} = isStill ? planes[0] : contact, made = Jolt.wrapPointer(settings, Jolt.ContactSettings);
      made.mCombinedFriction = friction, made.mCombinedRestitution = restitution;
    };
    listener.OnContactValidate = () => Jolt.ValidateResult_AcceptAllContactsForThisBodyPair;
    listener.OnContactAdded = listener.OnContactPersisted = set;
    listener.OnContactRemoved = () => {};
    this.system.SetContactListener(listener);
  }
  settingsOf(bodies, joint) {
    const settings = {
      revolute: Jolt.HingeConstraintSettings, prismatic: Jolt.SliderConstraintSettings,
      spherical: Jolt.PointConstraintSettings, fixed: Jolt.FixedConstraintSettings
    };
    const made = new settings[joint.type]();
    made.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
    made.mPoint1 = this.place(joint.parent_point), made.mPoint2 = this.place(joint.child_point);
    this.setLaws(made, joint);
    framesOf(bodies, joint).forEach((frame, i) => {
      const axis = (name, along) => made[name + (i + 1)] = this.vector(rotate(frame, along));
      if (joint.type === 'revolute') axis('mHingeAxis', [0, 0, 1]), axis('mNormalAxis', [1, 0, 0]);
      if (joint.type === 'prismatic') axis('mSliderAxis', [0, 0, 1]), axis('mNormalAxis', [1, 0, 0]);
      if (joint.type === 'fixed') axis('mAxisX', [1, 0, 0]), axis('mAxisY', [0, 1, 0]);
    });
    return made;
  }
  motions() { return this.made.map(motionOf); }
}

await serve({
  engine: 'jolt',
  packageName: 'jolt-physics',
  precision: 'binary32',
  settings: {
    default: 'no gyroscopic term; linear and angular damping 0.05; slow bodies sleep; limits 47 rad/s and 500 m/s; no bounce below 1 m/s',
    best: 'gyroscopic term on (mApplyGyroscopicForce); no damping, no sleeping, no speed limit; bounces from 0.01 m/s on'
  },
  joints: ['revolute', 'prismatic', 'spherical', 'fixed'],
  loops: ['revolute', 'spherical'],
  laws: ['limits', 'friction', 'springs', 'motors', 'couplings'],
  contacts: true,
  shapes: ['ball', 'capsule', 'cylinder', 'disc', 'box', 'polyhedron', 'several'],
  load: async () => {
    Jolt = await (await import('jolt-physics/wasm-compat')).default();
    return {World, Mechanism};
  }
});
