#include "measure/errors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "motion/exact_body.h"

namespace polhode {
namespace {

Wide wide(const Pair& pair) { return Wide(pair.high) + Wide(pair.low); }
Vector3<Wide> wide(const Vector3<Pair>& v) { return {wide(v[0]), wide(v[1]), wide(v[2])}; }
Quaternion<Wide> wide(const Quaternion<Pair>& q) { return {wide(q.w), wide(q.x), wide(q.y), wide(q.z)}; }

Wide length(const Vector3<Wide>& v) { return square_root(dot(v, v)); }
Wide magnitude(const Wide& x) { return x < 0 ? -x : x; }

double relative(const Wide& difference, const Wide& scale) {
    return double(scale > 0 ? difference / scale : difference);
}

// the angle from the two parts of a quaternion of any length: it scales out
double rotation_angle(const Quaternion<Wide>& r) {
    return 2 * std::atan2(double(length(vector_part(r))), double(magnitude(r.w)));
}

}  // namespace

double attitude_error(const Quaternion<double>& q, const Quaternion<Pair>& reference) {
    return rotation_angle(conjugate(wide(reference)) * cast<Wide>(q));
}

std::vector<double> norm_errors(const Trajectory& trajectory) {
    if (!trajectory.orthogonality_defect.empty()) return trajectory.orthogonality_defect;
    std::vector<double> result;
    for (const Sample& sample : trajectory.samples) {
        const Quaternion<Wide> q = cast<Wide>(sample.q);
        // |q| - 1 = (|q|^2 - 1) / (|q| + 1), with nothing cancelled in binary64
        const Wide square = squared_norm(q);
        result.push_back(double(magnitude(square - 1) / (square_root(square) + 1)));
    }
    return result;
}

ErrorSeries error_series(const Scene& scene, const Trajectory& trajectory, const Reference& reference) {
    ErrorSeries series;
    series.norm = norm_errors(trajectory);
    for (const Sample& sample : trajectory.samples) series.t.push_back(sample.t);
    if (!reference.available) return series;

    const ExactBody<Wide> body = exact_body<Wide>(scene);
    Wide omega_scale = 0, momentum_scale = 0, energy_scale = 0;
    for (const ReferenceSample& truth : reference.samples) {
        const Vector3<Wide> w = wide(truth.angular_velocity_B), v = wide(truth.velocity_W);
        Wide kinetic = dot(w, body.inertia_B * w) / 2;
        if (!body.pivoted) kinetic += body.mass * dot(v, v) / 2;
        omega_scale = std::max(omega_scale, length(w));
        momentum_scale = std::max(momentum_scale, length(wide(truth.angular_momentum_W)));
        energy_scale = std::max({energy_scale, kinetic, magnitude(wide(truth.energy))});
    }
    const std::size_t count = std::min(trajectory.samples.size(), reference.samples.size());
    for (std::size_t k = 0; k < count; ++k) {
        const Sample& sample = trajectory.samples[k];
        const ReferenceSample& truth = reference.samples[k];
        if (sample.t != truth.t) throw std::invalid_argument("trajectory and truth are sampled at different times");
        const Quaternion<Wide> q = cast<Wide>(sample.q), unit = normalized(q);
        const Vector3<Wide> w = cast<Wide>(sample.angular_velocity_B);
        const Invariants<Wide> own =
            invariants(scene, body, sample.t, unit, w, cast<Wide>(sample.position_W), cast<Wide>(sample.velocity_W));
        series.attitude.push_back(rotation_angle(conjugate(wide(truth.q)) * q));
        series.omega.push_back(relative(length(w - wide(truth.angular_velocity_B)), omega_scale));
        series.momentum.push_back(
            relative(length(own.angular_momentum_W - wide(truth.angular_momentum_W)), momentum_scale));
        series.energy.push_back(relative(magnitude(own.energy - wide(truth.energy)), energy_scale));
    }
    return series;
}

Errors errors(const ErrorSeries& series, const Trajectory& trajectory, const Reference& reference) {
    Errors result;
    if (trajectory.status != Status::ok || trajectory.samples.empty()) return result;
    const auto largest = [](const std::vector<double>& values) -> std::optional<double> {
        if (values.empty()) return {};
        const double most = *std::max_element(values.begin(), values.end());
        return std::isfinite(most) ? std::optional(most) : std::nullopt;
    };
    result.norm_max = largest(series.norm);
    if (!reference.available || series.attitude.size() != reference.samples.size()) return result;
    result.attitude_final = series.attitude.back();
    result.attitude_max = largest(series.attitude);
    result.omega_max = largest(series.omega);
    result.energy_max = largest(series.energy);
    result.momentum_max = largest(series.momentum);
    return result;
}

}  // namespace polhode
