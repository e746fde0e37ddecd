// What an experiment finds: tables and pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figure/split_figure.h"
#include "table/table.h"

namespace polhode {

/// A table and what a page shows of it.
struct NamedTable {
    std::string name;   ///< of its files after the experiment's: EXPERIMENT_name; empty: EXPERIMENT
    std::string title;  ///< of the page; empty: what the experiment is about
    Table table;
    std::vector<ColumnChoice> for_people{};  ///< what a page shows; empty: all columns
    bool only_csv = false;                   ///< for machines, and too long for a page
    /// name.csv is one file for all experiments: its last column tells whose a row is, and the others' rows stay.
    bool is_shared = false;
    std::optional<Table> page{};  ///< in place of a choice of columns
};

/// An empty table of these columns. A page shows those that have a heading, under it.
NamedTable headed_table(std::string name, std::string title, const std::vector<ColumnChoice>& columns);

/// The table as a page shows it.
Table page_of(const NamedTable& named);

struct Findings {
    std::vector<NamedTable> tables{};
    std::vector<NamedFigure> figures{};
    std::string page{};  ///< Markdown for EXPERIMENT.md in place of the table's, if not empty
    long missing = 0;    ///< rows that are not there yet: interrupted, filtered or a shard; run again to go on
    std::vector<std::string> machines{};  ///< by name, whose times the rows of cases tell
};

}  // namespace polhode
