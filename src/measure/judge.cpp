#include "measure/judge.h"

#include <algorithm>
#include <stdexcept>

#include "measure/errors.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

Vector3<double> rounded(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }

// |a - b| with the difference formed in 128 bits
double distance(const Vector3<double>& a, const Vector3<Pair>& b) {
    Vector3<Wide> difference;
    for (int i = 0; i < 3; ++i) difference[i] = Wide(a[i]) - Wide(b[i].high) - Wide(b[i].low);
    return double(square_root(dot(difference, difference)));
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

}  // namespace

Judgement judge(const Scene& scene, const TrajectoryFile& file, const Reference& truth) {
    if (!truth.available || truth.samples.size() != file.rows.size())
        throw std::invalid_argument("there is no truth at the file's times");
    const bool has_position = file.has_position || file.has_origin;
    Trajectory trajectory;
    trajectory.samples = samples_of(file, scene.body.center_of_mass);
    Judgement result;
    for (std::size_t k = 0; k < truth.samples.size(); ++k) {
        Sample& sample = trajectory.samples[k];
        const ReferenceSample& exact = truth.samples[k];
        if (has_position)
            result.position_max =
                std::max(result.position_max.value_or(0), distance(sample.position_W, exact.position_W));
        if (file.has_velocity)
            result.velocity_max =
                std::max(result.velocity_max.value_or(0), distance(sample.velocity_W, exact.velocity_W));
        // what the file does not tell is not judged: the truth stands in for it
        if (!file.has_angular_velocity) sample.angular_velocity_B = rounded(exact.angular_velocity_B);
        if (!has_position) sample.position_W = rounded(exact.position_W);
        if (!file.has_velocity) sample.velocity_W = rounded(exact.velocity_W);
    }
    const ErrorSeries series = error_series(scene, trajectory, truth);
    const auto worst = std::max_element(series.attitude.begin(), series.attitude.end());
    result.attitude_max = *worst;
    result.attitude_max_time = series.t[static_cast<std::size_t>(worst - series.attitude.begin())];
    result.attitude_final = series.attitude.back();
    result.norm_max = largest(series.norm);
    if (file.has_angular_velocity) {
        result.omega_max = largest(series.omega);
        result.momentum_max = largest(series.momentum);
        if (scene.pivot || (has_position && file.has_velocity)) result.energy_max = largest(series.energy);
    }
    return result;
}

}  // namespace polhode
