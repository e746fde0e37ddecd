#include "integrators/truth/dense.h"

#include <algorithm>
#include <cmath>

#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/collocation.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

using P = Real<50>;

// terms below 2^-60 of a block's scale are negligible compared with the rounding to binary64
constexpr double negligible = 0x1p-60;
constexpr long most_steps = 100'000;

int padded(int n) { return n <= BodyState::rotation ? 8 : 14; }

}  // namespace

template <int width>
void DenseTruth::evaluate(const Piece& piece, double t, double* y) const {
    const double x = ((t - piece.begin.high) - piece.begin.low) * piece.per_length;
    const double* row = coefficients_.data() + piece.offset + static_cast<std::size_t>(piece.degree) * width;
    double sum[width] = {};
    for (int k = piece.degree; k > 0; --k, row -= width)
        for (int i = 0; i < width; ++i) sum[i] = (sum[i] + row[i]) * x;
    const double* low = row + static_cast<std::size_t>(piece.degree + 1) * width;
    for (int i = 0; i < width; ++i) y[i] = row[i] + (low[i] + sum[i]);
}

ReferenceSample DenseTruth::at(double t) const {
    const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), t, [](double time, const Piece& piece) {
        return time < piece.begin.high || (time == piece.begin.high && piece.begin.low > 0);
    });
    const Piece& piece = after == pieces_.begin() ? pieces_.front() : *(after - 1);
    double y[14];
    if (width_ == 8)
        evaluate<8>(piece, t, y);
    else
        evaluate<14>(piece, t, y);
    const Quaternion<double> q = BodyState::attitude(y);
    const Vector3<double> w = BodyState::angular_velocity(y);
    Vector3<double> p, v;
    if (body_.pivoted)
        pivoted_center(q, w, body_.arm, p, v);
    else
        p = BodyState::position(y), v = BodyState::velocity(y);
    const Invariants<double> conserved = invariants(scene_, body_, t, q, w, p, v);
    const auto pairs = [](const Vector3<double>& a) { return Vector3<Pair>{a[0], a[1], a[2]}; };
    ReferenceSample sample;
    sample.t = t, sample.q = {q.w, q.x, q.y, q.z}, sample.angular_velocity_B = pairs(w);
    sample.angular_momentum_W = pairs(conserved.angular_momentum_W), sample.energy = conserved.energy;
    sample.position_W = pairs(p), sample.velocity_W = pairs(v);
    return sample;
}

