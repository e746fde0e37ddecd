#include "integrators/points/point_motion.h"

#include "motion/exact_body.h"

namespace polhode {

void PointMotion::place(const Quaternion<double>& q, const Vector3<double>& angular_velocity_W,
                        const Vector3<double>& position_W, const Vector3<double>& velocity_W, double* y) const {
    const int n = body_->count();
    for (int i = 0; i < n; ++i) {
        const Vector3<double> x = rotate(q, body_->rest_B[i]);
        put(y, 3 * i, position_W + x);
        put(y, 3 * (n + i), velocity_W + cross(angular_velocity_W, x));
    }
}

Vector3<double> PointMotion::initial(double* y) const {
    const ExactBody<double>& start = problem_->body;
    const Vector3<double> w = rotate(start.q, start.angular_velocity_B);
    place(start.q, w, start.position_W, start.velocity_W, y);
    return w;
}

PointMotion::Reading PointMotion::read(const double* y, bool attitude) const {
    const int n = body_->count();
    Reading reading;
    reading.cloud = cloud_of(body_->point_mass, y, n);
    for (int i = 0; i < n; ++i) reading.velocity_W = reading.velocity_W + vector_at(y, 3 * (n + i));
    reading.velocity_W = (1.0 / n) * reading.velocity_W;
    Vector3<double> L;
    for (int i = 0; i < n; ++i)
        L = L + body_->point_mass *
                    cross(vector_at(y, 3 * i) - reading.cloud.center, vector_at(y, 3 * (n + i)) - reading.velocity_W);
    reading.angular_velocity_W = inverse(reading.cloud.inertia) * L;
    if (attitude) reading.q = best_rotation(body_->rest_B, y, reading.cloud.center);
    return reading;
}

std::optional<Vector3<double>> PointMotion::enter(const Segment& segment, double* y) {
    segment_ = &segment;
    const Forcing<double>& f = segment.forcing;
    loaded_ =
        f.any_torque() ||
        (!f.pivoted && (f.has_body_force || f.has_translational_drag || !(f.acceleration_W == Vector3<double>())));
    if (segment.impulses.empty()) return {};
    const Reading now = read(y, true);
    const Quaternion<double> q = now.q * problem_->body.q_BP;
    Vector3<double> w = rotate_back(q, now.angular_velocity_W), p = now.cloud.center, v = now.velocity_W;
    const ExactBody<double>& body = problem_->body;
    for (const PosedImpulse<double>& impulse : segment.impulses)
        if (problem_->formulation == Formulation::full)
            apply(impulse, problem_->body.full_inertia, body.mass, body.pivoted, w, q, p, v);
        else
            apply(impulse, problem_->body.principal_inertia, body.mass, body.pivoted, w, q, p, v);
    if (body.pivoted) pivoted_center(q, w, f.arm, p, v);
    const Vector3<double> w_W = rotate(q, w);
    place(now.q, w_W, p, v, y);
    return w_W;
}

void PointMotion::add_loads(double t, const double* y, double* a) const {
    if (!loaded_) return;
    const Forcing<double>& f = segment_->forcing;
    const int n = body_->count();
    const bool turned = f.any_torque(), attitude = turned || f.has_body_force;
    Vector3<double> linear, angular, origin;
    if (attitude || f.has_translational_drag) {
        const Reading now = read(y, attitude);
        const Quaternion<double> q = now.q * problem_->body.q_BP;
        if (turned) {
            const Vector3<double> w = rotate_back(q, now.angular_velocity_W);
            const Vector3<double> tau = rotate(q, torque(f, t, w, q, now.cloud.center, now.velocity_W));
            Matrix3<double> tensor = now.cloud.inertia;
            if (f.pivoted) tensor = tensor + parallel_axis(problem_->body.mass, now.cloud.center);
            angular = inverse(tensor) * tau;
            if (!f.pivoted) origin = now.cloud.center;
        }
        if (f.has_body_force) linear = rotate(q, f.specific_force);
        if (f.has_translational_drag) linear = linear - f.specific_drag * now.velocity_W;
    }
    linear = f.pivoted ? Vector3<double>() : linear + f.acceleration_W;
    for (int i = 0; i < n; ++i) {
        Vector3<double> sum = vector_at(a, 3 * i) + linear;
        if (turned) sum = sum + cross(angular, vector_at(y, 3 * i) - origin);
        put(a, 3 * i, sum);
    }
}

Sample PointMotion::sample(double t, const double* y) const {
    const Reading now = read(y, true);
    Sample sample;
    sample.t = t, sample.q = now.q;
    sample.angular_velocity_B = rotate_back(now.q, now.angular_velocity_W);
    sample.position_W = now.cloud.center, sample.velocity_W = now.velocity_W;
    return sample;
}

}  // namespace polhode
