#include "integrators/truth/collocation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrators/truth/balls/chebyshev.h"
#include "integrators/truth/balls/flow.h"

namespace polhode::truth {
namespace {

using P = Real<100>;
constexpr long bound_bits = 64;
constexpr int parts = 8;  // per step, each with its own logarithmic norm
constexpr long max_steps = 20'000;

Ball convert_to_ball(const P& x) {
    Ball b;
    arf_set_mpfr(arb_midref(b.raw()), raw(x));
    return b;
}
P convert_to_real(const Ball& b) {
    P x;
    arf_get_mpfr(raw(x), arb_midref(b.raw()), MPFR_RNDN);
    return x;
}

// Compares the motion with one polynomial per step: bounds their distance and encloses the motion at the samples.
class CollocationEnclosure {
  public:
    CollocationEnclosure(const Piece& piece, const PiecePlan& plan, const std::vector<Ball>& start)
        : piece_(piece), norm_(plan), recording_(piece.equations), reached_(start) {
        const WorkingPrecision precision(bound_bits);
        coarse_ = rounded(recording_);
        if (is_polynomial(recording_)) return;
        result_.fault = "collocation supports only right-hand sides of sums and products";
        result_.hopeless = true;
    }

    const std::string& fault() const { return result_.fault; }

    /// Advances to `reached`. p are the states on [t, reached], with exact coefficients in x = 2 (time - t) / h - 1.
    void advance(const P& t, const P& reached, const std::vector<ChebyshevSeries>& p) {
        if (!result_.fault.empty()) return;
        Ball h;
        arb_sub(h.raw(), convert_to_ball(reached).raw(), convert_to_ball(t).raw(), ARF_PREC_EXACT);
        // from the last known point of the motion to the start of this polynomial
        std::vector<Bound> jump;
        for (std::size_t i = 0; i < p.size(); ++i) jump.push_back(Bound(reached_[i] - value_at(p[i], Ball(-1))));
        const Bound before = error_ + norm_.length(jump);
        const std::vector<ChebyshevSeries> rates = rates_along(recording_, p);
        std::vector<Bound> d;
        for (std::size_t i = 0; i < p.size(); ++i) {
            ChebyshevSeries difference = rates[i];
            const ChebyshevSeries slope = derivative(p[i]);
            if (difference.size() < slope.size()) difference.resize(slope.size());
            for (std::size_t k = 0; k < slope.size(); ++k) difference[k] -= slope[k] * (Ball(2) / h);
            d.push_back(sum_of(difference));
        }
        const Bound local = Bound(h) * norm_.length(d);
        Ball exponent, most;
        {
            const WorkingPrecision precision(bound_bits);
            const std::vector<Bound> margin = norm_.components(norm_.allowed());
            std::vector<Bound> slope;
            for (const ChebyshevSeries& series : p) slope.push_back(slope_of(series) * Bound(1.0 / parts));
            for (int part = 0; part < parts; ++part) {
                const Ball middle((2.0 * part + 1) / parts - 1);
                std::vector<Ball> box;
                for (std::size_t i = 0; i < p.size(); ++i)
                    box.push_back(widened(value_at(p[i], middle), slope[i] + margin[i]));
                const Ball mu = norm_.logarithmic_norm(coarse_, box);
                exponent += mu * h / Ball(parts);
                if (!mu.is_negative()) most += mu * h / Ball(parts);
            }
        }
        const Bound largest = exponential(most) * (before + local);
        if (!largest.is_finite() || norm_.allowed() < largest) {
            result_.fault = "the error bound exceeds its limit";
            return;
        }
        const std::vector<Bound> distance = norm_.components(largest);
        for (; next_ < piece_.sample_times.size(); ++next_) {
            const Ball time(piece_.sample_times[next_]);
            if (arb_gt(time.raw(), convert_to_ball(reached).raw())) break;
            const Ball x = Ball(2) * (time - convert_to_ball(t)) / h - Ball(1);
            std::vector<Ball> state;
            for (std::size_t i = 0; i < p.size(); ++i) state.push_back(widened(value_at(p[i], x), distance[i]));
            result_.samples.push_back(std::move(state));
        }
        error_ = exponential(exponent) * before + exponential(most) * local;
        for (std::size_t i = 0; i < p.size(); ++i) reached_[i] = value_at(p[i], Ball(1));
    }

    Enclosure finish(long steps) {
        const std::vector<Bound> distance = norm_.components(error_);
        for (std::size_t i = 0; i < reached_.size(); ++i) reached_[i] = widened(std::move(reached_[i]), distance[i]);
        result_.end = std::move(reached_);
        result_.steps = steps;
        return std::move(result_);
    }

  private:
    const Piece& piece_;
    WeightedNorm norm_;
    Recording<Ball> recording_, coarse_;
    std::vector<Ball> reached_;  // end of the last polynomial, within error_ of the motion; initially the start
    Bound error_;
    std::size_t next_ = 0;
    Enclosure result_;
};

}  // namespace

Enclosure enclose_by_collocation(const Scene& scene, const Piece& piece, const PiecePlan& plan,
                                 const std::vector<Ball>& start) {
    // The polynomials are taken as exact. The arithmetic only has to be finer than their accuracy.
    const double digits = std::min(94.0, 0.30103 * static_cast<double>(Ball::precision()));
    const WorkingPrecision precision(std::max(Ball::precision(), 400L));
    const int n = piece.dimension(), stages = std::clamp(static_cast<int>(0.6 * digits), 16, 40) + 4;
    CollocationStep<P, EulerForm> step(scene, stages);
    std::vector<P> unused(n, P(0)), y(n);
    step.form().initial(unused.data());
    step.form().enter(piece.begin, unused.data());
    step.enter(piece.begin);
    for (int i = 0; i < n; ++i) y[i] = convert_to_real(start[i]);
    std::vector<Block> blocks;
    for (const BodyState::Block& block : BodyState::blocks)
        if (block.first < n) blocks.push_back({block.first, block.size, plan.scales[block.first]});

    CollocationEnclosure enclosure(piece, plan, start);
    const int points = stages + 1;
    std::vector<P> thetas;
    for (int i = 0; i < points; ++i) thetas.push_back((P(1) + convert_to_real(chebyshev_point(i, points))) / 2);
    long steps = 0;
    std::vector<P> state(n);
    const auto accept = [&](const P& t, const P& reached, const P&) {
        std::vector<std::vector<Ball>> values(n, std::vector<Ball>(points));
        for (int i = 0; i < points; ++i) {
            step.evaluate(thetas[i], state.data());
            for (int j = 0; j < n; ++j) values[j][i] = convert_to_ball(state[j]);
        }
        std::vector<ChebyshevSeries> p;
        for (int j = 0; j < n; ++j) {
            p.push_back(interpolated(values[j]));
            for (Ball& c : p.back()) c = c.midpoint();
        }
        enclosure.advance(t, reached, p);
    };
    const std::string fault =
        collocate(step, piece.begin, piece.end, y, blocks, {stages, digits, max_steps}, steps, accept);
    Enclosure result = enclosure.finish(steps);
    if (result.fault.empty()) result.fault = fault, result.hopeless = steps > max_steps;
    return result;
}

}  // namespace polhode::truth
