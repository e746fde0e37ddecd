// What the writers for people have in common.
#pragma once

#include <string>
#include <vector>

#include "table/table.h"

namespace polhode {

/// Three significant digits: "0.0333", "5.9e-5"; "nan", "inf", "-inf".
std::string number_for_people(double value);

/// Columns with at least one number and no text: they are aligned to the right.
std::vector<bool> number_columns(const Table& table);

/// A text in which the characters that GitHub's Markdown may take as markup are escaped; an underscore within a word
/// is none.
std::string markdown_text(const std::string& text);

}  // namespace polhode
