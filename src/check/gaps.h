// Rows of trajectory tables that hold no motion.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace polhode {

/// A table under our names, and where there was nothing in it.
struct GappedTable {
    std::string text;               ///< without the times at which a cell is not a number; line numbers stay
    std::vector<std::size_t> gaps;  ///< of the times that are left, those before which others were; ascending
};

/// Leaves out all rows of a time at which any cell of a row is NaN: of several bodies, those of the others as well.
GappedTable without_nan(const std::string& text, const std::string& file);

}  // namespace polhode
