#include "integrators/truth/ball_taylor.h"

#include <arb_poly.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrators/truth/allowance.h"
#include "integrators/truth/ball_flow.h"

namespace polhode::truth {
namespace {

constexpr long bound_bits = 64;
constexpr int parts = 8;             // of a step, each with a logarithmic norm of its own
constexpr long max_steps = 400'000;  // a run of so many has gone astray

// exact sums and differences: times have few bits
Ball exact_sum(const Ball& a, const Ball& b) {
    Ball c;
    arb_add(c.raw(), a.raw(), b.raw(), ARF_PREC_EXACT);
    return c;
}
Ball exact_difference(const Ball& a, const Ball& b) {
    Ball c;
    arb_sub(c.raw(), a.raw(), b.raw(), ARF_PREC_EXACT);
    return c;
}

// the step on a grid 2^-20 of itself: the time keeps few bits
double on_grid(double h) {
    int exponent = 0;
    std::frexp(h, &exponent);
    const double unit = std::ldexp(1.0, exponent - 20);
    return std::floor(h / unit) * unit;
}

// |c_k| h^k <= 2^-bits of the block's size for the last coefficients; of four, since one may vanish by symmetry
double wanted_step(const Series<Ball>& series, const PiecePlan& plan, double bits) {
    const int n = series.dimension(), order = series.order();
    double log2_step = std::numeric_limits<double>::infinity();
    for (int block = 0; block < n; block += block == 3 ? 4 : 3) {
        const int end = block + (block == 3 ? 4 : 3);
        for (int k = order - 3; k <= order; ++k) {
            double size = -std::numeric_limits<double>::infinity();
            for (int i = block; i < end; ++i) size = std::max(size, Bound(series.coefficient(i, k)).log2_near());
            log2_step = std::min(log2_step, (std::log2(plan.scales[block]) - bits - size) / k);
        }
    }
    return std::exp2(log2_step);
}

}  // namespace

TermBounds term_bounds(const Series<Ball>& series, const Bound& h) {
    TermBounds terms;
    terms.order = series.order();
    const std::size_t nodes = series.recording().tape.nodes.size();
    terms.node.reserve(nodes * terms.order);
    std::vector<Bound> power(1, Bound(1.0));
    for (int k = 1; k <= terms.order; ++k) power.push_back(power.back() * h);
    for (std::size_t i = 0; i < nodes; ++i) {
        const Ball* c = series.node_coefficients(static_cast<int>(i));
        for (int k = 0; k < terms.order; ++k) terms.node.push_back(Bound(c[k]) * power[k]);
    }
    for (int i = 0; i < series.dimension(); ++i)
        terms.last.push_back(Bound(series.coefficient(i, terms.order)) * power[terms.order]);
    return terms;
}

std::vector<Bound> defect(const Recording<Ball>& recording, const TermBounds& terms) {
    using Kind = Node<Ball>::Kind;
    const std::vector<Node<Ball>>& nodes = recording.tape.nodes;
    const int N = terms.order;
    std::vector<Bound> remainder(nodes.size());
    // tail[i][m] = sum of the terms of node i from order m on, without the remainder
    std::vector<std::vector<Bound>> tail(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Bound* own = &terms.node[i * N];
        tail[i].resize(N + 1);
        for (int m = N; m-- > 0;) tail[i][m] = own[m] + tail[i][m + 1];
        const Node<Ball>& node = nodes[i];
        if (node.kind == Kind::state) {
            remainder[i] = terms.last[i];
        } else if (node.kind == Kind::combination) {
            remainder[i] = Bound(node.factor_a) * remainder[node.a];
            if (node.b >= 0) remainder[i] += Bound(node.factor_b) * remainder[node.b];
        } else {
            const Bound* a = &terms.node[static_cast<std::size_t>(node.a) * N];
            const std::vector<Bound>& b = tail[node.b];
            Bound sum;
            for (int j = 1; j < N; ++j) sum += a[j] * b[N - j];
            sum += tail[node.a][0] * remainder[node.b];
            sum += remainder[node.a] * b[0];
            sum += remainder[node.a] * remainder[node.b];
            remainder[i] = sum;
        }
    }
    std::vector<Bound> result;
    for (const Traced<Ball>& rate : recording.rates)
        result.push_back(rate.node < 0 ? Bound() : Bound(rate.factor) * remainder[rate.node]);
    return result;
}

std::vector<std::vector<Ball>> swept_boxes(const Series<Ball>& series, const TermBounds& terms, const Ball& h,
                                           const std::vector<Bound>& margin, int count) {
    const WorkingPrecision precision(bound_bits);
    const int n = series.dimension(), N = series.order(), length = std::min(N, 32);
    std::vector<std::vector<Ball>> boxes(count, std::vector<Ball>(n));
    std::vector<Ball> low(length);
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < length; ++k) arb_set_round(low[k].raw(), series.coefficient(i, k).raw(), Ball::precision());
        Bound rest = margin[i] + terms.last[i];
        for (int k = length; k < N; ++k) rest += terms.node[static_cast<std::size_t>(i) * N + k];
        for (int part = 0; part < count; ++part) {
            // [part, part + 1] h / count
            const Ball half = h / Ball(2 * count);
            const Ball t = widened(half * Ball(2 * part + 1), Bound(half));
            _arb_poly_evaluate_horner(boxes[part][i].raw(), low.front().raw(), length, t.raw(), Ball::precision());
            boxes[part][i] = widened(std::move(boxes[part][i]), rest);
        }
    }
    return boxes;
}

