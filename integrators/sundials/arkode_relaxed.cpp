// Relaxation Runge-Kutta methods: each step is scaled along its own direction so that the energy is conserved.
//
// Tableau holds one of ARKODE's explicit pairs. RelaxedStepper runs it with a fixed step (march()) or with step control
// (march_controlled()); relaxation() solves the quadratic equation for the scaling factor gamma. References: D. I.
// Ketcheson 2019, SIAM J. Numer. Anal. 57, 2850; Ranocha et al. 2020, SIAM J. Sci. Comput. 42, A612.
#include <arkode/arkode_arkstep.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "integrators/odeint/odeint.h"
#include "integrators/run/march_controlled.h"
#include "motion/conserved.h"

namespace polhode {
namespace {

/// One of ARKODE's explicit pairs, stored contiguously. `difference` = b - d, for the error estimate.
struct Tableau {
    static constexpr int max_stages = 13;
    int stages = 0, order = 0, embedded_order = 0;
    std::array<std::array<double, max_stages>, max_stages> a{};
    std::array<double, max_stages> b{}, c{}, difference{};

    explicit Tableau(ARKODE_ERKTableID id) {
        const std::unique_ptr<ARKodeButcherTableMem, decltype(&ARKodeButcherTable_Free)> table(
            ARKodeButcherTable_LoadERK(id), &ARKodeButcherTable_Free);
        if (!table) throw std::bad_alloc();
        stages = table->stages, order = table->q, embedded_order = table->p;
        for (int i = 0; i < stages; ++i) {
            for (int j = 0; j < i; ++j) a[i][j] = table->A[i][j];
            b[i] = table->b[i], c[i] = table->c[i], difference[i] = table->b[i] - table->d[i];
        }
    }
};

/// Ketcheson (2019): step from y to y + gamma d, d = h sum of b_i k_i, with gamma such that the energy equals the
/// initial one, and advance time by gamma h. gamma = 1 + O(h^(p-1)), so the order p is preserved.
///
/// The energy is a quadratic polynomial of the state, so gamma is the root of a quadratic equation. The caller's clock
/// advances by h; the stepper's clock is ahead of it by a lag of O(h^p), which the next step removes by aiming at the
/// caller's next time. At a sample or an event, a plain step of length -lag returns to the caller's time; its energy
/// error of O(h^(p (p + 1))) is far below round-off.
template <class SystemType>
class RelaxedStepper : public ControlledOdeintState<SystemType> {
    using Base = ControlledOdeintState<SystemType>;
    static constexpr int N = SystemType::dimension;
    using Y = OdeintArray<Base::N>;

  public:
    RelaxedStepper(const Problem& problem, const Tableau& table, double tolerance = 1)
        : Base(problem, tolerance, table.order), table_(&table) {
        restart();
    }
    void restart() {
        Base::restart();
        lag_ = 0;
        started_ = false;
        sample_evaluations_ = 0;
    }
    void enter(const Segment& segment) {
        remove_lag(this->y_, this->evaluations_);
        lag_ = 0;
        Base::enter(segment);
        if (started_) return;
        energy_ = this->system_.energy(this->y_.data());
        // where the terms of the energy cancel, the round-off is that of the terms
        round_off_ = 16 * std::numeric_limits<double>::epsilon() * (std::abs(energy_) + kinetic_scale());
        started_ = true;
    }
    void step(double t, double h) {
        Y d, difference;
        if (!evaluate_stages(this->y_, t + lag_, h - lag_, d, difference, this->evaluations_))
            return invalidate_state();
        advance(d, h - lag_, t + h);
    }
    Attempt attempt(double& t, double& h) {
        const double tried = h;
        Y d, difference;
        const double length = tried - lag_;
        if (!evaluate_stages(this->y_, t + lag_, length, d, difference, this->evaluations_)) {
            h = not_finite_shrinkage * tried;
            return Attempt::not_finite;
        }
        double sum = 0;
        for (int i = 0; i < N; ++i) {
            const double size = this->tolerance_ * (this->scales_[i] + std::abs(this->y_[i]));
            sum += difference[i] / size * (difference[i] / size);
        }
        const double error = std::sqrt(sum / N);
        // Hairer, Norsett & Wanner (1993), II.4
        const double factor = 0.9 * std::pow(error, -1.0 / (table_->embedded_order + 1));
        h = tried * std::min(5.0, std::max(0.2, factor));
        if (!(error <= 1)) return Attempt::rejected;
        t += tried;
        advance(d, length, t);
        return Attempt::accepted;
    }
    Sample sample(double t) const {
        Y synchronised = this->y_;
        remove_lag(synchronised, sample_evaluations_);
        return this->system_.motion(t, synchronised.data());
    }
    long sample_evaluations() const { return sample_evaluations_; }

  private:
    double kinetic_scale() const {
        const Vector3<double>& I = this->problem_->body.principal.moments;
        const double w = this->problem_->scales.angular_velocity;
        return std::max({I[0], I[1], I[2]}) * w * w / 2;
    }
    void invalidate_state() { this->y_[0] = std::numeric_limits<double>::quiet_NaN(); }

