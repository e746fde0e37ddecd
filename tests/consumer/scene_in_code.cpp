#include "scene_in_code.h"

#include <cmath>

using namespace polhode;

namespace {
const Vector3<double> initial_rate{0.5, 0, 1};  // rad/s, body axes
}  // namespace

Scene symmetric_body() {
    Scene scene;
    scene.name = "symmetric";
    scene.duration = duration;
    scene.body.inertia_B = diagonal(Vector3<double>(moment_A, moment_A, moment_C));
    scene.initial.angular_velocity = initial_rate;
    return scene;
}

Quaternion<double> symmetric_attitude(double t) {
    const Vector3<double> L{moment_A * initial_rate[0], moment_A * initial_rate[1], moment_C * initial_rate[2]};
    const double n = (moment_C - moment_A) * initial_rate[2] / moment_A;
    return rotation(L, std::sqrt(dot(L, L)) / moment_A * t) * rotation(Vector3<double>(0, 0, 1), -n * t);
}

Quaternion<double> rotation(const Vector3<double>& axis, double angle) {
    const double length = std::sqrt(dot(axis, axis)), s = std::sin(angle / 2) / length;
    return {std::cos(angle / 2), s * axis[0], s * axis[1], s * axis[2]};
}

double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
    const Quaternion<double> d = conjugate(a) * b;
    return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::fabs(d.w));
}

double worst_attitude_error(const Trajectory& trajectory) {
    double worst = trajectory.samples.empty() ? 4 : 0;
    for (const Sample& sample : trajectory.samples)
        worst = std::fmax(worst, angle_between(symmetric_attitude(sample.t), sample.q));
    return worst;
}
