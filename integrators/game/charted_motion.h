// The equations of motion with the attitude in three numbers c, a chart of the rotations:
//
//   y = w, c, p, v   (12; w in body axes)
//   q = chart.quaternion(c),  dc/dt = chart.rate(c, w),  the rest as FullMotion has it
//
// Chart: { Quaternion<S> quaternion(const Vector3<S>& c) const;   of unit length
//          Vector3<S> rate(const Vector3<S>& c, const Vector3<S>& w_B) const; }
#pragma once

#include <array>

#include "integrators/run/binary32.h"
#include "motion/problem.h"

namespace polhode {

template <class S>
using ChartedState = std::array<S, 12>;
template <class S>
using FullState = std::array<S, 13>;

template <class Chart, class S>
FullState<S> full_state(const Chart& chart, const S* y) {
    FullState<S> full;
    put(full.data(), 0, vector_at(y, 0));
    put(full.data(), 3, chart.quaternion(vector_at(y, 3)));
    put(full.data(), 7, vector_at(y, 6));
    put(full.data(), 10, vector_at(y, 9));
    return full;
}

/// Of a problem posed with Formulation::full. S: the scalar of its state.
template <class Chart, class S = double>
struct ChartedMotion {
    static constexpr int dimension = 12;
    SystemIn<FullMotion<double>, S> body;
    Chart chart;

    void derivative(double t, const S* y, S* dy) const {
        const FullState<S> full = full_state(chart, y);
        FullState<S> rate{};
        body.derivative(t, full.data(), rate.data());
        put(dy, 0, vector_at(rate.data(), 0));
        put(dy, 3, chart.rate(vector_at(y, 3), vector_at(y, 0)));
        put(dy, 6, vector_at(rate.data(), 7));
        put(dy, 9, vector_at(rate.data(), 10));
    }
};

/// Applies the impulses at the segment's begin to w and v.
template <class Chart, class S>
void enter_charted(const Problem& problem, const Segment& segment, const Chart& chart, S* y) {
    FullState<S> full = full_state(chart, y);
    enter<SystemIn<FullMotion<double>, S>>(problem, segment, full.data());
    put(y, 0, vector_at(full.data(), 0));
    put(y, 9, vector_at(full.data(), 10));
}

template <class Chart, class S>
Sample sample_charted(const Problem& problem, double t, const Chart& chart, const S* y) {
    const FullState<S> full = full_state(chart, y);
    Sample sample = sample_of<SystemIn<FullMotion<double>, S>>(problem, t, full.data());
    // at a pivot the attitude says where the centre of mass is
    if (problem.body.pivoted)
        pivoted_center(sample.q, sample.angular_velocity_B, problem.body.arm, sample.position_W, sample.velocity_W);
    return sample;
}

}  // namespace polhode
