// Figures drawn with text characters, for terminals.
#pragma once

#include <string>

#include "figure/figure.h"

namespace polhode {

/// Size and colour of a character plot.
struct CharacterPlot {
    int width = 100;     ///< columns, at least 40
    int rows = 16;       ///< height of a panel's frame, at least 4
    bool color = false;  ///< use the escape sequences of terminals with eight colours
};

/// Draws the figure's panels one below the other with one legend. Lines are Braille dots (UTF-8); axes have tics in
/// text. Without colour, curves with several labels are marked by a letter every few columns. Maps are omitted.
std::string character_plot(const Figure& figure, const CharacterPlot& plot);

}  // namespace polhode
