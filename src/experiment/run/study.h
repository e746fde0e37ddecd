// Experiments that are no sweep of methods over scenes: each is a function that makes tables and pictures of its own.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "body/wide.h"
#include "experiment/kinds/report.h"
#include "experiment/plan/experiment.h"
#include "experiment/run/sweep.h"
#include "table/table.h"

namespace polhode {

/// A table of a study's and, where they differ, the columns that a page shows of it.
struct NamedTable {
    std::string name;   ///< of its files after the experiment's: EXPERIMENT_name; empty: EXPERIMENT
    std::string title;  ///< of the page; empty: what the experiment is about
    Table table;
    std::vector<ColumnChoice> for_people{};  ///< empty: all columns
    bool only_csv = false;                   ///< for machines, and too long for a page
};

struct StudyResult {
    std::vector<NamedTable> tables;
    std::vector<NamedFigure> figures{};
    std::string page{};    ///< Markdown for EXPERIMENT.md in place of the table's, if not empty
    bool complete = true;  ///< false: interrupted, filtered or a shard; run again to go on
};

/// Called with the plan of an experiment file whose "kind" is the study's name. Of the options `quick` asks for a tenth
/// of the work; a study that is `resumable` keeps what it has finished in the directory, obeys filter, shard and jobs
/// and stops when a sweep would; for any other one folder, filter and shard mean nothing. Failures of methods are rows.
struct Study {
    std::string_view name;
    std::vector<std::string_view> reads;  ///< keys of the experiment file that it uses beside name, about and kind
    StudyResult (*run)(const Plan& plan, const RunOptions& options);
    bool resumable = false;
    bool chooses_steps = false;  ///< it finds the steps of fixed-step methods itself: the plan has one without a number
};

/// Of an inertia tensor: Frobenius norm of the difference over that of the true one, in 128 bits.
double relative_error(const Matrix3<double>& inertia, const Matrix3<Wide>& truth);

/// All studies, in no order that matters.
std::span<const Study> studies();

/// By name; nullptr if there is none.
const Study* find_study(std::string_view name);

/// Writes a study's tables (.csv, .md, .tex, .json) and pictures and its entry in provenance.json. Returns remarks for
/// the user (a picture that could not be drawn). Throws std::runtime_error.
std::vector<std::string> write_study_report(const Plan& plan, const StudyResult& result, const std::string& directory,
                                            const std::string& command_line, bool quick);

/// The identity of a study's result: program, experiment, scenes.
std::string study_key(const Plan& plan, bool quick);

}  // namespace polhode
