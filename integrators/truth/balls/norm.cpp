#include "integrators/truth/balls/norm.h"

#include <arb_mat.h>

#include <algorithm>
#include <cmath>

#include "integrators/series/linear_algebra.h"
#include "integrators/series/series.h"
#include "integrators/truth/balls/jacobian_sampler.h"
#include "integrators/truth/balls/matrix.h"
#include "integrators/truth/euler_form.h"
#include "integrators/truth/strong_damping.h"

namespace polhode::truth {
namespace {

constexpr long bound_bits = 64;

// Proves that all eigenvalues of a symmetric matrix of doubles are below `limit`: limit 1 - M has a Cholesky factor.
bool eigenvalues_below(const Eigen::MatrixXd& M, double limit) {
    const slong n = M.rows();
    arb_mat_t A, L;
    arb_mat_init(A, n, n);
    arb_mat_init(L, n, n);
    for (slong i = 0; i < n; ++i)
        for (slong j = 0; j < n; ++j) {
            arb_set_d(arb_mat_entry(A, i, j), -M(i, j));
            if (i == j) {
                const Ball add(limit);
                arb_add(arb_mat_entry(A, i, j), arb_mat_entry(A, i, j), add.raw(), ARF_PREC_EXACT);
            }
        }
    const bool below = arb_mat_cho(L, A, 2 * bound_bits) != 0;
    arb_mat_clear(A);
    arb_mat_clear(L);
    return below;
}

double largest_eigenvalue(const Eigen::MatrixXd& symmetric) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

}  // namespace

double growth_bits(const std::vector<JacobianSample>& visits, const Eigen::MatrixXd& S) {
    const Eigen::MatrixXd inverse = S.inverse();
    double sum = 0;
    for (const JacobianSample& visit : visits) {
        const Eigen::MatrixXd B = S * visit.J * inverse;
        // a negative norm gains nothing: the error made at the end remains
        sum += std::max(0.0, largest_eigenvalue((B + B.transpose()) / 2)) * visit.seconds;
    }
    return sum / std::log(2.0);
}

std::vector<PiecePlan> plan_pieces(const Problem& problem) {
    const EulerForm<double> form(problem.scene);
    const int n = form.dimension();
    const std::vector<Block> layout = form.blocks(problem.scales, problem.body.principal.moments);
    const std::size_t blocks = layout.size();
    // metric of the kinetic energy: w . I w / trace I
    const Matrix3<double>& I = problem.body.inertia_B;
    const double trace = I[0][0] + I[1][1] + I[2][2];
    Eigen::Matrix3d metric;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) metric(i, j) = I[i][j] / trace;
    const Eigen::Matrix3d C = metric.llt().matrixU();

    const auto weights = [&](const double* log2_weight) {
        Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
        for (std::size_t b = 0; b < blocks; ++b) {
            const auto& [first, count, size] = layout[b];
            for (int i = first; i < first + count; ++i)
                for (int j = first; j < first + count; ++j)
                    S(i, j) = std::exp2(log2_weight[b]) / size * (b == 0 ? C(i, j) : i == j ? 1.0 : 0.0);
        }
        return S;
    };
    const auto spread = [&](const double* log2_weight) {
        const auto [least, most] = std::minmax_element(log2_weight, log2_weight + blocks);
        return *most - *least;
    };

