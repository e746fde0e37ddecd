// Gragg, Bulirsch and Stoer's extrapolation of the explicit midpoint rule, with order and step size control.
//
// A step of K columns is always completed. Its columns are independent and run side by side, each in its own lane or
// packed into fewer, so stopping early would save nothing. The errors of orders 2K - 1 and 2K - 3 then give the best
// H for either order. The one with less work per unit of time is selected, or one order more (Deuflhard 1983; Hairer,
// Norsett & Wanner 1993, II.9).
//
// OrderControl selects order and step size. Three types compute the columns: RecordedColumns from a compiled
// recording, GeneralColumns for any right-hand side, RotationColumns for rotations in registers.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "integrators/contact/solve_contacts.h"
#include "integrators/own/compensated_state.h"
#include "integrators/own/extrapolation_control.h"
#include "integrators/own/lane_columns.h"
#include "integrators/own/midpoint_columns.h"
#include "integrators/own/record_system.h"
#include "integrators/run/controlled_steps.h"
#include "integrators/run/march_controlled.h"
#include "integrators/run/tolerance.h"
#include "motion/formula_model.h"

namespace polhode {
namespace {

/// Below this tolerance rounding dominates the error: the order is fixed and the columns use compensated sums.
constexpr double min_variable_order_tolerance = 3e-14;
/// The allowed error of a component is increased by this factor times its increment and the amplification, for the
/// rounding error that no step size avoids.
double rounding_allowance(double tolerance) { return tolerance < min_variable_order_tolerance ? 0x1p-56 : 0x1p-53; }

struct StepErrors {
    double squared, squared_before;  ///< see RotationStep
};

/// Order and step size of the next step.
///
/// The order changes only for a clear gain.
class OrderControl {
  public:
    OrderControl(double tolerance, const ExtrapolationTable& table, int most)
        : table_(&table),
          max_columns_(most),
          first_(tolerance < min_variable_order_tolerance ? compensated_row : initial_row(tolerance, most)) {
        restart();
    }
    void restart() {
        row_ = first_, rejected_ = false;
        reset();
    }
    int number() const { return row_; }
    const ExtrapolationRow& row() const { return (*table_)[row_]; }

    /// Returns the next H after a step H with the current row.
    double next(double H, const StepErrors& errors, bool accepted) {
        constexpr double gain_to_lower = 0.8, gain_to_raise = 0.7;
        const int K = row().columns;
        double same = H * factor(errors.squared, K), lower = H * factor(errors.squared_before, K - 1);
        if (!accepted) same = std::min(same, 0.9 * H), lower = std::min(lower, 0.9 * H);
        const double least = suggested_.least(same);
        lower *= least / same, same = least;
        if (row_ == compensated_row) return on_grid(same);
        if (K > min_columns && work(K - 1, lower) < gain_to_lower * work(K, same)) {
            row_ = K - 1, same = lower;
            reset();
        } else if (accepted && !rejected_ && K < max_columns_ && work(K, same) < gain_to_raise * work(K - 1, lower)) {
            // The step at which K + 1 columns would cost as much per unit of time.
            row_ = K + 1, same *= work(K + 1, 1) / work(K, 1);
            reset();
        }
        rejected_ = !accepted;
        return on_grid(same);
    }
    /// Returns the next H after a step whose result is not finite.
    double shrink_after_divergence(double H) {
        if (row_ != compensated_row) row_ = std::max(row_ - 2, min_columns);
        rejected_ = true;
        reset();
        return 0.1 * H;
    }
    double on_grid(double H) const { return step_on_grid(H, row().odd_multiple); }

  private:
    void reset() { suggested_.reset(); }
    double work(int K, double H) const { return (*table_)[K].work / H; }
    /// With careful columns the aim keeps even the worst error of T_KK along the motion below rounding.
    double factor(double squared_error, int K) const {
        return step_factor(row_ == compensated_row ? -7 : usual_log2_aim, squared_error, K);
    }

    const ExtrapolationTable* table_;
    int max_columns_, first_, row_ = first_;
    bool rejected_ = false;
    SuggestedSteps suggested_;
};

/// Extrapolates a step of K columns for any of the systems, from increments `column(j, i)` and their rounding errors.
template <class SystemType>
class ColumnsState : public GeneralState<SystemType> {
  public:
    ColumnsState(const Problem& problem, double tolerance)
        : GeneralState<SystemType>(problem, tolerance), rounding_(rounding_allowance(tolerance)) {}

