// Taylor series in binary64. The order follows from the tolerance, step sizes from the last two coefficients (Jorba &
// Zou 2005), dense output from the polynomial.
//
// TaylorSession drives one run over a series type. RecordedSeries sums the state with compensation. ExtendedSeries
// serves the tightest tolerances, at which rounding dominates: it keeps the state and the first coefficients in
// extended precision. Of a step's increment h y_1 + h^2 y_2 + .. only the remainder, some millionths of it, is then
// rounded to 53 bits. In binary64 alone the attitude error grows as 1e-16 (w t)^1.5 (Brouwer 1937, Astronomical
// Journal 46, 149). Time is scaled by a power of two so that the fastest rate is near one.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

#include "integrators/closed_form/compensated_rotation.h"
#include "integrators/contact/solve_contacts.h"
#include "integrators/own/binary_parts.h"
#include "integrators/own/record_system.h"
#include "integrators/run/solver_run.h"
#include "integrators/series/series.h"
#include "integrators/series/singular_step.h"
#include "integrators/tape/tape_series.h"
#include "motion/formula_model.h"
#include "motion/numbers.h"
#include "motion/systems.h"

namespace polhode {
namespace {

// Smallest useful tolerance: below it only rounding of the state remains.
constexpr double min_taylor_tolerance = 1e-16;
// Below this tolerance a step's truncation error is less than its rounding error.
constexpr double extended_below = 3e-15;
// Tolerance of ExtendedSeries, whatever the requested one. Truncation errors are alike in every step, so the
// resulting angle error grows as the square of the time.
constexpr double extended_tolerance = 1e-21;
using Extended = long double;
// Where long double is no wider than double, RecordedSeries is used at all tolerances.
constexpr bool has_extended = std::numeric_limits<Extended>::digits >= 64;

// x^(1/p) to a few parts in 10^4, which suffices for a step size, in a tenth of std::pow's time. x = m 2^e with m in
// [sqrt(1/2), sqrt(2)); log2 m from the series of artanh((m - 1)/(m + 1)), 2^y from the Taylor series about y = 0.
double approximate_root(double x, int p) {
    if (!(x > 1e-300 && x < 1e300)) return std::pow(x, 1.0 / p);
    double m = mantissa_of(x);
    int e = exponent_of(x);
    if (m > std::numbers::sqrt2) m *= 0.5, ++e;
    const double z = (m - 1) / (m + 1), zz = z * z;
    const double log2 = e + 2 * std::numbers::log2e * z * (1 + zz * (1.0 / 3 + zz * (1.0 / 5)));
    const double y = log2 / p, whole = std::round(y), f = (y - whole) * std::numbers::ln2;
    const double fraction = 1 + f * (1 + f * (0.5 + f * (1.0 / 6 + f * (1.0 / 24))));
    return fraction * power_of_two(static_cast<int>(whole));
}

/// Squared sizes of the last coefficient and the one before it, relative to the scales of the components: maximum
/// over all components.
struct CoefficientSizes {
    double last = 0, before = 0;

