// CVODE's variable-order, variable-step linear multistep methods.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "integrators/contact/solve_contacts.h"
#include "integrators/run/refusals.h"
#include "integrators/run/stiffness.h"
#include "integrators/sundials/cvode_session.h"
#include "integrators/sundials/sundials_run.h"
#include "motion/formula_model.h"

namespace polhode {
namespace {

/// CVODE for formula loads that switch. A step after which a switch value is negative ends where it falls to zero on
/// CVODE's interpolating polynomial; the next step restarts there with the equations of the other side.
class SwitchedCvodeSession : public CvodeSession<SwitchedSystem> {
    using Base = CvodeSession<SwitchedSystem>;

  public:
    using Base::Base;

    void restart() {
        Base::restart();
        crossing_.reset(), fault_.clear();
    }
    int enter(const Segment& segment) {
        crossing_.reset();
        return Base::enter(segment);
    }
    int step() {
        if (crossing_ && !cross()) return cannot_continue;
        const double begin = time();
        const std::vector<double> from = system_.switch_values(y());
        const int flag = Base::step();
        if (flag < 0) return flag;
        const std::vector<double> to = system_.switch_values(y());
        std::optional<double> first;
        for (std::size_t i = 0; i < to.size(); ++i) {
            if (!(to[i] < 0)) continue;
            // a value that is not positive at the start has been crossed there, up to rounding
            const double at = from[i] > 0 ? locate(i, begin) : std::nextafter(begin, time());
            if (!first || at < *first) first = at, crossing_ = i;
        }
        if (first) rewind(*first);
        return flag;
    }
    SolverFailure failure(int flag) {
        if (flag == cannot_continue) return {Status::failed, fmt::format("{}, at {}", fault_, format_time(time()))};
        return Base::failure(flag);
    }

  private:
    static constexpr int cannot_continue = -1000;  // not a flag of CVODE
    std::optional<std::size_t> crossing_;          // ended the last step
    std::string fault_;

    bool cross() {
        fault_ = system_.cross_switch(*crossing_, y());
        crossing_.reset();
        if (fault_.empty() && resume() != CV_SUCCESS) fault_ = "CVODE did not restart after a switch";
        return fault_.empty();
    }
    // the end of the bracket at which the value is not positive, by bisection
    double locate(std::size_t which, double positive) {
        double negative = time();
        for (int i = 0; i < 100; ++i) {
            const double middle = positive + (negative - positive) / 2;
            if (!(middle > positive && middle < negative)) break;
            (system_.switch_values(interpolated_state(middle))[which] > 0 ? positive : negative) = middle;
        }
        return negative;
    }
};

/// Steps of CVODE. A step that would exceed `longest` ends there.
class CvodeSteps : public SystemSteps {
  public:
    CvodeSteps(const Problem& problem, Multistep multistep, Iteration iteration, double tolerance)
        : session_(problem, multistep, iteration, tolerance) {
        session_.restart();
        flag_ = session_.enter(problem.segments.front());
    }
    double step(double longest) override {
        constexpr int standstill = 100;
        begin_ = session_.time();
        const double end = begin_ + longest;
        // flags below zero are errors
        for (int i = 0; i < standstill && flag_ >= 0; ++i) {
            flag_ = session_.step_to(end);
            if (flag_ >= 0 && session_.time() > begin_)
                return session_.time() == end ? longest : session_.time() - begin_;
        }
        return 0;
    }
    std::string fault() override { return flag_ < 0 ? session_.failure(flag_).message : "CVODE does not advance"; }
    const double* state() override { return session_.y(); }
    int dense_degree() override { return session_.last_order(); }
    void inside(double s, double* y) override { session_.state_inside(begin_ + s, y); }

  private:
    class Session : public CvodeSession<ErasedSystem> {
        using Base = CvodeSession<ErasedSystem>;

