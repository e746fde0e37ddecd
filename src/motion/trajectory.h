// What every method returns: states at times, how the run ended and what it cost.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "body/algebra.h"
#include "body/body_motion.h"

namespace polhode {

/// How a run ended.
enum class Status {
    ok,                 ///< at its end
    unsupported,        ///< not begun: the method cannot represent the scene
    diverged,           ///< with a number that is not finite, or an energy beyond all bounds
    tolerance_not_met,  ///< the solver says so; in tables also a tolerance-driven run that ends more than 1 rad off
    failed,             ///< otherwise; the message says why
};

/// The word that stands for a status in the result table: the enumerator's name.
const char* name_of(Status status);

/// What the parent of a joint exerts on the child through it, or a loop's first body on the second: the whole force and
/// torque, the joint's own spring, damper and motor included.
template <class S>
struct Reaction {
    Vector3<S> force_W;   ///< N
    Vector3<S> torque_W;  ///< about the child's point, or the second body's, N m

    /// Whether all numbers are equal.
    bool operator==(const Reaction&) const = default;
};

/// The motion of every body at one time, and the reactions of joints and loops where they are asked for.
struct Moment {
    std::vector<Sample> samples;              ///< one for each body
    std::vector<Reaction<double>> reactions;  ///< in the order of Trajectory::reactions, or none
};

/// The motion of every body at one time, seen in one sample or in a list of them.
class Bodies : public std::span<const Sample> {
  public:
    std::span<const Reaction<double>> reactions;  ///< where they are known

    Bodies(const Moment& moment) : span(moment.samples), reactions(moment.reactions) {}  ///< of several bodies
    Bodies(const Sample& one) : span(&one, 1) {}                                         ///< of a single body
    Bodies(const std::vector<Sample>& all) : span(all) {}                                ///< one sample for each
    Bodies(std::span<const Sample> all) : span(all) {}                                   ///< one sample for each
};

/// The angular velocity (rad/s) in world axes, by the sample's own attitude, normalised.
Vector3<double> angular_velocity_W(const Sample& sample);

/// What a solver tells of its troubles; empty where it does not tell, or cannot have them.
struct SolverCounts {
    std::optional<long> rejected_steps;    ///< tried and taken back, the error being too large
    std::optional<long> newton_failures;   ///< nonlinear systems of equations that did not converge
    std::optional<long> order_reductions;  ///< orders lowered because the step came near its limit of stability
};

/// What a method returns: the motion at the sample times, how the run ended and what it cost.
struct Trajectory {
    Status status = Status::ok;   ///< how the run ended
    std::string message;          ///< why, wherever status is neither ok nor unsupported; a remark otherwise
    int bodies = 1;               ///< how many there are in each moment
    std::vector<Sample> samples;  ///< those reached, by time and then by body; the first at t = 0
    std::vector<double> orthogonality_defect;  ///< of a matrix method: Frobenius norm of A^T A - 1 at each sample
    /// Where the method gives them, at each time those of all joints, then of all loops, in the scene's order.
    std::vector<Reaction<double>> reactions;
    std::vector<double> impact_times;  ///< s, of the impacts on the scene's planes
    long steps = 0;                    ///< taken
    /// Evaluations of the right-hand side by the whole run. That is the number of calls of a UserTorque that acts all
    /// the time, and of `derivative` of a user-defined system with doubles. Rejected attempts, first-step guesses and
    /// samples between steps are included. Not included: calls while a scene is posed, Jacobians (formed by automatic
    /// differentiation), and energies. Methods that evaluate no right-hand side count the unit of work that their
    /// documentation names; integrators/README.md lists them.
    long rhs_evaluations = 0;
    /// Those of rhs_evaluations that only the samples cost: 0 for a method that samples without evaluations.
    long sample_evaluations = 0;
    SolverCounts counts;         ///< the solver's own troubles
    double seconds = 0;          ///< wall clock of the integration alone, set-up left out
    bool limit_reached = false;  ///< `failed` because of one of Settings' limits
    double step = 0;             ///< s, the fixed step really taken (the largest); 0 where there is none

