// Which method `auto` stands for.
#include "integrators/auto.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "integrators/exact.h"
#include "integrators/method.h"
#include "motion/dual.h"

namespace polhode {
namespace {

bool damps(const Problem& problem) {
    return std::any_of(problem.segments.begin(), problem.segments.end(), [&](const Segment& segment) {
        return segment.forcing.has_damping ||
               (segment.forcing.has_translational_drag && problem.needs.dimension == 13 && !problem.body.pivoted);
    });
}

// The state that a sample is of: the way back from sample_of().
template <class SystemType>
void state_of(const Problem& problem, const Sample& sample, double* y) {
    const Vector3<double> w = rotate_back(problem.q_BP, sample.angular_velocity_B);
    const Quaternion<double> q = sample.q * problem.q_BP;
    if constexpr (SystemType::dimension == 3) {
        const Quaternion<double> turned = conjugate(problem.initial_q) * q;
        y[0] = dot(problem.axis, w), y[1] = turned.w, y[2] = dot(problem.axis, vector_part(turned));
    } else {
        put(y, 0, w), put(y, 3, q);
    }
    if constexpr (SystemType::dimension == 13) put(y, 7, sample.position_W), put(y, 10, sample.velocity_W);
}

// The largest |lambda| of the eigenvalues that decay. Those of a motion that only turns lie on the imaginary axis, and
// rounding sets them beside it.
double decay_rate(const Eigen::MatrixXd& J) {
    double rate = 0;
    for (const std::complex<double>& lambda : J.eigenvalues())
        if (lambda.real() < -1e-3 * std::abs(lambda)) rate = std::max(rate, std::abs(lambda));
    return rate;
}

template <class SystemType>
double decay_rate_at(const Problem& problem, const Sample& sample) {
    constexpr int N = SystemType::dimension;
    double y[N], J[N * N];
    state_of<SystemType>(problem, sample, y);
    jacobian(system_on<SystemType>(problem, problem.segments[segment_at(problem, sample.t)]), sample.t, y, J);
    const Eigen::MatrixXd matrix = Eigen::Map<const Eigen::Matrix<double, N, N, Eigen::RowMajor>>(J);
    return matrix.allFinite() ? decay_rate(matrix) : 0;
}

}  // namespace

Stiffness stiffness(const Problem& problem) {
    const Method* method = find_method("radau");
    if (!method || !damps(problem) || problem.needs.user_torque || !problem.scene.planes.empty()) return {};
    Settings settings;
    settings.tolerance = 1e-3, settings.samples = 50, settings.max_steps = 5000;
    const Trajectory trajectory = solve(problem, *method, settings);
    if (trajectory.status != Status::ok) return {};
    Stiffness found;
    const std::vector<Sample>& samples = trajectory.samples;
    with_system(problem, [&]<class SystemType>() {
        for (std::size_t k = 0; k < samples.size(); ++k) {
            // the trapezoidal rule
            const double before = k > 0 ? samples[k].t - samples[k - 1].t : 0;
            const double after = k + 1 < samples.size() ? samples[k + 1].t - samples[k].t : 0;
            const Vector3<double>& w = samples[k].angular_velocity_B;
            found.decays += (before + after) / 2 * decay_rate_at<SystemType>(problem, samples[k]);
            // a spin that is gone by the next sample has turned the body by far less than it would have
            found.turning += k > 0 ? before * std::sqrt(dot(w, w)) : 0;
        }
        return Trajectory{};
    });
    return found;
}

bool is_stiff(const Problem& problem) { return stiffness(problem).stiff(); }

Choice choose_method(const Problem& problem) {
    if (!problem.scene.planes.empty()) return {find_method("cvode_impacts"), "impacts on planes, located as events"};
    if (const Method* method = find_method("exact"); method && has_closed_form(problem))
        return {method, "the motion has a closed form"};
    if (is_stiff(problem))
        if (const Method* method = find_method("radau"))
            return {method, "the motion is stiff: it damps far faster than the body turns"};
    if (!problem.needs.user_torque)
        return {find_method("taylor"), "smooth motion without stiffness: a Taylor series comes nearest to round-off"};
    return {find_method("dop853"),
            "a torque of the user's own has no Taylor coefficients and may be rough: a Runge-Kutta pair of high order"};
}

}  // namespace polhode
