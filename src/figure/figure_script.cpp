// Writes the gnuplot script of a figure.
//
// Script emits one multiplot: each panel with its frame, axes, map cells, guides and curves, then the page with
// title, legend and note. Positions come from figure_layout.h and are given in screen coordinates; data are inline
// data blocks. gnuplot's automatic margins and key are not used.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "figure/axis.h"
#include "figure/curve_style.h"
#include "figure/figure.h"
#include "figure/figure_layout.h"
#include "figure/gnuplot_terminal.h"
#include "figure/guide_label.h"
#include "text/decimal.h"

namespace polhode {

namespace {

constexpr const char* guide_color = "#5a5a5a";

std::vector<Point> drawable_points(const Panel& panel, const Curve& curve) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
        if (drawable(curve.x[i], panel.log_x) && drawable(curve.y[i], panel.log_y)) {
            points.push_back({curve.x[i], curve.y[i]});
        }
    }
    return points;
}

struct Extent {
    Point low, high;
};

void widen(std::optional<Extent>& extent, const std::optional<Extent>& by) {
    if (!extent || !by) {
        if (by) extent = by;
        return;
    }
    extent->low = {std::min(extent->low.x, by->low.x), std::min(extent->low.y, by->low.y)};
    extent->high = {std::max(extent->high.x, by->high.x), std::max(extent->high.y, by->high.y)};
}

/// The n + 1 edges of cells around ascending centres; empty if an axis cannot show them.
std::vector<double> edges_of(const std::vector<double>& centres, bool logarithmic) {
    if (centres.empty()) return {};
    const auto to = [&](double v) { return logarithmic ? std::log10(v) : v; };
    const auto back = [&](double v) { return logarithmic ? std::pow(10.0, v) : v; };
    const std::size_t n = centres.size();
    const double first = n > 1 ? to(centres[1]) - to(centres[0]) : 1;
    const double last = n > 1 ? to(centres[n - 1]) - to(centres[n - 2]) : 1;
    std::vector<double> edges{back(to(centres[0]) - first / 2)};
    for (std::size_t i = 1; i < n; ++i) edges.push_back(back((to(centres[i - 1]) + to(centres[i])) / 2));
    edges.push_back(back(to(centres[n - 1]) + last / 2));
    for (std::size_t i = 0; i <= n; ++i)
        if (!drawable(edges[i], logarithmic) || (i > 0 && !(edges[i] > edges[i - 1]))) return {};
    return edges;
}

/// The map's cells of one class as few polygons: a run of cells in a row extends the polygon of an overlapping run in
/// the row below.
std::vector<std::vector<Point>> polygons_of(const OutcomeMap& map, int cell, const std::vector<double>& x,
                                            const std::vector<double>& y) {
    struct Run {
        std::size_t row, begin, end;
    };
    const std::size_t nx = map.x.size();
    std::vector<std::vector<Run>> stacks;
    std::vector<std::size_t> open;  // stacks that end at the lower edge of this row
    for (std::size_t j = 0; j < map.y.size(); ++j) {
        std::vector<std::size_t> reached;
        for (std::size_t i = 0, end = 0; i < nx; i = end) {
            const bool inside = map.cells[j * nx + i] == cell;
            for (end = i + 1; end < nx && (map.cells[j * nx + end] == cell) == inside;) ++end;
            if (!inside) continue;
            const auto below = std::find_if(open.begin(), open.end(), [&](std::size_t k) {
                return stacks[k].back().row + 1 == j && stacks[k].back().begin < end && i < stacks[k].back().end;
            });
            if (below == open.end()) stacks.emplace_back();
            const std::size_t stack = below == open.end() ? stacks.size() - 1 : *below;
            stacks[stack].push_back({j, i, end});
            reached.push_back(stack);
        }
        open = std::move(reached);
    }
    std::vector<std::vector<Point>> polygons;
    for (const std::vector<Run>& stack : stacks) {
        std::vector<Point>& polygon = polygons.emplace_back();
        for (const Run& run : stack) {
            polygon.push_back({x[run.begin], y[run.row]});
            polygon.push_back({x[run.begin], y[run.row + 1]});
        }
        for (auto run = stack.rbegin(); run != stack.rend(); ++run) {
            polygon.push_back({x[run->end], y[run->row + 1]});
            polygon.push_back({x[run->end], y[run->row]});
        }
        // remove points inside a straight edge
        for (std::size_t k = 1; k + 1 < polygon.size();) {
            const Point &before = polygon[k - 1], &here = polygon[k], &after = polygon[k + 1];
            const bool straight = before.x == here.x && here.x == after.x;
            if (straight || (here.x == before.x && here.y == before.y))
                polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
            else
                ++k;
        }
    }
    return polygons;
}