    void add(double last_squared, double before_squared, double scale) {
        const double share = 1 / (scale * scale);
        last = std::max(last, last_squared * share), before = std::max(before, before_squared * share);
        if (std::isnan(last_squared) || std::isnan(before_squared)) last = last_squared + before_squared;
    }
};

/// Step size from the radius of convergence that two coefficients indicate, times exp(-0.7/(p - 1)) (Jorba & Zou
/// 2005, Experimental Mathematics 14, 99, eq. 3.4).
double compute_step(const CoefficientSizes& sizes, double tolerance, int order) {
    const auto radius = [&](double squared, int p) {
        return squared == 0 ? HUGE_VAL : approximate_root(tolerance * tolerance / squared, 2 * p);
    };
    return std::min(radius(sizes.last, order), radius(sizes.before, order - 1)) * std::exp(-0.7 / (order - 1));
}

/// Coefficients of any system, with recurrences recorded from its right-hand side. `careful`: coefficients are
/// divided by k + 1 instead of multiplied by its rounded inverse.
template <class SystemType, bool careful = false>
class RecordedCoefficients {
  public:
    RecordedCoefficients(const Problem&, const Segment&, const SystemType& system, double tolerance)
        : series_(record_system<double>(system), {.careful = careful, .tolerance = tolerance}), scales_(system.size()) {
        system.scales(scales_.data());
    }
    void expand(const double* y) { series_.expand(y); }
    double step(double tolerance) const {
        const int order = series_.order();
        const double *last = series_.coefficients(order), *before = series_.coefficients(order - 1);
        CoefficientSizes sizes;
        for (int i = 0; i < size(); ++i) sizes.add(squared(last[i]), squared(before[i]), scales_[i]);
        return compute_step(sizes, tolerance, order);
    }
    /// Sums y_k h^(k - from) from k = `from` on, for each component.
    template <int from>
    void tail(double h, double* sums) const {
        series_.sum(from, h, sums);
    }
    /// Number of elements that tail() writes.
    int padded_size() const { return TapeLayout::whole(size()); }

  private:
    static double squared(double x) { return x * x; }
    int size() const { return static_cast<int>(scales_.size()); }

    TapeSeries series_;
    Numbers<SystemType::dimension> scales_;
};

/// A system's state and the series about it, with compensated summation.
template <class SystemType>
class RecordedSeries {
  public:
    RecordedSeries(const Problem& problem, const Segment& segment, const SystemType& system, double tolerance)
        : coefficients_(problem, segment, system, tolerance),
          sum_(system.size()),
          increment_(coefficients_.padded_size()) {}
    void start(const double* y) {
        for (int i = 0; i < size(); ++i) sum_[i] = {y[i], 0};
    }
    void expand() {
        state(increment_.data());
        coefficients_.expand(increment_.data());
    }
    double step(double tolerance) const { return coefficients_.step(tolerance); }
    void advance(double h) {
        compute_increment(h);
        for (int i = 0; i < size(); ++i) sum_[i].add(increment_[i]);
    }
    void evaluate(double h, double* y) {
        compute_increment(h);
        for (int i = 0; i < size(); ++i) y[i] = sum_[i].value + (sum_[i].lost + increment_[i]);
    }
    void state(double* y) const {
        for (int i = 0; i < size(); ++i) y[i] = sum_[i].value;
    }

  private:
    int size() const { return static_cast<int>(sum_.size()); }
    void compute_increment(double h) {
        coefficients_.template tail<1>(h, increment_.data());
        for (int i = 0; i < size(); ++i) increment_[i] *= h;
    }

