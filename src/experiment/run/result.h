// What one case of a sweep gives: a row of the result table.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/plan/experiment.h"
#include "measure/errors.h"
#include "motion/trajectory.h"
#include "table/table.h"

namespace polhode {

/// Attitude errors (rad) that rounding of the initial data alone causes: no method is to be judged below them. Empty
/// where the conditioning is not known.
struct Floors {
    std::optional<double> float64, float32;              ///< the worst over the samples
    std::optional<double> float64_final, float32_final;  ///< at T
};

struct Result {
    std::string scene, method;
    SettingKind setting_kind = SettingKind::none;
    double setting = 0;  ///< as asked for; without meaning where the kind is `none`
    Status status = Status::ok;
    std::optional<double> seconds_min, seconds_median;
    long repeats = 0;
    std::optional<long> steps, rhs_evaluations;
    SolverCounts counts;
    Errors errors;
    std::string message;
    std::string machine;               ///< whose times these are: its processor's name
    std::optional<double> step_taken;  ///< s, of a fixed-step run
    bool cut = false;                  ///< not reached, or stopped, by the limit on a run's time, steps or evaluations
    Formulation formulation = Formulation::reduced;
    std::optional<double> evaluations_per_revolution;  ///< as asked for, where the setting was found from it
    std::optional<double> revolutions;                 ///< T over the mean time of a revolution; of a long run
    Floors floors;                                     ///< of the scene, the same in all its rows
    ErrorSeries series;                                ///< only of a `drift` or `conservation` experiment
};

/// The time of one step, s; empty of a run that did not end well or took none.
std::optional<double> step_seconds(const Result& result);

/// A column of the result table. Tables and stored cases are written and read by it. The reader of folders, the
/// report's document and the list of metrics take their columns from it, so that a new column is one entry.
struct ResultColumn {
    std::string name;
    std::function<Cell(const Result&)> cell;
    /// Reads a cell into the result; empty where the column follows from others. Throws std::invalid_argument.
    std::function<void(const std::string&, Result&)> read;
    std::string meaning = "";    ///< with the unit, of a column that measures something; else empty
    std::string page_name = "";  ///< in the report's document; empty: not in it
    int page_digits = 0;         ///< significant digits there; <= 0: added to the digits of the whole document
    bool is_error = false;
    bool later = false;        ///< tables that were written before it existed are read too
    bool of_systems = false;   ///< only in tables of several bodies
    bool only_stored = false;  ///< only in the table of a stored case
};

/// All columns in the order of tables, without the experiment's name, which comes first.
const std::vector<ResultColumn>& result_column_table();
/// The index of a column of that table by its name. Throws std::invalid_argument where there is none.
std::size_t result_column_index(std::string_view name);

/// Which runs a table is of.
enum class TableOf {
    single_bodies,  ///< none of several bodies
    systems,        ///< some of several bodies: their columns stand at its end
    stored,         ///< what is kept of a case: those, and its machine
};

/// The standard columns, then step_taken, cut, formulation, evaluations_per_revolution, revolutions, float64_floor,
/// float32_floor, float64_floor_final and float32_floor_final, then rejected_steps, newton_failures, order_reductions,
/// and error_over_tolerance: the largest attitude error (rad) over the tolerance, of a run by tolerance; then those of
/// further tabled measures. Of several bodies further: position_error_max, linear_momentum_error_max, joint_gap_max,
/// joint_turn_max, reaction_error_max and worst_body.
std::vector<std::string> result_columns(TableOf which = TableOf::single_bodies);
std::vector<Cell> row_of(const std::string& experiment, const Result& result, TableOf which = TableOf::single_bodies);

/// The result that row_of() wrote, or one written before there was a column behind `revolutions`. Throws
/// std::invalid_argument where a cell cannot be read.
Result result_of(const Table& table, std::size_t row);

/// drift.csv: scene, method, setting, t, the standard errors, float64_floor and the other tabled errors, then the
/// experiment.
Table drift_table(const std::string& experiment, const std::vector<Result>& results);
/// drift_joints.csv: scene, method, setting, t, the errors that several bodies alone have, then the experiment; of the
/// results of several bodies.
Table joint_drift_table(const std::string& experiment, const std::vector<Result>& results);

/// The series of one case, without its scene, method and setting; and back.
Table series_table(const ErrorSeries& series);
/// Throws std::invalid_argument where a cell cannot be read, a time is missing or a column has a gap.
ErrorSeries series_of(const Table& table);

}  // namespace polhode