/// The extent of the panel's map, or of its curves' points; guides do not count. Empty if there are none.
std::optional<Extent> extent_of(const Panel& panel) {
    std::optional<Extent> extent;
    if (panel.map) {
        const std::vector<double> x = edges_of(panel.map->x, panel.log_x), y = edges_of(panel.map->y, panel.log_y);
        if (!x.empty() && !y.empty()) extent = Extent{{x.front(), y.front()}, {x.back(), y.back()}};
    } else {
        for (const Curve& curve : panel.curves)
            for (const Point& point : drawable_points(panel, curve)) widen(extent, Extent{point, point});
    }
    return extent;
}

/// Writes the script of one figure. Sizes are in points and are converted to the terminal's unit.
class Script {
  public:
    Script(const Figure& figure, const std::string& terminal, const std::string& path)
        : figure_(figure), layout_(layout_of(figure)), terminal_(terminal) {
        text = terminal_.opening(layout_.width, layout_.height, text_size, path);
        line("set multiplot");
        // a label that must cover curves gets an opaque background
        line("set style textbox opaque noborder fillcolor \"#ffffff\" margins 0.3,0.3");
        line("unset key");
        std::optional<Extent> all;
        if (figure.shared_axes)
            for (const Panel& panel : figure.panels) widen(all, extent_of(panel));
        for (std::size_t i = 0; i < figure.panels.size(); ++i) panel(i, all ? all : extent_of(figure.panels[i]));
        page();
        line("unset multiplot");
        line("unset output");
    }

    std::string text;

  private:
    void line(const std::string& command) { text += command + '\n'; }

    std::string font(double points) const { return terminal_.font(points); }
    double line_width(double points) const { return terminal_.line_width(points); }
    /// The terminals draw circles and squares smaller than other marks, each by its own factor.
    double point_size(int type) const {
        const bool small = type <= 7;
        const double size = terminal_.svg() ? (small ? 0.52 : 0.48) : (small ? 0.40 : 0.54);
        // marks made of lines must be larger to be distinguishable
        return type < 4 || is_open(type) ? 1.25 * size : size;
    }
    static constexpr double mark_line_width = 0.8;
    /// The cut-curve symbol, a ring around the last mark.
    static constexpr int ring = 6;
    static constexpr double ring_size = 1.6;
    /// gnuplot's point types from 4 on alternate between open and filled.
    static bool is_open(int type) { return type >= 4 && type % 2 == 0; }

    std::string on_page(double x, double y) const {
        return fmt::format("screen {:.5f},{:.5f}", x / layout_.width, 1 - y / layout_.height);
    }

    void frame(const Rectangle& plot) {
        line(fmt::format("set lmargin at screen {:.5f}", plot.left / layout_.width));
        line(fmt::format("set rmargin at screen {:.5f}", plot.right / layout_.width));
        line(fmt::format("set tmargin at screen {:.5f}", 1 - plot.top / layout_.height));
        line(fmt::format("set bmargin at screen {:.5f}", 1 - plot.bottom / layout_.height));
    }

    void axis(char name, const Axis& axis, bool labelled, bool outward) {
        line(fmt::format("{} logscale {}", axis.logarithmic ? "set" : "unset", name));
        line(fmt::format("set {}range [{}:{}]", name, shortest_decimal(axis.low), shortest_decimal(axis.high)));
        std::string tics;
        for (const Tic& tic : axis.tics) {
            tics += fmt::format("{}\"{}\" {} {}", tics.empty() ? "" : ", ", labelled ? tic.label : "", tic.position,
                                tic.label.empty() ? 1 : 0);
        }
        line(fmt::format("set {}tics {} nomirror scale 0.6,0.3 offset {} ({})", name, outward ? "out" : "in",
                         name == 'x' ? "0,0.2" : "0.4,0", tics));
    }