    RecordedCoefficients<SystemType> coefficients_;
    Numbers<SystemType::dimension, CompensatedSum> sum_;
    Numbers<run_time> increment_;
};

/// I^-1 in the axes of the posed problem, 1/(kg m^2).
Matrix3<double> inverse_inertia(const Problem& problem) {
    return problem.formulation == Formulation::full ? problem.body.full_inertia.inverse
                                                    : diagonal(problem.body.principal_inertia.inverse_moments);
}

/// Bound on sqrt(tau / I), 1/s, from bounds on the torque's components in the axes of the posed problem.
double torque_rate(const Problem& problem, const Vector3<double>& torque) {
    const Matrix3<double> inverse = inverse_inertia(problem);
    double rate = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            rate = std::max(rate, std::sqrt(std::abs(inverse[i][j])) * std::sqrt(std::abs(torque[j])));
    return rate;
}

/// Estimate of the fastest rate (1/s) at which w and q respond to a small perturbation because of the loads: decay by
/// drag, angular frequencies due to springs and to forces and torques fixed in the world.
double response_rate(const Problem& problem, const Segment& segment) {
    const Forcing<double>& f = segment.forcing;
    double rate = f.has_translational_drag ? f.specific_drag : 0;
    const auto add_torque = [&](double x, double y, double z) {
        rate = std::max(rate, torque_rate(problem, Vector3<double>(x, y, z)));
    };
    const auto length = [](const Vector3<double>& v) { return std::hypot(v[0], v[1], v[2]); };
    if (f.has_damping) {
        const Matrix3<double> decay = inverse_inertia(problem) * f.damping;
        for (int i = 0; i < 3; ++i)
            rate = std::max(rate, std::abs(decay[i][0]) + std::abs(decay[i][1]) + std::abs(decay[i][2]));
    }
    // |m x e| per component, for any unit vector e
    for (const Vector3<double>& m : f.field.moment)
        add_torque(std::hypot(m[1], m[2]), std::hypot(m[2], m[0]), std::hypot(m[0], m[1]));
    for (const auto& spring : f.springs) add_torque(spring.stiffness, spring.stiffness, spring.stiffness);
    if (f.has_world_torque) add_torque(length(f.torque_W), length(f.torque_W), length(f.torque_W));
    for (const auto& load : f.world_points) {
        const double arm = length(load.point_W) + (f.pivoted ? 0 : problem.scales.position);
        const double torque = arm * length(load.force);
        add_torque(torque, torque, torque);
    }
    return rate;
}

/// A series with its state and first coefficients in extended precision. The remainder, some millionths of a step's
/// increment, comes from binary64 coefficients.
template <class SystemType>
class ExtendedSeries {
  public:
    ExtendedSeries(const Problem& problem, const Segment& segment, const SystemType& system, double)
        : coefficients_(problem, segment, system, extended_tolerance),
          first_(record_system<Extended>(system), extended),
          longest_(problem.model() ? std::numeric_limits<double>::infinity() : 4 / response_rate(problem, segment)),
          state_(system.size()) {}
    void start(const double* y) { std::copy_n(y, size(), state_.begin()); }
    void expand() {
        Values y(size());
        state(y.data());
        coefficients_.expand(y.data());
        first_.expand(state_.data());
    }
    double step(double) const { return std::min(coefficients_.step(extended_tolerance), longest_); }
    void advance(double h) { state_ = advanced_state(h); }
    void evaluate(double h, double* y) const { round(advanced_state(h), y); }
    void state(double* y) const { round(state_, y); }

  private:
    using State = Numbers<SystemType::dimension, Extended>;
    using Values = Numbers<SystemType::dimension>;
    static constexpr int extended = 4;  ///< highest order in extended precision

    int size() const { return static_cast<int>(state_.size()); }
    State advanced_state(double h) const {
        Numbers<run_time> tail(coefficients_.padded_size());
        coefficients_.template tail<extended + 1>(h, tail.data());
        const Extended step = h;
        State y(size());
        for (int i = 0; i < size(); ++i) {
            Extended sum = tail[i];
            for (int k = extended; k > 0; --k) sum = first_.coefficient(i, k) + sum * step;
            y[i] = state_[i] + sum * step;
        }
        return y;
    }
    static void round(const State& state, double* y) {
        for (std::size_t i = 0; i < state.size(); ++i) y[i] = static_cast<double>(state[i]);
    }

