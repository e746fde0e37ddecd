// Operations of table(name, x).
#pragma once

#include <string>

#include "formula/parser.h"

namespace polhode::formula {

/// The value of a table at a node. `text` describes the switches.
int table_nodes(Expression& expression, const TableData& table, int x, const std::string& text);

}  // namespace polhode::formula
