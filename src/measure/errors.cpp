#include "measure/errors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace polhode {

ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference) {
    if (is_mechanism(scene)) return system_error_series(scene, trajectory, reference);
    const std::span<const Measure> all = measures();
    const ExactBody<Wide> body = exact_body<Wide>(scene);
    const std::size_t samples = trajectory.samples.size(),
                      compared = reference.available ? std::min(samples, reference.samples.size()) : 0;
    PerMeasure<Wide> scale;
    std::vector<TrueState<Wide>> truth;
    for (const ReferenceSample& sample : reference.samples) {
        truth.push_back(true_state(body, sample));
        for (std::size_t m = 0; m < all.size(); ++m)
            if (all[m].scale) scale[m] = std::max(scale[m], all[m].scale(truth.back()));
    }
    ErrorSeries series;
    for (std::size_t k = 0; k < samples; ++k) {
        const Sample& sample = trajectory.samples[k];
        series.t.push_back(sample.t);
        ComparedSample<Wide> c;
        c.q = cast<Wide>(sample.q), c.angular_velocity_B = cast<Wide>(sample.angular_velocity_B);
        c.position_W = cast<Wide>(sample.position_W), c.velocity_W = cast<Wide>(sample.velocity_W);
        if (!trajectory.orthogonality_defect.empty()) c.orthogonality_defect = trajectory.orthogonality_defect[k];
        if (k < compared) {
            if (sample.t != reference.samples[k].t)
                throw std::invalid_argument("trajectory and truth are sampled at different times");
            set_invariants(c, scene, body, sample.t, normalized(c.q));
            c.truth = truth[k];
        }
        for (std::size_t m = 0; m < all.size(); ++m)
            if (all[m].of_one_body() && (k < compared || (all[m].needs & known_truth) == 0)) {
                const Wide error = all[m].error(c);
                series[m].push_back(double(scale[m] > 0 ? error / scale[m] : error));
            }
    }
    return series;
}

Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference) {
    Errors result;
    if (trajectory.status != Status::ok || trajectory.samples.empty()) return result;
    result.worst_body = series.worst_body;
    for (std::size_t m = 0; m < measures().size(); ++m) {
        const std::vector<double>& values = series[m];
        const bool by_truth = (measures()[m].needs & known_truth) != 0;
        if (values.empty() || (by_truth && (!reference.available || values.size() != reference.moments()))) continue;
        result[m].final = values.back();
        // what is not a number at some sample has no largest
        const double most = *std::max_element(values.begin(), values.end());
        if (std::isfinite(most) && std::ranges::none_of(values, [](double x) { return std::isnan(x); }))
            result[m].max = most;
    }
    return result;
}

}  // namespace polhode
