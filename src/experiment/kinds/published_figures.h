// Published numbers of mechanisms, compared with the truth.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body/wide_decimal.h"

namespace polhode {

/// A published number and polhode's number for the same quantity.
struct PublishedFigure {
    std::string mechanism, source;
    std::string quantity;              ///< with unit
    std::string published;             ///< as printed
    std::string computed;              ///< polhode's number to 20 digits, or the reason why it is missing
    std::optional<double> difference;  ///< |published - computed| / |computed|
    std::optional<long> digits_printed;
    std::optional<long> correct_digits;  ///< floor(-log10 difference), at most digits_printed
};

/// All comparisons: Andrews' squeezing mechanism, Kane's babyboot, the double four-bar (mechanism_figures.h). `quick`:
/// only the last one, whose motion is a pendulum's. `samples`: of the truths, so that cached ones can be used.
std::vector<PublishedFigure> compare_figures(bool quick, long samples);

/// Formats a number with `digits` significant digits, at most 30: positional from 1e-4 to 1e9, else scientific.
std::string format_wide(const Wide& value, int digits);

}  // namespace polhode
