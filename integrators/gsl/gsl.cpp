// The GNU Scientific Library's solvers of ordinary differential equations, for comparison.
//
// GslSession drives one solver. The library has no dense output, so samples inside a step are integrated from the
// start of the step by a second driver. Right-hand sides that are not finite are reported to the library as
// recoverable errors.
#include "integrators/gsl/gsl.h"

#include <fmt/format.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_version.h>

#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "integrators/run/refusals.h"
#include "integrators/run/solver_run.h"
#include "integrators/run/tolerance.h"
#include "motion/finite.h"
#include "motion/jacobian.h"
#include "motion/numbers.h"
#include "motion/systems.h"

namespace polhode {
namespace {

/// The library's names are variables set by the dynamic linker.
struct GslScheme {
    const gsl_odeiv2_step_type* const* type;
    /// Solver from the start of a step to a sample inside it, because the library has no dense output.
    const gsl_odeiv2_step_type* const* sample_type;
    int order;  ///< initial order
};

/// The problem must outlive the session. The session must not be moved: the library holds pointers into it.
template <class SystemType>
class GslSession {
  public:
    /// Result type of the system's motion(): a sample, or the motion of all bodies.
    using Motion = decltype(std::declval<const SystemType&>().motion(0, nullptr));

    /// Relative tolerance R, absolute tolerance R times each component's scale. Throws std::bad_alloc if memory is
    /// exhausted.
    GslSession(const Problem& problem, const GslScheme& scheme, double tolerance)
        : problem_(&problem), system_(problem), order_(scheme.order), tolerance_(tolerance) {
        // By default the library aborts the program on errors.
        [[maybe_unused]] static const auto former = gsl_set_error_handler_off();
        system_.scales(scales_.data());
        driver_ = make_driver(main_context_, *scheme.type);
        sample_driver_ = make_driver(sample_context_, *scheme.sample_type);
    }
    GslSession(const GslSession&) = delete;
    GslSession& operator=(const GslSession&) = delete;

    void restart() {
        system_.initial(y_.data());
        main_context_.evaluations = sample_context_.evaluations = 0;
        steps_ = rejected_ = 0;
        gsl_odeiv2_driver_reset(driver_.get());
    }

    /// Handles an event: applies the impulses, then sets the loads of this segment. Clears the history of previous
    /// steps.
    int enter(const Segment& segment) {
        system_.enter(segment, y_.data());
        t_ = segment.begin, end_ = segment.end;
        if (!(end_ > t_)) return GSL_SUCCESS;
        rejected_ += static_cast<long>(driver_->e->failed_steps);
        gsl_odeiv2_driver_reset(driver_.get());
        h_ = first_step();
        return GSL_SUCCESS;
    }

    /// Takes one step, shortened at the end of the segment, and repeats it until its error is accepted. Returns a
    /// negative flag on failure.
    int step() {
        const double remaining = end_ - t_;
        ++steps_;
        // A remainder of a few rounding errors is merged into the step; on its own it is too short for the library.
        if (remaining <= 4 * std::numeric_limits<double>::epsilon() * end_) return take_euler_step();
        if (h_ >= remaining * (1 - 1e-14)) h_ = remaining * (1 + 1e-14);
        step_start_ = t_;
        sample_t_.reset();
        const int flag = flag_of(advance(*driver_, t_, end_, h_, y_));
        // Skipped for multistep methods (initial order 1), whose history would restart each time.
        if (flag >= 0 && order_ > 1 && project_step(system_, y_.data())) {
            rejected_ += static_cast<long>(driver_->e->failed_steps);
            gsl_odeiv2_evolve_reset(driver_->e), gsl_odeiv2_step_reset(driver_->s);
        }
        return flag;
    }

    double time() const { return t_; }
    Motion sample() const { return system_.motion(t_, y_.data()); }

    /// The motion at a time within the last step, integrated separately from the start of that step.
    std::optional<Motion> sample_inside(double at) {
        constexpr int max_steps = 1000;
        if (!sample_t_) {
            // The library keeps the state at the start of the step.
            std::copy(driver_->e->y0, driver_->e->y0 + size(), sample_y_.begin());
            sample_t_ = step_start_, sample_h_ = at - step_start_;
            gsl_odeiv2_driver_reset(sample_driver_.get());
        }
        for (int i = 0; i < max_steps && *sample_t_ < at; ++i)
            if (flag_of(advance(*sample_driver_, *sample_t_, at, sample_h_, sample_y_)) < 0) return {};
        if (*sample_t_ < at) {
            status_ = GSL_EMAXITER;
            return {};
        }
        return system_.motion(at, sample_y_.data());
    }
    int inside_flag() const { return flag_of(status_); }