    void panel(std::size_t index, const std::optional<Extent>& extent) {
        const Panel& panel = figure_.panels[index];
        const Rectangle& plot = layout_.plots[index];
        const bool label_x = layout_.labels_x[index], label_y = layout_.labels_y[index];
        frame(plot);
        line(fmt::format("set border 15 linewidth {:g} linecolor \"#404040\"", line_width(0.5)));
        const double middle = (plot.left + plot.right) / 2;
        const auto label = [&](const std::string& words, double x, double y, const std::string& style, double size) {
            if (words.empty()) return;
            line(fmt::format("set label {} at {} center {} noenhanced front font {}", gnuplot_quoted_line(words),
                             on_page(x, y), style, font(size)));
        };
        // keep the title of a narrow panel within its width
        const double room = (plot.right - plot.left + 8) / text_width(panel.title, 1);
        label(panel.title, middle, plot.top - 8, "",
              figure_.shared_axes ? std::clamp(room, 4.5, title_size) : title_size);
        if (label_x) label(panel.x_label, middle, plot.bottom + 21, "", text_size);
        if (label_y) label(panel.y_label, plot.left - 38, (plot.top + plot.bottom) / 2, "rotate by 90", text_size);

        std::vector<std::vector<Point>> curves;
        for (const Curve& curve : panel.curves) curves.push_back(drawable_points(panel, curve));
        if (extent) {
            // leave room for marks and the arrows of cut curves; a time axis without marks ends with its data
            const bool cut =
                std::any_of(panel.curves.begin(), panel.curves.end(), [](const Curve& c) { return c.cut; });
            const bool map = panel.map.has_value();
            const auto axis_of = [&](bool logarithmic, double low, double high, double labels, double padding,
                                     const std::optional<Limits>& limits) {
                if (limits) low = limits->low, high = limits->high;
                return make_axis(logarithmic, low, high, static_cast<int>(labels), map || limits ? 0 : padding);
            };
            const Axis x =
                axis_of(panel.log_x, extent->low.x, extent->high.x, (plot.right - plot.left) / (panel.log_x ? 24 : 32),
                        panel.log_x || cut ? 0.07 : 0, panel.x_limits);
            const Axis y = axis_of(panel.log_y, extent->low.y, extent->high.y, (plot.bottom - plot.top) / 16, 0.08,
                                   panel.y_limits);
            // inward tics would cross the cells
            axis('x', x, label_x, map);
            axis('y', y, label_y, map);
            if (label_x) factor(x, plot.right, plot.bottom + 21);
            if (label_y) factor(y, plot.left + 6, plot.top - 6);
            if (map)
                line("unset grid");
            else
                line(fmt::format("set grid xtics ytics linewidth {:g} dashtype solid linecolor \"#dddddd\"",
                                 line_width(0.4)));
            std::string beneath = cells_of(panel);
            beneath += guides_of(panel, curves, plot, x, y);
            curves_of(panel, curves, beneath, plot, x, y);
        } else {
            label("no data to plot", middle, (plot.top + plot.bottom) / 2, "textcolor \"#808080\"", text_size);
            nothing();
        }
        line("unset label");
        line("unset arrow");
    }

    /// Writes the data of the map's cells. Returns the plot elements that fill them, each followed by a comma. A
    /// hairline in the fill colour closes the gaps that viewers leave between neighbours.
    std::string cells_of(const Panel& panel) {
        if (!panel.map) return "";
        const OutcomeMap& map = *panel.map;
        const std::vector<double> x = edges_of(map.x, panel.log_x), y = edges_of(map.y, panel.log_y);
        if (x.empty() || y.empty() || map.cells.size() != map.x.size() * map.y.size()) return "";
        std::string elements;
        for (std::size_t c = 0; c < map.classes.size(); ++c) {
            std::string data;
            for (const std::vector<Point>& polygon : polygons_of(map, static_cast<int>(c), x, y)) {
                if (!data.empty()) data += '\n';
                for (const Point& point : polygon)
                    data += shortest_decimal(point.x) + ' ' + shortest_decimal(point.y) + '\n';
            }
            if (data.empty()) continue;
            text += fmt::format("$cells{} << END\n{}END\n", c, data);
            const std::string color = color_of_shade(map.classes[c].shade);
            elements += fmt::format(
                "$cells{} using 1:2 with filledcurves closed fillcolor \"{}\" fillstyle solid 1 border linecolor "
                "\"{}\" linewidth {:g}, \\\n  ",
                c, color, color, line_width(0.2));
        }
        return elements;
    }

