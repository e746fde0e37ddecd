// Reads a result directory: rows of sweeps, errors over time, all other tables, and the provenance of each.
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/result.h"
#include "motion/trajectory.h"
#include "table/table.h"

namespace polhode {

/// Names in the order of their first occurrence, with indices.
class NameList {
  public:
    /// Index of the name; appends the name if it is new.
    int place(const std::string& name);
    /// Index of the name, or -1.
    int find(const std::string& name) const;
    /// All names.
    const std::vector<std::string>& names() const { return names_; }
    /// The name with this index.
    const std::string& operator[](int place) const { return names_[static_cast<std::size_t>(place)]; }

  private:
    std::vector<std::string> names_;
    std::map<std::string, int, std::less<>> places_;
};

/// An undefined number.
inline constexpr double absent = std::numeric_limits<double>::quiet_NaN();

/// A row of a result table. Names are indices into the directory's lists.
struct FolderRow {
    int experiment = 0, scene = 0, method = 0, message = 0, formulation = 0;
    SettingKind kind = SettingKind::none;
    Status status = Status::ok;
    bool cut = false;  ///< ended by a limit on time, steps or evaluations
    /// Numbers of the columns of result_column_table(); NaN if undefined.
    std::vector<double> numbers = std::vector<double>(result_column_table().size(), absent);

    /// Number of the named column: row["attitude_error_max"].
    double& operator[](std::string_view column) { return numbers[result_column_index(column)]; }
    /// Number of the named column.
    double operator[](std::string_view column) const { return numbers[result_column_index(column)]; }
    /// Largest attitude error over the samples, rad.
    double attitude() const { return (*this)["attitude_error_max"]; }
    /// Median run time of the repeats, s.
    double seconds() const { return (*this)["seconds_median"]; }
    /// Rounding floor of binary64, rad.
    double floor() const { return (*this)["float64_floor"]; }
    /// Experiment, scene, method, kind of setting and formulation.
    using Curve = std::array<int, 5>;
    /// The curve to which the row belongs.
    Curve curve() const { return {experiment, scene, method, static_cast<int>(kind), formulation}; }
    /// Whether the run succeeded within this attitude error (rad) and was timed.
    bool is_within(double error) const { return status == Status::ok && attitude() <= error && seconds() > 0; }
};

/// The errors over time of one run.
struct FolderSeries {
    int experiment = 0, scene = 0, method = 0;
    double setting = absent;
    std::vector<double> t;                                             ///< s
    std::array<std::vector<double>, standard_measures.size()> errors;  ///< by index in standard_measures
};

/// Any other table.
struct FolderTable {
    std::string name;        ///< file name without .csv
    std::string experiment;  ///< experiment that wrote it; empty if unknown
    std::string title;       ///< empty if unknown
    Table table;             ///< all cells are text
    std::size_t total = 0;   ///< rows in the file; more than in `table` if the table was truncated
};

/// An experiment with rows or tables in the directory.
struct FolderExperiment {
    std::string name, about, kind, date;
    bool quick = false;
    std::vector<std::pair<std::string, std::string>> facts;  ///< CPU, compiler, commit, ..: name and value
};

/// A result directory.
struct ResultFolder {
    std::string directory;  ///< path as given by the caller
    std::string name;       ///< last component of the path
    std::vector<FolderExperiment> experiments;
    NameList scenes, methods, messages, formulations;
    std::vector<FolderRow> rows;
    std::vector<FolderSeries> series;
    std::vector<FolderTable> tables;
    std::map<std::string, std::string> scene_texts;  ///< canonical JSON by scene name in the rows (scenes.json)
    std::vector<std::string> remarks;                ///< one sentence per file that could not be read
};

/// Reads every .csv file of the directory, provenance.json and scenes.json. Files that cannot be read are omitted and
/// reported in `remarks`. Tables other than sweeps and errors over time are truncated to `most_rows` rows. Throws
/// InputError if the directory does not exist or contains no table.
ResultFolder read_folder(const std::string& directory, std::size_t most_rows);

/// The scenes of the rows by name, as far as they are available: from scenes.json, else from the built-in experiments
/// of the directory, else from the built-in scenes.
std::map<std::string, Scene> read_scenes(const ResultFolder& folder);

}  // namespace polhode