    RecordedCoefficients<SystemType, true> coefficients_;
    Series<Extended> first_;
    // Upper bound on the step, 4/rate. Near equilibrium the coefficients of the rounded state can vanish while those
    // of the exact state do not; in longer steps the difference would grow.
    double longest_;
    State state_;
};

/// Exponent k of the time unit 2^-k s in which the motion's fastest rate is near one. Returns 0 if no coefficient
/// leaves the range of binary64 without scaling.
int time_unit_exponent(const Problem& problem) {
    if (problem.model()) return 0;
    double rate = problem.scales.angular_velocity;
    for (int i = 0; i < 3; ++i) rate = std::max(rate, std::abs(problem.body.initial_angular_velocity[i]));
    for (const Segment& segment : problem.segments) {
        rate = std::max(rate, response_rate(problem, segment));
        if (segment.forcing.has_torque) rate = std::max(rate, torque_rate(problem, segment.forcing.torque));
    }
    constexpr int max_unscaled_exponent = 12, max_exponent = 1000;
    const int k = std::isfinite(rate) && rate > 0 ? std::ilogb(rate) : 0;
    if (std::abs(k) <= max_unscaled_exponent) return 0;
    // Keep every time of the scene a normal number.
    const int first =
        std::ilogb(problem.segments.front().end > 0 ? problem.segments.front().end : problem.scene.duration);
    const int last = std::ilogb(problem.scene.duration);
    return std::clamp(k, std::max(-max_exponent, -900 - first), std::min(max_exponent, 900 - last));
}

/// Returns the scene with time in units of 2^-k s. Scaling by powers of two is exact.
Scene scale_time(Scene scene, int k) {
    const auto scale = [k](auto& x, int power) {
        if constexpr (requires { x[0]; })
            for (int i = 0; i < 3; ++i) x[i] = std::scalbn(x[i], k * power);
        else
            x = std::scalbn(x, k * power);
    };
    scale(scene.duration, 1);
    scale(scene.initial.angular_velocity, -1), scale(scene.initial.velocity_W, -1);
    for (Load& load : scene.loads) {
        std::visit(
            [&scale]<class L>(L& l) {
                if constexpr (std::is_same_v<L, Impulse>)
                    scale(l.at, 1);
                else
                    scale(l.window.from, 1), scale(l.window.until, 1);
                if constexpr (std::is_same_v<L, Gravity>) scale(l.acceleration_W, -2);
                if constexpr (std::is_same_v<L, Torque> || std::is_same_v<L, Force>) scale(l.vector, -2);
                if constexpr (std::is_same_v<L, Impulse>) scale(l.vector, -1);
                if constexpr (std::is_same_v<L, Drag>) scale(l.rotational, -1), scale(l.translational, -1);
                if constexpr (std::is_same_v<L, Spring> || std::is_same_v<L, PointSpring>) scale(l.stiffness, -2);
                if constexpr (std::is_same_v<L, Motor>) scale(l.force, -2);
            },
            load);
    }
    return scene;
}

/// One run over a series. The series determines the steps, which are shortened only at events and at the end. Samples
/// are evaluated from the polynomial, so they do not affect the steps. Internal time is in units of 2^-exponent s, in
/// which `scaled` is posed; the interface uses seconds. Both problems must outlive the session.
template <class Series, class SystemType>
class TaylorSession {
  public:
    TaylorSession(const Problem& problem, const Problem& scaled, int exponent, double tolerance)
        : problem_(&problem),
          scaled_(&scaled),
          system_(scaled),
          unit_(std::scalbn(1.0, -exponent)),
          per_unit_(std::scalbn(1.0, exponent)),
          tolerance_(tolerance) {}

    /// Returns to t = 0 and resets all counts.
    void restart() {
        series_.reset();
        system_.initial(y_.data());
        t_ = 0, steps_ = 0, switched_ = 0;
        crossing_.reset(), fault_.clear();
        singular_.reset(), is_singular_ = false;
    }
    /// Handles an event: applies the impulses and sets the loads of this segment.
    int enter(const Segment& of_problem) {
        const Segment& segment = scaled_->segments[of_problem.index];
        advance_to_current_time();
        system_.enter(segment, y_.data());
        series_.reset();
        begin_ = t_ = segment.begin, end_ = segment.end;
        segment_ = &segment;
        crossing_.reset(), fault_.clear();
        singular_.reset(), is_singular_ = false;
        if (end_ > t_) series_.emplace(*scaled_, segment, system_, tolerance_).start(y_.data());
        return 0;
    }
    /// Takes one step, shortened at the end of the segment. Returns a negative flag, without advancing, if no step is
    /// possible.
    int step() {
        advance();
        if (!fault_.empty()) return cannot_continue;
        ++steps_;
        if constexpr (switches)
            if (is_singular_) return take_singular_step();
        series_->expand();
        const double h = series_->step(tolerance_);
        if constexpr (switches)
            if (std::isnan(h) && system_.has_roots()) return take_singular_step();
        if (std::isnan(h)) return not_finite;
        const double next = t_ + h;
        if (!(next > t_)) return too_short;
        // A remainder of a few rounding errors is merged into the step.
        t_ = next >= end_ - 1e-14 * (end_ - t_) ? end_ : next;
        if constexpr (switches) {
            if (system_.has_roots()) end_at_root_zero();
            return end_at_crossing();
        }
        return 0;
    }