    /// The power of ten that is factored out of an axis' labels; the text ends at x.
    void factor(const Axis& axis, double x, double y) {
        if (axis.factor_exponent == 0) return;
        const std::string sign = axis.factor_exponent < 0 ? "−" : "";
        line(fmt::format("set label \"×10^{{{}{}}}\" at {} right front font {}", sign, std::abs(axis.factor_exponent),
                         on_page(x, y), font(text_size)));
    }

    /// An empty frame, since gnuplot draws labels and arrows only with a plot.
    void nothing() { bare("2 notitle"); }

    /// Plots the elements in the unit square without axes, tics or grid.
    void bare(const std::string& elements) {
        for (const char name : {'x', 'y'}) {
            line(fmt::format("unset logscale {}", name));
            line(fmt::format("set {}range [0:1]", name));
            line(fmt::format("unset {}tics", name));
        }
        line("unset grid");
        line("plot " + elements);
    }

    void data(std::size_t index, const std::vector<Point>& points) {
        line(fmt::format("$curve{} << END", index));
        for (const Point& point : points) line(shortest_decimal(point.x) + ' ' + shortest_decimal(point.y));
        line("END");
    }

    /// Maps a point from axis units to the page.
    static Point place(const Point& point, const Rectangle& plot, const Axis& x, const Axis& y) {
        return {plot.left + fraction(x, point.x) * (plot.right - plot.left),
                plot.bottom - fraction(y, point.y) * (plot.bottom - plot.top)};
    }

    /// Writes data and labels of the visible guides. Returns the elements that plot them.
    std::string guides_of(const Panel& panel, const std::vector<std::vector<Point>>& curves, const Rectangle& plot,
                          const Axis& x, const Axis& y) {
        constexpr double size = 6;
        std::vector<std::vector<Point>> drawn;
        for (const std::vector<Point>& curve : curves) {
            std::vector<Point>& line = drawn.emplace_back();
            for (const Point& point : curve) line.push_back(place(point, plot, x, y));
        }
        const auto inside = [](const Axis& axis, double value) { return value >= axis.low && value <= axis.high; };
        std::string elements;
        for (std::size_t g = 0; g < panel.guides.size(); ++g) {
            const Guide& guide = panel.guides[g];
            std::vector<Point> points;
            if (guide.x.empty() && guide.y.size() == 1) {
                if (drawable(guide.y[0], panel.log_y)) points = {{x.low, guide.y[0]}, {x.high, guide.y[0]}};
            } else {
                points = drawable_points(panel, {.label = {}, .x = guide.x, .y = guide.y});
            }
            std::vector<Point> seen;
            for (const Point& point : points)
                if (inside(x, point.x) && inside(y, point.y)) seen.push_back(place(point, plot, x, y));
            if (seen.empty()) continue;
            line(fmt::format("$guide{} << END", g));
            for (const Point& point : points) line(shortest_decimal(point.x) + ' ' + shortest_decimal(point.y));
            line("END");
            elements +=
                fmt::format("$guide{} using 1:2 with lines linewidth {:g} dashtype (8,5) linecolor \"{}\", \\\n  ", g,
                            line_width(0.6), guide_color);

            if (const auto label = guide_label(guide.label, size, seen, drawn, plot))
                line(fmt::format("set label {} at {} {} noenhanced front textcolor \"{}\" font {}{}",
                                 gnuplot_quoted_line(guide.label), on_page(label->x, label->y),
                                 label->ends_there ? "right" : "left", guide_color, font(size),
                                 label->covered_points > 0 ? " boxed" : ""));
        }
        return elements;
    }

