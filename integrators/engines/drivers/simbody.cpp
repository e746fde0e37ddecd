// Simbody: a body on a Free mobilizer, or on a Ball at its pivot.
#include "integrators/engines/drivers/serve.h"
#include "integrators/engines/drivers/simbody_world.h"

namespace polhode::engines {
namespace {

SimbodyStart start_of(const Body& body) {
    if (!body.planes.empty()) throw Unsupported("Simbody's contacts are compliant: no coefficient of restitution");
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
    explicit SimbodyWorld(const Body& body) : system_(start_of(body)) {}

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

}  // namespace
}  // namespace polhode::engines

int main() {
    using namespace polhode::engines;
    return serve<SimbodyWorld>(
        {"simbody",
         SimbodySystem::version(),
         "binary64",
         {{"default", "Runge-Kutta-Merson with its own error control at the accuracy 1e-3, asked for a state every h"},
          {"best", "Runge-Kutta-Merson with the fixed step h"},
          {"gazebo",
           "the second semi-explicit Euler with its own error control, asked for a state every h, as Gazebo sets it "
           "up"}}});
}
