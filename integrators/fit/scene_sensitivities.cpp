#include "integrators/fit/scene_sensitivities.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "body/algebra.h"
#include "body/wide_decimal.h"
#include "integrators/run/processor_time.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

constexpr int reference_digits = 34;

/// The state of a body in 113 bits, angular velocity in world axes.
struct WideState {
    Quaternion<Wide> q;
    Vector3<Wide> w_W, p_W, v_W;
};

/// The reference at all times, then by body.
struct WideMotion {
    std::vector<WideState> states;
    std::string fault;
};

WideMotion wide_motion(const Scene& scene, const std::vector<double>& times, double seconds) {
    const DecimalReference truth = decimal_reference(scene, times, reference_digits, seconds);
    WideMotion motion;
    if (!truth.available) {
        motion.fault = truth.message;
        return motion;
    }
    for (const DecimalColumns& columns : truth.columns) {
        std::array<Wide, 13> x{};
        std::ranges::transform(columns, x.begin(), [](const std::string& text) { return parse_wide(text); });
        motion.states.push_back(
            {{x[0], x[1], x[2], x[3]}, {x[4], x[5], x[6]}, {x[7], x[8], x[9]}, {x[10], x[11], x[12]}});
    }
    return motion;
}

using Differences = std::array<Wide, Sensitivities::quantities>;

// The rotation vector from b to a, and the differences of w, p and v.
Differences difference(const WideState& a, const WideState& b) {
    // (1, turn / 2) or its negative for a small rotation
    const Quaternion<Wide> change = a.q * conjugate(b.q);
    const Vector3<Wide> turn = Wide(change.w < 0 ? -2 : 2) * vector_part(change);
    Differences all;
    for (std::size_t i = 0; i < 3; ++i) {
        all[i] = turn[i], all[3 + i] = a.w_W[i] - b.w_W[i];
        all[6 + i] = a.p_W[i] - b.p_W[i], all[9 + i] = a.v_W[i] - b.v_W[i];
    }
    return all;
}

Sample sample_of(double t, const WideState& state) {
    const Quaternion<double> q = normalized(cast<double>(state.q));
    return {t, q, rotate_back(q, cast<double>(state.w_W)), cast<double>(state.p_W), cast<double>(state.v_W)};
}

}  // namespace

Sensitivities difference_sensitivities(const Scene& scene, std::span<const SceneChange> changes,
                                       const std::vector<double>& times, const SensitivitySettings& settings) {
    // a smooth motion deviates from the mean of its neighbours by the square of the change, 1e-12 of the derivative
    constexpr double largest_deviation = 1e-6;
    const double end = processor_time() + settings.seconds_limit;
    const auto seconds_left = [&] { return std::clamp(end - processor_time(), 1e-3, truth_seconds); };
    Sensitivities result;
    const auto failed = [&](const std::string& why) {
        result.status = Status::failed, result.message = why;
        return result;
    };
    const WideMotion base = wide_motion(scene, times, seconds_left());
    if (!base.fault.empty()) return failed(base.fault);
    const std::size_t rows = base.states.size(), n = changes.size();
    result.bodies = static_cast<int>(rows / times.size()), result.parameters = n;
    result.derivatives.resize(rows * Sensitivities::quantities * n);
    for (std::size_t row = 0; row < rows; ++row)
        result.samples.push_back(sample_of(times[row / static_cast<std::size_t>(result.bodies)], base.states[row]));
    for (std::size_t c = 0; c < n; ++c) {
        const WideMotion ahead = wide_motion(changes[c].ahead, times, seconds_left());
        const WideMotion behind = wide_motion(changes[c].behind, times, seconds_left());
        for (const WideMotion* one : {&ahead, &behind})
            if (!one->fault.empty()) return failed(one->fault);
        for (std::size_t row = 0; row < rows; ++row) {
            const Differences forward = difference(ahead.states[row], base.states[row]),
                              backward = difference(base.states[row], behind.states[row]);
            for (std::size_t k = 0; k < Sensitivities::quantities; ++k) {
                const double derivative = static_cast<double>((forward[k] + backward[k]) / Wide(changes[c].by));
                const double deviation = static_cast<double>((forward[k] - backward[k]) / Wide(changes[c].by));
                if (!(std::abs(deviation) <= largest_deviation * (1 + std::abs(derivative))))
                    return failed(
                        fmt::format("the motion at t = {:g} s has no derivative with respect to number {}: "
                                    "an event is there, or events change",
                                    result.samples[row].t, c + 1));
                result.derivatives[(row * Sensitivities::quantities + k) * n + c] = derivative;
            }
        }
    }
    return result;
}

Sensitivities scene_sensitivities(const Scene& scene, std::span<const SceneChange> changes,
                                  const std::vector<double>& times, const SensitivitySettings& settings) {
    return part_with_events(scene).empty() ? sensitivities(scene, changes, times, settings)
                                           : difference_sensitivities(scene, changes, times, settings);
}

}  // namespace polhode