    static constexpr std::size_t most_marked = 40, marks_of_long_curves = 12;
    // larger mark for a curve of a single point
    static constexpr double lone = 2;

    /// `beneath`: elements drawn below the curves, each followed by a comma.
    void curves_of(const Panel& panel, const std::vector<std::vector<Point>>& curves, const std::string& beneath,
                   const Rectangle& plot, const Axis& x, const Axis& y) {
        std::string elements;
        const auto element = [&](const std::string& what) { elements += (elements.empty() ? "" : ", \\\n  ") + what; };
        for (std::size_t i = 0; i < curves.size(); ++i) {
            const Curve& curve = panel.curves[i];
            const std::vector<Point>& points = curves[i];
            if (points.empty()) continue;
            data(i, points);
            const int type = point_type_of(curve.mark);
            const std::string color = color_of(curve.color);
            if (curve.line) {
                // a white outline, since map cells may be as dark as the curve
                if (panel.map)
                    element(fmt::format("$curve{} using 1:2 with lines linewidth {:g} linecolor \"#ffffff\"", i,
                                        line_width(2.2)));
                element(fmt::format("$curve{} using 1:2 with lines linewidth {:g} dashtype {} linecolor \"{}\"", i,
                                    line_width(0.9), dash_of(curve), color));
            }
            if (curve.points || !curve.line) {
                // fill open marks with white, so that the line does not show through; on long curves draw a few
                // marks, offset between neighbours
                const std::size_t apart =
                    curve.line && points.size() > most_marked ? points.size() / marks_of_long_curves : 1;
                const std::size_t first = static_cast<std::size_t>(std::max(0, curve.mark)) * apart / 5 % apart;
                const std::string every =
                    fmt::format("$curve{} using 1:2 every {}::{}::{} with points pointsize {}", i, apart, first,
                                points.size() - 1, (points.size() == 1 && curve.line ? lone : 1) * point_size(type));
                if (is_open(type)) element(fmt::format("{} pointtype {} linecolor \"#ffffff\"", every, type + 1));
                element(fmt::format("{} pointtype {} linewidth {:g} linecolor \"{}\"", every, type,
                                    line_width(mark_line_width), color));
            }
            if (!curve.cut) continue;
            element(
                fmt::format("$curve{} using 1:2 every ::{} with points pointtype {} pointsize {} linewidth {:g} "
                            "linecolor \"{}\"",
                            i, points.size() - 1, ring, ring_size * point_size(ring), line_width(0.8), color));
            onward_arrow(points, plot, x, y, color);
        }
        if (elements.empty()) elements = "NaN notitle";
        line("plot " + beneath + elements);
    }

    /// Draws an arrow from the last point in the curve's final direction on the page, clipped to the frame. A single
    /// point gets no arrow.
    void onward_arrow(const std::vector<Point>& points, const Rectangle& plot, const Axis& x, const Axis& y,
                      const std::string& color) {
        const Point last = place(points.back(), plot, x, y);
        for (std::size_t i = points.size() - 1; i-- > 0;) {
            const Point before = place(points[i], plot, x, y);
            const double length = std::hypot(last.x - before.x, last.y - before.y);
            if (length < 1) continue;
            const Point direction{(last.x - before.x) / length, (last.y - before.y) / length};
            const double begin = 4, end = 12;
            const Point tip{std::clamp(last.x + end * direction.x, plot.left, plot.right),
                            std::clamp(last.y + end * direction.y, plot.top, plot.bottom)};
            arrow(on_page(last.x + begin * direction.x, last.y + begin * direction.y), on_page(tip.x, tip.y), color);
            return;
        }
    }

    void arrow(const std::string& from, const std::string& to, const std::string& color) {
        line(
            fmt::format("set arrow from {} to {} head filled size screen {:.5f},25 front linewidth {:g} "
                        "linecolor \"{}\"",
                        from, to, 4.5 / layout_.width, line_width(0.8), color));
    }