    /// How many times have samples.
    std::size_t moments() const { return samples.size() / static_cast<std::size_t>(bodies); }
    /// All bodies at the k-th time, k < moments().
    Bodies at(std::size_t k) const {
        const std::size_t n = static_cast<std::size_t>(bodies);
        return std::span(samples).subspan(k * n, n);
    }
    /// Appends a moment.
    void append(const Bodies& moment) {
        bodies = static_cast<int>(moment.size());
        samples.insert(samples.end(), moment.begin(), moment.end());
        reactions.insert(reactions.end(), moment.reactions.begin(), moment.reactions.end());
    }
};

/// t_k = k T / n, the k-th of n + 1 sample times, in s. Truth and methods use this one formula, so that both mean the
/// same binary64.
inline double sample_time(double duration, long k, long n) {
    return k == n ? duration : duration * static_cast<double>(k) / static_cast<double>(n);
}

/// The n + 1 sample times k T / n, k = 0..n, in s.
inline std::vector<double> sample_times(double duration, long n) {
    std::vector<double> times;
    for (long k = 0; k <= n; ++k) times.push_back(sample_time(duration, k, n));
    return times;
}

/// A value in two parts, high + low, |low| <= ulp(high)/2: about 106 bits.
struct Pair {
    double high = 0;  ///< the value rounded to binary64
    double low = 0;   ///< what the rounding left

    /// Zero.
    constexpr Pair() = default;
    /// high + low, which must not overlap.
    constexpr Pair(double high_, double low_ = 0) : high(high_), low(low_) {}
    /// Whether both parts are equal.
    bool operator==(const Pair&) const = default;
};

/// The truth of a body at one time, to more digits than a double has.
struct ReferenceSample {
    double t = 0;                      ///< s
    Quaternion<Pair> q;                ///< body to world, |q| = 1, without sign flips between samples
    Vector3<Pair> angular_velocity_B;  ///< rad/s
    /// About the pivot, or else about the centre of mass, kg m^2/s; zero of one of several bodies.
    Vector3<Pair> angular_momentum_W;
    Vector3<Pair> position_W;  ///< of the centre of mass, m
    Vector3<Pair> velocity_W;  ///< of the centre of mass, m/s
    Pair energy;               ///< kinetic and potential, J; zero of one of several bodies

    /// The sample in binary64: the leading part of each number.
    Sample rounded() const {
        const auto high = [](const Vector3<Pair>& v) { return Vector3<double>{v[0].high, v[1].high, v[2].high}; };
        return {
            t, {q.w.high, q.x.high, q.y.high, q.z.high}, high(angular_velocity_B), high(position_W), high(velocity_W)};
    }
};

/// What several bodies have together at one time, in truth.
struct ReferenceSystem {
    double t = 0;  ///< s
    Pair kinetic;  ///< energy, J
    Pair energy;   ///< kinetic and potential, J
    /// About the world's origin, or about the centre of mass of all where no joint ties them to the world, kg m^2/s.
    Vector3<Pair> angular_momentum_W;
    Vector3<Pair> linear_momentum_W;  ///< kg m/s
};

/// The truth: the motion that others are judged by.
struct Reference {
    bool available = false;          ///< false: there is none, and nothing but `message` is set
    std::string message;             ///< why there is none, or how it was made
    double bound = 0;                ///< largest of the attitude's error (rad) and the other blocks' relative errors
    std::vector<Pair> impact_times;  ///< s, of the impacts on the scene's planes
    double impact_time_error = 0;    ///< s, largest of them
    int bodies = 1;                  ///< how many there are at each time
    std::vector<ReferenceSample> samples;   ///< at each sample time one of each body
    std::vector<ReferenceSystem> system;    ///< of a scene of several bodies, one at each sample time; else empty
    std::vector<Reaction<Pair>> reactions;  ///< where they are known, in the order of Trajectory::reactions

    /// How many times have samples.
    std::size_t moments() const { return samples.size() / static_cast<std::size_t>(bodies); }
};

}  // namespace polhode