    double time() const { return t_ * unit_; }
    auto sample() {
        advance_to_current_time();
        return convert_to_seconds(system_.motion(t_, y_.data()));
    }
    /// The motion at a time within the last step.
    auto sample_inside(double at) {
        const double t = at * per_unit_;
        if (singular_)
            singular_->evaluate((t - begin_) / (t_ - begin_), y_.data());
        else
            series_->evaluate(t - begin_, y_.data());
        return std::optional(convert_to_seconds(system_.motion(t, y_.data())));
    }
    int inside_flag() const { return 0; }

    SolverFailure failure(int flag) const {
        if (flag == cannot_continue) return {Status::failed, fmt::format("{} at t = {:g} s", fault_, time())};
        if (flag == not_finite) return {Status::diverged, fmt::format("not finite at t = {:g} s", time())};
        return {Status::tolerance_not_met, fmt::format("step size below the spacing of numbers at t = {:g} s", time())};
    }

    /// Counts since restart().
    long steps() const { return steps_; }
    long rhs_evaluations() const { return steps_; }

  private:
    static constexpr int not_finite = -1, too_short = -2, cannot_continue = -3;
    static constexpr bool switches = requires(SystemType f) { f.switching_points(); };

    // User-defined systems are in seconds already.
    static Moment convert_to_seconds(Moment bodies) { return bodies; }
    Sample convert_to_seconds(Sample sample) const {
        sample.t *= unit_;
        sample.angular_velocity_B = per_unit_ * sample.angular_velocity_B;
        sample.velocity_W = per_unit_ * sample.velocity_W;
        return sample;
    }
    // Until the next step or event the series stays at the start of the last step, so that samples can be evaluated.
    void advance_to_current_time() {
        if (!series_) return;
        advance();
        series_->state(y_.data());
    }
    void advance() {
        if (!(t_ > begin_)) return;
        if (singular_) {
            singular_->evaluate(1.0, y_.data());
            singular_.reset(), begin_ = t_;
            if constexpr (SystemType::dimension == run_time)
                if (system_.projects()) system_.project(y_.data());
            series_->start(y_.data());
            return;
        }
        series_->advance(t_ - begin_), begin_ = t_;
        if constexpr (SystemType::dimension == run_time) {
            if (!system_.projects()) return;
            series_->state(y_.data());
            system_.project(y_.data());
            if constexpr (switches) cross_switch();
            series_->start(y_.data());
        }
    }

