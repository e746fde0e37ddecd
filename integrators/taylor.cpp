// Taylor series in binary64: orders 12 to 24, steps from the coefficients, dense output from the polynomial.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "integrators/kernels/rotation_series.h"
#include "integrators/march.h"
#include "integrators/truth/series.h"

namespace polhode {
namespace {

// the smallest tolerance that means anything: beyond it round-off of the state is all that is left
constexpr double least_tolerance = 1e-16;

/// Lengths of the order'th and the one before it coefficient over the scale of their block: the largest of all blocks.
struct Sizes {
    double last = 0, before = 0;

    void note(double last_length, double before_length, double scale) {
        last = std::max(last, last_length / scale), before = std::max(before, before_length / scale);
    }
};

/// Jorba & Zou 2005, Experimental Mathematics 14, 99, eq. 3.4: the radius of convergence seen at two coefficients,
/// times exp(-0.7/(p - 1)).
double step_of(const Sizes& sizes, double tolerance, int order) {
    const auto radius = [&](double size, int p) { return size > 0 ? std::pow(tolerance / size, 1.0 / p) : HUGE_VAL; };
    return std::min(radius(sizes.last, order), radius(sizes.before, order - 1)) * std::exp(-0.7 / (order - 1));
}

// sum += increment, with what was lost before in `lost`: Kahan 1965
template <class T>
void add_compensated(T& sum, T& lost, const T& increment) {
    const T corrected = increment + lost, before = sum;
    sum = before + corrected;
    const T kept = sum - before;
    lost = (before - (sum - kept)) + (corrected - kept);
}

/// Rotations in principal axes, by RotationSeries.
template <int order>
class UnrolledSeries {
  public:
    template <class SystemType>
    static bool serves(const Problem& problem) {
        if constexpr (SystemType::dimension != 7) return false;
        return std::all_of(problem.segments.begin(), problem.segments.end(),
                           [](const Segment& s) { return RotationSeries<order>::serves(s.forcing); });
    }

    UnrolledSeries(const Problem& problem, const Segment& segment, double rate_scale)
        : series_(problem.principal_inertia), rate_scale_(rate_scale) {
        series_.set(segment.forcing);
#if defined(__x86_64__)
        expand_ = __builtin_cpu_supports("avx2") ? &expand_avx2 : &expand_anywhere;
#else
        expand_ = &expand_anywhere;
#endif
    }
    void start(const double* y) {
        w_ = Lanes4{y[0], y[1], y[2], 0}, q_ = Lanes4{y[3], y[4], y[5], y[6]};
        w_lost_ = q_lost_ = Lanes4{0, 0, 0, 0};
    }
    void expand() { expand_(series_, w_, q_); }
    double step(double tolerance) const {
        Sizes sizes;
        sizes.note(length(series_.rate(order)), length(series_.rate(order - 1)), rate_scale_);
        sizes.note(length(series_.attitude(order)), length(series_.attitude(order - 1)), 1);
        return step_of(sizes, tolerance, order);
    }
    void advance(double h) {
        Lanes4 dw, dq;
        series_.increment(h, dw, dq);
        add_compensated(w_, w_lost_, dw);
        add_compensated(q_, q_lost_, dq);
    }
    void look(double h, double* y) const {
        Lanes4 dw, dq;
        series_.increment(h, dw, dq);
        put(w_ + (w_lost_ + dw), q_ + (q_lost_ + dq), y);
    }
    void state(double* y) const { put(w_, q_, y); }

  private:
    using Series = RotationSeries<order>;

    static double length(const Lanes4& v) {
        return std::sqrt((v[0] * v[0] + v[1] * v[1]) + (v[2] * v[2] + v[3] * v[3]));
    }
    static void put(const Lanes4& w, const Lanes4& q, double* y) {
        for (int i = 0; i < 3; ++i) y[i] = w[i];
        for (int i = 0; i < 4; ++i) y[3 + i] = q[i];
    }
    static void expand_anywhere(Series& series, const Lanes4& w, const Lanes4& q) { series.expand(w, q); }
#if defined(__x86_64__)
    // the same operations in the same order, four lanes to a register in place of two: the same bits
    [[gnu::target("avx2")]] static void expand_avx2(Series& series, const Lanes4& w, const Lanes4& q) {
        series.expand(w, q);
    }
#endif

    Series series_;
    void (*expand_)(Series&, const Lanes4&, const Lanes4&) = nullptr;
    double rate_scale_;
    Lanes4 w_{}, q_{}, w_lost_{}, q_lost_{};
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
        std::copy(y, y + dimension, y_.begin());
        lost_.fill(0);
    }
    void expand() { series_.expand(y_.data()); }
    double step(double tolerance) const {
        Sizes sizes;
        for (int i = 0; i < dimension; ++i)
            sizes.note(std::abs(series_.coefficient(i, order)), std::abs(series_.coefficient(i, order - 1)),
                       scales_[i]);
        return step_of(sizes, tolerance, order);
    }
    void advance(double h) {
        for (int i = 0; i < dimension; ++i) add_compensated(y_[i], lost_[i], increment(i, h));
    }
    void look(double h, double* y) const {
        for (int i = 0; i < dimension; ++i) y[i] = y_[i] + (lost_[i] + increment(i, h));
    }
    void state(double* y) const { std::copy(y_.begin(), y_.end(), y); }

