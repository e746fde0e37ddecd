#include "integrators/points/point_motion.h"

#include "motion/exact_body.h"

namespace polhode {

void PointMotion::set_points(const Quaternion<double>& q, const Vector3<double>& angular_velocity_W,
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
    set_points(start.q, w, start.position_W, start.velocity_W, y);
    return w;
}

PointMotion::RigidState PointMotion::compute_rigid_state(const double* y, bool attitude) const {
    const int n = body_->count();
    RigidState state;
    state.cloud = compute_cloud(body_->point_mass, y, n);
    for (int i = 0; i < n; ++i) state.velocity_W = state.velocity_W + vector_at(y, 3 * (n + i));
    state.velocity_W = (1.0 / n) * state.velocity_W;
    Vector3<double> L;
    for (int i = 0; i < n; ++i)
        L = L + body_->point_mass *
                    cross(vector_at(y, 3 * i) - state.cloud.center, vector_at(y, 3 * (n + i)) - state.velocity_W);
    state.angular_velocity_W = inverse(state.cloud.inertia) * L;
    if (attitude) state.q = best_rotation(body_->rest_B, y, state.cloud.center);
    return state;
}

std::optional<Vector3<double>> PointMotion::enter(const Segment& segment, double* y) {
    segment_ = &segment;
    const Forcing<double>& f = segment.forcing;
    has_loads_ =
        f.any_torque() ||
        (!f.pivoted && (f.has_body_force || f.has_translational_drag || !(f.acceleration_W == Vector3<double>())));
    if (segment.impulses.empty()) return {};
    const RigidState now = compute_rigid_state(y, true);
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
    set_points(now.q, w_W, p, v, y);
    return w_W;
}

void PointMotion::add_loads(double t, const double* y, double* a) const {
    if (!has_loads_) return;
    const Forcing<double>& f = segment_->forcing;
    const int n = body_->count();
    const bool has_torque = f.any_torque(), attitude = has_torque || f.has_body_force;
    Vector3<double> linear, angular, origin;
    if (attitude || f.has_translational_drag) {
        const RigidState now = compute_rigid_state(y, attitude);
        const Quaternion<double> q = now.q * problem_->body.q_BP;
        if (has_torque) {
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
        if (has_torque) sum = sum + cross(angular, vector_at(y, 3 * i) - origin);
        put(a, 3 * i, sum);
    }
}

Sample PointMotion::sample(double t, const double* y) const {
    const RigidState now = compute_rigid_state(y, true);
    Sample sample;
    sample.t = t, sample.q = now.q;
    sample.angular_velocity_B = rotate_back(now.q, now.angular_velocity_W);
    sample.position_W = now.cloud.center, sample.velocity_W = now.velocity_W;
    return sample;
}

}  // namespace polhode
