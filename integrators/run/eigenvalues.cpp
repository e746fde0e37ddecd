#include "integrators/run/eigenvalues.h"

#include <Eigen/Dense>

#include "motion/dual.h"

namespace polhode {
namespace {

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

template <class SystemType>
std::vector<std::complex<double>> eigenvalues_on(const Problem& problem, const Sample& sample) {
    constexpr int N = SystemType::dimension;
    double y[N], J[N * N];
    state_of<SystemType>(problem, sample, y);
    jacobian(system_on<SystemType>(problem, problem.segments[segment_at(problem, sample.t)]), sample.t, y, J);
    const Eigen::MatrixXd matrix = Eigen::Map<const Eigen::Matrix<double, N, N, Eigen::RowMajor>>(J);
    if (!matrix.allFinite()) return {};
    const Eigen::VectorXcd values = matrix.eigenvalues();
    return {values.begin(), values.end()};
}

}  // namespace

std::vector<std::complex<double>> eigenvalues(const Problem& problem, const Sample& sample) {
    std::vector<std::complex<double>> found;
    with_system(problem, [&]<class SystemType>() {
        found = eigenvalues_on<SystemType>(problem, sample);
        return Trajectory{};
    });
    return found;
}

std::complex<double> largest_in_magnitude(std::span<const std::complex<double>> eigenvalues) {
    std::complex<double> largest = 0;
    for (const std::complex<double>& value : eigenvalues)
        if (std::abs(value) > std::abs(largest)) largest = value;
    return {largest.real(), std::abs(largest.imag())};
}

}  // namespace polhode
