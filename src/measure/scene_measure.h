// Invariants and joint violations of the whole system of bodies of a scene at one time.
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

/// Evaluates motions of a scene's bodies in the scalar S, double or Wide.
template <class S>
class SceneMeasure {
  public:
    /// Keeps a reference to the scene, which must be valid.
    explicit SceneMeasure(const Scene& scene);

    /// The number of bodies.
    std::size_t bodies() const { return centers_.size(); }
    /// Whether the scene uses `bodies`, even if there is only one.
    bool is_of_several() const { return std::holds_alternative<MechanismMeasure<S>>(kind_); }
    /// Whether the measure is defined for the scene: a single body has no joint measures, and bodies connected to the
    /// world by a joint have no free-system measures.
    bool has(const Measure& measure) const;
    /// The data that the measure needs, flags of Known: the energy and momenta of several bodies also need the
    /// positions and velocities of all bodies.
    unsigned needs(const Measure& measure) const;
    /// From a body's origin to its centre of mass, m, body axes.
    const Vector3<S>& center(std::size_t body) const { return centers_[body]; }
    /// Initial position of the centre of mass of a single body, m, world axes; the world's origin for several bodies.
    Vector3<S> start_W() const;
    /// Distance from each joint's child point to the child's centre of mass, m; see MechanismMeasure::arms().
    std::vector<S> arms() const;

    /// Invariants of the motions of all bodies at time t (s), q of unit length. The angular momentum of a single body
    /// is about its pivot, or else about its centre of mass. `coordinates` holds the joint coordinates at an earlier
    /// time and is updated.
    SystemInvariants<S> invariants(double t, std::span<const BodyMotion<S>> motions,
                                   JointCoordinates& coordinates) const;
    /// Invariants of the reference; `motions` come from true_motion(). For a single body, energy and momentum are
    /// taken from its sample.
    SystemInvariants<S> true_invariants(std::span<const ReferenceSample> samples,
                                        std::span<const BodyMotion<S>> motions, JointCoordinates& coordinates) const;
    /// How far the joints are from closed.
    JointViolations<S> violations(std::span<const BodyMotion<S>> motions) const;

  private:
    const Scene* scene_;
    std::variant<ExactBody<S>, MechanismMeasure<S>> kind_;
    std::vector<Vector3<S>> centers_;
};

/// The error in a measure, before division by the scale, and the index of the worst body (0 for the whole system).
template <class S>
std::pair<S, std::size_t> error_in(const Measure& measure, const ComparedMotion<S>& compared) {
    if (measure.whole_error) return {measure.whole_error(compared), 0};
    std::pair<S, std::size_t> worst{measure.error(compared.bodies[0]), 0};
    for (std::size_t b = 1; b < compared.bodies.size(); ++b)
        if (const S other = measure.error(compared.bodies[b]); is_larger(other, worst.first)) worst = {other, b};
    return worst;
}

/// The scale of a measure at one time; 0 if the error is absolute.
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
