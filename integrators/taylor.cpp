// Taylor series in binary64: orders 12 to 24, steps from the coefficients, dense output from the polynomial.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "integrators/kernels/rotation_series.h"
#include "integrators/kernels/turn.h"
#include "integrators/solver_run.h"
#include "integrators/truth/series.h"

namespace polhode {
namespace {

// the smallest tolerance that means anything: beyond it round-off of the state is all that is left
constexpr double least_tolerance = 1e-16;

// x^(1/p) to a few parts in 10^4, which is all that a step's length needs, in a tenth of std::pow's time: x = m 2^e
// with m in [sqrt(1/2), sqrt(2)); log2 m by the series of artanh((m - 1)/(m + 1)), 2^y by Taylor's about y = 0.
double root(double x, int p) {
    if (!(x > 1e-300 && x < 1e300)) return std::pow(x, 1.0 / p);
    constexpr std::uint64_t mantissa = 0x000fffffffffffff, exponent_of_1 = 0x3ff0000000000000;
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
    double m = std::bit_cast<double>((bits & mantissa) | exponent_of_1);
    int e = static_cast<int>(bits >> 52) - 1023;
    if (m > std::numbers::sqrt2) m *= 0.5, ++e;
    const double z = (m - 1) / (m + 1), zz = z * z;
    const double log2 = e + 2 * std::numbers::log2e * z * (1 + zz * (1.0 / 3 + zz * (1.0 / 5)));
    const double y = log2 / p, whole = std::round(y), f = (y - whole) * std::numbers::ln2;
    const double fraction = 1 + f * (1 + f * (0.5 + f * (1.0 / 6 + f * (1.0 / 24))));
    return fraction *
           std::bit_cast<double>(exponent_of_1 + (static_cast<std::uint64_t>(static_cast<std::int64_t>(whole)) << 52));
}

/// The order'th coefficient and the one before it, squared and over the scale of their block squared: the largest of
/// all blocks.
struct Sizes {
    double last = 0, before = 0;

    void note(double last_squared, double before_squared, double scale) {
        const double share = 1 / (scale * scale);
        last = std::max(last, last_squared * share), before = std::max(before, before_squared * share);
        if (std::isnan(last_squared) || std::isnan(before_squared)) last = last_squared + before_squared;
    }
};

/// Jorba & Zou 2005, Experimental Mathematics 14, 99, eq. 3.4: the radius of convergence seen at two coefficients,
/// times exp(-0.7/(p - 1)).
double step_of(const Sizes& sizes, double tolerance, int order) {
    const auto radius = [&](double squared, int p) {
        return squared == 0 ? HUGE_VAL : root(tolerance * tolerance / squared, 2 * p);
    };
    return std::min(radius(sizes.last, order), radius(sizes.before, order - 1)) * std::exp(-0.7 / (order - 1));
}

/// Rotations in principal axes, by RotationSeries; the same bits by every set of instructions.
template <int order, class Wide>
class UnrolledSeries {
  public:
    UnrolledSeries(const Problem& problem, const Segment& segment)
        : series_(problem.principal_inertia), rate_scale_(problem.scales.angular_velocity) {
        series_.set(segment.forcing);
        if constexpr (std::is_same_v<Wide, Lanes8>)
            expand_ = &expand_avx512, move_ = &move_avx512;
        else if (instruction_set() == InstructionSet::avx2)
            expand_ = &expand_avx2, move_ = &move_avx2;
    }
    void start(const double* y) { state_ = PackedRotation(y), lost_ = {}; }
    void expand() { expand_(series_, state_); }
    double step(double tolerance) const {
        Sizes sizes;
        sizes.note(series_.squared_rate(order), series_.squared_rate(order - 1), rate_scale_);
        sizes.note(series_.squared_attitude(order), series_.squared_attitude(order - 1), 1);
        return step_of(sizes, tolerance, order);
    }
    void advance(double h) { move_(series_, h, state_, lost_); }
    void look(double h, double* y) const {
        PackedRotation state = state_, lost = lost_;
        move_(series_, h, state, lost);
        state.unpack(y);
    }
    void state(double* y) const { state_.unpack(y); }

  private:
    using Series = RotationSeries<order, Wide>;

