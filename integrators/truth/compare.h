// Two runs set side by side, and the truth written from the first.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "body/elementary.h"
#include "integrators/truth/attempt.h"
#include "integrators/truth/taylor.h"
#include "motion/exact_body_of.h"

namespace polhode::truth {

/// The largest difference between two runs: the attitude's angle in rad, and each other block relative to its largest
/// length over the run (absolute where that is zero).
template <class P>
double disagreement(const Run<P>& a, const Run<P>& b) {
    struct Tally {
        P largest{0}, difference{0};
        void note(const Vector3<P>& x, const Vector3<P>& y) {
            largest = std::max(largest, length(x));
            difference = std::max(difference, length(x - y));
        }
        P relative() const { return largest == 0 ? difference : P(difference / largest); }
    };
    P angle(0);
    Tally w, p, v;
    for (std::size_t i = 0; i < a.motions.size(); ++i) {
        const Motion<P>&x = a.motions[i], &y = b.motions[i];
        const Quaternion<P> between = conjugate(x.q) * y.q;
        angle = std::max(angle, P(2 * length(vector_part(between))));
        if (between.w <= 0) angle = std::max(angle, P(3));  // opposite sign: a flip is a disagreement too
        w.note(x.angular_velocity_B, y.angular_velocity_B);
        p.note(x.position_W, y.position_W);
        v.note(x.velocity_W, y.velocity_W);
    }
    const P worst = std::max({angle, w.relative(), p.relative(), v.relative()});
    return is_finite(worst) ? worst.template convert_to<double>() : std::numeric_limits<double>::infinity();
}

template <class P>
Vector3<Pair> pairs(const Vector3<P>& v) {
    Vector3<Pair> result;
    for (int i = 0; i < 3; ++i) result[i] = pair_of(v[i]);
    return result;
}

/// Fills in the truth's samples from `run`.
template <class P>
Truth written(const Problem& problem, const std::vector<double>& sample_times, const Run<P>& run, int digits) {
    const ExactBody<P> body = exact_body<P>(problem.scene);
    Truth truth;
    for (std::size_t i = 0; i < sample_times.size(); ++i) {
        const Motion<P>& m = run.motions[i];
        const Invariants<P> kept =
            invariants<P>(problem.scene, body, sample_times[i], m.q, m.angular_velocity_B, m.position_W, m.velocity_W);
        ReferenceSample sample;
        sample.t = sample_times[i];
        sample.q = {pair_of(m.q.w), pair_of(m.q.x), pair_of(m.q.y), pair_of(m.q.z)};
        sample.angular_velocity_B = pairs(m.angular_velocity_B);
        sample.angular_momentum_W = pairs(kept.angular_momentum_W);
        sample.position_W = pairs(m.position_W);
        sample.velocity_W = pairs(m.velocity_W);
        sample.energy = pair_of(kept.energy);
        truth.reference.samples.push_back(sample);

        const Vector3<P> w_W = rotate(m.q, m.angular_velocity_B);
        const P* columns[13] = {&m.q.w,           &m.q.x,           &m.q.y,           &m.q.z,
                                &w_W[0],          &w_W[1],          &w_W[2],          &m.position_W[0],
                                &m.position_W[1], &m.position_W[2], &m.velocity_W[0], &m.velocity_W[1],
                                &m.velocity_W[2]};
        DecimalColumns decimals;
        for (int c = 0; c < 13; ++c) decimals[c] = decimal_of(*columns[c], digits);
        truth.decimals.push_back(decimals);
    }
    return truth;
}

/// Both runs as an attempt; `how` says by what.
template <class P>
Attempt compared(const Problem& problem, const std::vector<double>& sample_times, const Run<P>& first,
                 const Run<P>& second, const std::string& how, int digits) {
    Attempt attempt;
    attempt.fault = first.fault.empty() ? second.fault : first.fault;
    if (!attempt.fault.empty()) return attempt;
    double difference = disagreement(first, second);
    P late(0);
    for (std::size_t i = 0; i < std::min(first.impacts.size(), second.impacts.size()); ++i)
        late = std::max(late, P(abs(first.impacts[i] - second.impacts[i])));
    // another number of impacts is another motion
    if (first.impacts.size() != second.impacts.size()) difference = std::numeric_limits<double>::infinity();
    attempt.agreed_digits = difference > 0 ? -std::log10(difference) : digits;
    attempt.truth = written(problem, sample_times, first, digits);
    attempt.truth.steps = first.steps + second.steps;
    attempt.truth.reference.bound = difference;
    attempt.truth.reference.message = how;
    if (first.impacts.empty()) return attempt;
    for (const P& t : first.impacts) {
        attempt.truth.reference.impact_times.push_back(pair_of(t));
        attempt.truth.impact_decimals.push_back(decimal_of(t, digits));
    }
    attempt.truth.reference.impact_time_error = late.template convert_to<double>();
    attempt.truth.reference.message +=
        fmt::format("; {} impact{}, whose times differ by {:.1e} s at most", first.impacts.size(),
                    first.impacts.size() == 1 ? "" : "s", attempt.truth.reference.impact_time_error);
    return attempt;
}

}  // namespace polhode::truth
