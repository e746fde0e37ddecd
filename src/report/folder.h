// A folder of results, read: the rows of its sweeps, errors over time, every other table, where each came from.
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

/// Names in the order in which they first occurred.
class NameList {
  public:
    /// The name's place, a new one where it has not occurred yet.
    int place(const std::string& name);
    /// The name's place, or -1.
    int find(const std::string& name) const;
    /// All of them.
    const std::vector<std::string>& names() const { return names_; }
    /// The name at a place.
    const std::string& operator[](int place) const { return names_[static_cast<std::size_t>(place)]; }

  private:
    std::vector<std::string> names_;
    std::map<std::string, int, std::less<>> places_;
};

/// A number that is not there.
inline constexpr double absent = std::numeric_limits<double>::quiet_NaN();

/// A row of a result table. Names are places in the folder's lists.
struct FolderRow {
    int experiment = 0, scene = 0, method = 0, message = 0, formulation = 0;
    SettingKind kind = SettingKind::none;
    Status status = Status::ok;
    bool cut = false;  ///< ended by a limit on time, steps or evaluations
    /// The numbers of the columns of result_column_table(); NaN where there is none.
    std::vector<double> numbers = std::vector<double>(result_column_table().size(), absent);

    /// The number of a column by its name: row["attitude_error_max"].
    double& operator[](std::string_view column) { return numbers[result_column_index(column)]; }
    /// The number of a column by its name.
    double operator[](std::string_view column) const { return numbers[result_column_index(column)]; }
    /// rad, the largest error over the samples.
    double attitude() const { return (*this)["attitude_error_max"]; }
    /// s, the median of the repeats.
    double seconds() const { return (*this)["seconds_median"]; }
    /// rad, the rounding floor of binary64.
    double floor() const { return (*this)["float64_floor"]; }
    /// Experiment, scene, method, kind of setting and formulation.
    using Curve = std::array<int, 5>;
    /// What the rows of one curve share.
    Curve curve() const { return {experiment, scene, method, static_cast<int>(kind), formulation}; }
    /// Whether the run ended well within this attitude error (rad) and was timed.
    bool is_within(double error) const { return status == Status::ok && attitude() <= error && seconds() > 0; }
};

/// What is told of errors over time, and the columns of drift.csv that tell it.
inline constexpr std::array<std::string_view, 5> drift_measures{"attitude", "omega", "energy", "momentum", "norm"};

/// The errors over time of one run.
struct FolderSeries {
    int experiment = 0, scene = 0, method = 0;
    double setting = absent;
    std::vector<double> t;                                          ///< s
    std::array<std::vector<double>, drift_measures.size()> errors;  ///< as drift_measures
};

/// Any other table.
struct FolderTable {
    std::string name;        ///< of its file, without .csv
    std::string experiment;  ///< whose it is; empty where that is not known
    std::string title;       ///< empty where it is not known
    Table table;             ///< every cell a text
    std::size_t total = 0;   ///< rows in the file; more than there are in `table`, of one that is too long
};

/// An experiment that the folder has rows or tables of.
struct FolderExperiment {
    std::string name, about, kind, date;
    bool quick = false;
    std::vector<std::pair<std::string, std::string>> facts;  ///< CPU, compiler, commit, ..: name and value
};

/// A folder of results.
struct ResultFolder {
    std::string directory;  ///< as it was given
    std::string name;       ///< its last part
    std::vector<FolderExperiment> experiments;
    NameList scenes, methods, messages, formulations;
    std::vector<FolderRow> rows;
    std::vector<FolderSeries> series;
    std::vector<FolderTable> tables;
    std::map<std::string, std::string> scene_texts;  ///< canonical JSON by the scene's name in the rows (scenes.json)
    std::vector<std::string> remarks;                ///< files that could not be read, a sentence each
};

/// Reads every .csv file of the folder, provenance.json and scenes.json. A file that cannot be read is left out and
/// `remarks` says why. Of a table that is no sweep's the first `most_rows` rows are kept. Throws InputError where there
/// is no such folder, or it holds no table.
ResultFolder read_folder(const std::string& directory, std::size_t most_rows);

/// The scenes that rows are of, as far as they can be had again, by their names in the rows: from scenes.json, from the
/// built-in experiments that the rows are of, from the catalogue.
std::map<std::string, Scene> scenes_of(const ResultFolder& folder);

}  // namespace polhode
