#include "integrators/truth/dense.h"

#include <algorithm>
#include <cmath>

#include "integrators/truth/attempt_taylor.h"
#include "integrators/truth/reference.h"

namespace polhode {
namespace {

using P = truth::Real<50>;

// what is below 2^-60 of a block's scale is nothing beside the rounding to binary64
constexpr double negligible = 0x1p-60;
constexpr long most_steps = 100'000;

int padded(int n) { return n <= 7 ? 8 : 14; }

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
    const Quaternion<double> q = quaternion_at(y, 3);
    const Vector3<double> w = vector_at(y, 0);
    Vector3<double> p, v;
    if (body_.pivoted)
        pivoted_center(q, w, body_.arm, p, v);
    else
        p = vector_at(y, 7), v = vector_at(y, 10);
    const Invariants<double> kept = invariants(scene_, body_, t, q, w, p, v);
    const auto pairs = [](const Vector3<double>& a) { return Vector3<Pair>{a[0], a[1], a[2]}; };
    ReferenceSample sample;
    sample.t = t, sample.q = {q.w, q.x, q.y, q.z}, sample.angular_velocity_B = pairs(w);
    sample.angular_momentum_W = pairs(kept.angular_momentum_W), sample.energy = kept.energy;
    sample.position_W = pairs(p), sample.velocity_W = pairs(v);
    return sample;
}

DenseTruth dense_reference(const Scene& scene, double end) {
    DenseTruth dense;
    dense.scene_ = scene;
    // a little further on, so that an event at the end opens a piece as well
    dense.scene_.duration = end * (1 + 1e-6);
    validate(dense.scene_, scene.name);
    const Problem problem = pose(dense.scene_);
    if (truth_method(problem) != "Taylor series") {
        dense.message = "no Taylor series: the motion is stiff, or a torque is the user's own";
        return dense;
    }
    dense.body_ = exact_body<double>(dense.scene_);
    std::vector<double> times;
    constexpr long intervals = 256;
    for (long k = 0; k <= intervals; ++k) times.push_back(sample_time(end, k, intervals));

    const truth::EulerForm<P> form(dense.scene_);
    const int n = form.dimension(), width = padded(n);
    dense.width_ = width;
    const std::vector<truth::Block> blocks = form.blocks(problem.scales, problem.principal.moments);
    const auto keep_step = [&](const P& t, const P& h, const truth::Series<P>& series) {
        DenseTruth::Piece piece;
        piece.begin = truth::pair_of(t), piece.per_length = P(1 / h).convert_to<double>();
        piece.offset = dense.coefficients_.size();
        dense.coefficients_.resize(piece.offset + static_cast<std::size_t>(series.order() + 2) * width);
        double* row = dense.coefficients_.data() + piece.offset;
        P power(1);
        int degree = 0, small = 0;
        for (int k = 0; k <= series.order() && small < 3; ++k, power *= h) {
            bool matters = false;
            for (const truth::Block& block : blocks)
                for (int i = block.first; i < block.first + block.size; ++i) {
                    const double c = P(series.coefficient(i, k) * power).convert_to<double>();
                    row[static_cast<std::size_t>(k) * width + i] = c;
                    matters = matters || std::abs(c) > negligible * block.scale;
                }
            // of three, since some may vanish by symmetry
            small = matters ? 0 : small + 1;
            degree = k;
        }
        piece.degree = degree;
        double* low = row + static_cast<std::size_t>(degree + 1) * width;
        std::fill_n(low, width, 0.0);
        for (int i = 0; i < n; ++i) low[i] = truth::pair_of(series.coefficient(i, 0)).low;
        dense.coefficients_.resize(piece.offset + static_cast<std::size_t>(degree + 2) * width);
        dense.pieces_.push_back(piece);
    };

    double local = 26, agreed = 0;
    std::string fault;
    for (int attempts = 0; attempts < 2 && local <= 44; ++attempts) {
        dense.pieces_.clear(), dense.coefficients_.clear();
        // orders and steps as in attempt_by_taylor
        const truth::TaylorSettings coarse{static_cast<int>(std::ceil(1.15 * local)) + 2, local, 1, most_steps};
        const truth::TaylorSettings fine{static_cast<int>(std::ceil(1.3 * local)) + 5, local + 2, 0.93, most_steps};
        const Vector3<double>& moments = problem.principal.moments;
        auto second = truth::in_thread([&] {
            return truth::taylor<P, truth::MomentumForm<P>>(dense.scene_, times, problem.scales, moments, coarse);
        });
        const truth::Run<P> first =
            truth::taylor<P, truth::EulerForm<P>>(dense.scene_, times, problem.scales, moments, fine, keep_step);
        const truth::Run<P> other = second.get();
        fault = first.fault.empty() ? other.fault : first.fault;
        if (!fault.empty()) break;
        const double difference = truth::disagreement(first, other);
        agreed = difference > 0 ? -std::log10(difference) : 50;
        if (agreed >= 17) {
            dense.available = true;
            // two roundings of a quaternion's components turn it by at most 4 2^-53 2
            dense.bound = difference + 8 * 0x1p-53;
            dense.message = fmt::format(
                "Taylor polynomials, their coefficients rounded to binary64: {} at order {} in {} steps, {} at order "
                "{} in "
                "{} steps",
                truth::EulerForm<P>::name, fine.order, first.steps, truth::MomentumForm<P>::name, coarse.order,
                other.steps);
            return dense;
        }
        local = 17 + (local - agreed) + 6;
    }
    dense.message =
        fault.empty() ? fmt::format("{} digits agree at most", static_cast<int>(std::max(0.0, agreed))) : fault;
    return dense;
}

}  // namespace polhode