DenseTruth dense_reference(const Scene& scene, double end) {
    DenseTruth dense;
    if (is_mechanism(scene)) {
        dense.message = "polynomial references support only one body";
        return dense;
    }
    dense.scene_ = scene;
    // slightly longer, so that an event at the end also starts a piece
    dense.scene_.duration = end * (1 + 1e-6);
    validate(dense.scene_, scene.name);
    const Problem problem = pose(dense.scene_);
    if (problem.needs.user_torque) {
        dense.message = "user-defined torques have no reference solution";
        return dense;
    }
    if (!scene.planes.empty()) {
        dense.message = "polynomial references do not support impacts on planes";
        return dense;
    }
    const bool by_collocation = truth_method(problem) == "collocation";
    dense.body_ = exact_body<double>(dense.scene_);
    const std::vector<double> times = sample_times(end, 256);

    const truth::EulerForm<P> form(dense.scene_);
    const int n = form.dimension(), width = padded(n);
    dense.width_ = width;
    const std::vector<truth::Block> blocks = form.blocks(problem.scales, problem.body.principal.moments);
    // scaled(i, k): the coefficient of ((t - begin) / h)^k in the i-th variable
    const auto keep = [&](const P& t, const P& h, int order, const auto& scaled) {
        DenseTruth::Piece piece;
        piece.begin = pair_of(t), piece.per_length = P(1 / h).convert_to<double>();
        piece.offset = dense.coefficients_.size();
        dense.coefficients_.resize(piece.offset + static_cast<std::size_t>(order + 2) * width);
        double* row = dense.coefficients_.data() + piece.offset;
        int degree = 0, small = 0;
        for (int k = 0; k <= order && small < 3; ++k) {
            bool matters = false;
            for (const truth::Block& block : blocks)
                for (int i = block.first; i < block.first + block.size; ++i) {
                    const double c = scaled(i, k).template convert_to<double>();
                    row[static_cast<std::size_t>(k) * width + i] = c;
                    matters = matters || std::abs(c) > negligible * block.scale;
                }
            // three consecutive orders, because some may vanish by symmetry
            small = matters ? 0 : small + 1;
            degree = k;
        }
        piece.degree = degree;
        double* low = row + static_cast<std::size_t>(degree + 1) * width;
        std::fill_n(low, width, 0.0);
        for (int i = 0; i < n; ++i) low[i] = pair_of(scaled(i, 0)).low;
        dense.coefficients_.resize(piece.offset + static_cast<std::size_t>(degree + 2) * width);
        dense.pieces_.push_back(piece);
    };
    const auto keep_series = [&](const P& t, const P& h, const auto& series) {
        std::vector<P> powers{P(1)};
        for (int k = 0; k < series.order(); ++k) powers.push_back(powers.back() * h);
        keep(t, h, series.order(), [&](int i, int k) { return P(P(series.coefficient(i, k)) * powers[k]); });
    };
    // Converts the collocation polynomial to monomials by divided differences of as many values as it has coefficients.
    // The rounding errors are negligible in 50 digits.
    const auto keep_collocation = [&](const P& t, const P& h, const auto& step) {
        const int order = step.stages();
        std::vector<std::vector<P>> values(order + 1, std::vector<P>(n));
        std::vector<P> at, monomial(static_cast<std::size_t>(order + 1) * n, P(0));
        for (int j = 0; j <= order; ++j) {
            at.push_back(P(j) / order);
            step.evaluate(at[j], values[j].data());
        }
        for (int i = 0; i < n; ++i) {
            for (int level = 1; level <= order; ++level)
                for (int j = order; j >= level; --j)
                    values[j][i] = (values[j][i] - values[j - 1][i]) / (at[j] - at[j - level]);
            // Horner's rule on Newton's form: c <- c (x - at_j) + difference_j
            P* c = &monomial[static_cast<std::size_t>(i) * (order + 1)];
            for (int j = order; j >= 0; --j) {
                for (int k = order; k > 0; --k) c[k] = c[k - 1] - at[j] * c[k];
                c[0] = values[j][i] - at[j] * c[0];
            }
        }
        keep(t, h, order, [&](int i, int k) {
            return monomial[static_cast<std::size_t>(i) * (order + 1) + static_cast<std::size_t>(k)];
        });
    };

    const truth::Allowance allowance(truth_seconds);
    const truth::MpfrConstants constants;
    double local = 26, agreed = 0;
    std::string fault;
    for (int attempts = 0; attempts < 2 && local <= 44; ++attempts) {
        dense.pieces_.clear(), dense.coefficients_.clear();
        const Vector3<double>& moments = problem.body.principal.moments;
        std::string how;
        // orders and steps as in attempt_by_taylor() and attempt_by_collocation()
        truth::Run<P> first, other;
        if (by_collocation) {
            const int stages = std::max(16, static_cast<int>(std::ceil(0.6 * local)));
            const truth::CollocationSettings coarse{stages, local, most_steps}, fine{stages + 4, local + 2, most_steps};
            auto second = truth::in_thread([&] {
                return truth::collocation<P, truth::MomentumForm>(dense.scene_, times, problem.scales, moments, coarse);
            });
            first = truth::collocation<P, truth::EulerForm>(dense.scene_, times, problem.scales, moments, fine,
                                                            keep_collocation);
            other = second.get();
            how = fmt::format("collocation polynomials of {} and {} stages", fine.stages, coarse.stages);
        } else {
            const truth::TaylorRuns runs(local, most_steps);
            auto second = truth::in_thread([&] {
                return truth::taylor<P, truth::MomentumForm<P>>(dense.scene_, times, problem.scales, moments,
                                                                runs.coarse);
            });
            first = truth::taylor<P, truth::EulerForm<P>>(dense.scene_, times, problem.scales, moments, runs.fine,
                                                          keep_series);
            other = second.get();
            how = fmt::format("Taylor polynomials of order {} and {}", runs.fine.order, runs.coarse.order);
        }
        fault = first.fault.empty() ? other.fault : first.fault;
        if (!fault.empty()) break;
        const double difference = truth::disagreement(first, other);
        agreed = difference > 0 ? -std::log10(difference) : 50;
        if (agreed >= 17) {
            dense.available = true;
            // two roundings of a quaternion's components rotate it by at most 4 2^-53 2
            dense.bound = difference + 8 * 0x1p-53;
            dense.message =
                fmt::format("{} in {} and {} steps ({}, {}), coefficients rounded to binary64", how, first.steps,
                            other.steps, truth::EulerForm<P>::name, truth::MomentumForm<P>::name);
            return dense;
        }
        local = 17 + (local - agreed) + 6;
    }
    dense.message =
        fault.empty() ? fmt::format("at most {} digits agree", static_cast<int>(std::max(0.0, agreed))) : fault;
    return dense;
}

}  // namespace polhode
