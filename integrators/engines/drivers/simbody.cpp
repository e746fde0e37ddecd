// Simbody: a body on a Free mobilizer, or on a Ball mobilizer at its pivot.
#include "integrators/engines/drivers/serve.h"
#include "integrators/engines/drivers/simbody_world.h"

namespace polhode::engines {
namespace {

SimbodyStart make_start(const Body& body) {
    if (!body.planes.empty())
        throw Unsupported("Simbody's contacts have no coefficient of restitution: they are compliant");
    SimbodyStart start{};
    start.mass = body.mass, start.setting = body.setting, start.pivoted = body.pivot.has_value();
    start.q[0] = body.q.w, start.q[1] = body.q.x, start.q[2] = body.q.y, start.q[3] = body.q.z;
    for (int i = 0; i < 3; ++i) {
        start.moments[i] = body.moments[i], start.w[i] = body.w[i], start.p[i] = body.p[i];
        start.v[i] = body.v[i], start.gravity[i] = body.gravity[i];
        if (body.pivot) start.pivot[i] = (*body.pivot)[i];
    }
    return start;
}

class SimbodyWorld {
  public:
    explicit SimbodyWorld(const Body& body) : system_(make_start(body)) {}

    Motion motion() const {
        double n[13];
        system_.motion(n);
        return {{n[0], n[1], n[2], n[3]}, vector_of(n + 4), vector_of(n + 7), vector_of(n + 10)};
    }
    void set_velocities(const Vector3<double>& w, const Vector3<double>& v) { system_.set_velocities(&w[0], &v[0]); }
    void set_gravity(const Vector3<double>& gravity) { system_.set_gravity(&gravity[0]); }
    void apply(const Vector3<double>& force, const Vector3<double>& torque) { system_.apply(&force[0], &torque[0]); }
    void step(double h) { system_.step(h); }
    double mass() const { return system_.mass(); }
    Vector3<double> moments() const {
        Vector3<double> three;
        system_.moments(&three[0]);
        return three;
    }

  private:
    SimbodySystem system_;
};

SimbodyJoint make_joint(const Mechanism& mechanism, const LinkJoint& joint) {
    Quaternion<double> frame;
    if (joint.type == "revolute") frame = frame_about(joint.axes_W[0]);
    if (joint.type == "prismatic")
        frame = frame_about(rotate(frame_about(joint.axes_W[0]), Vector3<double>(1, 0, 0)), joint.axes_W[0]);
    if (joint.type == "universal") {
        if (!joint.has_perpendicular_axes())
            throw Unsupported("Simbody supports only universal joints with perpendicular axes");
        frame = frame_about(cross(joint.axes_W[0], joint.axes_W[1]), joint.axes_W[0]);
    }
    SimbodyJoint plain{joint.type, joint.parent, joint.child, {}, {}, {}, {}};
    const Quaternion<double> out = conjugate(mechanism.attitude(joint.parent)) * frame,
                             in = conjugate(mechanism.attitude(joint.child)) * frame;
    std::copy_n(&joint.parent_point[0], 3, plain.parent_point),
        std::copy_n(&joint.child_point[0], 3, plain.child_point);
    const double q_out[] = {out.w, out.x, out.y, out.z}, q_in[] = {in.w, in.x, in.y, in.z};
    std::copy_n(q_out, 4, plain.parent_frame), std::copy_n(q_in, 4, plain.child_frame);
    return plain;
}

SimbodyMechanismStart make_start(const Mechanism& mechanism) {
    SimbodyMechanismStart start{};
    start.setting = mechanism.setting;
    std::copy_n(&mechanism.gravity[0], 3, start.gravity);
    for (const LinkBody& body : mechanism.bodies) {
        const auto& [q, w, p, v] = body.start;
        SimbodyLink link{body.mass,
                         {body.moments[0], body.moments[1], body.moments[2]},
                         {q.w, q.x, q.y, q.z, w[0], w[1], w[2], p[0], p[1], p[2], v[0], v[1], v[2]}};
        start.links.push_back(link);
    }
    for (const int i : mechanism.outward_order())
        start.joints.push_back(mechanism.parent_joint(i)
                                   ? make_joint(mechanism, *mechanism.parent_joint(i))
                                   : SimbodyJoint{"free", -1, i, {}, {}, {1, 0, 0, 0}, {1, 0, 0, 0}});
    for (const LinkJoint& loop : mechanism.loops) start.loops.push_back(make_joint(mechanism, loop));
    return start;
}

class SimbodyMechanism {
  public:
    explicit SimbodyMechanism(const Mechanism& mechanism)
        : system_(make_start(mechanism)), count_(mechanism.bodies.size()) {}

    std::vector<Motion> motions() const {
        std::vector<double> n(13 * count_);
        system_.motions(n.data());
        std::vector<Motion> all;
        for (const double* m = n.data(); m < n.data() + n.size(); m += 13)
            all.push_back({{m[0], m[1], m[2], m[3]}, vector_of(m + 4), vector_of(m + 7), vector_of(m + 10)});
        return all;
    }
    void apply(int index, const Vector3<double>& force, const Vector3<double>& torque) {
        system_.apply(index, &force[0], &torque[0]);
    }
    void step(double h) { system_.step(h); }

  private:
    SimbodyMechanismSystem system_;
    std::size_t count_;
};

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    return serve<SimbodyWorld, SimbodyMechanism>(
        {"simbody",
         SimbodySystem::version(),
         "binary64",
         {{"default", "Runge-Kutta-Merson with its own error control at accuracy 1e-3; state reported every h"},
          {"best", "Runge-Kutta-Merson at the fixed step h"},
          {"gazebo",
           "semi-explicit Euler 2 with its own error control, configured as in Gazebo; state reported every h"}},
         {"revolute", "prismatic", "spherical", "universal", "fixed"},
         {"revolute", "spherical"}});
}
