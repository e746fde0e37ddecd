// Encloses a piece of a motion by Taylor series with a proven defect. taylor.h has the theory.
//
// PieceEnclosure takes one step at a time: Taylor coefficients at an exact point (Series<Ball>), the step length from
// the last coefficients, the defect of the polynomial along the tape (term_bounds(), defect()), the error growth from
// the logarithmic norm over boxes swept by the polynomial (find_growth(), swept_boxes()), then the samples inside the
// step. The template argument carries the errors from step to step: NormErrors as one length, ParallelepipedErrors as a
// set multiplied by the transition matrix (Lohner's method; parallelepiped.h, transition.h).
#include "integrators/truth/balls/taylor.h"

#include <arb_poly.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrators/truth/allowance.h"
#include "integrators/truth/balls/flow.h"
#include "integrators/truth/balls/parallelepiped.h"
#include "integrators/truth/balls/transition.h"

namespace polhode::truth {
namespace {

constexpr long bound_bits = 64;
const Bound unbounded(std::numeric_limits<double>::infinity());
constexpr long max_steps = 400'000;    // takes hours
constexpr long foreseen_after = 1000;  // steps; after these the total number is extrapolated
// The terms of a series bound a divisor or a square root from zero only within a part of its step.
constexpr int most_halvings = 40;

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

// rounds the step down to 20 bits, so that the time keeps few bits
double on_grid(double h) {
    int exponent = 0;
    std::frexp(h, &exponent);
    const double unit = std::ldexp(1.0, exponent - 20);
    return std::floor(h / unit) * unit;
}

// |c_k| h^k <= 2^-bits of the block's size for the last four coefficients, because one may vanish by symmetry
double wanted_step(const Series<Ball>& series, const PiecePlan& plan, double bits, bool with_radii) {
    const int order = series.order();
    double log2_step = std::numeric_limits<double>::infinity();
    for (const Block& block : plan.blocks)
        for (int k = order - 3; k <= order; ++k) {
            double size = -std::numeric_limits<double>::infinity();
            for (int i = block.first; i < block.first + block.size; ++i)
                size = std::max(size, with_radii ? Bound(series.coefficient(i, k)).log2_near()
                                                 : series.coefficient(i, k).log2_near());
            log2_step = std::min(log2_step, (std::log2(block.scale) - bits - size) / k);
        }
    return std::exp2(log2_step);
}

// sum of |a_j| |b_k| h^(j+k) over j + k >= N, over the first N terms of each; tail[m] is the sum of b's terms from m on
Bound tail_product(const Bound* a, const std::vector<Bound>& tail, int N) {
    Bound sum;
    for (int j = 1; j < N; ++j) sum += a[j] * tail[N - j];
    return sum;
}

// [i][m]: sum of the terms of node i from order m on, without the remainder
std::vector<std::vector<Bound>> sum_tails(const TermBounds& terms, std::size_t nodes) {
    const int N = terms.order;
    std::vector<std::vector<Bound>> tail(nodes, std::vector<Bound>(N + 1));
    for (std::size_t i = 0; i < nodes; ++i)
        for (int m = N; m-- > 0;) tail[i][m] = terms.node[i * N + m] + tail[i][m + 1];
    return tail;
}

bool all_finite(const std::vector<Bound>& bounds) {
    return std::all_of(bounds.begin(), bounds.end(), [](const Bound& b) { return b.is_finite(); });
}

}  // namespace

TermBounds term_bounds(const Series<Ball>& series, const Bound& h) {
    TermBounds terms;
    terms.order = series.order();
    const std::size_t nodes = series.recording().tape.nodes.size();
    terms.node.reserve(nodes * terms.order);
    std::vector<Bound> power(1, Bound(1.0));
    for (int k = 1; k <= terms.order; ++k) power.push_back(power.back() * h);
    terms.least.reserve(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        const Ball* c = series.node_coefficients(static_cast<int>(i));
        terms.least.push_back(Bound::least_of(c[0]));
        for (int k = 0; k < terms.order; ++k) terms.node.push_back(Bound(c[k]) * power[k]);
    }
    for (int i = 0; i < series.dimension(); ++i)
        terms.last.push_back(Bound(series.coefficient(i, terms.order)) * power[terms.order]);
    return terms;
}

Defect defect(const Recording<Ball>& recording, const TermBounds& terms) {
    using Kind = TapeNode<Ball>::Kind;
    const std::vector<TapeNode<Ball>>& nodes = recording.tape.nodes;
    const int N = terms.order;
    const auto term = [&](std::size_t i) { return &terms.node[i * N]; };
    std::vector<Bound> remainder(nodes.size());
    Defect result;
    result.least.resize(nodes.size());
    const std::vector<std::vector<Bound>> tail = sum_tails(terms, nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const TapeNode<Ball>& node = nodes[i];
        const auto a = static_cast<std::size_t>(node.a), b = static_cast<std::size_t>(node.b);
        Bound own;
        switch (node.kind) {
            case Kind::state:
                own = terms.last[i];
                break;
            case Kind::combination:
                own = Bound(node.factor_a) * remainder[a];
                if (node.b >= 0) own += Bound(node.factor_b) * remainder[b];
                break;
            case Kind::product:
                own = tail_product(term(a), tail[b], N);
                own += tail[a][0] * remainder[b];
                own += remainder[a] * tail[b][0];
                own += remainder[a] * remainder[b];
                break;
            case Kind::quotient:
                own = tail_product(term(b), tail[i], N) + remainder[b] * tail[i][0];
                if (node.a >= 0) own += remainder[a];
                own = own / result.least[b];
                break;
            case Kind::root: {
                const Bound least = least_difference(terms.least[i], tail[i][1]);
                own = (tail_product(term(i), tail[i], N) + remainder[a]) / least;
                // the operand is positive if it differs from r^2 > 0 by less than r^2
                if (!(own < least)) own = unbounded;
                break;
            }
            case Kind::sine:
                own = tail_product(term(a), tail[i], N) + tail_product(term(a), tail[b], N) + remainder[a];
                remainder[b] = own;
                break;
            case Kind::cosine:
                own = remainder[i];
                break;
        }
        remainder[i] = own;
        result.least[i] = least_difference(terms.least[i], tail[i][1] + own);
    }
    // a division by a number that may vanish has no bound, even if its result is multiplied by 0
    const bool bounded = all_finite(remainder);
    for (const Traced<Ball>& rate : recording.rates)
        result.rate.push_back(!bounded         ? unbounded
                              : rate.node >= 0 ? Bound(rate.factor) * remainder[rate.node]
                                               : Bound());
    for (std::size_t i = 0; i < nodes.size(); ++i) result.node.push_back(tail[i][0] + remainder[i]);
    return result;
}

std::vector<Bound> change_of_rates(const Recording<Ball>& recording, const Defect& along,
                                   const std::vector<Bound>& moved) {
    using Kind = TapeNode<Ball>::Kind;
    const std::vector<TapeNode<Ball>>& nodes = recording.tape.nodes;
    std::vector<Bound> change(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const TapeNode<Ball>& node = nodes[i];
        const auto a = static_cast<std::size_t>(node.a), b = static_cast<std::size_t>(node.b);
        switch (node.kind) {
            case Kind::state:
                change[i] = moved[i];
                break;
            case Kind::combination:
                change[i] = Bound(node.factor_a) * change[a];
                if (node.b >= 0) change[i] += Bound(node.factor_b) * change[b];
                break;
            case Kind::product:
                change[i] = (along.node[a] + change[a]) * change[b];
                change[i] += change[a] * along.node[b];
                break;
            case Kind::quotient:
                change[i] = along.node[i] * change[b];
                if (node.a >= 0) change[i] += change[a];
                change[i] = change[i] / least_difference(along.least[b], change[b]);
                break;
            case Kind::root:
                // the changed root is real if the operand stays above zero
                change[i] = change[a] < along.least[a] ? change[a] / along.least[i] : unbounded;
                break;
            case Kind::sine:
            case Kind::cosine:
                change[i] = change[a];
                break;
        }
    }
    const bool bounded = all_finite(change);
    std::vector<Bound> result;
    for (const Traced<Ball>& rate : recording.rates)
        result.push_back(!bounded ? unbounded : rate.node >= 0 ? Bound(rate.factor) * change[rate.node] : Bound());
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

namespace {

// Bounds for one step from an exact point; lengths in the norm.
struct StepBounds {
    Ball h;
    Bound local;           ///< error of the polynomial from the point, before its growth within the step
    Bound growth, at_end;  ///< growth factors of an error of the point: maximum within the step, and at its end
    Bound largest;         ///< distance of the motion from the polynomial, including the errors before the step
};

// Bounds the error growth by the logarithmic norm on each of several parts of the step. Uses more parts where the boxes
// are too wide for a useful bound.
void find_growth(const Recording<Ball>& recording, const WeightedNorm& norm, const Series<Ball>& series,
                 const TermBounds& terms, const std::vector<Bound>& margin, int parts, StepBounds& step) {
    constexpr int most_parts = 128;
    const Bound much(0x1p6);
    const WorkingPrecision precision(bound_bits);
    for (;; parts *= 4) {
        const Ball part = step.h / Ball(parts);
        Ball exponent, most;
        for (const std::vector<Ball>& box : swept_boxes(series, terms, step.h, margin, parts)) {
            const Ball mu = norm.logarithmic_norm(recording, box);
            exponent += mu * part;
            if (!mu.is_negative()) most += mu * part;
        }
        step.growth = exponential(most), step.at_end = exponential(exponent);
        if (step.growth < much || parts * 4 > most_parts) return;
    }
}

// The distance of the motion from the point, carried as one length in the norm.
class NormErrors {
  public:
    static constexpr int parts = 8;  // per step, each with its own logarithmic norm

    NormErrors(const Piece&, const PiecePlan&, const WeightedNorm& norm, int, const std::vector<Bound>& radius)
        : norm_(norm), length_(norm.length(radius)) {}

    Bound length() const { return length_; }
    std::vector<Bound> components() const { return norm_.components(length_); }

    // Returns false if the errors have no bound.
    bool begin(const std::vector<Ball>&, const TermBounds&, const StepBounds& step) {
        step_ = step, distance_ = norm_.components(step.largest);
        return true;
    }
    std::vector<Bound> distance_at(const Ball&) const { return distance_; }
    void end(const std::vector<Bound>& radius) {
        length_ = step_.at_end * length_ + step_.growth * step_.local + norm_.length(radius);
    }

  private:
    const WeightedNorm& norm_;
    Bound length_;
    StepBounds step_;
    std::vector<Bound> distance_;
};

// The distance carried as a parallelepiped that rotates and shears with the motion. The logarithmic norm then applies
// only to small remainders, so that few parts per step are sufficient.
class ParallelepipedErrors {
  public:
    static constexpr int parts = 2;

    ParallelepipedErrors(const Piece& piece, const PiecePlan& plan, const WeightedNorm& norm, int order,
                         const std::vector<Bound>& radius)
        : norm_(norm),
          set_(plan.scales, radius),
          scales_(plan.scales),
          transition_(piece.equations, order, plan.spare_bits) {}

    Bound length() const { return norm_.length(set_.components()); }
    std::vector<Bound> components() const { return set_.components(); }

    bool begin(const std::vector<Ball>& point, const TermBounds& terms, const StepBounds& step) {
        h_ = step.h, local_ = norm_.components(step.growth * step.local);
        transition_.set_order(order_for(terms, step.growth));
        transition_.expand(point, Bound(step.h), step.largest, step.growth, norm_.allowed(), norm_);
        return transition_.is_bounded();
    }
    std::vector<Bound> distance_at(const Ball& t) const {
        std::vector<Bound> distance = set_.components_after(transition_.at(t));
        for (std::size_t i = 0; i < distance.size(); ++i) distance[i] += local_[i];
        return distance;
    }
    void end(const std::vector<Bound>& radius) {
        for (std::size_t i = 0; i < local_.size(); ++i) local_[i] += radius[i];
        set_.advance(transition_.at(h_), local_);
    }

  private:
    // Smaller terms of W are not needed: an error of W only widens the set that W multiplies.
    static constexpr double last_term = 0x1p-72;

    const WeightedNorm& norm_;
    Parallelepiped set_;
    std::vector<double> scales_;
    Transition transition_;
    Ball h_;
    std::vector<Bound> local_;

    // the terms of y serve as an estimate for those of W
    int order_for(const TermBounds& terms, const Bound& growth) const {
        const double last = last_term / std::max(1.0, growth.near());
        int order = terms.order;
        for (; order > 8; --order)
            for (std::size_t i = 0; i < scales_.size(); ++i)
                if (terms.node[i * terms.order + order - 1].near() > last * scales_[i]) return order + 2;
        return order;
    }
};

// Encloses the motion of a piece, one step at a time.
template <class Errors>
class PieceEnclosure {
  public:
    /// The arguments must outlive this object.
    PieceEnclosure(const Piece& piece, const PiecePlan& plan, const std::vector<Ball>& start)
        : piece_(piece),
          plan_(plan),
          bits_(static_cast<double>(Ball::precision()) - plan.spare_bits),
          // the work order^2 / step is minimal near order = ln(2) / 2 bits (Jorba & Zou 2005)
          order_(std::max(16, static_cast<int>(std::ceil(0.347 * bits_)) + 2)),
          series_(piece.equations, order_),
          norm_(plan),
          coarse_(rounded_coarsely(series_.recording())),
          point_(midpoints(start, piece.dimension())),
          reached_(static_cast<std::size_t>(piece.dimension())),
          radius_(radii(start, piece.dimension())),
          errors_(piece, plan, norm_, order_, radius_),
          margin_(norm_.components(norm_.allowed())),
          t_(piece.begin),
          end_(piece.end) {}

    Enclosure enclose() {
        while (!(t_ == end_))
            if (!advance()) return std::move(result_);
        const std::vector<Bound> distance = errors_.components();
        result_.end = point_;
        for (std::size_t i = 0; i < point_.size(); ++i)
            result_.end[i] = widened(std::move(result_.end[i]), distance[i]);
        return std::move(result_);
    }

  private:
    const Piece& piece_;
    const PiecePlan& plan_;
    double bits_;
    int order_;
    Series<Ball> series_;
    WeightedNorm norm_;
    Recording<Ball> coarse_;             // rounded to bound_bits
    std::vector<Ball> point_, reached_;  // the start of the step, without its errors; a sample, or the end
    std::vector<Bound> radius_;          // rounding errors of point_
    Errors errors_;
    std::vector<Bound> margin_;
    Ball t_, end_;
    std::size_t next_sample_ = 0;
    Enclosure result_;

    static Recording<Ball> rounded_coarsely(const Recording<Ball>& recording) {
        const WorkingPrecision precision(bound_bits);
        return rounded(recording);
    }
    static std::vector<Ball> midpoints(const std::vector<Ball>& y, int n) {
        std::vector<Ball> result;
        for (int i = 0; i < n; ++i) result.push_back(y[i].midpoint());
        return result;
    }
    static std::vector<Bound> radii(const std::vector<Ball>& y, int n) {
        std::vector<Bound> result;
        for (int i = 0; i < n; ++i) result.push_back(Bound::radius_of(y[i]));
        return result;
    }

    // One step. Returns false if the enclosure ends with a fault.
    bool advance() {
        if (!is_within_limits()) return false;
        series_.expand(point_.data());
        StepBounds step;
        Ball t_after = end_;
        if (!choose_step(step.h, t_after)) return false;

        for (int halvings = 0; !bound_step(step); ++halvings) {
            if (!result_.fault.empty()) return false;
            if (halvings == most_halvings) {
                result_.fault = "a divisor or a square root of the equations may vanish";
                return false;
            }
            arb_mul_2exp_si(step.h.raw(), step.h.raw(), -1);
            t_after = exact_sum(t_, step.h);
        }
        enclose_samples(step.h);
        series_.evaluate(step.h, reached_.data());
        point_ = midpoints(reached_, piece_.dimension()), radius_ = radii(reached_, piece_.dimension());
        errors_.end(radius_);
        t_ = t_after;
        return true;
    }

    // Bounds the errors of a step of length step.h. Returns false without a fault if they have no bound, false with one
    // if they exceed the limit.
    bool bound_step(StepBounds& step) {
        const TermBounds terms = term_bounds(series_, Bound(step.h));
        step.local = Bound(step.h) * norm_.length(defect(series_.recording(), terms).rate);
        if (!step.local.is_finite()) return false;
        find_growth(coarse_, norm_, series_, terms, margin_, Errors::parts, step);
        step.largest = step.growth * (errors_.length() + step.local);
        if (!step.largest.is_finite()) return false;
        if (norm_.allowed() < step.largest) {
            result_.fault = fmt::format("the error bound exceeds its limit at {} bits", Ball::precision());
            return false;
        }
        return errors_.begin(point_, terms, step);
    }

    // Counts the step. Returns false and sets the fault if the number of steps or the time allowed is exceeded.
    bool is_within_limits() {
        const double passed = t_.near() - piece_.begin;
        const bool too_many =
            result_.steps == foreseen_after && (piece_.end - piece_.begin) / passed * foreseen_after > 2.0 * max_steps;
        if (too_many || result_.steps >= max_steps) {
            result_.fault = fmt::format("{:.2g} s took {} of at most {} steps", passed, result_.steps, max_steps);
            result_.hopeless = true;
            return false;
        }
        ++result_.steps;
        if (Allowance::is_spent()) {
            result_.fault = Allowance::fault;
            return false;
        }
        return true;
    }

    // Sets the step length h and its end. Returns false and sets the fault if there is no useful length.
    bool choose_step(Ball& h, Ball& t_after) {
        const double wanted = on_grid(wanted_step(series_, plan_, bits_, true));
        // the bounds of the rounding errors grow faster with the order than the terms of the motion
        if (8 * wanted < std::min(wanted_step(series_, plan_, bits_, false), piece_.end - t_.near())) {
            result_.fault = fmt::format("rounding errors at {} bits shorten the steps", Ball::precision());
            result_.coarse = true;
            return false;
        }
        if (!(wanted > 0)) {
            result_.fault = "the step size is zero";
            result_.hopeless = true;
            return false;
        }
        h = exact_difference(end_, t_);
        if (std::isfinite(wanted) && arb_gt(h.raw(), Ball(wanted).raw())) h = Ball(wanted), t_after = exact_sum(t_, h);
        return true;
    }

    void enclose_samples(const Ball& h) {
        for (; next_sample_ < piece_.sample_times.size(); ++next_sample_) {
            const Ball after = exact_difference(Ball(piece_.sample_times[next_sample_]), t_);
            if (arb_gt(after.raw(), h.raw())) break;
            series_.evaluate(after, reached_.data());
            const std::vector<Bound> distance = errors_.distance_at(after);
            for (std::size_t i = 0; i < reached_.size(); ++i)
                reached_[i] = widened(std::move(reached_[i]), distance[i]);
            result_.samples.push_back(reached_);
        }
    }
};

}  // namespace

Enclosure enclose_by_taylor(const Piece& piece, const PiecePlan& plan, const std::vector<Ball>& start, Carry carry) {
    return carry == Carry::norm ? PieceEnclosure<NormErrors>(piece, plan, start).enclose()
                                : PieceEnclosure<ParallelepipedErrors>(piece, plan, start).enclose();
}

}  // namespace polhode::truth
