// Figures that others published of mechanisms, each beside the truth.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body/wide.h"

namespace polhode {

/// One number of another's beside ours.
struct ComparedFigure {
    std::string mechanism, source;
    std::string quantity;              ///< with its unit
    std::string published;             ///< as it was printed
    std::string ours;                  ///< to twenty digits; or why there is none
    std::optional<double> difference;  ///< |published - ours| / |ours|
    std::optional<long> digits_printed;
    std::optional<long> digits_right;  ///< floor(-log10 difference), of those printed
};

/// All of them: Andrews' squeezing mechanism, Kane's babyboot, the double four-bar (mechanism_figures.h). `quick`:
/// of the last one alone, whose motion is a pendulum's. `samples`: of the truths, so that one made before serves.
std::vector<ComparedFigure> compared_figures(bool quick, long samples);

/// A decimal in 128 bits ("-929.47", "1e-3"); its last digits are right to some units of 1e-33 of itself.
Wide wide_of_decimal(std::string_view text);

/// A number to so many significant digits, at most 30, in positional notation from 1e-4 to 1e9, else in scientific one.
std::string decimal_of_wide(const Wide& value, int digits);

}  // namespace polhode
