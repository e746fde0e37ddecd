// Positions of the parts of a figure on its page, in points (1/72 inch) from the top left corner.
#pragma once

#include <string>
#include <vector>

#include "figure/figure.h"

namespace polhode {

/// A rectangle on the page, points.
struct Rectangle {
    double left = 0, top = 0, right = 0, bottom = 0;
};

/// An entry of the legend and its position.
struct LegendEntry {
    std::string label;
    const Curve* curve = nullptr;  ///< the first curve with this label; null for the cut-curve symbol and for a class
    std::string fill;              ///< fill colour of a class
    double x = 0, y = 0;           ///< left end of the sample, middle of the text line
};

/// Positions of all parts of a figure.
struct FigureLayout {
    double width = 0, height = 0;
    std::vector<Rectangle> plots;  ///< the frame of each panel, without labels and title
    /// Whether a panel's axis is labelled. With shared axes, only the outer ones are.
    std::vector<bool> labels_x, labels_y;
    std::vector<LegendEntry> legend;
    std::vector<std::string> note_lines;
    double first_note_line = 0;  ///< middle of the first line of the note
};

inline constexpr double text_size = 7, title_size = 8, figure_title_size = 9;
inline constexpr double line_height = 10, legend_sample = 22;

/// Computes the layout of a figure.
FigureLayout layout_of(const Figure& figure);

/// Estimated text width in points for a wide sans-serif such as DejaVu Sans, with a margin because fonts differ.
double text_width(const std::string& text, double size);

}  // namespace polhode
