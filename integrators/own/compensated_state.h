// State handling shared by polhode's tolerance-driven integrators: the compensated state, on any system
// (GeneralState) or in one register (RotationLanes), the error allowed per component, and the first step size.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "integrators/lanes/rotation_lanes.h"
#include "integrators/run/march.h"
#include "integrators/run/march_controlled.h"
#include "motion/numbers.h"

namespace polhode {

// Floor for squared error scales.
inline constexpr double min_squared_scale = 1e-290;

/// Returns a first step, s: 0.8 over the fastest rate of y and of dy/dt in units of the scales, at most `longest`. The
/// rate of dy/dt comes from a short Euler step. Costs two evaluations.
template <class SystemType, class Values>
double estimate_first_step(const SystemType& system, double t, const double* y, const Values& scales, double longest) {
    const std::size_t N = scales.size();
    Values f = scales, z = scales, f_ahead = scales;
    system.derivative(t, y, f.data());
    double rate = 0;
    for (std::size_t i = 0; i < N; ++i) rate = std::max(rate, std::abs(f[i]) / scales[i]);
    const double h = std::min(1e-3 / rate, 1e-3 * longest);
    for (std::size_t i = 0; i < N; ++i) z[i] = y[i] + h * f[i];
    system.derivative(t + h, z.data(), f_ahead.data());
    for (std::size_t i = 0; i < N; ++i) rate = std::max(rate, std::sqrt(std::abs(f_ahead[i] - f[i]) / h / scales[i]));
    const double first = 0.8 / rate;
    return first > 0 && first < longest ? first : longest;
}

/// y + lost for one of the systems, with any right-hand side.
template <class SystemType>
class GeneralState {
  public:
    using Y = Numbers<SystemType::dimension>;

    GeneralState(const Problem& problem, double tolerance) : system_(problem) {
        system_.scales(scales_.data());
        for (int i = 0; i < system_.size(); ++i)
            squared_scale_[i] = min_squared_scale + (tolerance * scales_[i]) * (tolerance * scales_[i]);
        restart();
    }
    void restart() {
        system_.initial(y_.data());
        clear_rounding_error();
    }
    void enter(const Segment& segment) {
        if (system_.enter(segment, y_.data())) clear_rounding_error();
    }
    double first_step(double t, double longest) { return estimate_first_step(system_, t, y_.data(), scales_, longest); }
    void accept() {
        y_ = next_, lost_ = next_lost_;
        if (project_step(system_, y_.data())) clear_rounding_error();
    }
    const double* state() const { return y_.data(); }
    auto sample(double t) const { return system_.motion(t, y_.data()); }
    std::vector<double> switch_values() const requires SwitchingSystem<SystemType> {
        return system_.switch_values(y_.data());
    }
    std::string cross_switch(std::size_t which) requires SwitchingSystem<SystemType> {
        return system_.cross_switch(which, y_.data());
    }

  protected:
    /// next = y + lost + large + small, component i.
    void add(int i, double large, double small) {
        const double sum = y_[i] + large;
        const double rest = (small + lost_[i]) + rounded_away(y_[i], large, sum);
        next_[i] = sum + rest;
        next_lost_[i] = rounded_away(sum, rest, next_[i]);
    }

    void clear_rounding_error() { std::fill(lost_.begin(), lost_.end(), 0); }

    SystemType system_;
    Y scales_{system_.size()}, squared_scale_ = scales_, y_ = scales_, lost_ = scales_, next_ = scales_,
                               next_lost_ = scales_;
};

/// A state whose right-hand side switches; see march_controlled().
template <class State>
concept SwitchingState = requires(State s, std::size_t which) {
    s.switch_values();
    s.cross_switch(which);
};

/// The compensated state in registers, for rotations whose torques have coefficients.
template <class SystemType>
class RotationLanes {
  public:
    /// Returns whether all torques of the problem have coefficients, with terms up to `most`.
    static bool supports(const Problem& problem, RotationTerms most = RotationTerms::quadratic) {
        return std::all_of(problem.segments.begin(), problem.segments.end(), [&](const Segment& segment) {
            const auto c = rotation_coefficients(problem.body.principal_inertia, segment_forcing(segment));
            return c && c->terms <= most;
        });
    }
    RotationLanes(const Problem& problem, double tolerance, double rounding) : problem_(&problem), system_(problem) {
        system_.scales(scales_.data());
        allowance_.rounding = rounding;
        allowance_.squared_scale[7] = 1;
        for (int i = 0; i < 7; ++i)
            allowance_.squared_scale[i] = min_squared_scale + (tolerance * scales_[i]) * (tolerance * scales_[i]);
        restart();
    }
    void restart() {
        state_ = {};
        system_.initial(state_.y);
    }
    void enter(const Segment& segment) {
        if (system_.enter(segment, state_.y)) std::fill_n(state_.lost, 8, 0.0);
        coefficients_ = *rotation_coefficients(problem_->body.principal_inertia, segment_forcing(segment));
    }
    double first_step(double t, double longest) { return estimate_first_step(system_, t, state_.y, scales_, longest); }
    void accept() { state_ = next_.state; }
    auto sample(double t) const { return system_.motion(t, state_.y); }

  protected:
    static const Forcing<double>* segment_forcing(const Segment& segment) {
        return SystemType::has_torque ? &segment.forcing : nullptr;
    }

    const Problem* problem_;
    SystemType system_;
    RotationCoefficients coefficients_;
    RotationAllowance allowance_;
    std::array<double, 7> scales_{};
    RotationState state_;
    RotationStep next_;
};

}  // namespace polhode
