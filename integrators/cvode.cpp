// CVODE's variable-order, variable-step linear multistep methods.
#include <fmt/format.h>

#include <utility>

#include "integrators/cvode_session.h"
#include "integrators/march.h"
#include "integrators/versions.h"

namespace polhode {
namespace {

// steps in a row that do not move t before a run is given up
constexpr int standstill = 100;

Status status_of(int flag) {
    switch (flag) {
        case CV_TOO_MUCH_ACC:
        case CV_ERR_FAILURE:
        case CV_CONV_FAILURE:
            return Status::tolerance_not_met;
        default:
            return Status::failed;
    }
}

template <class SystemType>
class CvodeRun {
  public:
    CvodeRun(const Problem& problem, const Settings& settings, Multistep multistep, Iteration iteration)
        : problem_(problem),
          settings_(settings),
          bound_(energy_bound(problem)),
          session_(problem, multistep, iteration, *settings.tolerance) {}

    Trajectory solve() {
        Budget budget(settings_);
        int runs = 0;
        bool going = true;
        const Stopwatch stopwatch;
        while (going && runs < settings_.repetitions) {
            ++runs;
            going = run(settings_.record && runs == settings_.repetitions, budget);
        }
        trajectory_.seconds = stopwatch.seconds() / runs;
        trajectory_.steps = session_.steps();
        trajectory_.rhs_evaluations = session_.rhs_evaluations();
        if (!settings_.record && going) record(problem_, session_.sample(), bound_, trajectory_);
        return std::move(trajectory_);
    }

  private:
    bool fail(Status status, std::string message) {
        trajectory_.status = status, trajectory_.message = std::move(message);
        return false;
    }
    bool fail(int flag) {
        std::string message = session_.message();
        if (message.empty()) message = fmt::format("{} returned", CVodeGetReturnFlagName(flag));
        if (const auto t = session_.not_finite_at())
            return fail(Status::diverged,
                        fmt::format("the right-hand side is not finite at t = {:g} s; CVODE: {}", *t, message));
        return fail(status_of(flag), "CVODE: " + message);
    }
    bool keep(const Sample& sample) { return record(problem_, sample, bound_, trajectory_); }

    bool run(bool recording, Budget& budget) {
        const double T = problem_.scene.duration;
        const long N = settings_.samples;
        long k = 0;
        session_.restart();
        for (std::size_t i = 0; i < problem_.segments.size(); ++i) {
            const Segment& segment = problem_.segments[i];
            const bool last = i + 1 == problem_.segments.size();
            if (const int flag = session_.enter(segment); flag < 0) return fail(flag);
            // a sample at an event shows the motion after it
            if (recording && sample_time(T, k, N) == segment.begin && (last || segment.end > segment.begin)) {
                if (!keep(session_.sample())) return false;
                ++k;
            }
            int still = 0;
            while (session_.time() < segment.end) {
                if (!budget.take()) {
                    budget.stop(trajectory_);
                    return false;
                }
                const double begin = session_.time();
                if (const int flag = session_.step(); flag < 0) return fail(flag);
                const double t = session_.time();
                still = t > begin ? 0 : still + 1;
                if (still == standstill)
                    return fail(Status::tolerance_not_met,
                                fmt::format("step size below the spacing of numbers at t = {:g} s", t));
                for (; recording && k <= N && sample_time(T, k, N) <= t; ++k) {
                    const double at = sample_time(T, k, N);
                    if (at == t && t == segment.end && !last) break;  // the next segment shows it
                    if (!keep(at == t ? session_.sample() : session_.sample_inside(at))) return false;
                }
            }
        }
        return true;
    }

    const Problem& problem_;
    const Settings& settings_;
    double bound_;
    CvodeSession<SystemType> session_;
    Trajectory trajectory_;
};

Trajectory solve_by(const Problem& problem, const Settings& settings, Multistep multistep, Iteration iteration) {
    Trajectory trajectory = with_system(problem, [&]<class SystemType>() {
        return CvodeRun<SystemType>(problem, settings, multistep, iteration).solve();
    });
    // no timing of such a library is shown without the word
    if (sundials_unoptimised())
        trajectory.message += trajectory.message.empty() ? "SUNDIALS unoptimised" : "; SUNDIALS unoptimised";
    return trajectory;
}

// Functional iteration costs 350 us where Newton's method costs 610 (to 1e-6), and 910 where it costs 1080 (to 1e-9):
// free body, I = (1, 2, 3), omega = (1, 1, 1), T = 100. It fails where the motion is stiff; so do Adams' formulas.
Trajectory adams(const Problem& problem, const Settings& settings) {
    return solve_by(problem, settings, Multistep::adams, Iteration::functional);
}

Trajectory bdf(const Problem& problem, const Settings& settings) {
    if (problem.needs.user_torque) return unsupported("a torque of the user's own has no Jacobian");
    return solve_by(problem, settings, Multistep::bdf, Iteration::newton);
}

constexpr std::string_view source =
    "Hindmarsh, Brown, Grant, Lee, Serban, Shumaker & Woodward 2005, SUNDIALS: suite of nonlinear and "
    "differential/algebraic equation solvers, ACM Trans. Math. Softw. 31, 363-396";

constexpr Method list[] = {
    {.name = "cvode_adams",
     .documentation =
         "CVODE's Adams-Moulton formulas of order 1 to 12 in Nordsieck form, for non-stiff motion. The implicit "
         "equation is solved by functional iteration, which needs no Jacobian. "
         "Relative tolerance R, absolute tolerance R times the component's scale. Steps are CVODE's own and "
         "stop exactly at every event, where the history is dropped; samples between come from the dense output of "
         "the step they fall in (the interpolating polynomial of the step's own order), so the steps do not depend "
         "on the sampling.",
     .source = source,
     .conserves = "nothing",
     .control = Control::tolerance,
     .solve = adams},
    {.name = "cvode_bdf",
     .documentation =
         "CVODE's backward differentiation formulas of order 1 to 5 in fixed-leading-coefficient Nordsieck form, for "
         "stiff motion. The implicit equation is solved by a modified Newton iteration with the exact Jacobian and a "
         "dense LU factorisation. Tolerances, events and samples as for `cvode_adams`. A torque of the user's own is "
         "`unsupported`: it has no Jacobian.",
     .source = source,
     .conserves = "nothing",
     .control = Control::tolerance,
     .solve = bdf},
};

}  // namespace

extern const std::span<const Method> cvode_methods;
const std::span<const Method> cvode_methods{list};

}  // namespace polhode