    /// Meaning of a negative flag.
    SolverFailure failure(int) const {
        if (main_context_.not_finite || sample_context_.not_finite)
            return {Status::diverged, fmt::format("the right-hand side is not finite at {} at any step size{}",
                                                  format_time(t_), last_state(sample()))};
        return {Status::tolerance_not_met,
                fmt::format(
                    "GSL: {} at t = {:g} s",
                    status_ == GSL_FAILURE ? "no step is small enough for the tolerance" : gsl_strerror(status_), t_)};
    }

    /// Counts since restart().
    long steps() const { return steps_; }
    long rhs_evaluations() const { return main_context_.evaluations; }
    long sample_evaluations() const { return sample_context_.evaluations; }
    SolverCounts counts() const { return {rejected_ + static_cast<long>(driver_->e->failed_steps), {}, {}}; }

  private:
    using State = Numbers<SystemType::dimension>;

    std::size_t size() const { return static_cast<std::size_t>(system_.size()); }

    /// Context that the library passes to the callbacks.
    struct Context {
        const GslSession* session;
        gsl_odeiv2_system system{};
        long evaluations = 0;
        bool not_finite = false;  ///< whether the last evaluation was not finite
        std::exception_ptr exception{};
    };
    struct FreeDriver {
        void operator()(gsl_odeiv2_driver* driver) const { gsl_odeiv2_driver_free(driver); }
    };
    using Driver = std::unique_ptr<gsl_odeiv2_driver, FreeDriver>;

    // Any status except GSL_EBADFUNC makes the library retry with half the step.
    static int right_hand_side(double t, const double* y, double* dy, void* context) {
        Context* self = static_cast<Context*>(context);
        ++self->evaluations;
        try {
            self->session->system_.derivative(t, y, dy);
        } catch (...) {  // exceptions must not cross the C library
            self->exception = std::current_exception();
            return GSL_EBADFUNC;
        }
        self->not_finite = !all_finite({dy, self->session->size()});
        return self->not_finite ? GSL_EDOM : GSL_SUCCESS;
    }
    // The right-hand side does not depend on time: between events every load of a scene file is constant.
    static int fill_jacobian(double t, const double* y, double* J, double* dfdt, void* context) {
        Context* self = static_cast<Context*>(context);
        const std::size_t n = self->session->size();
        jacobian(self->session->system_, t, y, J);
        std::fill(dfdt, dfdt + n, 0.0);
        self->not_finite = !all_finite({J, n * n});
        return self->not_finite ? GSL_EDOM : GSL_SUCCESS;
    }

    Driver make_driver(Context& context, const gsl_odeiv2_step_type* type) {
        context.session = this;
        context.system = {right_hand_side, fill_jacobian, size(), &context};
        Driver result(
            gsl_odeiv2_driver_alloc_scaled_new(&context.system, type, 1, tolerance_, tolerance_, 1, 0, scales_.data()));
        if (!result) throw std::bad_alloc();
        return result;
    }

    // The driver's own loop, one step at a time.
    int advance(gsl_odeiv2_driver& driver, double& t, double stop, double& h, State& y) {
        status_ = gsl_odeiv2_evolve_apply(driver.e, driver.c, driver.s, driver.sys, &t, stop, &h, y.data());
        for (Context* context : {&main_context_, &sample_context_})
            if (context->exception) std::rethrow_exception(std::exchange(context->exception, nullptr));
        return status_;
    }
    static int flag_of(int status) { return status == GSL_SUCCESS ? 0 : -1; }

    // One explicit Euler step is exact over a few rounding errors of time.
    int take_euler_step() {
        State rate(system_.size());
        system_.derivative(t_, y_.data(), rate.data());
        ++main_context_.evaluations;
        for (std::size_t i = 0; i < size(); ++i) y_[i] += (end_ - t_) * rate[i];
        t_ = end_;
        return GSL_SUCCESS;
    }

    double first_step() {
        State tolerated = scales_;
        for (std::size_t i = 0; i < size(); ++i) tolerated[i] = tolerance_ * (scales_[i] + std::abs(y_[i]));
        const auto rate = [&](double later, const State& y, State& dy) {
            system_.derivative(t_ + later, y.data(), dy.data());
            ++main_context_.evaluations;
        };
        const double h = polhode::first_step(rate, y_, tolerated, order_);
        return h > 0 && std::isfinite(h) ? h : 1e-6 * problem_->scene.duration;
    }

