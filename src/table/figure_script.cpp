// The gnuplot script of a figure.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "table/axis.h"
#include "table/curve_style.h"
#include "table/decimal.h"
#include "table/figure.h"
#include "table/figure_layout.h"
#include "table/gnuplot_terminal.h"
#include "table/guide_label.h"

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

/// Writes the script of one figure; sizes in points, times `unit` in the terminal's own.
class Script {
  public:
    Script(const Figure& figure, const std::string& terminal, const std::string& path)
        : figure_(figure), layout_(layout_of(figure)), terminal_(terminal) {
        text = terminal_.opening(layout_.width, layout_.height, text_size, path);
        line("set multiplot");
        line("unset key");
        for (std::size_t i = 0; i < figure.panels.size(); ++i) panel(i);
        page();
        line("unset multiplot");
        line("unset output");
    }

    std::string text;

  private:
    void line(const std::string& command) { text += command + '\n'; }

    std::string font(double points) const { return terminal_.font(points); }
    double line_width(double points) const { return terminal_.line_width(points); }
    /// The terminals draw circles and squares smaller than the other markers, by shares of their own.
    double point_size(int marker) const {
        const bool small = marker <= 7;
        return terminal_.svg() ? (small ? 0.52 : 0.48) : (small ? 0.40 : 0.54);
    }

    std::string on_page(double x, double y) const {
        return fmt::format("screen {:.5f},{:.5f}", x / layout_.width, 1 - y / layout_.height);
    }

    void frame(const Rectangle& plot) {
        line(fmt::format("set lmargin at screen {:.5f}", plot.left / layout_.width));
        line(fmt::format("set rmargin at screen {:.5f}", plot.right / layout_.width));
        line(fmt::format("set tmargin at screen {:.5f}", 1 - plot.top / layout_.height));
        line(fmt::format("set bmargin at screen {:.5f}", 1 - plot.bottom / layout_.height));
    }

    void axis(char name, const Axis& axis) {
        line(fmt::format("{} logscale {}", axis.logarithmic ? "set" : "unset", name));
        line(fmt::format("set {}range [{}:{}]", name, shortest_decimal(axis.low), shortest_decimal(axis.high)));
        std::string tics;
        for (const Tic& tic : axis.tics) {
            tics += fmt::format("{}\"{}\" {} {}", tics.empty() ? "" : ", ", tic.label, tic.position,
                                tic.label.empty() ? 1 : 0);
        }
        line(fmt::format("set {}tics nomirror scale 0.6,0.3 offset {} ({})", name, name == 'x' ? "0,0.2" : "0.4,0",
                         tics));
    }

    void panel(std::size_t index) {
        const Panel& panel = figure_.panels[index];
        const Rectangle& plot = layout_.plots[index];
        frame(plot);
        line(fmt::format("set border 15 linewidth {:g} linecolor \"#404040\"", line_width(0.5)));
        const double middle = (plot.left + plot.right) / 2;
        const auto label = [&](const std::string& words, double x, double y, const std::string& style, double size) {
            if (words.empty()) return;
            line(fmt::format("set label {} at {} center {} noenhanced front font {}", gnuplot_quoted_line(words),
                             on_page(x, y), style, font(size)));
        };
        label(panel.title, middle, plot.top - 8, "", title_size);
        label(panel.x_label, middle, plot.bottom + 21, "", text_size);
        label(panel.y_label, plot.left - 38, (plot.top + plot.bottom) / 2, "rotate by 90", text_size);

        std::vector<std::vector<Point>> curves;
        std::optional<Point> low, high;
        for (const Curve& curve : panel.curves) {
            curves.push_back(drawable_points(panel, curve));
            for (const Point& point : curves.back()) {
                low = low ? Point{std::min(low->x, point.x), std::min(low->y, point.y)} : point;
                high = high ? Point{std::max(high->x, point.x), std::max(high->y, point.y)} : point;
            }
        }
        if (low) {
            // room for markers and the arrows of cut curves; a time axis without them ends where its data end
            const bool cut =
                std::any_of(panel.curves.begin(), panel.curves.end(), [](const Curve& c) { return c.cut; });
            const double x_labels = (plot.right - plot.left) / (panel.log_x ? 24 : 32);
            const double y_labels = (plot.bottom - plot.top) / 16;
            const Axis x =
                make_axis(panel.log_x, low->x, high->x, static_cast<int>(x_labels), panel.log_x || cut ? 0.07 : 0);
            const Axis y = make_axis(panel.log_y, low->y, high->y, static_cast<int>(y_labels), 0.08);
            axis('x', x);
            axis('y', y);
            factor(x, plot.right, plot.bottom + 21);
            factor(y, plot.left + 6, plot.top - 6);
            line(fmt::format("set grid xtics ytics linewidth {:g} dashtype solid linecolor \"#dddddd\"",
                             line_width(0.4)));
            const std::string guides = guides_of(panel, curves, plot, x, y);
            curves_of(panel, curves, guides, plot, x, y);
        } else {
            label("no point to draw", middle, (plot.top + plot.bottom) / 2, "textcolor \"#808080\"", text_size);
            nothing();
        }
        line("unset label");
        line("unset arrow");
    }

