// Pictures of characters, for terminals.
#pragma once

#include <string>

#include "figure/figure.h"

namespace polhode {

struct CharacterPlot {
    int width = 100;     ///< columns, 40 at least
    int rows = 16;       ///< of a panel's frame, 4 at least
    bool color = false;  ///< with the escape sequences of a terminal that has eight colours
};

/// The figure's panels one below the other, and one legend: lines as Braille dots (UTF-8), the axes with their tics in
/// text. Without colour, curves of several labels have a letter each every few columns. Maps are left out.
std::string character_plot(const Figure& figure, const CharacterPlot& plot);

}  // namespace polhode