    // Ends the step where a square root passes zero: its polynomial would change sign there.
    void end_at_root_zero() {
        constexpr int parts = 4;
        constexpr double near_zero = 0.25, smallness = 1e-13;  // relative to the largest argument
        const double h = t_ - begin_;
        const auto at = [&](double after) {
            series_->evaluate(after, y_.data());
            return system_.root_arguments(y_.data());
        };
        std::vector<double> least = at(0), largest = least;
        for (int i = 1; i <= parts; ++i) {
            const std::vector<double> now = at(h * i / parts);
            for (std::size_t j = 0; j < now.size(); ++j)
                least[j] = std::min(least[j], now[j]), largest[j] = std::max(largest[j], now[j]);
        }
        bool may_pass = false;
        for (std::size_t j = 0; j < least.size(); ++j) may_pass = may_pass || !(least[j] > near_zero * largest[j]);
        if (!may_pass) return;
        const std::optional<double> zero = find_root_zero<double>(at, h, smallness);
        if (!zero) return;
        t_ = std::min(t_, std::max(std::nextafter(begin_, end_), begin_ + *zero));
        is_singular_ = t_ < end_;
    }
    // A step from a state at which a square root has no series.
    int take_singular_step() {
        constexpr int stages = 8;
        constexpr double digits = 15.5;
        is_singular_ = false;
        std::vector<double> y(y_.size()), scales(y.size());
        series_->state(y.data());
        system_.scales(scales.data());
        const std::vector<SwitchOf<double>> points = system_.switching_points();
        const auto derivative = [&](const double* at, double* rates) { system_.derivative(0, at, rates); };
        const auto accepts = [&](std::vector<double> state) {
            system_.project(state.data());
            return std::ranges::all_of(points, [&](const SwitchOf<double>& point) {
                return point.sign * (state[static_cast<std::size_t>(point.component)] - point.threshold) >= 0;
            });
        };
        singular_.emplace(stages);
        const std::optional<double> h = singular_->solve(derivative, y, (end_ - t_) / 16, scales, digits, accepts);
        if (!h || !(t_ + *h > t_)) {
            singular_.reset();
            return not_finite;
        }
        t_ += *h;
        return 0;
    }

    // Ends the step at the first crossing of a switching point. The polynomial is searched at equally spaced times.
    int end_at_crossing() {
        constexpr int parts = 16;
        const double h = t_ - begin_;
        const std::vector<SwitchOf<double>> points = system_.switching_points();
        if (points.empty()) return 0;
        const auto heights = [&](double after) {
            series_->evaluate(after, y_.data());
            std::vector<double> all;
            for (const auto& point : points) all.push_back(y_[point.component] - point.threshold);
            return all;
        };
        for (int j = 1; j <= parts; ++j) {
            const std::vector<double> now = heights(h * j / parts);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const int sign = points[i].sign;
                // a switch that stays at its threshold
                if (sign == 0 && std::abs(now[i]) > 1e-12 * std::max(1.0, std::abs(points[i].threshold))) {
                    fault_ = "chattering: the motion slides along a switching surface";
                    return cannot_continue;
                }
                if (sign * now[i] >= 0) continue;
                const double after = locate(points[i], h * (j - 1) / parts, h * j / parts);
                if (!crossing_ || after < crossing_->after) crossing_ = {i, after};
            }
            if (crossing_) break;
        }
        // a step has a positive length
        if (crossing_) t_ = std::min(t_, std::max(std::nextafter(begin_, end_), begin_ + crossing_->after));
        return 0;
    }
    // The crossing between two times after the start of the step, by bisection.
    double locate(const SwitchOf<double>& point, double from, double to) {
        for (int i = 0; i < 60 && from < to; ++i) {
            const double middle = from + (to - from) / 2;
            if (middle == from || middle == to) break;
            series_->evaluate(middle, y_.data());
            (point.sign * (y_[point.component] - point.threshold) > 0 ? from : to) = middle;
        }
        return to;
    }
    // Changes the equations at the crossing that ended the step.
    void cross_switch() {
        if (!crossing_) return;
        constexpr long most_switches = 100'000;
        fault_ = system_.cross_switch(crossing_->which, y_.data());
        if (++switched_ > most_switches) fault_ = "too many switches";
        crossing_.reset();
        series_.emplace(*scaled_, *segment_, system_, tolerance_);
    }

