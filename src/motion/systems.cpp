#include "motion/systems.h"

#include "motion/contact.h"

namespace polhode {

static_assert(System<PrincipalAxisRotation> && System<FreeRotation> && System<LoadedRotation> && System<LoadedMotion> &&
              System<FullMotion> && System<ErasedSystem>);

Sample BodySystem::rotated(double t, const Vector3<double>& w, const Quaternion<double>& q) const {
    const Problem& problem = *problem_;
    Sample sample;
    sample.t = t;
    const bool same_axes = problem.body.q_BP == Quaternion<double>{};
    sample.q = same_axes ? q : q * conjugate(problem.body.q_BP);
    sample.angular_velocity_B = same_axes ? w : rotate(problem.body.q_BP, w);
    return sample;
}

Sample BodySystem::placed(double t, const Vector3<double>& w, const Quaternion<double>& q) const {
    const Problem& problem = *problem_;
    Sample sample = rotated(t, w, q);
    if (problem.body.pivoted) {
        pivoted_center(sample.q, sample.angular_velocity_B, problem.body.arm, sample.position_W, sample.velocity_W);
    } else {
        const Segment& segment = problem.segments[segment_at(problem, t)];
        translated(segment, t - segment.begin, sample.position_W, sample.velocity_W);
    }
    return sample;
}

void BodySystem::apply(const PosedImpulse<double>& impulse, Vector3<double>& w, const Quaternion<double>& q,
                       const Vector3<double>& p, Vector3<double>& v) const {
    const ExactBody<double>& body = problem_->body;
    if (problem_->formulation == Formulation::full)
        polhode::apply(impulse, problem_->body.full_inertia, body.mass, body.pivoted, w, q, p, v);
    else
        polhode::apply(impulse, problem_->body.principal_inertia, body.mass, body.pivoted, w, q, p, v);
}

void PrincipalAxisRotation::initial(double* y) const {
    y[0] = dot(problem_->body.axis, problem_->body.initial_angular_velocity), y[1] = 1, y[2] = 0;
}

bool PrincipalAxisRotation::enter(const Segment& segment, double* y) {
    for (const PosedImpulse<double>& impulse : segment.impulses) {
        const Vector3<double> before = angular_velocity(y);
        Vector3<double> w = before, p, v;
        apply(impulse, w, attitude(y), p, v);
        y[0] += dot(problem_->body.axis, w - before);
    }
    static_cast<Equations&>(*this) = segment.about_axis;
    return !segment.impulses.empty();
}

Sample PrincipalAxisRotation::motion(double t, const double* y) const {
    return placed(t, angular_velocity(y), attitude(y));
}

void PrincipalAxisRotation::scales(double* scales) const {
    scales[0] = problem_->scales.angular_velocity;
    scales[1] = scales[2] = 1;
}

void PrincipalAxisRotation::state(const Sample& sample, double* y) const {
    const Quaternion<double> turned = conjugate(problem_->body.initial_q) * (sample.q * problem_->body.q_BP);
    y[0] = dot(problem_->body.axis, rotate_back(problem_->body.q_BP, sample.angular_velocity_B));
    y[1] = turned.w, y[2] = dot(problem_->body.axis, vector_part(turned));
}

Quaternion<double> PrincipalAxisRotation::attitude(const double* y) const {
    const Vector3<double>& e = problem_->body.axis;
    return problem_->body.initial_q * Quaternion<double>{y[1], y[2] * e[0], y[2] * e[1], y[2] * e[2]};
}

template <class BodyEquations>
void QuaternionSystem<BodyEquations>::initial(double* y) const {
    set_rotation(y, problem_->body.initial_angular_velocity, problem_->body.initial_q);
    if constexpr (has_translation) set_translation(y, problem_->body.position_W, problem_->body.velocity_W);
}

template <class BodyEquations>
bool QuaternionSystem<BodyEquations>::enter(const Segment& segment, double* y) {
    for (const PosedImpulse<double>& impulse : segment.impulses) {
        Vector3<double> w = angular_velocity(y), p, v;
        const Quaternion<double> q = attitude(y);
        if constexpr (has_translation) p = position(y), v = velocity(y);
        apply(impulse, w, q, p, v);
        set_rotation(y, w, q);
        if constexpr (has_translation) {
            const Vector3<double> place = p;
            if (problem_->body.pivoted) pivoted_center(q, w, segment.forcing.arm, p, v);
            set_translation(y, place, v);
        }
    }
    static_cast<Equations&>(*this) = equations(*problem_, segment);
    return !segment.impulses.empty();
}

template <class BodyEquations>
Sample QuaternionSystem<BodyEquations>::motion(double t, const double* y) const {
    if constexpr (has_translation) {
        Sample sample = rotated(t, angular_velocity(y), attitude(y));
        sample.position_W = position(y), sample.velocity_W = velocity(y);
        return sample;
    } else {
        return placed(t, angular_velocity(y), attitude(y));
    }
}

template <class BodyEquations>
void QuaternionSystem<BodyEquations>::scales(double* scales) const {
    const Scales& s = problem_->scales;
    const auto all = [](double x) { return Vector3<double>(x, x, x); };
    set_rotation(scales, all(s.angular_velocity), {1, 1, 1, 1});
    if constexpr (has_translation) set_translation(scales, all(s.position), all(s.velocity));
}

template <class BodyEquations>
void QuaternionSystem<BodyEquations>::state(const Sample& sample, double* y) const {
    set_rotation(y, rotate_back(problem_->body.q_BP, sample.angular_velocity_B), sample.q * problem_->body.q_BP);
    if constexpr (has_translation) set_translation(y, sample.position_W, sample.velocity_W);
}

template class QuaternionSystem<FreeEquations<double>>;
template class QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, false>>;
template class QuaternionSystem<LoadedEquations<double, PrincipalInertia<double>, true>>;
template class QuaternionSystem<LoadedEquations<double, FullInertia<double>, true>>;

Placement<double> placement_of(const double* y) {
    const Quaternion<double> q = normalized(FullMotion::attitude(y));
    return {q, FullMotion::position(y), FullMotion::velocity(y), rotate(q, FullMotion::angular_velocity(y))};
}

ImpactOutcome resolve_plane_impacts(const Problem& problem, double tolerance, double* y) {
    const Placement<double> at = placement_of(y);
    const std::vector<Contact<double>> touching = problem.body.geometry->contacts(at, tolerance);
    if (touching.empty()) return {};
    const Matrix3<double> inverse_inertia = problem.formulation == Formulation::full
                                                ? problem.body.full_inertia.inverse
                                                : diagonal(problem.body.principal_inertia.inverse_moments);
    ImpactBody<double> body{1 / problem.body.mass, polhode::rotated(inverse_inertia, at.q), at.position_W,
                            at.velocity_W, at.angular_velocity_W};
    const ImpactOutcome outcome = resolve_impact(body, touching);
    if (outcome.has_impact) {
        // add only the change, rotated back: components without an impulse then keep their bits
        FullMotion::set_rotation(
            y, FullMotion::angular_velocity(y) + rotate_back(at.q, body.angular_velocity_W - at.angular_velocity_W),
            FullMotion::attitude(y));
        FullMotion::set_translation(y, FullMotion::position(y), body.velocity_W);
    }
    return outcome;
}

}  // namespace polhode
