// Comparison of two runs, and the reference made from the first one.
//
// Difference accumulates the largest difference between motions; disagreement() applies it to two runs. make_truth()
// converts a run to samples and decimals. compare_runs() combines both into an Attempt. For several bodies, reactions
// are compared as well: components that redundant constraints leave undetermined become NaN.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "body/elementary.h"
#include "integrators/truth/attempt.h"
#include "integrators/truth/taylor.h"
#include "motion/exact_body_of.h"
#include "motion/mechanism_motion_of.h"

namespace polhode::truth {

/// Lengths that the blocks would have if the bodies rotated by one radian during the run. Lengths that are negligible
/// compared with them are round-off; differences are then relative to the natural sizes.
template <class P>
struct NaturalSizes {
    P angular_velocity{0}, position{0}, velocity{0};
};
/// For several bodies: from their largest radius of gyration and the scene's duration.
template <class P>
NaturalSizes<P> natural_sizes(const Scene& scene) {
    P square(0);
    for (const MassProperties<P>& body : bodies_mass_properties<P>(scene))
        if (body.mass > P(0))
            square =
                std::max(square, P((body.inertia[0][0] + body.inertia[1][1] + body.inertia[2][2]) / (2 * body.mass)));
    const P size = square_root(square), rate = P(1) / P(scene.duration);
    return {rate, size, size * rate};
}

/// The larger of two numbers; NaN counts as the largest.
template <class P>
P larger(const P& a, const P& b) {
    return !(b <= a) && !isnan(a) ? b : a;
}

/// Accumulates the largest difference between motions: the attitude's angle in rad, and each other block relative to
/// its largest length over all motions (absolute if that is zero). Infinite if a motion is not finite.
template <class P>
class Difference {
  public:
    Difference() = default;
    explicit Difference(const NaturalSizes<P>& natural) {
        w_.natural = natural.angular_velocity, p_.natural = natural.position, v_.natural = natural.velocity;
    }

    void add(const Motion<P>& x, const Motion<P>& y) {
        const Quaternion<P> between = conjugate(x.q) * y.q;
        angle_ = larger(angle_, P(2 * length(vector_part(between))));
        if (between.w <= 0) angle_ = std::max(angle_, P(3));  // opposite sign: a sign flip counts as a disagreement
        w_.add(x.angular_velocity_B, y.angular_velocity_B);
        p_.add(x.position_W, y.position_W);
        v_.add(x.velocity_W, y.velocity_W);
    }
    double worst() const {
        const P worst = larger(larger(angle_, w_.relative()), larger(p_.relative(), v_.relative()));
        return is_finite(worst) ? worst.template convert_to<double>() : std::numeric_limits<double>::infinity();
    }

