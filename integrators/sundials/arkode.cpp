// ARKODE's Runge-Kutta methods, explicit and diagonally implicit.
#include <algorithm>
#include <vector>

#include "integrators/run/amplification.h"
#include "integrators/run/march.h"
#include "integrators/run/refusals.h"
#include "integrators/run/stiffness.h"
#include "integrators/sundials/arkode_session.h"
#include "integrators/sundials/sundials_run.h"

namespace polhode {
namespace {

/// Fixed steps as a Stepper. A step fails if its implicit equations cannot be solved.
template <class SystemType>
class ArkodeFixedStepper {
  public:
    ArkodeFixedStepper(const Problem& problem, const ArkodeTable& table) : session_(problem, table, std::nullopt) {}
    void restart() { session_.restart(); }
    void enter(const Segment& segment) { record_flag(session_.enter(segment)); }
    void step(double t, double h) {
        if (!failed()) record_flag(session_.fixed_step(t, h));
    }
    // at the caller's time: ARKODE's sum of steps may round differently
    auto sample(double t) const { return session_.sample_at(t); }
    bool finite() const { return all_finite(std::span<const double>(session_.y(), session_.size())); }
    long rhs_evaluations() const { return session_.rhs_evaluations(); }
    bool failed() const { return flag_ < 0; }
    void explain(Trajectory& trajectory) {
        SolverFailure failure = session_.failure(flag_);
        trajectory.status = failure.status, trajectory.message = std::move(failure.message);
    }

  private:
    void record_flag(int flag) { flag_ = std::min(flag_, flag); }

    // mutable: ARKODE's query functions take non-const pointers
    mutable ArkodeSession<SystemType> session_;
    int flag_ = ARK_SUCCESS;
};

template <bool implicit, int order>
Trajectory solve_arkode(const Problem& problem, const Settings& settings) {
    const ArkodeTable table{implicit, order};
    return with_system(problem, [&]<class SystemType>() {
        if (settings.step) {
            Trajectory trajectory = march<ArkodeFixedStepper<SystemType>>(problem, settings, table);
            append_unoptimised_remark(trajectory);
            return trajectory;
        }
        ArkodeSession<SystemType> session(problem, table, settings.tolerance);
        return run_sundials(problem, settings, session);
    });
}

Trajectory solve_arkode_by_stiffness(const Problem& problem, const Settings& settings) {
    const bool stiff = is_stiff(problem);
    Trajectory trajectory =
        stiff ? solve_arkode<true, 5>(problem, settings) : solve_arkode<false, 8>(problem, settings);
    return prepend_remark(std::move(trajectory), stiff ? "diagonally implicit, order 5: the motion is stiff"
                                                       : "explicit, order 8: the motion is not stiff");
}

/// A Butcher table of ARKODE, stored contiguously.
struct ButcherTable {
    std::vector<double> A, b;

    explicit ButcherTable(ARKodeButcherTable table) {
        if (!table) throw std::bad_alloc();
        for (int i = 0; i < table->stages; ++i) {
            A.insert(A.end(), table->A[i], table->A[i] + table->stages);
            b.push_back(table->b[i]);
        }
        ARKodeButcherTable_Free(table);
    }
};

template <bool implicit, int order>
double arkode_growth(std::complex<double> z) {
    static const ButcherTable table = [] {
        if constexpr (implicit) {
            constexpr int table_ids[] = {ARKSTEP_DEFAULT_DIRK_3, ARKSTEP_DEFAULT_DIRK_4, ARKSTEP_DEFAULT_DIRK_5};
            return ButcherTable(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(table_ids[order - 3])));
        } else {
            constexpr int table_ids[] = {ARKSTEP_DEFAULT_ERK_2, ARKSTEP_DEFAULT_ERK_3, ARKSTEP_DEFAULT_ERK_4,
                                         ARKSTEP_DEFAULT_ERK_5, ARKSTEP_DEFAULT_ERK_6, ARKSTEP_DEFAULT_ERK_8,
                                         ARKSTEP_DEFAULT_ERK_8};
            return ButcherTable(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(table_ids[order - 2])));
        }
    }();
    return runge_kutta_amplification(table.A, table.b, z);
}

constexpr std::string_view arkode_source =
    "Reynolds, Gardner, Woodward & Chinomona 2023, ARKODE: A flexible IVP solver infrastructure for one-step methods, "
    "ACM Trans. Math. Softw. 49, 19; SUNDIALS 6.4";