  protected:
    template <class Column, class Lost>
    StepErrors extrapolated(const ExtrapolationRow& row, Column&& column, Lost&& lost) {
        const int last = row.columns - 1;
        StepErrors errors{0, 0};
        for (int i = 0; i < this->system_.size(); ++i) {
            const double finest = column(last, i), finest_lost = lost(last, i);
            double value = 0, error = 0, error_before = 0;
            for (int j = 0; j < last; ++j) {
                const double difference = (column(j, i) - finest) + (lost(j, i) - finest_lost);
                value += row.weights.value[j] * difference;
                error += row.weights.error[j] * difference;
                error_before += row.weights.error_before[j] * difference;
            }
            const double slack = rounding_ * row.amplification * finest;
            const double allowed = this->squared_scale_[i] + slack * slack;
            errors.squared += error * error / allowed;
            errors.squared_before += error_before * error_before / allowed;
            // y + z_K with its rounding error, then the rest.
            this->add(i, finest, value + finest_lost);
        }
        return errors;
    }

  private:
    double rounding_;
};

/// For any right-hand side that can be recorded: compiled, with the columns side by side.
template <class SystemType>
class RecordedColumns : public ColumnsState<SystemType> {
    using Base = ColumnsState<SystemType>;

  public:
    static constexpr const ExtrapolationTable& table = lane_rows;
    static constexpr int most = max_lane_columns;

    using Base::Base;
    void enter(const Segment& segment) {
        Base::enter(segment);
        columns_.emplace(record_system<double>(this->system_));
    }
    StepErrors attempt(double, double H, int number) {
        const ExtrapolationRow& row = table[number];
        columns_->step(this->y_.data(), H, row, number == compensated_row);
        return this->extrapolated(
            row, [&](int j, int i) { return columns_->increment(j, i); },
            [&](int j, int i) { return columns_->lost(j, i); });
    }

  private:
    std::optional<LaneColumns> columns_;
};

/// For any right-hand side, one column after another.
template <class SystemType>
class GeneralColumns : public ColumnsState<SystemType> {
    using Y = typename ColumnsState<SystemType>::Y;

  public:
    static constexpr const ExtrapolationTable& table = extrapolation_rows;
    static constexpr int most = max_columns;

    using ColumnsState<SystemType>::ColumnsState;
    StepErrors attempt(double t, double H, int number) {
        const ExtrapolationRow& row = table[number];
        const int N = this->system_.size();
        Y f(N);
        this->system_.derivative(t, this->y_.data(), f.data());
        std::array<Y, max_columns> column = copies_of<max_columns>(Y(N)), lost_column = column;
        for (int j = 0; j < row.columns; ++j)
            midpoint(t, f, H / row.substeps[j], row.substeps[j], number == compensated_row, column[j], lost_column[j]);
        return this->extrapolated(
            row, [&](int j, int i) { return column[j][i]; }, [&](int j, int i) { return lost_column[j][i]; });
    }

  private:
    /// Computes z_n of z_(m+1) = z_(m-1) + 2h f(t + m h, y + z_m), z_0 = 0, z_1 = h f(t, y). `careful`: also its
    /// rounding error.
    void midpoint(double t, const Y& f, double h, int n, bool careful, Y& now, Y& lost) const {
        const int N = this->system_.size();
        Y before(N), lost_before(N), y(N), rate(N);
        std::fill(lost.begin(), lost.end(), 0);
        for (int i = 0; i < N; ++i) now[i] = h * f[i];
        for (int m = 1; m < n; ++m) {
            for (int i = 0; i < N; ++i) y[i] = this->y_[i] + (now[i] + lost[i]);
            this->system_.derivative(t + m * h, y.data(), rate.data());
            for (int i = 0; i < N; ++i) {
                const double change = 2 * h * rate[i] + lost_before[i], next = before[i] + change;
                lost_before[i] = lost[i], lost[i] = careful ? rounded_away(before[i], change, next) : 0;
                before[i] = now[i], now[i] = next;
            }
        }
    }
};

/// For rotations in registers, with the columns side by side.
template <class SystemType>
class RotationColumns : public RotationLanes<SystemType> {
    using Base = RotationLanes<SystemType>;

  public:
    static constexpr const ExtrapolationTable& table = extrapolation_rows;
    static constexpr int most = max_columns;

    RotationColumns(const Problem& problem, double tolerance)
        : Base(problem, tolerance, rounding_allowance(tolerance)), step_(midpoint_step(instruction_set())) {}

    StepErrors attempt(double, double H, int row) {
        step_(this->coefficients_, this->allowance_, this->state_, H, row, this->next_);
        return {this->next_.squared_error, this->next_.squared_error_before};
    }

