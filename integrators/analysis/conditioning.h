// Sensitivity of a scene's motion to its initial state: kappa(t) = || d state(t) / d state(0) ||.
//
// The state in minimal coordinates, every block in units of its scale:
//   attitude          rotation vector of a small rotation (rad), scale 1
//   angular velocity  scale problem.scales.angular_velocity, an estimate of the run's largest to three digits
//   position, velocity of the centre of mass, with their scales; omitted if it never moves or a pivot ties it to the
//                     rotation
// The norm is the spectral norm: the largest growth of any change of length 1. It does not depend on the axes in which
// rotations and vectors are written, nor on the system as which the scene was posed.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "motion/problem.h"
#include "scene/scene.h"

namespace polhode {

/// Half a unit in the last place of 1: the relative rounding error of a number.
constexpr double float64_roundoff = 0x1p-53, float32_roundoff = 0x1p-24;

/// The largest value of a sequence over time, and the first time at which it occurs.
struct Peak {
    double value = 0, time = 0;
};

struct Conditioning {
    bool available = false;        ///< kappa is known at all requested times
    bool limit_reached = false;    ///< unavailable because the limits of ConditioningSettings were reached
    std::string message;           ///< why it is unavailable, or how it was computed and how accurate it is
    std::vector<double> times;     ///< s; if unavailable, the times that were reached
    std::vector<double> state;     ///< kappa(t), one value per time
    std::vector<double> attitude;  ///< norm of the attitude rows alone: rad per relative change of the initial state
    long steps = 0;                ///< number of solver steps

    /// Peaks over `times`; zero if there are none.
    Peak state_peak() const;
    Peak attitude_peak() const;
    /// Attitude error (rad) at times[k] due to rounding of the initial data alone; at most pi.
    double floor(std::size_t k, double roundoff) const;
    /// The largest floor over all times.
    Peak floor_peak(double roundoff) const;
};

struct ConditioningSettings {
    std::optional<double> tolerance;  ///< relative; default 1e-14, or 1e-9 if the motion is stiff
    long max_steps = 2'000'000;       ///< unavailable if more are needed
    double seconds_limit = std::numeric_limits<double>::infinity();  ///< processor time of the thread, s
    /// For a mechanism, if max_steps is at most prompt_conditioning_steps: limit of steps times components times dual
    /// right-hand-side evaluations per stage. The default takes a few seconds.
    double mechanism_work = 6e5;
};

/// Value of max_steps for immediate output: half a second of work.
constexpr long prompt_conditioning_steps = 100'000;

/// Value of ConditioningSettings::mechanism_work for pages that are printed immediately: a fifth of a second.
constexpr double brief_mechanism_work = 3e4;

/// Computes kappa at the given times, s, which must not decrease, from 0 to the scene's duration (at the time of an
/// event: after it). Solves the variational equation dS/dt = df/dy S together with the motion by CVODES' staggered
/// forward sensitivities (Hindmarsh et al. 2005; Feehery, Tolsma & Barton 1997), with Adams' formulas and functional
/// iteration, or BDF and Newton's method if the motion is stiff. df/dy S is exact, from dual numbers, or comes from
/// central differences for a user-defined torque. Impulses are differentiated. If the motion has a closed form and
/// rotates by more than 4000 rad, differences of the closed form are used. Results are the same bits on every run. The
/// relative error of kappa is about kappa times the tolerance; the message tells if binary64 cannot follow the motion.
/// Throws std::invalid_argument if the times are invalid.
Conditioning conditioning(const Problem& problem, const std::vector<double>& times,
                          const ConditioningSettings& settings = {});

/// Poses the scene. The run lasts to the last of the times, even beyond the scene's duration.
Conditioning conditioning(const Scene& scene, const std::vector<double>& times,
                          const ConditioningSettings& settings = {});

}  // namespace polhode
