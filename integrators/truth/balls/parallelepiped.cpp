#include "integrators/truth/balls/parallelepiped.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "integrators/series/linear_algebra.h"
#include "integrators/truth/balls/matrix.h"

namespace polhode::truth {
namespace {

constexpr long bits = 64;

}  // namespace

Parallelepiped::Parallelepiped(std::vector<double> scales, const std::vector<Bound>& radius)
    : n_(scales.size()), scales_(std::move(scales)), Q_(n_ * n_) {
    const WorkingPrecision precision(bits);
    for (std::size_t i = 0; i < n_; ++i) {
        Q_[i * n_ + i] = scales_[i];
        r_.push_back(Bound(radius[i].ball() / Ball(scales_[i])));
    }
}

std::vector<Bound> Parallelepiped::components() const {
    std::vector<Bound> result(n_);
    for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t k = 0; k < n_; ++k) result[i] += Bound(std::abs(Q_[i * n_ + k])) * r_[k];
    return result;
}

std::vector<Ball> Parallelepiped::times_Q(const std::vector<Ball>& W) const {
    std::vector<Ball> Q;
    for (const double entry : Q_) Q.emplace_back(entry);
    return product(W, Q, n_);
}

std::vector<Bound> Parallelepiped::times_r(const std::vector<Ball>& M) const {
    std::vector<Bound> result(n_);
    for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t k = 0; k < n_; ++k) result[i] += Bound(M[i * n_ + k]) * r_[k];
    return result;
}

std::vector<Bound> Parallelepiped::components_after(const std::vector<Ball>& W) const {
    const WorkingPrecision precision(bits);
    return times_r(times_Q(W));
}

void Parallelepiped::advance(const std::vector<Ball>& W, const std::vector<Bound>& added) {
    const WorkingPrecision precision(bits);
    const std::vector<Ball> M = times_Q(W);
    // The longest edge comes first: its direction is kept, and the others are orthogonalised against it. Lengths are
    // relative to the longest r, which may be smaller than the smallest double.
    double longest = -std::numeric_limits<double>::infinity();
    for (const Bound& r : r_) longest = std::max(longest, r.log2_near());
    const auto n = static_cast<Eigen::Index>(n_);
    Eigen::MatrixXd edges(n, n);
    for (std::size_t k = 0; k < n_; ++k) {
        const double length = r_[k].is_zero() ? 0x1p-200 : std::max(0x1p-200, std::exp2(r_[k].log2_near() - longest));
        for (std::size_t i = 0; i < n_; ++i)
            edges(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
                M[i * n_ + k].near() / scales_[i] * length;
    }
    std::vector<Eigen::Index> order(n_);
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return edges.col(a).squaredNorm() > edges.col(b).squaredNorm(); });
    Eigen::MatrixXd sorted(n, n);
    for (Eigen::Index k = 0; k < n; ++k) sorted.col(k) = edges.col(order[k]);
    if (sorted.allFinite()) {
        const Eigen::MatrixXd axes = Eigen::HouseholderQR<Eigen::MatrixXd>(sorted).householderQ();
        for (std::size_t i = 0; i < n_; ++i)
            for (std::size_t k = 0; k < n_; ++k)
                Q_[i * n_ + k] = scales_[i] * axes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
    }
    // r' = |Q'^-1 (W Q)| r + |Q'^-1| added
    const std::vector<Ball> inverse = inverse_of(Q_, n_, 2 * bits);
    std::vector<Bound> next = times_r(product(inverse, M, n_));
    for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t k = 0; k < n_; ++k) next[i] += Bound(inverse[i * n_ + k]) * added[k];
    r_ = std::move(next);
}

}  // namespace polhode::truth