Enclosure enclose_by_taylor(const Piece& piece, const PiecePlan& plan, const std::vector<Ball>& start) {
    Enclosure result;
    const int n = piece.form.dimension();
    const auto bits = static_cast<double>(Ball::precision());
    // the work order^2 / step is least near order = ln(2) / 2 bits (Jorba & Zou 2005)
    const int order = std::max(16, static_cast<int>(std::ceil(0.347 * bits)) + 2);
    Series<Ball> series(record<Ball>(piece.form, n), order);
    const WeightedNorm norm(plan);
    const Recording<Ball> coarse = [&] {
        const WorkingPrecision precision(bound_bits);
        return rounded(series.recording());
    }();

    // the motion is within `error` of `point`, in the norm
    std::vector<Ball> point(n), at_sample(n);
    std::vector<Bound> radius(n);
    const auto split = [&](const std::vector<Ball>& y) {
        for (int i = 0; i < n; ++i) point[i] = y[i].midpoint(), radius[i] = Bound::radius_of(y[i]);
        return norm.length(radius);
    };
    Bound error = split(start);
    // as far as the motion may be from the point for the logarithmic norm to hold: small beside every variable
    double least = 0;
    const std::vector<Bound> unit = norm.components(Bound(1.0));
    for (int i = 0; i < n; ++i) least = std::max(least, unit[i].near() / plan.scales[i]);
    const Bound allowed(0x1p-20 / least);
    const std::vector<Bound> margin = norm.components(allowed);

    Ball t(piece.begin);
    const Ball end(piece.end);
    std::size_t next = 0;
    while (!(t == end)) {
        if (result.steps++ >= max_steps) {
            result.fault = "more steps than are allowed";
            return result;
        }
        if (Allowance::is_spent()) {
            result.fault = Allowance::fault;
            return result;
        }
        series.expand(point.data());
        const double wanted = on_grid(wanted_step(series, plan, bits));
        if (!(wanted > 0)) {
            result.fault = "the step vanishes";
            return result;
        }
        Ball h = exact_difference(end, t), reached = end;
        if (std::isfinite(wanted) && arb_gt(h.raw(), Ball(wanted).raw())) h = Ball(wanted), reached = exact_sum(t, h);

        const TermBounds terms = term_bounds(series, Bound(h));
        const Bound local = Bound(h) * norm.length(defect(series.recording(), terms));
        // exponents of what an error is multiplied by: over the whole step, and at the most
        Ball exponent, most;
        {
            const WorkingPrecision precision(bound_bits);
            const Ball part = h / Ball(parts);
            for (const std::vector<Ball>& box : swept_boxes(series, terms, h, margin, parts)) {
                const Ball mu = norm.logarithmic_norm(coarse, box);
                exponent += mu * part;
                if (!mu.is_negative()) most += mu * part;
            }
        }
        const Bound largest = exponential(most) * (error + local);
        if (!largest.is_finite() || allowed < largest) {
            result.fault = fmt::format("errors grow beyond what {} bits can carry", Ball::precision());
            return result;
        }
        const std::vector<Bound> distance = norm.components(largest);
        for (; next < piece.sample_times.size(); ++next) {
            const Ball after = exact_difference(Ball(piece.sample_times[next]), t);
            if (arb_gt(after.raw(), h.raw())) break;
            series.evaluate(after, at_sample.data());
            for (int i = 0; i < n; ++i) at_sample[i] = widened(std::move(at_sample[i]), distance[i]);
            result.samples.push_back(at_sample);
        }
        series.evaluate(h, at_sample.data());
        error = exponential(exponent) * error + exponential(most) * local + split(at_sample);
        t = reached;
    }
    const std::vector<Bound> distance = norm.components(error);
    result.end = point;
    for (int i = 0; i < n; ++i) result.end[i] = widened(std::move(result.end[i]), distance[i]);
    return result;
}

}  // namespace polhode::truth