    // d = h sum b_i k_i and the embedded error estimate, from `y` at t; returns false if a rate is not finite
    bool evaluate_stages(const Y& y, double t, double h, Y& d, Y& difference, long& evaluations) const {
        const Tableau& table = *table_;
        std::array<Y, Tableau::max_stages> k;
        for (int i = 0; i < table.stages; ++i) {
            Y stage = y;
            for (int j = 0; j < i; ++j)
                for (int n = 0; n < N; ++n) stage[n] += h * table.a[i][j] * k[j][n];
            ++evaluations;
            this->system_.derivative(t + table.c[i] * h, stage.data(), k[i].data());
        }
        for (int n = 0; n < N; ++n) {
            d[n] = difference[n] = 0;
            for (int i = 0; i < table.stages; ++i)
                d[n] += h * table.b[i] * k[i][n], difference[n] += h * table.difference[i] * k[i][n];
        }
        return all_finite(d);
    }

    // y <- y + gamma d after a step of this length; `clock` is the caller's new time
    void advance(const Y& d, double length, double clock) {
        for (int n = 0; n < N; ++n) this->y_[n] += d[n];
        const double delta = relaxation(d);
        for (int n = 0; n < N; ++n) this->y_[n] += delta * d[n];
        lag_ = delta * length, clock_ = clock;
    }

    // gamma - 1, relative to the end of the plain step: E(y + delta d) = E(y) + delta s + delta^2 a
    double relaxation(const Y& d) const {
        const double residual = this->system_.energy(this->y_.data()) - energy_;
        if (!(std::abs(residual) > round_off_)) return 0;
        Y ahead = this->y_, behind = this->y_;
        for (int n = 0; n < N; ++n) ahead[n] += d[n], behind[n] -= d[n];
        const double here = residual + energy_;
        const double up = this->system_.energy(ahead.data()) - here;
        const double down = this->system_.energy(behind.data()) - here;
        const double s = (up - down) / 2, a = (up + down) / 2;
        const double discriminant = s * s - 4 * a * residual;
        if (!(discriminant >= 0)) return 0;
        const double delta = -2 * residual / (s + std::copysign(std::sqrt(discriminant), s));
        // if the energy hardly changes along d, as in steady rotation, no such point is near
        return std::abs(delta) < 0.5 ? delta : 0;
    }

    void remove_lag(Y& y, long& evaluations) const {
        if (lag_ == 0) return;
        Y d, difference;
        evaluate_stages(y, clock_ + lag_, -lag_, d, difference, evaluations);
        for (int n = 0; n < N; ++n) y[n] += d[n];
    }

    const Tableau* table_;
    bool started_ = false;
    mutable long sample_evaluations_ = 0;  // of steps over the lag that only samples require
    double energy_ = 0, round_off_ = 0;
    double lag_ = 0;    // s, stepper's clock minus caller's clock
    double clock_ = 0;  // s, caller's clock after the last step
};

std::string relaxation_refusal(const Problem& problem) {
    const std::vector<Conserved> invariants =
        conserved(problem.formulation == Formulation::full ? pose(problem.scene) : problem);
    const auto is_energy = [](const Conserved& c) { return c.kind == ConservedKind::energy; };
    return std::any_of(invariants.begin(), invariants.end(), is_energy) ? "" : "the motion does not conserve energy";
}

template <ARKODE_ERKTableID id>
Trajectory solve_relaxed(const Problem& problem, const Settings& settings) {
    if (settings.tolerance && !is_reachable(*settings.tolerance)) return unreachable_tolerance(*settings.tolerance);
    const Tableau table(id);
    return with_one_body(problem, [&]<class SystemType>() {
        if (!settings.tolerance) return march<RelaxedStepper<SystemType>>(problem, settings, table);
        return march_controlled(problem, settings, RelaxedStepper<SystemType>(problem, table, *settings.tolerance));
    });
}

constexpr std::string_view relaxation_source =
    "Ketcheson 2019, Relaxation Runge-Kutta methods: conservation and stability for inner-product norms, SIAM J. "
    "Numer. Anal. 57, 2850; Ranocha, Sayyari, Dalcin, Parsani & Ketcheson 2020, SIAM J. Sci. Comput. 42, A612";
constexpr std::string_view relaxation_invariants = "E (with q not normalised), if the motion conserves it";

constexpr Method relaxed_variants[] = {
    {.name = "arkode_erk4_relaxed",
     .documentation =
         "The table of `arkode_erk4` (Zonneveld's of order 4) with relaxation: each step is y + gamma h sum b_i k_i, "
         "with the gamma near 1 that restores the initial energy, and time advances by gamma h. The energy is "
         "quadratic in the state, so gamma is the root of a quadratic equation. The next step makes up the time lag of "
         "O(h^4); samples and events are reached by a plain step over the lag. |q| and L are not conserved. Under "
         "forces, E in result tables, which is computed with normalised q, has an error due to the drift of |q|. Step "
         "control, with a tolerance: root mean square over the components, each relative to R (scale + |y|). "
         "`unsupported` if the motion does not conserve its energy. (SUNDIALS has relaxation from 6.6 on; this "
         "implementation uses only its tables.)",
     .order = 4,
     .solve = solve_relaxed<ARKODE_ZONNEVELD_5_3_4>},
    {.name = "arkode_erk8_relaxed",
     .documentation = "The table of `arkode_erk8` (Fehlberg's of order 8) with relaxation as in `arkode_erk4_relaxed`.",
     .order = 8,
     .solve = solve_relaxed<ARKODE_FEHLBERG_13_7_8>},
};

constexpr auto relaxed_family = apply_defaults({.source = relaxation_source,
                                                .conserves = relaxation_invariants,
                                                .control = Control::fixed_step_or_tolerance,
                                                .family = Family::runge_kutta,
                                                .library = sundials_library,
                                                .refusal = relaxation_refusal},
                                               relaxed_variants);

}  // namespace

extern const std::span<const Method> arkode_relaxed_methods{relaxed_family};

}  // namespace polhode