    static void expand_plain(Series& series, const PackedRotation& state) { series.expand(state); }
    static void move_plain(const Series& series, double h, PackedRotation& state, PackedRotation& lost) {
        series.move(h, state, lost);
    }
    POLHODE_TARGET_AVX2 static void expand_avx2(Series& series, const PackedRotation& state) { series.expand(state); }
    POLHODE_TARGET_AVX2 static void move_avx2(const Series& series, double h, PackedRotation& state,
                                              PackedRotation& lost) {
        series.move(h, state, lost);
    }
    POLHODE_TARGET_AVX512 static void expand_avx512(Series& series, const PackedRotation& state) {
        series.expand(state);
    }
    POLHODE_TARGET_AVX512 static void move_avx512(const Series& series, double h, PackedRotation& state,
                                                  PackedRotation& lost) {
        series.move(h, state, lost);
    }

    Series series_;
    void (*expand_)(Series&, const PackedRotation&) = &expand_plain;
    void (*move_)(const Series&, double, PackedRotation&, PackedRotation&) = &move_plain;
    double rate_scale_;
    PackedRotation state_, lost_;
};

/// Any of the systems, its recurrences recorded from the one right-hand side.
template <int order, class SystemType>
class RecordedSeries {
  public:
    static constexpr int dimension = SystemType::dimension;

    RecordedSeries(const Problem& problem, const Segment& segment)
        : series_(truth::record<double>(Form{system_on<SystemType>(problem, segment)}, dimension), order) {
        component_scales<SystemType>(problem, scales_.data());
    }
    void start(const double* y) {
        for (int i = 0; i < dimension; ++i) sum_[i] = {y[i], 0};
    }
    void expand() {
        std::array<double, dimension> y{};
        state(y.data());
        series_.expand(y.data());
    }
    double step(double tolerance) const {
        Sizes sizes;
        for (int i = 0; i < dimension; ++i)
            sizes.note(squared(series_.coefficient(i, order)), squared(series_.coefficient(i, order - 1)), scales_[i]);
        return step_of(sizes, tolerance, order);
    }
    void advance(double h) {
        for (int i = 0; i < dimension; ++i) sum_[i].add(increment(i, h));
    }
    void look(double h, double* y) const {
        for (int i = 0; i < dimension; ++i) y[i] = sum_[i].value + (sum_[i].lost + increment(i, h));
    }
    void state(double* y) const {
        for (int i = 0; i < dimension; ++i) y[i] = sum_[i].value;
    }

  private:
    struct Form {
        SystemType system;
        void derivative(const truth::Traced<double>* y, truth::Traced<double>* dy) const {
            system.derivative(0, y, dy);
        }
    };
    static double squared(double x) { return x * x; }
    double increment(int i, double h) const {
        double sum = series_.coefficient(i, order);
        for (int k = order - 1; k >= 1; --k) sum = sum * h + series_.coefficient(i, k);
        return sum * h;
    }

    truth::Series<double> series_;
    std::array<double, dimension> scales_{};
    std::array<CompensatedSum, dimension> sum_{};
};

/// One run on a series: steps of its own choosing, cut only at events and at the end; samples are looked up in the
/// polynomial, so the steps do not depend on them. The problem must outlive the session.
template <class Series, class SystemType>
class TaylorSession {
  public:
    TaylorSession(const Problem& problem, double tolerance) : problem_(&problem), tolerance_(tolerance) {}

    /// Back to t = 0, all counts to zero.
    void restart() {
        series_.reset();
        initial_state<SystemType>(*problem_, y_.data());
        t_ = 0, steps_ = 0;
    }
    /// An event: impulses, then the loads of this segment.
    int enter(const Segment& segment) {
        settle();
        polhode::enter<SystemType>(*problem_, segment, y_.data());
        series_.reset();
        begin_ = t_ = segment.begin, end_ = segment.end;
        if (end_ > t_) series_.emplace(*problem_, segment).start(y_.data());
        return 0;
    }
    /// One step, cut at the segment's end; below zero, and nothing has moved, where there is none.
    int step() {
        if (t_ > begin_) series_->advance(t_ - begin_), begin_ = t_;
        ++steps_;
        series_->expand();
        const double h = series_->step(tolerance_);
        if (std::isnan(h)) return not_finite;
        const double next = t_ + h;
        if (!(next > t_)) return too_short;
        // a remainder of a few rounding errors joins the step
        t_ = next >= end_ - 1e-14 * (end_ - t_) ? end_ : next;
        return 0;
    }