  private:
    MidpointStep* step_;
};

template <class Columns>
class ControlledExtrapolation {
  public:
    ControlledExtrapolation(const Problem& problem, double tolerance)
        : duration_(problem.scene.duration),
          columns_(problem, tolerance),
          control_(tolerance, Columns::table, Columns::most) {}

    void restart() {
        columns_.restart();
        control_.restart();
        evaluations_ = 0;
    }
    void enter(const Segment& segment) { columns_.enter(segment); }
    double first_step(double t) {
        control_.restart();
        evaluations_ += 2;
        return control_.on_grid(columns_.first_step(t, duration_));
    }
    Attempt attempt(double& t, double& h) {
        const StepErrors errors = columns_.attempt(t, h, control_.number());
        evaluations_ += control_.row().evaluations;
        if (!std::isfinite(errors.squared) || !std::isfinite(errors.squared_before)) {
            h = control_.shrink_after_divergence(h);
            return Attempt::not_finite;
        }
        const bool accepted = errors.squared <= 1;
        const double tried = h;
        h = control_.next(h, errors, accepted);
        if (!accepted) return Attempt::rejected;
        columns_.accept();
        t += tried;
        return Attempt::accepted;
    }
    std::vector<double> switch_values() const requires SwitchingState<Columns> { return columns_.switch_values(); }
    std::string cross_switch(std::size_t which) requires SwitchingState<Columns> {
        return columns_.cross_switch(which);
    }
    const double* state() const { return columns_.state(); }
    auto sample(double t) const { return columns_.sample(t); }
    long rhs_evaluations() const { return evaluations_; }

  private:
    double duration_;
    Columns columns_;
    OrderControl control_;
    long evaluations_ = 0;
};

std::unique_ptr<SystemSteps> extrapolation_steps(const Problem& problem, double tolerance) {
    using Stepper = ControlledExtrapolation<GeneralColumns<ErasedSystem>>;
    return std::make_unique<ControlledSteps<Stepper>>(problem, Stepper(problem, tolerance));
}

Trajectory solve_extrapolation(const Problem& problem, const Settings& settings) {
    const double tolerance = *settings.tolerance;
    if (!is_reachable(tolerance)) return unreachable_tolerance(tolerance);
    if (contact::has_events(problem.scene)) return contact::solve_events(problem, settings, extrapolation_steps);
    if (has_formula_loads(problem.scene)) {
        // recorded equations do not switch
        if (has_switches(problem))
            return march_controlled(problem, settings,
                                    ControlledExtrapolation<GeneralColumns<SwitchedSystem>>(problem, tolerance));
        return march_controlled(problem, settings,
                                ControlledExtrapolation<RecordedColumns<FormulaSystem>>(problem, tolerance));
    }
    return with_system(problem, [&]<class SystemType>() {
        if constexpr (is_rotation<SystemType>)
            if (RotationLanes<SystemType>::supports(problem, RotationTerms::axial_field))
                return march_controlled(problem, settings,
                                        ControlledExtrapolation<RotationColumns<SystemType>>(problem, tolerance));
        if (!problem.needs.user_torque)
            return march_controlled(problem, settings,
                                    ControlledExtrapolation<RecordedColumns<SystemType>>(problem, tolerance));
        return march_controlled(problem, settings,
                                ControlledExtrapolation<GeneralColumns<SystemType>>(problem, tolerance));
    });
}

constexpr Method extrapolation_variants[] = {
    {.name = "extrapolation",
     .documentation =
         "Extrapolation of the explicit midpoint rule, order 4 to 18 and step size by the tolerance, on increments "
         "with compensated summation; any right-hand side. The columns run side by side in vector registers, with the "
         "same bits on every instruction set. Free rotations and Lagrange's top have dedicated code; all other "
         "right-hand sides except user-defined torques are compiled to machine code for the scene. The error of each "
         "component per step is limited to R times its scale, or to its rounding error if that is larger. Events of "
         "contacts and joints are located on a collocation polynomial of each step.",
     .source = "Gragg 1965, SIAM J. Numer. Anal. 2, 384; Bulirsch & Stoer 1966, Numer. Math. 8, 1; Deuflhard 1983, "
               "Numer. Math. 41, 399; Hairer, Norsett & Wanner 1993, II.9",
     .conserves = "nothing",
     .control = Control::tolerance,
     .general_systems = true,
     .order = 0,
     .solve = solve_extrapolation,
     .steps = extrapolation_steps,
     .refusal = contact::event_refusal},
};

constexpr auto extrapolation_list = apply_defaults({.family = Family::extrapolation}, extrapolation_variants);

}  // namespace

extern const std::span<const Method> extrapolation_methods{extrapolation_list};

}  // namespace polhode
