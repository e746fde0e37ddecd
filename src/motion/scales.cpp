#include <algorithm>
#include <array>
#include <cmath>

#include "motion/contact.h"
#include "motion/needs.h"
#include "motion/scout.h"
#include "motion/systems.h"

namespace polhode {
namespace {

constexpr long scout_steps = 20000;

template <class SystemType, std::size_t N>
double largest_change(const std::array<double, N>& difference, const std::array<double, N>& y) {
    // the rates and the other components are each compared with their own size
    double worst = 0, rate = 0;
    constexpr std::size_t rates = SystemType::rates;
    for (std::size_t i = 0; i < rates; ++i) rate = std::max(rate, std::abs(y[i]));
    for (std::size_t i = 0; i < N; ++i) {
        const double size = i < rates ? rate : std::max(1.0, std::abs(y[i]));
        const double change = std::abs(difference[i]);
        if (change > 0) worst = std::max(worst, size > 0 ? change / size : 1.0);
    }
    return worst;
}

void note(const Problem& problem, const Sample& sample, Scales& scales) {
    const auto raise = [](double& scale, double value) {
        if (std::isfinite(value)) scale = std::max(scale, value);
    };
    raise(scales.angular_velocity, length(sample.angular_velocity_B));
    if (problem.body.pivoted && problem.formulation == Formulation::reduced) return;
    raise(scales.position, length(sample.position_W));
    raise(scales.velocity, length(sample.velocity_W));
}

template <class SystemType>
void scout(const Problem& problem, Scales& scales) {
    using Y = std::array<double, SystemType::dimension>;
    Y y{};
    SystemType f(problem);
    f.initial(y.data());
    long steps = 0;
    for (const Segment& segment : problem.segments) {
        f.enter(segment, y.data());
        note(problem, f.motion(segment.begin, y.data()), scales);
        const auto rate = [&](double t, const Y& at, Y& dy) { f.derivative(t, at.data(), dy.data()); };
        const auto on_step = [&](double t, Y& at) {
            bool has_impact = false;
            if constexpr (SystemType::has_translation)
                // like impact_stepping: a body that penetrates a plane is reflected
                has_impact = problem.body.geometry->any() && resolve_plane_impacts(problem, 0, at.data()).has_impact;
            note(problem, f.motion(t, at.data()), scales);
            return has_impact;
        };
        if (!scout_leg(segment, y, steps, scout_steps, rate, largest_change<SystemType, std::tuple_size_v<Y>>, on_step))
            return;
    }
}

}  // namespace

void find_scales(Problem& problem) {
    Scales scales{0, 0, 0};
    with_one_body(problem, [&]<class SystemType>() { scout<SystemType>(problem, scales); });
    // a motion at rest has no scale: use one radian and one metre over the duration
    if (scales.angular_velocity == 0) scales.angular_velocity = 1 / problem.scene.duration;
    if (scales.position == 0) scales.position = 1;
    if (scales.velocity == 0) scales.velocity = scales.position / problem.scene.duration;
    problem.scales = scales;
}

}  // namespace polhode