    const Problem* problem_;
    SystemType system_;
    int order_;
    double tolerance_;
    State scales_{system_.size()}, y_ = scales_, sample_y_ = scales_;
    double t_ = 0, step_start_ = 0, end_ = 0, h_ = 0, sample_h_ = 0;
    std::optional<double> sample_t_;
    long steps_ = 0, rejected_ = 0;
    int status_ = GSL_SUCCESS;
    Context main_context_{}, sample_context_{};
    Driver driver_, sample_driver_;
};

const GslScheme rk8pd{&gsl_odeiv2_step_rk8pd, &gsl_odeiv2_step_rk8pd, 8};
const GslScheme msadams{&gsl_odeiv2_step_msadams, &gsl_odeiv2_step_rk8pd, 1};
const GslScheme bsimp{&gsl_odeiv2_step_bsimp, &gsl_odeiv2_step_bsimp, 4};
const GslScheme msbdf{&gsl_odeiv2_step_msbdf, &gsl_odeiv2_step_bsimp, 1};

template <const GslScheme& scheme>
Trajectory solve_gsl(const Problem& problem, const Settings& settings) {
    if (!is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    return with_system(problem, [&]<class SystemType>() {
        GslSession<SystemType> session(problem, scheme, *settings.tolerance);
        return SolverRun(problem, settings, session).solve();
    });
}

constexpr std::string_view gsl_source =
    "Galassi, Davies, Theiler, Gough, Jungman, Alken, Booth & Rossi 2009, GNU Scientific Library Reference Manual, 3rd "
    "ed.";

constexpr Method gsl_variants[] = {
    {.name = "gsl_rk8pd",
     .documentation =
         "GSL's explicit Runge-Kutta pair of orders 8 and 9. Relative tolerance R, absolute tolerance R times the "
         "component's scale, by GSL's own step control (`control_scaled`). Steps stop exactly at events and at the end "
         "only. A sample inside a step is computed by separate steps from the start of the step; their right-hand "
         "sides are counted. Only in the build tree, with POLHODE_PEERS_GPL: GSL is under the GPL.",
     .source = "Prince & Dormand 1981, High order embedded Runge-Kutta formulae, J. Comput. Appl. Math. 7, 67-75; "
               "Galassi et al. 2009, GNU Scientific Library Reference Manual, 3rd ed.",
     .solve = solve_gsl<rk8pd>,
     .family = Family::runge_kutta},
    {.name = "gsl_msadams",
     .documentation =
         "GSL's Adams formulas of order 1 to 12 in Nordsieck form, the implicit equation solved by functional "
         "iteration; for non-stiff motion. Events restart the history. Samples inside a step are computed by steps of "
         "`gsl_rk8pd`. Tolerances as for `gsl_rk8pd`.",
     .source = gsl_source,
     .solve = solve_gsl<msadams>,
     .family = Family::multistep},
    {.name = "gsl_bsimp",
     .documentation =
         "GSL's semi-implicit extrapolation with the exact Jacobian, for stiff motion. Tolerances, events and samples "
         "as for `gsl_rk8pd`. User-defined torques are `unsupported`, because they have no Jacobian.",
     .source = "Bader & Deuflhard 1983, A semi-implicit mid-point rule for stiff systems of ordinary differential "
               "equations, Numer. Math. 41, 373-398; Galassi et al. 2009, GNU Scientific Library Reference Manual, "
               "3rd ed.",
     .solve = solve_gsl<bsimp>,
     .family = Family::extrapolation,
     .refusal = no_jacobian_of_user_torque},
    {.name = "gsl_msbdf",
     .documentation =
         "GSL's backward differentiation formulas of order 1 to 5 in Nordsieck form, the implicit equation solved by a "
         "modified Newton iteration with the exact Jacobian; for stiff motion. Events restart the history. Samples "
         "inside a step are computed by steps of `gsl_bsimp`. Tolerances as for `gsl_bsimp`.",
     .source = gsl_source,
     .solve = solve_gsl<msbdf>,
     .family = Family::multistep,
     .refusal = no_jacobian_of_user_torque},
};

constexpr auto gsl_family = apply_defaults(
    {.conserves = "nothing", .control = Control::tolerance, .general_systems = true, .library = gsl_library},
    gsl_variants);

}  // namespace

const std::span<const Method> gsl_methods{gsl_family};

std::string gsl_library_version() { return gsl_version; }

}  // namespace polhode