    double time() const { return t_; }
    Sample sample() {
        settle();
        return sample_of<SystemType>(*problem_, t_, y_.data());
    }
    /// The motion at a time within the last step.
    std::optional<Sample> sample_inside(double at) {
        series_->look(at - begin_, y_.data());
        return sample_of<SystemType>(*problem_, at, y_.data());
    }
    int inside_flag() const { return 0; }

    struct Failure {
        Status status;
        std::string message;
    };
    Failure failure(int flag) const {
        if (flag == not_finite) return {Status::diverged, "not finite at t = " + std::to_string(t_)};
        return {Status::tolerance_not_met, "step size below the spacing of numbers at t = " + std::to_string(t_)};
    }

    /// Since restart().
    long steps() const { return steps_; }
    long rhs_evaluations() const { return steps_; }

  private:
    static constexpr int not_finite = -1, too_short = -2;

    // the series stays where the last step began until the next one or the end of its segment: samples lie between
    void settle() {
        if (!series_) return;
        if (t_ > begin_) series_->advance(t_ - begin_), begin_ = t_;
        series_->state(y_.data());
    }

    const Problem* problem_;
    double tolerance_;
    double begin_ = 0, t_ = 0, end_ = 0;  ///< s: of the last step, now, of the segment
    long steps_ = 0;
    std::array<double, SystemType::dimension> y_{};
    std::optional<Series> series_;
};

template <class Series, class SystemType>
Trajectory solve_by(const Problem& problem, const Settings& settings) {
    TaylorSession<Series, SystemType> session(problem, std::max(*settings.tolerance, least_tolerance));
    Trajectory trajectory = SolverRun(problem, settings, session).solve();
    if (*settings.tolerance < least_tolerance && trajectory.status == Status::ok) {
        trajectory.status = Status::tolerance_not_met;
        trajectory.message = "a tolerance below 1e-16 is beyond binary64: steps were taken for 1e-16";
    }
    return trajectory;
}

bool is_unrolled(const Problem& problem) {
    return std::all_of(problem.segments.begin(), problem.segments.end(),
                       [](const Segment& s) { return RotationSeries<2, LanePair>::serves(s.forcing); });
}

template <int order>
Trajectory solve_at_order(const Problem& problem, const Settings& settings) {
    return with_system(problem, [&]<class SystemType>() {
        if constexpr (SystemType::dimension == 7)
            if (is_unrolled(problem)) {
                if (instruction_set() == InstructionSet::avx512)
                    return solve_by<UnrolledSeries<order, Lanes8>, SystemType>(problem, settings);
                return solve_by<UnrolledSeries<order, LanePair>, SystemType>(problem, settings);
            }
        return solve_by<RecordedSeries<order, SystemType>, SystemType>(problem, settings);
    });
}

// p = 1 - log(tolerance) / 2 is the order at which a digit costs least (Jorba & Zou, 3.1)
Trajectory solve(const Problem& problem, const Settings& settings) {
    if (problem.needs.user_torque) return unsupported("a torque of the user's own has no Taylor coefficients");
    const double order = 1 - std::log(*settings.tolerance) / 2;
    if (order <= 12) return solve_at_order<12>(problem, settings);
    if (order <= 16) return solve_at_order<16>(problem, settings);
    if (order <= 20) return solve_at_order<20>(problem, settings);
    return solve_at_order<24>(problem, settings);
}

constexpr Method list[] = {
    {.name = "taylor",
     .documentation =
         "Taylor series in binary64, of order 12, 16, 20 or 24 by the tolerance, the step from the last "
         "two coefficients "
         "(Jorba & Zou), samples from the polynomial, the state summed with compensation. Rotations have "
         "recurrences of "
         "their own, eight lanes at a time, by AVX-512 or AVX2 where the processor has them with the same bits as "
         "elsewhere; all else "
         "is recorded from the one right-hand side. An evaluation is a whole series.",
     .source = "R. E. Moore 1966, Interval Analysis; A. Jorba and M. Zou 2005, Experimental Mathematics 14, 99-117",
     .conserves = "nothing",
     .control = Control::tolerance,
     .solve = solve},
};

}  // namespace

extern const std::span<const Method> taylor_methods;
constinit const std::span<const Method> taylor_methods{list};

}  // namespace polhode
