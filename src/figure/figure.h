// Publication-quality figures: panels of curves, drawn by gnuplot as SVG and PDF.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace polhode {

/// A curve of a panel.
struct Curve {
    std::string label;   ///< in the legend; one entry per label over all panels; empty: none
    int color = 0;       ///< colour index (figure/curve_style.h): one per family of methods, the same in every figure
    int mark = 0;        ///< mark index: one per member of the family
    int dash = 0;        ///< 0 solid, 1.. dashed, dotted, ..: e.g. one per setting
    bool points = true;  ///< draw marks (at a dozen points if there are more than 40); false: line only
    bool cut = false;    ///< the curve was cut short: a ring and an arrow at its end, explained in the legend
    std::vector<double> x, y;  ///< points that are not drawable (axis.h) are skipped: not finite, beyond 1e300, or
                               ///< not positive on a logarithmic axis
    bool line = true;          ///< false: marks only, at every point
    std::string group{};       ///< "runge_kutta": the group by which split_figure.h splits figures
};

/// A reference line, thin, grey and dashed, with its name beside it if the curves leave room. It does not extend the
/// axes and is omitted if it lies outside them.
struct Guide {
    std::string label;
    std::vector<double> x, y;  ///< a single y and no x: a horizontal line across the frame
};

/// Number of shades. 0 is the lightest and means best; each is darker than the one before, also in greyscale.
constexpr int shade_count = 8;

/// A class of outcomes in a map.
struct MapClass {
    std::string label;  ///< in the legend, one entry over all panels
    int shade = 0;
};

/// Outcome for each pair of two parameters: cells filled by class, below the panel's curves and guides.
struct OutcomeMap {
    std::vector<double> x, y;       ///< cell centres, ascending; edges are half-way between them on the axis' scale
    std::vector<int> cells;         ///< row by row, cells[j * x.size() + i]: index into `classes`; -1: left blank
    std::vector<MapClass> classes;  ///< all are in the legend, even if they do not occur
};

/// The ends of an axis.
struct Limits {
    double low = 0, high = 1;
};

/// One plot of a figure.
struct Panel {
    std::string title, x_label, y_label;  ///< labels include units: "time (s)"
    bool log_x = true, log_y = true;
    std::vector<Curve> curves;
    std::vector<Guide> guides{};
    std::optional<OutcomeMap> map{};  ///< the axes end where the map ends
    /// Fixed ends of the axes; anything beyond is clipped.
    std::optional<Limits> x_limits{}, y_limits{};
};

/// How two curves are compared.
enum class Best {
    lowest_end,  ///< the lower last point is better
    least_x,     ///< reaching a y at a smaller x is better: errors against time
    greatest_x,  ///< reaching a y at a larger x is better: errors against steps
};

/// A figure. All text is shown literally.
struct Figure {
    std::string title;
    int columns = 1;  ///< panels per row
    std::vector<Panel> panels;
    std::string note;  ///< text below the panels: why a curve was cut, an unoptimised library, ..
    /// All panels share one range of axes that covers all of them. They are placed close together, and only the left
    /// and bottom ones have labels.
    bool shared_axes = false;
    std::string truncation_note{};  ///< appended to the note if a curve is cut: the reason
    Best best = Best::lowest_end;   ///< the criterion by which curves are selected if there are too many
};

/// The gnuplot script that draws the figure to `path` (standard output if empty) with `terminal` ("svg" or "pdf";
/// throws std::invalid_argument otherwise). Data are inline. A panel is about one column of a paper wide, or half a
/// page if there are several per row. One legend is placed below all panels.
std::string gnuplot_script(const Figure& figure, const std::string& terminal, const std::string& path);

/// Draws PATH.svg and PATH.pdf, or those requested, through temporary files that are renamed. The same figure gives
/// the same bytes. Returns an empty string, or the error (such as gnuplot missing or exceeding the time limit), so
/// that tables do not depend on gnuplot. Throws std::runtime_error if a file cannot be written.
std::string draw(const Figure& figure, const std::string& path_without_extension,
                 const std::vector<std::string>& formats = {"svg", "pdf"},
                 std::chrono::milliseconds time_limit = std::chrono::seconds(60));

}  // namespace polhode
