// Pictures that a paper could print: panels of curves, drawn by gnuplot as SVG and PDF.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace polhode {

struct Curve {
    std::string label;   ///< in the legend; curves of one label share one entry over all panels; none if empty
    int color = 0;       ///< which colour (figure/curve_style.h): one a family of methods, the same in every picture
    int mark = 0;        ///< which mark: one a member of the family
    int dash = 0;        ///< 0 solid, 1.. dashed, dotted, ..: e.g. one a setting
    bool points = true;  ///< with marks (at a dozen points where there are more than 40) or a line only
    bool cut = false;    ///< the curve was cut short: a ring about its last point and an arrow onward, explained in the
                         ///< legend
    std::vector<double> x, y;  ///< points that are not finite, or not positive on a logarithmic axis, are left out (and
                               ///< so are magnitudes beyond 1e300, which no axis can show)
    bool line = true;          ///< false: marks only, at every point
    std::string group{};       ///< "runge_kutta": what a picture of too many curves is split by (figure/split_figure.h)
};

/// A line to read the curves by, thin, grey and dashed, with its name beside it where the curves leave room. It does
/// not widen the axes, and is left out where it lies outside them.
struct Guide {
    std::string label;
    std::vector<double> x, y;  ///< a single y and no x: a level across the frame
};

/// So many shades: 0 the lightest, for what is best, each darker than the one before in print without colour as well.
constexpr int shade_count = 8;

struct MapClass {
    std::string label;  ///< in the legend, one entry over all panels
    int shade = 0;
};

/// What came of each pair of two parameters: cells filled by class, beneath the panel's curves and guides.
struct OutcomeMap {
    std::vector<double> x, y;       ///< the cells' centres, ascending; their edges lie half-way, on the axis' scale
    std::vector<int> cells;         ///< row by row, cells[j * x.size() + i]: a place in `classes`; -1: left blank
    std::vector<MapClass> classes;  ///< all are in the legend, whether they occur or not
};

struct Limits {
    double low = 0, high = 1;
};

struct Panel {
    std::string title, x_label, y_label;  ///< labels with units: "time (s)"
    bool log_x = true, log_y = true;
    std::vector<Curve> curves;
    std::vector<Guide> guides{};
    std::optional<OutcomeMap> map{};  ///< the axes end where it ends
    /// Where the axes end, whatever is drawn; what lies beyond is cut off.
    std::optional<Limits> x_limits{}, y_limits{};
};

/// Which of two curves is the better one.
enum class Best {
    lowest_end,  ///< whose last point is lower
    least_x,     ///< who reaches a y at a smaller x: errors against time
    greatest_x,  ///< who reaches a y at a larger x: errors against steps
};

/// All text shows literally.
struct Figure {
    std::string title;
    int columns = 1;  ///< panels in a row
    std::vector<Panel> panels;
    std::string note;  ///< lines below: what the reader must know (why a curve was cut, an unoptimised library)
    /// All panels have the same axes, over what any of them shows: they stand close, and only those at the left and at
    /// the bottom have labels.
    bool shared_axes = false;
    std::string note_of_cut{};     ///< behind the note where a curve is cut: why
    Best best = Best::lowest_end;  ///< by which a choice of its curves is made where they are too many
};

/// The gnuplot script that draws the figure to `path` (to standard output if empty) by `terminal` ("svg" or "pdf"; else
/// std::invalid_argument); data inline, no file needed. A panel is about one column of a paper wide, or half a page
/// where there are several in a row; one legend below all panels.
std::string gnuplot_script(const Figure& figure, const std::string& terminal, const std::string& path);

/// Draws PATH.svg and PATH.pdf, or those of them that are asked for (through temporaries, renamed); the same figure
/// gives the same bytes. Returns an empty string, or what went wrong, such as gnuplot missing or silent beyond the time
/// limit: tables do not depend on it. Throws std::runtime_error where a file cannot be written.
std::string draw(const Figure& figure, const std::string& path_without_extension,
                 const std::vector<std::string>& formats = {"svg", "pdf"},
                 std::chrono::milliseconds time_limit = std::chrono::seconds(60));

}  // namespace polhode
