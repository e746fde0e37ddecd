// The result of every method: samples of the motion, how the run ended, and its cost. Also the reference in the same
// form.
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
    ok,                 ///< reached its end
    unsupported,        ///< not started: the method cannot represent the scene
    diverged,           ///< a number is not finite, or the energy is beyond all bounds
    tolerance_not_met,  ///< reported by the solver; in tables also a run by tolerance that ends > 1 rad off
    failed,             ///< any other failure; the message gives the reason
};

/// The name of a status in result tables: the enumerator's name.
const char* name_of(Status status);

/// The force and torque that the parent of a joint exerts on the child through it, or a loop's first body on its
/// second. They include the joint's spring, damper and motor.
template <class S>
struct Reaction {
    Vector3<S> force_W;   ///< N
    Vector3<S> torque_W;  ///< about the child's point (a loop's point on its second body), N m

    /// Whether all numbers are equal.
    bool operator==(const Reaction&) const = default;
};

/// The motion of every body at one time, and the reactions of joints and loops if requested.
struct Moment {
    std::vector<Sample> samples;              ///< one per body
    std::vector<Reaction<double>> reactions;  ///< in the order of Trajectory::reactions, or empty
};

/// A view of the motion of every body at one time, over one sample or several.
class Bodies : public std::span<const Sample> {
  public:
    std::span<const Reaction<double>> reactions;  ///< if known

    Bodies(const Moment& moment) : span(moment.samples), reactions(moment.reactions) {}  ///< several bodies
    Bodies(const Sample& one) : span(&one, 1) {}                                         ///< a single body
    Bodies(const std::vector<Sample>& all) : span(all) {}                                ///< one sample per body
    Bodies(std::span<const Sample> all) : span(all) {}                                   ///< one sample per body
};

/// The angular velocity (rad/s) in world axes, by the sample's attitude, normalised.
Vector3<double> angular_velocity_W(const Sample& sample);

/// The solver's failure statistics; empty if it does not report them or they do not apply.
struct SolverCounts {
    std::optional<long> rejected_steps;    ///< attempted steps rejected because of their error
    std::optional<long> newton_failures;   ///< Newton iterations that did not converge
    std::optional<long> order_reductions;  ///< order reductions because the step was near the stability limit
};

/// The result of a method: the motion at the sample times, how the run ended and its cost.
struct Trajectory {
    Status status = Status::ok;   ///< how the run ended
    std::string message;          ///< the reason if status is neither ok nor unsupported; otherwise a remark
    int bodies = 1;               ///< number of bodies at each time
    std::vector<Sample> samples;  ///< the samples reached, by time, then by body; the first at t = 0
    std::vector<double> orthogonality_defect;  ///< for a matrix method: Frobenius norm of A^T A - 1 at each sample
    /// If the method computes them: at each time the reactions of all joints, then of all loops, in the scene's
    /// order.
    std::vector<Reaction<double>> reactions;
    std::vector<double> impact_times;  ///< times of impacts on the scene's planes, s
    long steps = 0;                    ///< number of steps
    /// Evaluations of the right-hand side by the whole run. That is the number of calls of a UserTorque that acts all
    /// the time, and of `derivative` of a user-defined system with doubles. Rejected attempts, first-step guesses and
    /// samples between steps are included. Not included: calls while a scene is posed, Jacobians (formed by automatic
    /// differentiation), and energies. Methods that evaluate no right-hand side count the unit of work that their
    /// documentation names; integrators/README.md lists them.
    long rhs_evaluations = 0;
    /// The part of rhs_evaluations that only the samples require: 0 for a method that samples without evaluations.
    long sample_evaluations = 0;
    SolverCounts counts;         ///< the solver's failure statistics
    double seconds = 0;          ///< wall clock of the integration alone, without set-up
    bool limit_reached = false;  ///< `failed` because of one of the limits in Settings
    double step = 0;             ///< the (largest) fixed step actually used, s; 0 for other methods

