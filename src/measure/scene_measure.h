// What the bodies of a scene, one or several, have together at one time.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "measure/measures.h"
#include "motion/exact_body.h"
#include "motion/mechanism_motion.h"
#include "scene/scene.h"

namespace polhode {

/// Measures motions of a scene's bodies in the scalar S, double or Wide.
template <class S>
class SceneMeasure {
  public:
    /// Keeps a reference to the scene, which is valid.
    explicit SceneMeasure(const Scene& scene);

    /// How many bodies there are.
    std::size_t bodies() const { return centers_.size(); }
    /// Whether the scene is one of several bodies, be there one only.
    bool is_of_several() const { return std::holds_alternative<MechanismMeasure<S>>(kind_); }
    /// Whether motions of the scene have this measure: one body has none of joints, bodies that a joint ties to the
    /// world have none of free systems.
    bool has(const Measure& measure) const;
    /// From a body's origin to its centre of mass, m, body axes.
    const Vector3<S>& center(std::size_t body) const { return centers_[body]; }
    /// Where the centre of mass of a single body starts, m, world axes; of several the world's origin.
    Vector3<S> start_W() const;
    /// From the point of each joint's child to its centre of mass, m; see MechanismMeasure::arms().
    std::vector<S> arms() const;

    /// Of the motions of all bodies at time t (s), q of unit length. The angular momentum of a single body is about its
    /// pivot, or else about its centre of mass. `coordinates` are of this motion at an earlier time, and follow.
    SystemInvariants<S> invariants(double t, std::span<const BodyMotion<S>> motions,
                                   JointCoordinates& coordinates) const;
    /// The same of the truth, `motions` by true_motion(). A single body's sample has its energy and its momentum.
    SystemInvariants<S> true_invariants(std::span<const ReferenceSample> samples,
                                        std::span<const BodyMotion<S>> motions, JointCoordinates& coordinates) const;
    /// How far joints are from closed.
    JointViolations<S> violations(std::span<const BodyMotion<S>> motions) const;

  private:
    const Scene* scene_;
    std::variant<ExactBody<S>, MechanismMeasure<S>> kind_;
    std::vector<Vector3<S>> centers_;
};

/// The error in a measure, before it is divided by the scale, and the body whose it is (0 of all together).
template <class S>
std::pair<S, std::size_t> error_in(const Measure& measure, const ComparedMotion<S>& compared) {
    if (measure.whole_error) return {measure.whole_error(compared), 0};
    std::pair<S, std::size_t> worst{measure.error(compared.bodies[0]), 0};
    for (std::size_t b = 1; b < compared.bodies.size(); ++b)
        if (const S other = measure.error(compared.bodies[b]); is_larger(other, worst.first)) worst = {other, b};
    return worst;
}

/// What an error in a measure is relative to at one time: 0 where it is absolute.
template <class S>
S scale_in(const Measure& measure, std::span<const BodyMotion<S>> truth, const SystemInvariants<S>& whole) {
    if (measure.whole_scale) return std::max(S(0), measure.whole_scale(whole));
    S largest(0);
    if (measure.scale)
        for (const BodyMotion<S>& body : truth) largest = std::max(largest, measure.scale(body));
    return largest;
}

/// @cond
extern template class SceneMeasure<double>;
extern template class SceneMeasure<Wide>;
/// @endcond

}  // namespace polhode