  private:
    struct BlockDifference {
        P largest{0}, difference{0}, natural{0};
        void add(const Vector3<P>& x, const Vector3<P>& y) {
            largest = larger(largest, length(x));
            difference = larger(difference, length(x - y));
        }
        P relative() const {
            const P size = largest > P(1e-15) * natural ? largest : natural;
            return size == 0 ? difference : P(difference / size);
        }
    };
    P angle_{0};
    BlockDifference w_, p_, v_;
};

/// The largest difference between two runs.
template <class P>
double disagreement(const Run<P>& a, const Run<P>& b) {
    Difference<P> difference;
    for (std::size_t i = 0; i < a.motions.size(); ++i) difference.add(a.motions[i], b.motions[i]);
    return difference.worst();
}
/// For several bodies: differences are relative to the largest length over all bodies.
template <class P>
double disagreement(const Run<P, Motions<P>>& a, const Run<P, Motions<P>>& b, const NaturalSizes<P>& natural = {}) {
    Difference<P> difference(natural);
    for (std::size_t i = 0; i < a.motions.size(); ++i)
        for (std::size_t body = 0; body < a.motions[i].size(); ++body)
            difference.add(a.motions[i][body], b.motions[i][body]);
    return difference.worst();
}

template <class P>
Vector3<Pair> pairs(const Vector3<P>& v) {
    Vector3<Pair> result;
    for (int i = 0; i < 3; ++i) result[i] = pair_of(v[i]);
    return result;
}

/// Appends the decimals and the sample of a body, without energy and angular momentum.
template <class P>
ReferenceSample& write_motion(Truth& truth, double t, const Motion<P>& m, int digits) {
    ReferenceSample sample;
    sample.t = t;
    sample.q = {pair_of(m.q.w), pair_of(m.q.x), pair_of(m.q.y), pair_of(m.q.z)};
    sample.angular_velocity_B = pairs(m.angular_velocity_B);
    sample.position_W = pairs(m.position_W);
    sample.velocity_W = pairs(m.velocity_W);
    truth.reference.samples.push_back(sample);

    const Vector3<P> w_W = rotate(m.q, m.angular_velocity_B);
    const P* columns[13] = {&m.q.w,           &m.q.x,           &m.q.y,           &m.q.z,           &w_W[0],
                            &w_W[1],          &w_W[2],          &m.position_W[0], &m.position_W[1], &m.position_W[2],
                            &m.velocity_W[0], &m.velocity_W[1], &m.velocity_W[2]};
    DecimalColumns decimals;
    for (int c = 0; c < 13; ++c) decimals[c] = decimal_of(*columns[c], digits);
    truth.decimals.push_back(decimals);
    return truth.reference.samples.back();
}

/// Converts `run` to the samples of a reference.
template <class P>
Truth make_truth(const Problem& problem, const std::vector<double>& sample_times, const Run<P>& run, int digits) {
    const ExactBody<P> body = exact_body<P>(problem.scene);
    Truth truth;
    for (std::size_t i = 0; i < sample_times.size(); ++i) {
        const Motion<P>& m = run.motions[i];
        const Invariants<P> conserved =
            invariants<P>(problem.scene, body, sample_times[i], m.q, m.angular_velocity_B, m.position_W, m.velocity_W);
        ReferenceSample& sample = write_motion(truth, sample_times[i], m, digits);
        sample.angular_momentum_W = pairs(conserved.angular_momentum_W);
        sample.energy = pair_of(conserved.energy);
    }
    return truth;
}

/// Further quantities that a formulation of several bodies provides, at every sample time or not at all.
template <class P>
struct MechanismOutputs {
    std::vector<std::vector<Reaction<P>>> reactions;  ///< all joints, then all loops
    /// Of each joint, as in JointCoordinates. If empty, the angles are tracked from sample to sample.
    std::vector<std::vector<std::array<double, 2>>> coordinates;
};

/// Converts `run` to the samples of several bodies and of the whole system.
template <class P>
Truth make_truth(const Problem& problem, const std::vector<double>& sample_times, const Run<P, Motions<P>>& run,
                 int digits, const MechanismOutputs<P>& outputs = {}) {
    const MechanismMeasure<P> measure(problem.scene);
    JointCoordinates coordinates(problem.scene);
    Truth truth;
    truth.reference.bodies = static_cast<int>(measure.bodies());
    for (std::size_t i = 0; i < sample_times.size(); ++i) {
        const double t = sample_times[i];
        for (const Motion<P>& m : run.motions[i]) write_motion(truth, t, m, digits);
        if (!outputs.coordinates.empty()) coordinates.set(t, outputs.coordinates[i]);
        const SystemInvariants<P> all = measure.invariants(t, run.motions[i], coordinates);
        truth.reference.system.push_back({t, pair_of(all.kinetic), pair_of(all.energy), pairs(all.angular_momentum_W),
                                          pairs(all.linear_momentum_W)});
        if (outputs.reactions.empty()) continue;
        for (const Reaction<P>& r : outputs.reactions[i]) {
            truth.reference.reactions.push_back({pairs(r.force_W), pairs(r.torque_W)});
            ReactionDecimals decimals;
            for (std::size_t c = 0; c < 3; ++c) {
                decimals[c] = decimal_of(r.force_W[c], digits);
                decimals[c + 3] = decimal_of(r.torque_W[c], digits);
            }
            truth.reaction_decimals.push_back(decimals);
        }
    }
    return truth;
}

/// The largest difference between the reactions of two runs. Forces are relative to the largest force, torques to the
/// largest torque or moment of a force about the child's centre of mass. Redundant constraints leave part of the
/// reactions undetermined, and the two formulations choose that part differently. Components that differ by more than
/// `undetermined` are set to NaN in the first run and do not count.
template <class P>
double disagreement(const Scene& scene, MechanismOutputs<P>& a, const MechanismOutputs<P>& b, double undetermined) {
    const std::vector<P> arms = MechanismMeasure<P>(scene).arms();
    P force(0), torque(0);
    for (std::vector<Reaction<P>>& moment : a.reactions)
        for (std::size_t j = 0; j < arms.size(); ++j) {
            const P pull = length(moment[j].force_W);
            force = std::max(force, pull);
            torque = std::max({torque, length(moment[j].torque_W), P(pull * arms[j])});
        }
    P worst(0);
    const auto compare = [&](Vector3<P>& x, const Vector3<P>& y, const P& largest) {
        for (std::size_t c = 0; c < 3; ++c) {
            const P off = largest == 0 ? P(abs(x[c] - y[c])) : P(abs(x[c] - y[c]) / largest);
            if (off <= undetermined)
                worst = std::max(worst, off);
            else
                x[c] = P(std::numeric_limits<double>::quiet_NaN());
        }
    };
    for (std::size_t i = 0; i < a.reactions.size(); ++i)
        for (std::size_t j = 0; j < arms.size(); ++j) {
            compare(a.reactions[i][j].force_W, b.reactions[i][j].force_W, force);
            compare(a.reactions[i][j].torque_W, b.reactions[i][j].torque_W, torque);
        }
    return worst.template convert_to<double>();
}

/// Makes an attempt from two runs with a known largest difference; `truth` comes from the first run.
template <class P, class Sample>
Attempt make_attempt(Truth truth, const Run<P, Sample>& first, const Run<P, Sample>& second, double difference,
                     const std::string& how, int digits) {
    Attempt attempt;
    P time_difference(0);
    for (std::size_t i = 0; i < std::min(first.impacts.size(), second.impacts.size()); ++i)
        time_difference = std::max(time_difference, P(abs(first.impacts[i] - second.impacts[i])));
    // a different number of impacts means a different motion
    if (first.impacts.size() != second.impacts.size()) difference = std::numeric_limits<double>::infinity();
    attempt.agreed_digits = difference > 0 ? -std::log10(difference) : digits;
    attempt.truth = std::move(truth);
    attempt.truth.steps = first.steps + second.steps;
    attempt.truth.reference.bound = difference;
    attempt.truth.reference.message = how;
    if (first.impacts.empty()) return attempt;
    for (const P& t : first.impacts) {
        attempt.truth.reference.impact_times.push_back(pair_of(t));
        attempt.truth.impact_decimals.push_back(decimal_of(t, digits));
    }
    attempt.truth.reference.impact_time_error = time_difference.template convert_to<double>();
    attempt.truth.reference.message +=
        fmt::format("; {} impact{}, times differ by at most {:.1e} s", first.impacts.size(),
                    first.impacts.size() == 1 ? "" : "s", attempt.truth.reference.impact_time_error);
    return attempt;
}

/// An attempt that did not reach the end.
inline Attempt failed_attempt(const std::string& fault) {
    Attempt attempt;
    attempt.fault = fault;
    return attempt;
}

/// Compares both runs and returns the attempt; `how` describes the method in its message.
template <class P>
Attempt compare_runs(const Problem& problem, const std::vector<double>& sample_times, const Run<P>& first,
                     const Run<P>& second, const std::string& how, int digits) {
    const std::string& fault = first.fault.empty() ? second.fault : first.fault;
    if (!fault.empty()) return failed_attempt(fault);
    return make_attempt(make_truth(problem, sample_times, first, digits), first, second, disagreement(first, second),
                        how, digits);
}

/// Compares both runs of several bodies. If both provide reactions, these are compared and written too. Reactions that
/// the motion does not determine are NaN.
template <class P>
Attempt compare_runs(const Problem& problem, const std::vector<double>& sample_times, const Run<P, Motions<P>>& first,
                     const Run<P, Motions<P>>& second, const std::string& how, int digits,
                     const MechanismOutputs<P>& first_outputs = {}, const MechanismOutputs<P>& second_outputs = {}) {
    const std::string& fault = first.fault.empty() ? second.fault : first.fault;
    if (!fault.empty()) return failed_attempt(fault);
    double difference = disagreement(first, second, natural_sizes<P>(problem.scene));
    MechanismOutputs<P> outputs = first_outputs;
    if (second_outputs.reactions.empty()) outputs.reactions.clear();
    if (!outputs.reactions.empty()) {
        // the reactions agree to a few digits less than the motions; larger differences mean undetermined components
        const double undetermined = std::max(1e-12, 1e4 * difference);
        difference = std::max(difference, disagreement(problem.scene, outputs, second_outputs, undetermined));
    }
    return make_attempt(make_truth(problem, sample_times, first, digits, outputs), first, second, difference, how,
                        digits);
}

}  // namespace polhode::truth