  private:
    struct Form {
        SystemType system;
        void derivative(const truth::Traced<double>* y, truth::Traced<double>* dy) const {
            system.derivative(0, y, dy);
        }
    };
    double increment(int i, double h) const {
        double sum = series_.coefficient(i, order);
        for (int k = order - 1; k >= 1; --k) sum = sum * h + series_.coefficient(i, k);
        return sum * h;
    }

    truth::Series<double> series_;
    std::array<double, dimension> scales_{}, y_{}, lost_{};
};

/// Steps of the series' own choosing, cut only at events and at the end; samples are looked up in the polynomial, so
/// the steps do not depend on them.
template <class Series, class SystemType, class... Options>
Trajectory march_series(const Problem& problem, const Settings& settings, const Options&... options) {
    Trajectory trajectory;
    const double T = problem.scene.duration, bound = energy_bound(problem);
    const double tolerance = std::max(*settings.tolerance, least_tolerance);
    const long N = settings.samples;
    Budget budget(settings);
    long expansions = 0;
    std::array<double, SystemType::dimension> y{};
    const auto run = [&](bool recording) {
        expansions = 0;
        initial_state<SystemType>(problem, y.data());
        Pace pace(settings, T, budget.steps());
        long k = 0;
        const auto keep = [&](double t) {
            return record(problem, sample_of<SystemType>(problem, t, y.data()), bound, trajectory);
        };
        for (std::size_t i = 0; i < problem.segments.size(); ++i) {
            const Segment& segment = problem.segments[i];
            enter<SystemType>(problem, segment, y.data());
            const bool closes = i + 1 < problem.segments.size() && problem.segments[i + 1].begin == segment.end;
            double t = segment.begin;
            if (recording && sample_time(T, k, N) == t && (i + 1 == problem.segments.size() || segment.end > t)) {
                if (!keep(t)) return false;
                ++k;
            }
            if (!(segment.end > t)) continue;
            Series series(problem, segment, options...);
            series.start(y.data());
            while (t < segment.end) {
                if (!budget.take()) {
                    budget.stop(trajectory);
                    return false;
                }
                series.expand();
                ++expansions;
                double h = series.step(tolerance), next = t + h;
                if (std::isnan(h)) {
                    trajectory.status = Status::diverged;
                    trajectory.message = "not finite at t = " + std::to_string(t);
                    return false;
                }
                if (!(next > t)) {
                    trajectory.status = Status::tolerance_not_met;
                    trajectory.message = "step size below the spacing of numbers at t = " + std::to_string(t);
                    return false;
                }
                // a remainder of a few rounding errors joins the step
                if (next >= segment.end - 1e-14 * (segment.end - t)) next = segment.end;
                h = next - t;
                for (; recording && k <= N && sample_time(T, k, N) <= next; ++k) {
                    const double at = sample_time(T, k, N);
                    if (closes && at == segment.end) break;  // the next segment shows it
                    series.look(at - t, y.data());
                    if (!keep(at)) return false;
                }
                series.advance(h);
                t = next;
                if (!pace.keeps(budget.steps(), t)) {
                    trajectory.status = Status::tolerance_not_met, trajectory.message = Pace::message(t);
                    return false;
                }
            }
            series.state(y.data());
        }
        return true;
    };
    const Stopwatch stopwatch;
    for (int repetition = 0; repetition < settings.repetitions; ++repetition)
        if (!run(settings.record && repetition + 1 == settings.repetitions)) break;
    trajectory.seconds = stopwatch.seconds() / settings.repetitions;
    trajectory.steps = budget.steps() / settings.repetitions;
    trajectory.rhs_evaluations = expansions;
    if (!settings.record && trajectory.status == Status::ok)
        record(problem, sample_of<SystemType>(problem, T, y.data()), bound, trajectory);
    if (*settings.tolerance < least_tolerance && trajectory.status == Status::ok) {
        trajectory.status = Status::tolerance_not_met;
        trajectory.message = "a tolerance below 1e-16 is beyond binary64: steps were taken for 1e-16";
    }
    return trajectory;
}

template <int order>
Trajectory solve_at_order(const Problem& problem, const Settings& settings) {
    return with_system(problem, [&]<class SystemType>() {
        if (UnrolledSeries<order>::template serves<SystemType>(problem))
            if constexpr (SystemType::dimension == 7)
                return march_series<UnrolledSeries<order>, SystemType>(problem, settings,
                                                                       problem.scales.angular_velocity);
        return march_series<RecordedSeries<order, SystemType>, SystemType>(problem, settings);
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
     .documentation = "Taylor series in binary64, of order 12, 16, 20 or 24 by the tolerance, the step from the last "
                      "two coefficients "
                      "(Jorba & Zou), samples from the polynomial, the state summed with compensation. Rotations have "
                      "recurrences of "
                      "their own, four lanes at a time, by AVX2 where the processor has it with the same bits as "
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
