#include <algorithm>
#include <array>
#include <cmath>

#include "motion/contact.h"
#include "motion/needs.h"
#include "motion/systems.h"

namespace polhode {
namespace {

constexpr long scout_steps = 20000;
constexpr double scout_tolerance = 1e-3;

template <class SystemType, std::size_t N>
double largest_change(const std::array<double, N>& difference, const std::array<double, N>& y) {
    // rates first, then the rest: each block against its own size
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

// Bogacki & Shampine (1989), orders 3 and 2.
template <class SystemType>
void scout(const Problem& problem, Scales& scales) {
    constexpr int N = SystemType::dimension;
    using Y = std::array<double, N>;
    Y y{};
    SystemType f(problem);
    f.initial(y.data());
    long steps = 0;
    for (const Segment& segment : problem.segments) {
        f.enter(segment, y.data());
        note(problem, f.motion(segment.begin, y.data()), scales);
        double t = segment.begin;
        Y k1{}, k2{}, k3{}, k4{}, z{}, next{}, difference{};
        f.derivative(t, y.data(), k1.data());
        double h = (segment.end - segment.begin) / 100;
        while (t < segment.end) {
            if (++steps > scout_steps) return;
            h = std::min(h, segment.end - t);
            for (int i = 0; i < N; ++i) z[i] = y[i] + h / 2 * k1[i];
            f.derivative(t + h / 2, z.data(), k2.data());
            for (int i = 0; i < N; ++i) z[i] = y[i] + h * 3 / 4 * k2[i];
            f.derivative(t + h * 3 / 4, z.data(), k3.data());
            for (int i = 0; i < N; ++i) next[i] = y[i] + h / 9 * (2 * k1[i] + 3 * k2[i] + 4 * k3[i]);
            f.derivative(t + h, next.data(), k4.data());
            for (int i = 0; i < N; ++i) difference[i] = h * (-5.0 / 72 * k1[i] + k2[i] / 12 + k3[i] / 9 - k4[i] / 8);
            const double error = largest_change<SystemType>(difference, next) / scout_tolerance;
            if (!std::isfinite(error) || error > 1) {
                h *= std::isfinite(error) ? std::max(0.2, 0.9 * std::cbrt(1 / error)) : 0.1;
                if (t + h == t) return;
                continue;
            }
            t = segment.end - t <= h ? segment.end : t + h;
            y = next, k1 = k4;
            if constexpr (SystemType::has_translation)
                // as impact_stepping: what is too deep is sent back
                if (problem.body.geometry->any() && strike_planes(problem, 0, y.data()).struck)
                    f.derivative(t, y.data(), k1.data());
            note(problem, f.motion(t, y.data()), scales);
            h *= error > 0 ? std::min(5.0, 0.9 * std::cbrt(1 / error)) : 5.0;
        }
    }
}

}  // namespace

void find_scales(Problem& problem) {
    Scales scales{0, 0, 0};
    with_one_body(problem, [&]<class SystemType>() { scout<SystemType>(problem, scales); });
    // a motion at rest has no scale of its own: one radian, metre over the duration
    if (scales.angular_velocity == 0) scales.angular_velocity = 1 / problem.scene.duration;
    if (scales.position == 0) scales.position = 1;
    if (scales.velocity == 0) scales.velocity = scales.position / problem.scene.duration;
    problem.scales = scales;
}

}  // namespace polhode