    /// The number of sample times.
    std::size_t moments() const { return samples.size() / static_cast<std::size_t>(bodies); }
    /// All bodies at the k-th sample time, k < moments().
    Bodies at(std::size_t k) const {
        const std::size_t n = static_cast<std::size_t>(bodies);
        return std::span(samples).subspan(k * n, n);
    }
    /// Appends the motion at one time.
    void append(const Bodies& moment) {
        bodies = static_cast<int>(moment.size());
        samples.insert(samples.end(), moment.begin(), moment.end());
        reactions.insert(reactions.end(), moment.reactions.begin(), moment.reactions.end());
    }
};

/// t_k = k T / n, the k-th of n + 1 sample times, in s. The reference and all methods use this formula, so that they
/// use the same binary64 times.
inline double sample_time(double duration, long k, long n) {
    return k == n ? duration : duration * static_cast<double>(k) / static_cast<double>(n);
}

/// The n + 1 sample times k T / n, k = 0..n, in s.
inline std::vector<double> sample_times(double duration, long n) {
    std::vector<double> times;
    for (long k = 0; k <= n; ++k) times.push_back(sample_time(duration, k, n));
    return times;
}

/// A value in two parts, high + low, with |low| <= ulp(high)/2: about 106 bits.
struct Pair {
    double high = 0;  ///< the value rounded to binary64
    double low = 0;   ///< the rounding error of `high`

    /// Zero.
    constexpr Pair() = default;
    /// high + low. The two must not overlap.
    constexpr Pair(double high_, double low_ = 0) : high(high_), low(low_) {}
    /// Whether both parts are equal.
    bool operator==(const Pair&) const = default;
};

/// The reference motion of a body at one time, with more digits than a double.
struct ReferenceSample {
    double t = 0;                      ///< s
    Quaternion<Pair> q;                ///< body to world, |q| = 1, without sign flips between samples
    Vector3<Pair> angular_velocity_B;  ///< rad/s
    /// About the pivot, or else about the centre of mass, kg m^2/s; zero for one of several bodies.
    Vector3<Pair> angular_momentum_W;
    Vector3<Pair> position_W;  ///< centre of mass, m
    Vector3<Pair> velocity_W;  ///< centre of mass, m/s
    Pair energy;               ///< kinetic plus potential energy, J; zero for one of several bodies

    /// The sample in binary64: the high part of each number.
    Sample rounded() const {
        const auto high = [](const Vector3<Pair>& v) { return Vector3<double>{v[0].high, v[1].high, v[2].high}; };
        return {
            t, {q.w.high, q.x.high, q.y.high, q.z.high}, high(angular_velocity_B), high(position_W), high(velocity_W)};
    }
};

/// Reference values of the energy and momenta of several bodies at one time.
struct ReferenceSystem {
    double t = 0;  ///< s
    Pair kinetic;  ///< kinetic energy, J
    Pair energy;   ///< kinetic plus potential energy, J
    /// About the world's origin; if no joint ties the bodies to the world, about their common centre of mass. kg
    /// m^2/s
    Vector3<Pair> angular_momentum_W;
    Vector3<Pair> linear_momentum_W;  ///< kg m/s
};

/// The reference solution (ground truth), with which other motions are compared.
struct Reference {
    bool available = false;                 ///< false: there is no reference, and only `message` is set
    std::string message;                    ///< why there is no reference, or how it was computed
    double bound = 0;                       ///< bound of the errors: attitude (rad), other blocks (relative)
    std::vector<Pair> impact_times;         ///< times of impacts on the scene's planes, s
    double impact_time_error = 0;           ///< largest error of impact_times, s
    int bodies = 1;                         ///< number of bodies at each time
    std::vector<ReferenceSample> samples;   ///< at each sample time one per body
    std::vector<ReferenceSystem> system;    ///< several bodies: one per sample time; else empty
    std::vector<Reaction<Pair>> reactions;  ///< if known, in the order of Trajectory::reactions

    /// The number of sample times.
    std::size_t moments() const { return samples.size() / static_cast<std::size_t>(bodies); }
};

}  // namespace polhode