    JacobianSampler<EulerForm<double>> sampler(problem.scene, layout);
    std::vector<PiecePlan> plans;
    for (const Segment& segment : problem.segments) {
        const std::vector<JacobianSample> visits = sampler.visits(segment.begin, segment.end);
        double best[4] = {0, 0, 0, 0}, cost = growth_bits(visits, weights(best)) + spread(best);
        for (const double stride : {8.0, 2.0, 0.5})
            for (bool better = true; better;) {
                better = false;
                for (std::size_t b = 0; b < blocks; ++b)
                    for (const double move : {stride, -stride}) {
                        double tried[4];
                        std::copy_n(best, 4, tried);
                        tried[b] += move;
                        if (std::abs(tried[b]) > 200) continue;
                        const double c = growth_bits(visits, weights(tried)) + spread(tried);
                        if (c < cost - 1e-3) std::copy_n(tried, 4, best), cost = c, better = true;
                    }
            }
        PiecePlan plan;
        plan.dimension = n;
        const Eigen::MatrixXd S = weights(best);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) plan.weights.push_back(S(i, j));
        for (const Block& block : layout) plan.scales.insert(plan.scales.end(), block.size, block.scale);
        plan.blocks = layout;
        plan.growth_bits = growth_bits(visits, S), plan.spread_bits = spread(best);
        plan.damping_number = damping_number(problem, segment);
        plans.push_back(std::move(plan));
    }
    return plans;
}

WeightedNorm::WeightedNorm(const PiecePlan& plan)
    : n_(plan.dimension), inverse_(inverse_of(plan.weights, static_cast<std::size_t>(n_), 2 * bound_bits)) {
    for (const double weight : plan.weights) S_.emplace_back(weight);
    double most = 0;
    const std::vector<Bound> unit = components(Bound(1.0));
    for (int i = 0; i < n_; ++i) most = std::max(most, unit[i].near() / plan.scales[i]);
    allowed_ = Bound(0x1p-20 / most);
}

Bound WeightedNorm::length(const std::vector<Bound>& component) const {
    Bound sum;
    for (int i = 0; i < n_; ++i) {
        Bound z;
        for (int j = 0; j < n_; ++j)
            if (!S_[i * n_ + j].is_zero()) z += Bound(S_[i * n_ + j]) * component[j];
        sum += z * z;
    }
    return root(sum);
}

std::vector<Bound> WeightedNorm::components(const Bound& length) const {
    std::vector<Bound> result;
    for (int i = 0; i < n_; ++i) {
        Bound sum;
        for (int j = 0; j < n_; ++j) {
            const Bound entry(inverse_[i * n_ + j]);
            sum += entry * entry;
        }
        result.push_back(root(sum) * length);
    }
    return result;
}

Ball WeightedNorm::logarithmic_norm(const Recording<Ball>& recording, const std::vector<Ball>& box) const {
    const WorkingPrecision precision(bound_bits);
    const std::vector<Ball> J = jacobian_of(recording, box.data());
    const auto n = static_cast<std::size_t>(n_);
    const std::vector<Ball> B = product(product(S_, J, n), inverse_, n);
    // (B + B^T)/2 = M + rest, M in exact doubles; the norm of the rest is at most its largest row sum
    Eigen::MatrixXd M(n_, n_);
    Bound rest;
    for (int i = 0; i < n_; ++i) {
        Bound row;
        for (int j = 0; j < n_; ++j) {
            const Ball entry = (B[i * n_ + j] + B[j * n_ + i]) * Ball(0.5);
            M(i, j) = entry.near();  // symmetric: both orders give the same sum
            row += Bound(entry - Ball(M(i, j)));
        }
        if (rest < row) rest = row;
    }
    Ball unknown;
    arb_pos_inf(unknown.raw());
    if (!rest.is_finite() || !M.allFinite()) return unknown;
    const double near = largest_eigenvalue(M), size = M.cwiseAbs().maxCoeff();
    double slack = 1e-12 * size;
    while (slack <= size + 1e-300) {
        if (eigenvalues_below(M, near + slack)) return Ball(near + slack) + rest.ball();
        slack = 16 * slack + 1e-300;
    }
    return unknown;
}

Recording<Ball> rounded(const Recording<Ball>& recording) {
    Recording<Ball> result = recording;
    const auto round = [](Ball& x) { arb_set_round(x.raw(), x.raw(), Ball::precision()); };
    for (TapeNode<Ball>& node : result.tape.nodes) round(node.factor_a), round(node.factor_b);
    for (Traced<Ball>& rate : result.rates) round(rate.factor);
    return result;
}

}  // namespace polhode::truth
