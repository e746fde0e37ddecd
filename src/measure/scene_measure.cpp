#include "measure/scene_measure.h"

#include "motion/formula_potential.h"

namespace polhode {
namespace {

template <class S>
std::variant<ExactBody<S>, MechanismMeasure<S>> kind_of(const Scene& scene) {
    if (is_mechanism(scene)) return MechanismMeasure<S>(scene);
    return exact_body<S>(scene);
}

}  // namespace

template <class S>
SceneMeasure<S>::SceneMeasure(const Scene& scene) : scene_(&scene), kind_(kind_of<S>(scene)) {
    for (const NamedBody& body : scene.bodies) centers_.push_back(cast<S>(body.body.center_of_mass));
    if (const auto* body = std::get_if<ExactBody<S>>(&kind_)) centers_.push_back(body->center);
}

template <class S>
bool SceneMeasure<S>::has(const Measure& measure) const {
    const auto* several = std::get_if<MechanismMeasure<S>>(&kind_);
    if (!several) return measure.of_one_body;
    return !several->is_tied_to_world() || (measure.needs & known_free_system) == 0;
}

template <class S>
unsigned SceneMeasure<S>::needs(const Measure& measure) const {
    const bool whole = is_of_several() && measure.whole_error && (measure.needs & known_angular_velocity) != 0;
    return measure.needs | (whole ? known_center : 0U);
}

template <class S>
Vector3<S> SceneMeasure<S>::start_W() const {
    const auto* body = std::get_if<ExactBody<S>>(&kind_);
    if (!body) return {};
    return body->pivoted ? rotate(body->q, body->arm) : body->position_W;
}

template <class S>
std::vector<S> SceneMeasure<S>::arms() const {
    const auto* several = std::get_if<MechanismMeasure<S>>(&kind_);
    return several ? several->arms() : std::vector<S>();
}

template <class S>
SystemInvariants<S> SceneMeasure<S>::invariants(double t, std::span<const BodyMotion<S>> motions,
                                                JointCoordinates& coordinates) const {
    if (const auto* several = std::get_if<MechanismMeasure<S>>(&kind_)) {
        SystemInvariants<S> result = several->invariants(t, motions, coordinates);
        if (has_formula_potential(*scene_)) result.energy += formula_potential_of_bodies<S>(*scene_, t, motions);
        return result;
    }
    const BodyMotion<S>& m = motions[0];
    const Invariants<S> computed = polhode::invariants(*scene_, std::get<ExactBody<S>>(kind_), t, m.q,
                                                       m.angular_velocity_B, m.position_W, m.velocity_W);
    SystemInvariants<S> result;
    result.kinetic = computed.kinetic;
    result.energy = computed.energy;
    if (has_formula_potential(*scene_)) result.energy += formula_potential<S>(*scene_, t, m.q, m.position_W);
    result.angular_momentum_W = computed.angular_momentum_W;
    return result;
}

template <class S>
SystemInvariants<S> SceneMeasure<S>::true_invariants(std::span<const ReferenceSample> samples,
                                                     std::span<const BodyMotion<S>> motions,
                                                     JointCoordinates& coordinates) const {
    // from the motions, like a trajectory's invariants: if an angle rotates too far between samples to count its
    // revolutions, both count alike
    if (is_of_several()) return invariants(samples[0].t, motions, coordinates);
    const auto& body = std::get<ExactBody<S>>(kind_);
    const auto value = [](const Pair& pair) { return S(pair.high) + S(pair.low); };
    const BodyMotion<S>& m = motions[0];
    SystemInvariants<S> result;
    result.kinetic = dot(m.angular_velocity_B, body.inertia_B * m.angular_velocity_B) / S(2);
    if (!body.pivoted) result.kinetic += body.mass * dot(m.velocity_W, m.velocity_W) / S(2);
    result.energy = value(samples[0].energy);
    for (std::size_t i = 0; i < 3; ++i) result.angular_momentum_W[i] = value(samples[0].angular_momentum_W[i]);
    return result;
}

template <class S>
JointViolations<S> SceneMeasure<S>::violations(std::span<const BodyMotion<S>> motions) const {
    const auto* several = std::get_if<MechanismMeasure<S>>(&kind_);
    return several ? several->violations(motions) : JointViolations<S>();
}

template class SceneMeasure<double>;
template class SceneMeasure<Wide>;

}  // namespace polhode