    const Problem *problem_, *scaled_;
    SystemType system_;
    double unit_, per_unit_;  ///< s and 1/s
    double tolerance_;
    double begin_ = 0, t_ = 0, end_ = 0;  ///< scaled time: start of the last step, now, end of the segment
    long steps_ = 0;
    struct Crossing {
        std::size_t which;  ///< index of the switching point
        double after;       ///< from the start of the step
    };
    const Segment* segment_ = nullptr;
    std::optional<Crossing> crossing_;  ///< ended the last step
    std::string fault_;                 ///< why the motion cannot be continued
    long switched_ = 0;
    bool is_singular_ = false;                      ///< a square root is zero at t_
    std::optional<SingularStep<double>> singular_;  ///< the last step, if it is not the series'
    Numbers<SystemType::dimension> y_{system_.size()};
    std::optional<Series> series_;
};

template <class Series, class SystemType>
Trajectory solve_with_series(const Problem& problem, const Settings& settings) {
    const int exponent = time_unit_exponent(problem);
    std::optional<Problem> scaled;
    if (exponent != 0) scaled = pose(scale_time(problem.scene, exponent), problem.formulation);
    TaylorSession<Series, SystemType> session(problem, scaled ? *scaled : problem, exponent,
                                              std::max(*settings.tolerance, min_taylor_tolerance));
    Trajectory trajectory = SolverRun(problem, settings, session).solve();
    if (*settings.tolerance < min_taylor_tolerance && trajectory.status == Status::ok) {
        trajectory.status = Status::tolerance_not_met;
        trajectory.message = "a tolerance below 1e-16 cannot be met in binary64; 1e-16 was used";
    }
    return trajectory;
}

Trajectory solve_taylor(const Problem& problem, const Settings& settings) {
    if (contact::has_events(problem.scene)) return contact::solve_events(problem, settings);
    if (has_formula_loads(problem.scene)) {
        if (*settings.tolerance < extended_below && has_extended)
            return solve_with_series<ExtendedSeries<FormulaSystem>, FormulaSystem>(problem, settings);
        return solve_with_series<RecordedSeries<FormulaSystem>, FormulaSystem>(problem, settings);
    }
    return with_system(problem, [&]<class SystemType>() {
        if (*settings.tolerance < extended_below && has_extended)
            return solve_with_series<ExtendedSeries<SystemType>, SystemType>(problem, settings);
        return solve_with_series<RecordedSeries<SystemType>, SystemType>(problem, settings);
    });
}

std::string taylor_refusal(const Problem& problem) {
    return problem.needs.user_torque ? "user-defined torques have no Taylor coefficients" : "";
}

constexpr Method taylor_variants[] = {
    {.name = "taylor",
     .documentation =
         "Taylor series in binary64, with the order of least work at the tolerance, the step size from the last two "
         "coefficients (Jorba & Zou), samples from the polynomial, and compensated summation of the state. For "
         "tolerances below 3e-15 the step size is that of 1e-21, and the state and the terms up to h^4 are in extended "
         "precision if long double has at least 64 bits: the attitude error of a free body is then 3e-16 rad after 100 "
         "s and 4e-11 rad after a million radians, at about seven times the run time. Time is scaled by a power of two "
         "near the motion's fastest rate, so that the method behaves the same at any rate. The recurrences are "
         "recorded from the right-hand side and compiled for the scene to machine code, with AVX-512 or AVX2. Where "
         "machine code cannot be generated, an interpreter gives the same bits. One evaluation is a whole series. On "
         "planes "
         "it follows flight, sliding and rolling in reduced coordinates, with events located on the series.",
     .source = "R. E. Moore 1966, Interval Analysis; A. Jorba and M. Zou 2005, Experimental Mathematics 14, 99-117",
     .conserves = "nothing",
     .control = Control::tolerance,
     .planes = true,
     .general_systems = true,
     .solve = solve_taylor},
};

constexpr auto taylor_list = apply_defaults({.family = Family::series, .refusal = taylor_refusal}, taylor_variants);

}  // namespace

extern const std::span<const Method> taylor_methods{taylor_list};

}  // namespace polhode
