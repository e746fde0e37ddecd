// The result of one case of a sweep: a row of the result table.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/plan/experiment.h"
#include "measure/contact_errors.h"
#include "measure/errors.h"
#include "motion/trajectory.h"
#include "table/table.h"

namespace polhode {

/// Attitude errors (rad) that rounding of the initial data alone causes; smaller errors of a method have no meaning.
/// Empty if the conditioning is not available.
struct Floors {
    std::optional<double> float64, float32;              ///< maximum over the samples
    std::optional<double> float64_final, float32_final;  ///< at T
};

struct Result {
    std::string scene, method;
    SettingKind setting_kind = SettingKind::none;
    double setting = 0;  ///< as requested; unused if the kind is `none`
    Status status = Status::ok;
    std::optional<double> seconds_min, seconds_median;
    long repeats = 0;
    std::optional<long> steps, rhs_evaluations;
    SolverCounts counts;
    Errors errors;
    ContactErrors contacts;  ///< scenes with planes only
    std::string message;
    std::string machine;               ///< processor name of the machine that measured the times
    std::optional<double> step_taken;  ///< s, of a fixed-step run
    bool cut = false;                  ///< stopped by a limit on time, steps or evaluations, or not run because of one
    Formulation formulation = Formulation::reduced;
    std::optional<double> evaluations_per_revolution;  ///< as requested, if the setting was calibrated
    std::optional<double> revolutions;                 ///< T over the mean time per revolution; kinds with series only
    Floors floors;                                     ///< round-off floors of the scene; equal in all its rows
    ErrorSeries series;                                ///< kinds with keeps_series only
};

/// Time per step, s; empty if the run is not `ok` or took no steps.
std::optional<double> step_seconds(const Result& result);

/// A column of the result table. It defines how tables and stored cases are written and read. The reader of result
/// directories, the report and the list of metrics use the same columns, so that a new column is one entry.
struct ResultColumn {
    std::string name;
    std::function<Cell(const Result&)> cell;
    /// Reads a cell into the result; empty if the column is computed from others. Throws std::invalid_argument.
    std::function<void(const std::string&, Result&)> read;
    std::string meaning = "";    ///< description with unit, for columns of measurements; else empty
    std::string page_name = "";  ///< name in the report's document; empty: not in the document
    int page_digits = 0;         ///< significant digits there; <= 0: added to the digits of the whole document
    bool is_error = false;
    bool optional = false;      ///< optional when a table is read, because older tables do not have it
    bool only_systems = false;  ///< only in tables of several bodies (or of scenes with planes, if only_planes is set)
    bool only_planes = false;   ///< only in tables of scenes with planes (or of several bodies, if only_systems is set)
    bool only_stored = false;   ///< only in the table of a stored case
};

/// The measures with standard columns, in order: attitude_error and so on in drift.csv. The columns of other measures
/// are at the end of a table.
inline constexpr std::array<std::string_view, 5> standard_measures{"attitude", "omega", "energy", "momentum", "norm"};

/// All columns in the order of tables, without the first column `experiment`.
const std::vector<ResultColumn>& result_column_table();
/// The index of a column in that table. Throws std::invalid_argument if there is no such column.
std::size_t result_column_index(std::string_view name);

/// Which columns a table has.
enum class TableKind {
    single_bodies,  ///< the columns for scenes of one body
    systems,        ///< additionally, at the end, the columns for scenes of several bodies
    planes,         ///< the columns for scenes of one body, and at the end those for scenes with planes
    all_scenes,     ///< the columns for all scenes
    stored,         ///< additionally the machine: the table of a stored case
};

/// The names of the columns: the standard columns, then step_taken, cut, formulation, evaluations_per_revolution,
/// revolutions, float64_floor, float32_floor, float64_floor_final, float32_floor_final, rejected_steps,
/// newton_failures, order_reductions and error_over_tolerance (largest attitude error in rad over the tolerance, for
/// runs by tolerance), then those of further tabled measures. Tables of several bodies also have position_error_max,
/// linear_momentum_error_max, joint_gap_max, joint_turn_max, reaction_error_max and worst_body, tables of scenes with
/// planes position_error_max, event_time_error_max, penetration_max, slip_error_max and contact_energy_gain.
std::vector<std::string> result_columns(TableKind which = TableKind::single_bodies);
std::vector<Cell> result_row(const std::string& experiment, const Result& result,
                             TableKind which = TableKind::single_bodies);

/// Reads a row written by result_row(). Columns after `revolutions` are optional. Throws std::invalid_argument if a
/// cell cannot be read.
Result parse_result(const Table& table, std::size_t row);

/// The table drift.csv: scene, method, setting, t, the standard errors, float64_floor, the other tabled errors,
/// experiment.
Table drift_table(const std::string& experiment, const std::vector<Result>& results);
/// The table drift_joints.csv of the results with several bodies: scene, method, setting, t, the errors that only
/// several bodies have, experiment.
Table joint_drift_table(const std::string& experiment, const std::vector<Result>& results);

/// The error series of one case, without its scene, method and setting.
Table series_table(const ErrorSeries& series);
/// Reads a table written by series_table(). Throws std::invalid_argument if a cell cannot be read, a time is missing
/// or a column has a gap.
ErrorSeries parse_series(const Table& table);

}  // namespace polhode
