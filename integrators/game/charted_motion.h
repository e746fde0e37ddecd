// The equations of motion with the attitude in three numbers c, a chart of the rotation group:
//
//   y = w, c, p, v   (12; w in body axes)
//   q = chart.quaternion(c),  dc/dt = chart.rate(c, w),  the rest as in FullMotion
//
// Chart: { Vector3<S> start(const Quaternion<double>& q);               centres the chart; returns the c of q
//          Quaternion<S> quaternion(const Vector3<S>& c) const;         of unit length
//          Vector3<S> rate(const Vector3<S>& c, const Vector3<S>& w_B) const; }
#pragma once

#include <array>

#include "integrators/run/binary32.h"

namespace polhode {

/// The system of a problem posed with Formulation::full. S: scalar of its state.
template <class Chart, class S = double>
class ChartedMotion {
  public:
    using Scalar = S;
    static constexpr int dimension = 12;
    static constexpr int size() { return dimension; }

    explicit ChartedMotion(const Problem& problem) : problem_(&problem), body_(problem) {}

    void initial(S* y) {
        const ExactBody<double>& start = problem_->body;
        put(y, 0, cast<S>(start.angular_velocity_B));
        put(y, 3, chart_.start(start.q));
        put(y, 6, cast<S>(start.position_W));
        put(y, 9, cast<S>(start.velocity_W));
    }
    bool enter(const Segment& segment, S* y) {
        Full full = quaternion_state(y);
        const bool changed = body_.enter(segment, full.data());
        put(y, 0, FullMotion::angular_velocity(full.data()));
        put(y, 9, FullMotion::velocity(full.data()));
        return changed;
    }
    void derivative(double t, const S* y, S* dy) const {
        const Full full = quaternion_state(y);
        Full rate{};
        body_.derivative(t, full.data(), rate.data());
        put(dy, 0, FullMotion::angular_velocity(rate.data()));
        put(dy, 3, coordinate_rate(y));
        put(dy, 6, FullMotion::position(rate.data()));
        put(dy, 9, FullMotion::velocity(rate.data()));
    }
    Sample motion(double t, const S* y) const {
        Sample sample = body_.motion(t, quaternion_state(y).data());
        // With a pivot, the attitude determines the position of the centre of mass.
        const ExactBody<double>& body = problem_->body;
        if (body.pivoted)
            pivoted_center(sample.q, sample.angular_velocity_B, body.arm, sample.position_W, sample.velocity_W);
        return sample;
    }
    void scales(double* scales) const {
        const auto all = [](double x) { return Vector3<double>(x, x, x); };
        put(scales, 0, all(problem_->scales.angular_velocity));
        put(scales, 3, all(1));
        put(scales, 6, all(problem_->scales.position));
        put(scales, 9, all(problem_->scales.velocity));
    }

    Chart& chart() { return chart_; }
    const Chart& chart() const { return chart_; }
    static Vector3<S> coordinates(const S* y) { return vector_at(y, 3); }
    static void set_coordinates(S* y, const Vector3<S>& c) { put(y, 3, c); }
    Vector3<S> coordinate_rate(const S* y) const { return chart_.rate(coordinates(y), vector_at(y, 0)); }

  private:
    using Full = std::array<S, FullMotion::dimension>;

    Full quaternion_state(const S* y) const {
        Full full;
        FullMotion::set_rotation(full.data(), vector_at(y, 0), chart_.quaternion(coordinates(y)));
        FullMotion::set_translation(full.data(), vector_at(y, 6), vector_at(y, 9));
        return full;
    }

    const Problem* problem_;
    SystemIn<FullMotion, S> body_;
    Chart chart_{};
};

}  // namespace polhode
