#include "integrators/truth/dense.h"

#include <algorithm>
#include <cmath>

#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/collocation.h"
#include "integrators/truth/reference.h"
#include "scene/scene_formulas.h"

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

// Computes the polynomials by two formulations and stores those of one.
class DenseTruth::Builder {
  public:
    /// Samples at `times`, s, are compared. The arguments must outlive this object.
    Builder(DenseTruth& dense, const Problem& problem, const std::vector<double>& times)
        : dense_(dense), problem_(problem), times_(times), by_collocation_(truth_method(problem) == "collocation") {
        const truth::EulerForm<P> form(dense.scene_);
        n_ = form.dimension(), width_ = padded(n_);
        dense.width_ = width_;
        blocks_ = form.blocks(problem.scales, problem.body.principal.moments);
    }

    void build() {
        const truth::Allowance allowance(truth_seconds);
        const truth::MpfrConstants constants;
        double local = 26, agreed = 0;
        for (int attempts = 0; attempts < 2 && local <= 44; ++attempts) {
            dense_.pieces_.clear(), dense_.coefficients_.clear();
            // orders and steps as in attempt_by_taylor() and attempt_by_collocation()
            const Runs runs = by_collocation_ ? run_collocation(local) : run_taylor(local);
            const std::string& fault = runs.first.fault.empty() ? runs.other.fault : runs.first.fault;
            if (!fault.empty()) {
                dense_.message = fault;
                return;
            }
            const double difference = truth::disagreement(runs.first, runs.other);
            agreed = difference > 0 ? -std::log10(difference) : 50;
            if (agreed >= 17) {
                dense_.available = true;
                // two roundings of a quaternion's components rotate it by at most 4 2^-53 2
                dense_.bound = difference + 8 * 0x1p-53;
                dense_.message = fmt::format("{} in {} and {} steps ({}, {}), coefficients rounded to binary64",
                                             runs.polynomials, runs.first.steps, runs.other.steps,
                                             truth::EulerForm<P>::name, truth::MomentumForm<P>::name);
                return;
            }
            local = 17 + (local - agreed) + 6;
        }
        dense_.message = fmt::format("at most {} digits agree", static_cast<int>(std::max(0.0, agreed)));
    }

  private:
    // The runs of the two formulations at the same settings. `first` stores its polynomials.
    struct Runs {
        truth::Run<P> first, other;
        std::string polynomials;  // for messages
    };

    DenseTruth& dense_;
    const Problem& problem_;
    const std::vector<double>& times_;
    bool by_collocation_;
    int n_ = 0, width_ = 0;
    std::vector<truth::Block> blocks_;

    Runs run_collocation(double local) {
        const Vector3<double>& moments = problem_.body.principal.moments;
        const int stages = std::max(16, static_cast<int>(std::ceil(0.6 * local)));
        const truth::CollocationSettings coarse{stages, local, most_steps}, fine{stages + 4, local + 2, most_steps};
        auto second = truth::in_thread([&] {
            return truth::collocation<P, truth::MomentumForm>(dense_.scene_, times_, problem_.scales, moments, coarse);
        });
        Runs runs;
        runs.first = truth::collocation<P, truth::EulerForm>(
            dense_.scene_, times_, problem_.scales, moments, fine,
            [this](const P& t, const P& h, const auto& step) { add_collocation(t, h, step); });
        runs.other = second.get();
        runs.polynomials = fmt::format("collocation polynomials of {} and {} stages", fine.stages, coarse.stages);
        return runs;
    }

    Runs run_taylor(double local) {
        const Vector3<double>& moments = problem_.body.principal.moments;
        const truth::TaylorRuns settings(local, most_steps);
        auto second = truth::in_thread([&] {
            return truth::taylor<P, truth::MomentumForm<P>>(dense_.scene_, times_, problem_.scales, moments,
                                                            settings.coarse);
        });
        Runs runs;
        runs.first = truth::taylor<P, truth::EulerForm<P>>(
            dense_.scene_, times_, problem_.scales, moments, settings.fine,
            [this](const P& t, const P& h, const auto& series) { add_series(t, h, series); });
        runs.other = second.get();
        runs.polynomials =
            fmt::format("Taylor polynomials of order {} and {}", settings.fine.order, settings.coarse.order);
        return runs;
    }

