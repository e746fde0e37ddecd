// Functions shared by the Markdown and LaTeX writers.
#pragma once

#include <string>
#include <vector>

#include "table/table.h"

namespace polhode {

/// Formats a number to three significant digits: "0.0333", "5.9e-5"; "nan", "inf", "-inf".
std::string format_readable_number(double value);

/// For each column, whether it has at least one number and no text. Such columns are aligned to the right.
std::vector<bool> number_columns(const Table& table);

/// Escapes the characters that GitHub's Markdown may interpret as markup. An underscore within a word is not markup.
std::string markdown_text(const std::string& text);

}  // namespace polhode
