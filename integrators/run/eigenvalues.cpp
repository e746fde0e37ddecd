#include "integrators/run/eigenvalues.h"

#include <cmath>

#include "integrators/series/linear_algebra.h"
#include "motion/jacobian.h"

namespace polhode {
namespace {

template <class SystemType>
std::vector<std::complex<double>> eigenvalues_on(const Problem& problem, const Sample& sample) {
    constexpr int N = SystemType::dimension;
    double y[N], J[N * N];
    const SystemType system(problem, problem.segments[segment_at(problem, sample.t)]);
    system.state(sample, y);
    jacobian(system, sample.t, y, J);
    return eigenvalues(J);
}

}  // namespace

std::vector<std::complex<double>> eigenvalues(std::span<const double> J) {
    const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(J.size()))));
    const Eigen::MatrixXd matrix =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(J.data(), n, n);
    if (!matrix.allFinite()) return {};
    const Eigen::VectorXcd values = matrix.eigenvalues();
    return {values.begin(), values.end()};
}

std::vector<std::complex<double>> eigenvalues(const Problem& problem, const Sample& sample) {
    // a sample of such a system does not contain its state
    if (problem.model()) return {};
    return with_one_body(problem, [&]<class SystemType>() { return eigenvalues_on<SystemType>(problem, sample); });
}

std::complex<double> largest_in_magnitude(std::span<const std::complex<double>> eigenvalues) {
    std::complex<double> largest = 0;
    for (const std::complex<double>& value : eigenvalues)
        if (std::abs(value) > std::abs(largest)) largest = value;
    return {largest.real(), std::abs(largest.imag())};
}

}  // namespace polhode