    // scaled(i, k): the coefficient of ((t - begin) / h)^k in the i-th variable
    template <class Coefficient>
    void add_piece(const P& t, const P& h, int order, const Coefficient& scaled) {
        Piece piece;
        piece.begin = pair_of(t), piece.per_length = P(1 / h).convert_to<double>();
        piece.offset = dense_.coefficients_.size();
        dense_.coefficients_.resize(piece.offset + static_cast<std::size_t>(order + 2) * width_);
        double* row = dense_.coefficients_.data() + piece.offset;
        int degree = 0, small = 0;
        for (int k = 0; k <= order && small < 3; ++k) {
            bool matters = false;
            for (const truth::Block& block : blocks_)
                for (int i = block.first; i < block.first + block.size; ++i) {
                    const double c = scaled(i, k).template convert_to<double>();
                    row[static_cast<std::size_t>(k) * width_ + i] = c;
                    matters = matters || std::abs(c) > negligible * block.scale;
                }
            // three consecutive orders, because some may vanish by symmetry
            small = matters ? 0 : small + 1;
            degree = k;
        }
        piece.degree = degree;
        double* low = row + static_cast<std::size_t>(degree + 1) * width_;
        std::fill_n(low, width_, 0.0);
        for (int i = 0; i < n_; ++i) low[i] = pair_of(scaled(i, 0)).low;
        dense_.coefficients_.resize(piece.offset + static_cast<std::size_t>(degree + 2) * width_);
        dense_.pieces_.push_back(piece);
    }

    template <class Series>
    void add_series(const P& t, const P& h, const Series& series) {
        std::vector<P> powers{P(1)};
        for (int k = 0; k < series.order(); ++k) powers.push_back(powers.back() * h);
        add_piece(t, h, series.order(), [&](int i, int k) { return P(P(series.coefficient(i, k)) * powers[k]); });
    }

    // Converts the collocation polynomial to monomials by divided differences of as many values as it has coefficients.
    // The rounding errors are negligible in 50 digits.
    template <class Step>
    void add_collocation(const P& t, const P& h, const Step& step) {
        const int order = step.stages();
        std::vector<std::vector<P>> values(order + 1, std::vector<P>(n_));
        std::vector<P> at, monomial(static_cast<std::size_t>(order + 1) * n_, P(0));
        for (int j = 0; j <= order; ++j) {
            at.push_back(P(j) / order);
            step.evaluate(at[j], values[j].data());
        }
        for (int i = 0; i < n_; ++i) {
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
        add_piece(t, h, order, [&](int i, int k) {
            return monomial[static_cast<std::size_t>(i) * (order + 1) + static_cast<std::size_t>(k)];
        });
    }
};

DenseTruth dense_reference(const Scene& scene, double end) {
    DenseTruth dense;
    dense.scene_ = scene;
    // slightly longer, so that an event at the end also starts a piece
    dense.scene_.duration = end * (1 + 1e-6);
    validate(dense.scene_, scene.name);
    const Problem problem = pose(dense.scene_);
    if (problem.needs.user_torque) {
        dense.message = "user-defined torques have no reference solution";
        return dense;
    }
    if (!std::holds_alternative<OneBody>(problem.system)) {
        dense.message = fmt::format("polynomial references do not support {}", name_of(problem.needs.system));
        return dense;
    }
    if (!scene.planes.empty() || !scene.contacts.empty()) {
        dense.message = "polynomial references do not support impacts on planes";
        return dense;
    }
    dense.body_ = exact_body<double>(dense.scene_);
    const std::vector<double> times = sample_times(end, 256);
    DenseTruth::Builder(dense, problem, times).build();
    return dense;
}

}  // namespace polhode
