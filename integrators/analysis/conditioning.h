// How a scene's motion answers to small changes of its start: kappa(t) = || d state(t) / d state(0) ||.
//
// The state in minimal coordinates, every block in units of its scale:
//   attitude          the rotation vector of a small turn (rad), scale 1
//   angular velocity  over problem.scales.angular_velocity, an estimate of the run's largest to three digits
//   position, velocity of the centre of mass over theirs, unless it never moves or a pivot ties it to the rotation
// The norm is the spectral one: the largest growth of any change of length 1. It does not depend on the axes in which
// turns and vectors are written, nor on the system as which the scene was posed.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "motion/problem.h"
#include "scene/scene.h"

namespace polhode {

/// Half a unit in the last place of 1: how far rounding moves a number, relatively.
constexpr double float64_roundoff = 0x1p-53, float32_roundoff = 0x1p-24;

/// The largest value of a sequence over time, and when it is first reached.
struct Peak {
    double value = 0, time = 0;
};

struct Conditioning {
    bool available = false;        ///< kappa is known at all the times asked for
    bool budget_spent = false;     ///< it is not, for want of steps: ConditioningSettings bounds them
    std::string message;           ///< why it is not, or how it was made and what it is worth
    std::vector<double> times;     ///< s; where not available those that were reached
    std::vector<double> state;     ///< kappa(t), one for each time
    std::vector<double> attitude;  ///< its rows of the attitude alone: rad for each relative change of the start
    long steps = 0;                ///< of the solver

    /// Over `times`; zero where there is none.
    Peak state_peak() const;
    Peak attitude_peak() const;
    /// Attitude error (rad) at times[k] that rounding of the initial data alone causes; no more than pi.
    double floor(std::size_t k, double roundoff) const;
    /// The worst of them.
    Peak floor_peak(double roundoff) const;
};

struct ConditioningSettings {
    std::optional<double> tolerance;  ///< relative; default 1e-14, 1e-9 where the motion is stiff
    long max_steps = 2'000'000;       ///< beyond it not available
    double seconds_limit = std::numeric_limits<double>::infinity();  ///< s, of the thread's own time
    /// Of a mechanism, where max_steps is prompt_conditioning_steps or less: the most steps times components times
    /// evaluations of the dual right-hand side by stage. Some seconds by default.
    double mechanism_work = 6e5;
};

/// max_steps for what is read at once: half a second of work.
constexpr long prompt_conditioning_steps = 100'000;

/// ConditioningSettings::mechanism_work for a page that is printed at once: a fifth of a second.
constexpr double brief_mechanism_work = 3e4;

/// kappa at times (s, not decreasing, from 0 to the scene's duration; at the time of an event: after it), from the
/// variational equation dS/dt = df/dy S, solved along with the motion by CVODES' staggered forward sensitivities
/// (Hindmarsh et al. 2005; Feehery, Tolsma & Barton 1997): Adams' formulas by functional iteration, BDF by Newton's
/// method where the motion is stiff. df/dy S comes exactly from the one right-hand side on dual numbers, of a torque of
/// the user's own by central differences. Impulses jump through their own derivative. Beyond some thousand
/// radians, where the motion has a closed form, from differences of that. The same bits on every run.
/// kappa itself is known to about kappa times the tolerance, relatively; where it says that binary64 cannot follow the
/// motion so does the message. Throws std::invalid_argument on bad times.
Conditioning conditioning(const Problem& problem, const std::vector<double>& times,
                          const ConditioningSettings& settings = {});

/// Poses the scene; the run lasts to the last of the times, also beyond the scene's duration.
Conditioning conditioning(const Scene& scene, const std::vector<double>& times,
                          const ConditioningSettings& settings = {});

}  // namespace polhode
