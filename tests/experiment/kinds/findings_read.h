// Helpers that read tables of findings in tests.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"

namespace polhode {

inline RunOptions quickly() {
    RunOptions options;
    options.quick = true;
    return options;
}

/// Returns the table of that name. Throws if there is none.
inline const Table& table_of(const Findings& result, const std::string& name) {
    for (const NamedTable& named : result.tables)
        if (named.name == name) return named.table;
    throw std::invalid_argument("no table " + name);
}

/// Returns a cell of type double. Throws std::bad_variant_access if it has another type.
inline double number(const Table& table, const std::vector<Cell>& row, const char* column) {
    return std::get<double>(row[column_index(table, column)]);
}

/// Returns a cell as printed.
inline std::string word(const Table& table, const std::vector<Cell>& row, const char* column) {
    return text_of(row[column_index(table, column)]);
}

}  // namespace polhode