#define POLHODE_EXPLICIT_COMMON                                                                                        \
    " The library's default table of this order. Each step evaluates all its stages, because ARKStep does not reuse "  \
    "the last one. With a fixed step, or with a tolerance: relative R, absolute R times the component's scale, root "  \
    "mean square over the components, ARKODE's own step control. Steps stop exactly at every event. Samples inside a " \
    "step are computed with the same table from its start, so the steps do not depend on the sampling."
#define POLHODE_IMPLICIT_COMMON                                                                                        \
    " The library's default table of this order. The stages are solved by a modified Newton iteration with the exact " \
    "Jacobian and a dense LU factorisation; with a fixed step to round-off, with a new Jacobian each step. "           \
    "Tolerance, events and samples as for `arkode_erk4`. User-defined torques are `unsupported`, because they have "   \
    "no Jacobian."

template <bool implicit, int order>
constexpr Method arkode_method(std::string_view name, std::string_view documentation) {
    return {.name = name,
            .documentation = documentation,
            .source = arkode_source,
            .conserves = "nothing",
            .control = Control::fixed_step_or_tolerance,
            .general_systems = true,
            .order = order,
            .solve = solve_arkode<implicit, order>,
            .amplification = arkode_growth<implicit, order>,
            .refusal = implicit ? no_jacobian_of_user_torque : nullptr};
}

constexpr Method arkode_variants[] = {
    arkode_method<false, 2>(
        "arkode_erk2",
        "ARKODE's explicit Runge-Kutta method of order 2 (Heun-Euler, 2 stages, pair 2(1))." POLHODE_EXPLICIT_COMMON),
    arkode_method<false, 3>("arkode_erk3",
                            "ARKODE's explicit Runge-Kutta method of order 3 (Bogacki-Shampine, 4 stages, pair "
                            "3(2))." POLHODE_EXPLICIT_COMMON),
    arkode_method<false, 4>(
        "arkode_erk4",
        "ARKODE's explicit Runge-Kutta method of order 4 (Zonneveld, 5 stages, pair 4(3))." POLHODE_EXPLICIT_COMMON),
    arkode_method<false, 5>(
        "arkode_erk5",
        "ARKODE's explicit Runge-Kutta method of order 5 (Cash-Karp, 6 stages, pair 5(4))." POLHODE_EXPLICIT_COMMON),
    arkode_method<false, 6>(
        "arkode_erk6",
        "ARKODE's explicit Runge-Kutta method of order 6 (Verner, 8 stages, pair 6(5))." POLHODE_EXPLICIT_COMMON),
    arkode_method<false, 8>(
        "arkode_erk8",
        "ARKODE's explicit Runge-Kutta method of order 8 (Fehlberg, 13 stages, pair 8(7))." POLHODE_EXPLICIT_COMMON),
    arkode_method<true, 3>(
        "arkode_dirk3",
        "ARKODE's diagonally implicit Runge-Kutta method of order 3 (Kennedy & Carpenter's ARK3(2)4L[2]SA, "
        "ESDIRK, 4 stages, L-stable)." POLHODE_IMPLICIT_COMMON),
    arkode_method<true, 4>(
        "arkode_dirk4",
        "ARKODE's diagonally implicit Runge-Kutta method of order 4 (Hairer & Wanner's SDIRK 5(4), 5 stages, "
        "L-stable)." POLHODE_IMPLICIT_COMMON),
    arkode_method<true, 5>(
        "arkode_dirk5",
        "ARKODE's diagonally implicit Runge-Kutta method of order 5 (Kennedy & Carpenter's ARK5(4)8L[2]SA, "
        "ESDIRK, 8 stages, L-stable)." POLHODE_IMPLICIT_COMMON),
    {.name = "arkode",
     .documentation =
         "`arkode_dirk5` if the motion is stiff, otherwise `arkode_erk8`, with a tolerance; the message says which. "
         "Stiff means that the motion damps far faster than the body rotates. This is determined along a motion that "
         "`radau` computes to three digits; its time is not included in the reported time. With a user-defined torque "
         "it is always `arkode_erk8`.",
     .source = arkode_source,
     .conserves = "nothing",
     .control = Control::tolerance,
     .solve = solve_arkode_by_stiffness},
};

constexpr auto arkode_family =
    apply_defaults({.family = Family::runge_kutta, .library = sundials_library}, arkode_variants);

}  // namespace

extern const std::span<const Method> arkode_methods{arkode_family};

}  // namespace polhode