    /// Parts of the page: title, legend, note.
    void page() {
        frame({0, 0, layout_.width, layout_.height});
        line("unset border");
        const auto label = [&](const std::string& words, double x, double y, const char* place, double size) {
            line(fmt::format("set label {} at {} {} noenhanced font {}", gnuplot_quoted_line(words), on_page(x, y),
                             place, font(size)));
        };
        if (!figure_.title.empty()) label(figure_.title, layout_.width / 2, 10, "center", figure_title_size);
        // the legend's lines are plotted: the SVG terminal would merge arrows of one colour into one dash pattern
        std::string lines;
        for (std::size_t i = 0; i < layout_.legend.size(); ++i) {
            const LegendEntry& entry = layout_.legend[i];
            legend_sign(entry);
            const std::string element = !entry.fill.empty()                           ? legend_cell(i, entry)
                                        : entry.curve != nullptr && entry.curve->line ? legend_line(i, entry)
                                                                                      : "";
            if (!element.empty()) lines += (lines.empty() ? "" : ", \\\n  ") + element;
            label(entry.label, entry.x + legend_sample + 4, entry.y, "left", text_size);
        }
        for (std::size_t i = 0; i < layout_.note_lines.size(); ++i) {
            label(layout_.note_lines[i], 8, layout_.first_note_line + line_height * static_cast<double>(i), "left",
                  text_size);
        }
        bare(lines.empty() ? "2 notitle" : lines);
    }

    /// Writes the data block of a legend entry's line in the page's unit square. Returns the element that plots it.
    std::string legend_line(std::size_t index, const LegendEntry& entry) {
        const double y = 1 - entry.y / layout_.height;
        line(fmt::format("$legend{} << END", index));
        line(fmt::format("{:.5f} {:.5f}", entry.x / layout_.width, y));
        line(fmt::format("{:.5f} {:.5f}", (entry.x + legend_sample) / layout_.width, y));
        line("END");
        return fmt::format("$legend{} using 1:2 with lines linewidth {:g} dashtype {} linecolor \"{}\" notitle", index,
                           line_width(0.9), dash_of(*entry.curve), color_of(entry.curve->color));
    }

    /// Writes a class's legend entry: a filled cell with a thin frame, since the lightest shade is nearly white.
    std::string legend_cell(std::size_t index, const LegendEntry& entry) {
        line(fmt::format("$legend{} << END", index));
        line(fmt::format("{:.5f} {:.5f} {:.5f} {:.5f}", (entry.x + 6) / layout_.width,
                         (entry.x + legend_sample) / layout_.width, 1 - (entry.y + 3.2) / layout_.height,
                         1 - (entry.y - 3.2) / layout_.height));
        line("END");
        return fmt::format(
            "$legend{} using 1:3:1:2:3:4 with boxxyerror fillcolor \"{}\" fillstyle solid 1 border linecolor "
            "\"#404040\" "
            "linewidth {:g} notitle",
            index, entry.fill, line_width(0.3));
    }

    void legend_sign(const LegendEntry& entry) {
        if (!entry.fill.empty()) return;
        const double middle = entry.x + legend_sample / 2;
        const auto sign = [&](int type, double size, const std::string& color) {
            line(fmt::format("set label \"\" at {} point pointtype {} pointsize {} linewidth {:g} linecolor \"{}\"",
                             on_page(middle, entry.y), type, size * point_size(type), line_width(mark_line_width),
                             color));
        };
        if (entry.curve == nullptr) {
            const std::string grey = "#404040";
            sign(ring, ring_size, grey);
            arrow(on_page(middle + 4, entry.y), on_page(entry.x + legend_sample, entry.y), grey);
            return;
        }
        if (!entry.curve->points && entry.curve->line) return;
        const int type = point_type_of(entry.curve->mark);
        if (is_open(type)) sign(type + 1, 1, "#ffffff");
        sign(type, 1, color_of(entry.curve->color));
    }

    const Figure& figure_;
    const FigureLayout layout_;
    const GnuplotTerminal terminal_;
};

}  // namespace

std::string gnuplot_script(const Figure& figure, const std::string& terminal, const std::string& path) {
    return Script(figure, terminal, path).text;
}

}  // namespace polhode