    /// The power of ten that an axis' labels leave out, ending at x.
    void factor(const Axis& axis, double x, double y) {
        if (axis.factor_exponent == 0) return;
        const std::string sign = axis.factor_exponent < 0 ? "−" : "";
        line(fmt::format("set label \"×10^{{{}{}}}\" at {} right front font {}", sign, std::abs(axis.factor_exponent),
                         on_page(x, y), font(text_size)));
    }

    /// An empty frame: gnuplot draws labels and arrows only with a plot.
    void nothing() { bare("2 notitle"); }

    /// The unit square without axes, tics or grid, and in it the elements.
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

    /// Where a point stands on the page.
    static Point place(const Point& point, const Rectangle& plot, const Axis& x, const Axis& y) {
        return {plot.left + fraction(x, point.x) * (plot.right - plot.left),
                plot.bottom - fraction(y, point.y) * (plot.bottom - plot.top)};
    }

    /// Data and labels of the guides that are to be seen, and the elements that plot them.
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
                points = drawable_points(panel, {{}, 0, 0, false, false, guide.x, guide.y});
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
                line(fmt::format("set label {} at {} {} noenhanced front textcolor \"{}\" font {}",
                                 gnuplot_quoted_line(guide.label), on_page(label->x, label->y),
                                 label->ends_there ? "right" : "left", guide_color, font(size)));
        }
        return elements;
    }

    // a curve of one point is to be seen as well
    static constexpr double lone = 2;

    /// `guides`: the elements beneath, each with the comma after it.
    void curves_of(const Panel& panel, const std::vector<std::vector<Point>>& curves, const std::string& guides,
                   const Rectangle& plot, const Axis& x, const Axis& y) {
        std::string elements;
        const auto element = [&](const std::string& what) { elements += (elements.empty() ? "" : ", \\\n  ") + what; };
        for (std::size_t i = 0; i < curves.size(); ++i) {
            const Curve& curve = panel.curves[i];
            const std::vector<Point>& points = curves[i];
            if (points.empty()) continue;
            data(i, points);
            const std::size_t marked = points.size() - (curve.cut ? 1 : 0);
            element(fmt::format("$curve{} using 1:2 with lines linewidth {:g} dashtype {} linecolor \"{}\"", i,
                                line_width(0.9), dash_of(curve), color_of(curve)));
            if (curve.points && marked > 0) {
                element(
                    fmt::format("$curve{} using 1:2 every {}::0::{} with points pointtype {} pointsize {} "
                                "linecolor \"{}\"",
                                i, (points.size() + 39) / 40, marked - 1, marker_of(curve),
                                (marked == 1 ? lone : 1) * point_size(marker_of(curve)), color_of(curve)));
            }
            if (!curve.cut) continue;
            const std::string last = fmt::format("$curve{} using 1:2 every ::{} with points", i, points.size() - 1);
            element(fmt::format("{} pointtype {} pointsize {} linecolor \"#ffffff\"", last, marker_of(curve),
                                point_size(marker_of(curve))));
            element(fmt::format("{} pointtype {} pointsize {} linewidth {:g} linecolor \"{}\"", last,
                                marker_of(curve) - 1, point_size(marker_of(curve)), line_width(0.8), color_of(curve)));
            onward_arrow(points, plot, x, y, color_of(curve));
        }
        line("plot " + guides + elements);
    }

    /// From the last point on in the curve's last direction as drawn, within the frame. A single point has none.
    void onward_arrow(const std::vector<Point>& points, const Rectangle& plot, const Axis& x, const Axis& y,
                      const std::string& color) {
        const Point last = place(points.back(), plot, x, y);
        for (std::size_t i = points.size() - 1; i-- > 0;) {
            const Point before = place(points[i], plot, x, y);
            const double length = std::hypot(last.x - before.x, last.y - before.y);
            if (length < 1) continue;
            const Point direction{(last.x - before.x) / length, (last.y - before.y) / length};
            const double begin = 2.5, end = 11;
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

    /// What belongs to the page: title, legend, note.
    void page() {
        frame({0, 0, layout_.width, layout_.height});
        line("unset border");
        const auto label = [&](const std::string& words, double x, double y, const char* place, double size) {
            line(fmt::format("set label {} at {} {} noenhanced font {}", gnuplot_quoted_line(words), on_page(x, y),
                             place, font(size)));
        };
        if (!figure_.title.empty()) label(figure_.title, layout_.width / 2, 10, "center", figure_title_size);
        // the lines of the legend are plotted: the SVG terminal runs arrows of one colour into one dash pattern
        std::string lines;
        for (std::size_t i = 0; i < layout_.legend.size(); ++i) {
            const LegendEntry& entry = layout_.legend[i];
            legend_sign(entry);
            if (entry.curve != nullptr) lines += (lines.empty() ? "" : ", \\\n  ") + legend_line(i, entry);
            label(entry.label, entry.x + legend_sample + 4, entry.y, "left", text_size);
        }
        for (std::size_t i = 0; i < layout_.note_lines.size(); ++i) {
            label(layout_.note_lines[i], 8, layout_.first_note_line + line_height * static_cast<double>(i), "left",
                  text_size);
        }
        bare(lines.empty() ? "2 notitle" : lines);
    }

    /// The data block of an entry's line across its sign, in the page's unit square, and the element that plots it.
    std::string legend_line(std::size_t index, const LegendEntry& entry) {
        const double y = 1 - entry.y / layout_.height;
        line(fmt::format("$legend{} << END", index));
        line(fmt::format("{:.5f} {:.5f}", entry.x / layout_.width, y));
        line(fmt::format("{:.5f} {:.5f}", (entry.x + legend_sample) / layout_.width, y));
        line("END");
        return fmt::format("$legend{} using 1:2 with lines linewidth {:g} dashtype {} linecolor \"{}\" notitle", index,
                           line_width(0.9), dash_of(*entry.curve), color_of(*entry.curve));
    }

    void legend_sign(const LegendEntry& entry) {
        const double middle = entry.x + legend_sample / 2;
        const auto marker = [&](int type, const std::string& color) {
            line(fmt::format("set label \"\" at {} point pointtype {} pointsize {} linewidth {:g} linecolor \"{}\"",
                             on_page(middle, entry.y), type, point_size(type), line_width(0.8), color));
        };
        if (entry.curve == nullptr) {
            const std::string grey = "#404040";
            marker(6, grey);  // an open circle
            arrow(on_page(middle + 2.5, entry.y), on_page(entry.x + legend_sample, entry.y), grey);
            return;
        }
        if (entry.curve->points) marker(marker_of(*entry.curve), color_of(*entry.curve));
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
