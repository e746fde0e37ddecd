// What the tests of the studies read from their findings.
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

/// The table of that name; throws if there is none.
inline const Table& table_of(const Findings& result, const std::string& name) {
    for (const NamedTable& named : result.tables)
        if (named.name == name) return named.table;
    throw std::invalid_argument("no table " + name);
}

/// A cell that holds a double; throws std::bad_variant_access if it does not.
inline double number(const Table& table, const std::vector<Cell>& row, const char* column) {
    return std::get<double>(row[column_index(table, column)]);
}

/// A cell as the table prints it.
inline std::string word(const Table& table, const std::vector<Cell>& row, const char* column) {
    return text_of(row[column_index(table, column)]);
}

}  // namespace polhode