      public:
        using Base::Base;
        /// One step, which does not pass t.
        int step_to(double t) {
            // without a limit, the end only bounds the estimate of the first step
            constexpr double far = 1e3;
            const bool is_limited = t < std::numeric_limits<double>::max();
            this->end_ = is_limited ? t : this->time() + far;
            const int flag = CVodeSetStopTime(this->memory(), is_limited ? t : 1e300);
            return flag < 0 ? flag : Base::step();
        }
        int last_order() {
            int order = 1;
            CVodeGetLastOrder(this->memory(), &order);
            return order;
        }
        void state_inside(double t, double* y) { std::copy_n(this->interpolated_state(t), this->size(), y); }
    };
    Session session_;
    double begin_ = 0;
    int flag_ = 0;
};

std::unique_ptr<SystemSteps> cvode_adams_steps(const Problem& problem, double tolerance) {
    return std::make_unique<CvodeSteps>(problem, Multistep::adams, Iteration::functional, tolerance);
}

std::unique_ptr<SystemSteps> cvode_bdf_steps(const Problem& problem, double tolerance) {
    return std::make_unique<CvodeSteps>(problem, Multistep::bdf, Iteration::newton, tolerance);
}

Trajectory solve_cvode(const Problem& problem, const Settings& settings, Multistep multistep, Iteration iteration) {
    if (contact::has_events(problem.scene))
        return contact::solve_events(problem, settings,
                                     multistep == Multistep::adams ? cvode_adams_steps : cvode_bdf_steps);
    if (has_formula_loads(problem.scene) && has_switches(problem)) {
        SwitchedCvodeSession session(problem, multistep, iteration, *settings.tolerance);
        return run_sundials(problem, settings, session);
    }
    return with_system(problem, [&]<class SystemType>() {
        CvodeSession<SystemType> session(problem, multistep, iteration, *settings.tolerance);
        return run_sundials(problem, settings, session);
    });
}

// Functional iteration costs 350 us instead of 610 with Newton's method (to 1e-6), and 910 instead of 1080 (to 1e-9):
// free body, I = (1, 2, 3), omega = (1, 1, 1), T = 100. It fails if the motion is stiff; so do Adams' formulas.
Trajectory solve_adams(const Problem& problem, const Settings& settings) {
    return solve_cvode(problem, settings, Multistep::adams, Iteration::functional);
}

Trajectory solve_bdf(const Problem& problem, const Settings& settings) {
    return solve_cvode(problem, settings, Multistep::bdf, Iteration::newton);
}

Trajectory solve_cvode_by_stiffness(const Problem& problem, const Settings& settings) {
    const bool stiff = is_stiff(problem);
    Trajectory trajectory = stiff ? solve_bdf(problem, settings) : solve_adams(problem, settings);
    return prepend_remark(std::move(trajectory), stiff ? "BDF: the motion is stiff" : "Adams: the motion is not stiff");
}

Trajectory solve_projected_bdf(const Problem& problem, const Settings& settings) {
    return with_one_body(problem, [&]<class SystemType>() {
        CvodeSession<SystemType> session(problem, Multistep::bdf, Iteration::newton, *settings.tolerance);
        session.set_projection(Projection<SystemType>(problem));
        return run_sundials(problem, settings, session);
    });
}

std::string bdf_refusal(const Problem& problem) {
    if (std::string why = no_jacobian_of_user_torque(problem); !why.empty()) return why;
    return contact::event_refusal(problem);
}

constexpr std::string_view cvode_source =
    "Hindmarsh, Brown, Grant, Lee, Serban, Shumaker & Woodward 2005, SUNDIALS: suite of nonlinear and "
    "differential/algebraic equation solvers, ACM Trans. Math. Softw. 31, 363-396";

constexpr Method cvode_variants[] = {
    {.name = "cvode_adams",
     .documentation =
         "CVODE's Adams-Moulton formulas of order 1 to 12 in Nordsieck form, for non-stiff motion. The implicit "
         "equation is solved by functional iteration, which needs no Jacobian, to a thousandth of the error allowed by "
         "the error test. Relative tolerance R, absolute tolerance R times the component's scale. CVODE controls the "
         "steps. They stop exactly at every event, where the history restarts. Samples inside a step use its dense "
         "output (the interpolating polynomial of the step's order), so the steps do not depend on the sampling. "
         "Events of contacts and joints are located on the same polynomial; the history restarts after each.",
     .general_systems = true,
     .solve = solve_adams,
     .steps = cvode_adams_steps,
     .refusal = contact::event_refusal},
    {.name = "cvode_bdf",
     .documentation =
         "CVODE's backward differentiation formulas of order 1 to 5 in fixed-leading-coefficient Nordsieck form, for "
         "stiff motion. The implicit equation is solved by a modified Newton iteration with the exact Jacobian and a "
         "dense LU factorisation. Stability-limit detection is on: where vibrations are damped so little that the "
         "formulas of orders 3 to 5 would be unstable, the order is reduced, and the reductions are counted. "
         "Tolerances, events and samples as for `cvode_adams`. User-defined torques are `unsupported`, because they "
         "have no Jacobian.",
     .general_systems = true,
     .solve = solve_bdf,
     .steps = cvode_bdf_steps,
     .refusal = bdf_refusal},
    {.name = "cvode_bdf_projected",
     .documentation =
         "`cvode_bdf` with CVODE's projection of the end of each step onto |q| = 1 and the motion's invariants, as in "
         "`odeint_rk4_projected`. The error estimate that controls step and order is not projected.",
     .conserves = "|q| and, if the motion conserves them, E, momenta and spin, to round-off",
     .solve = solve_projected_bdf,
     .refusal = no_jacobian_of_user_torque},
    {.name = "cvode",
     .documentation =
         "`cvode_bdf` if the motion is stiff, otherwise `cvode_adams`; the message says which. Stiff means that the "
         "motion damps far faster than the body rotates. This is determined along a motion that `radau` computes to "
         "three digits; its time is not included in the reported time. With a user-defined torque it is always "
         "`cvode_adams`.",
     .solve = solve_cvode_by_stiffness},
};

constexpr auto cvode_family = apply_defaults({.source = cvode_source,
                                              .conserves = "nothing",
                                              .control = Control::tolerance,
                                              .family = Family::multistep,
                                              .library = sundials_library},
                                             cvode_variants);

}  // namespace

extern const std::span<const Method> cvode_methods{cvode_family};

}  // namespace polhode
