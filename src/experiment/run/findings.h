// The results of an experiment: tables and figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figure/split_figure.h"
#include "table/table.h"

namespace polhode {

/// A table, and its form on a page.
struct NamedTable {
    std::string name;   ///< files are named EXPERIMENT_name, or EXPERIMENT if the name is empty
    std::string title;  ///< title on the page; if empty, the experiment's `about`
    Table table;
    std::vector<ColumnChoice> page_columns{};  ///< columns and headings on a page; empty: all columns
    bool only_csv = false;                     ///< no page: too long, or for programs only
    /// Whether name.csv is shared by all experiments. Its last column is the experiment; rows of other experiments are
    /// kept.
    bool is_shared = false;
    std::optional<Table> page{};  ///< the table on the page, instead of `page_columns`
};

/// Returns a table of these columns without rows. A page shows the columns that have a heading.
NamedTable make_named_table(std::string name, std::string title, const std::vector<ColumnChoice>& columns);

/// The table as shown on a page.
Table page_of(const NamedTable& named);

struct Findings {
    std::vector<NamedTable> tables{};
    std::vector<NamedFigure> figures{};
    std::string page{};                   ///< Markdown for EXPERIMENT.md; if empty, the page of the table is used
    long missing = 0;                     ///< rows not computed yet: interrupted, filtered, or of other shards
    std::vector<std::string> machines{};  ///< names of the machines that measured the times of the rows
};

}  // namespace polhode
