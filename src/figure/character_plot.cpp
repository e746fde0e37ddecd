// Draws a Figure with text characters.
//
// Canvas is a grid of characters; each holds a Braille pattern of 2 x 4 dots (U+2800 plus a bit mask), the pen that
// drew it last and an optional letter. Plotter maps each panel's axes to dots, draws guides and curves as dot lines,
// adds letters if there is no colour, and appends axes and the legend as text.

#include "figure/character_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "figure/axis.h"
#include "text/decimal.h"

namespace polhode {
namespace {

constexpr int no_pen = -1, guide_pen = -2;
constexpr std::string_view letters = "ox+*#@%&=$";
/// Cyan, yellow, magenta, green, red, blue: readable on dark and light backgrounds.
constexpr std::array<int, 6> color_codes = {36, 33, 35, 32, 31, 34};

std::size_t shown_width(std::string_view text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// The first `most` characters of a text; the last one is an ellipsis if the text is longer.
std::string cut(const std::string& text, std::size_t most) {
    if (shown_width(text) <= most) return text;
    std::string beginning;
    std::size_t count = 0;
    for (const char c : text) {
        if ((static_cast<unsigned char>(c) & 0xc0) != 0x80 && ++count >= most) break;
        beginning += c;
    }
    return beginning + "…";
}

std::string repeated(std::string_view piece, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += piece;
    return text;
}

/// UTF-8 of the Braille character U+2800 + bits.
std::string braille(int bits) {
    return {static_cast<char>(0xe2), static_cast<char>(0xa0 | (bits >> 6)), static_cast<char>(0x80 | (bits & 0x3f))};
}

/// A canvas of Braille characters, two dots wide and four dots high each.
class Canvas {
  public:
    Canvas(int columns, int rows)
        : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

    int dots_wide() const { return 2 * columns_; }
    int dots_high() const { return 4 * rows_; }

    void dot(int x, int y, int pen) {
        if (x < 0 || x >= dots_wide() || y < 0 || y >= dots_high()) return;
        // bit numbers of the dots of a Braille pattern
        constexpr int bit[4][2] = {{0, 3}, {1, 4}, {2, 5}, {6, 7}};
        Cell& cell = at(x / 2, y / 4);
        cell.bits |= 1 << bit[y % 4][x % 2];
        cell.pen = pen;
    }
    void sign(int column, int row, char letter, int pen) {
        Cell& cell = at(column, row);
        cell.letter = letter, cell.pen = pen;
    }
    /// Draws every `stride`-th dot of a line.
    void line(double x0, double y0, double x1, double y1, int pen, int stride = 1) {
        const int steps = std::max(1, static_cast<int>(std::ceil(std::max(std::abs(x1 - x0), std::abs(y1 - y0)))));
        for (int k = 0; k <= steps; k += stride) {
            const double share = static_cast<double>(k) / steps;
            dot(static_cast<int>(std::lround(x0 + share * (x1 - x0))),
                static_cast<int>(std::lround(y0 + share * (y1 - y0))), pen);
        }
    }
    /// A row of characters without trailing blanks.
    std::string row(int r, bool color) const {
        int end = columns_;
        while (end > 0 && at(end - 1, r).bits == 0 && at(end - 1, r).letter == 0) --end;
        std::string text;
        int pen = no_pen;
        for (int c = 0; c < end; ++c) {
            const Cell& cell = at(c, r);
            const bool blank = cell.bits == 0 && cell.letter == 0;
            if (color && !blank && cell.pen != pen) {
                if (pen != no_pen) text += "\x1b[0m";
                text += escape(cell.pen);
                pen = cell.pen;
            }
            text += cell.letter != 0 ? std::string(1, cell.letter) : blank ? " " : braille(cell.bits);
        }
        if (color && pen != no_pen) text += "\x1b[0m";
        return text;
    }
    static std::string escape(int pen) {
        if (pen == guide_pen) return "\x1b[2m";
        const auto place = static_cast<std::size_t>(pen) % color_codes.size();
        // after the last colour, repeat the colours in bold
        return static_cast<std::size_t>(pen) / color_codes.size() % 2 == 0
                   ? fmt::format("\x1b[{}m", color_codes[place])
                   : fmt::format("\x1b[1;{}m", color_codes[place]);
    }

  private:
    struct Cell {
        int bits = 0, pen = no_pen;
        char letter = 0;
    };
    std::size_t place(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }
    Cell& at(int column, int row) { return cells_[place(column, row)]; }
    const Cell& at(int column, int row) const { return cells_[place(column, row)]; }

    int columns_, rows_;
    std::vector<Cell> cells_;
};

struct CanvasPoint {
    double x, y;
};
std::vector<CanvasPoint> drawable_points_of(const Panel& panel, const std::vector<double>& x,
                                            const std::vector<double>& y) {
    std::vector<CanvasPoint> points;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
        if (drawable(x[i], panel.log_x) && drawable(y[i], panel.log_y)) points.push_back({x[i], y[i]});
    return points;
}

struct TextTic {
    double value;
    std::string label;
};
std::vector<TextTic> text_tics(const Axis& axis) {
    std::vector<TextTic> tics;
    for (const Tic& tic : axis.tics) {
        if (tic.label.empty()) continue;
        const double value = parse_decimal(tic.position).value_or(std::numeric_limits<double>::quiet_NaN());
        const double place = fraction(axis, value);
        if (place >= 0 && place <= 1) tics.push_back({value, fmt::format("{:g}", value)});
    }
    return tics;
}

class Plotter {
  public:
    Plotter(const Figure& figure, const CharacterPlot& plot) : figure_(figure), plot_(plot) {
        plot_.width = std::max(40, plot.width), plot_.rows = std::max(4, plot.rows);
        for (const Panel& panel : figure.panels)
            for (const Curve& curve : panel.curves)
                if (!curve.label.empty()) pens_.try_emplace(curve.label, static_cast<int>(pens_.size()));
    }

    std::string text() {
        std::string all;
        if (!figure_.title.empty()) all += cut(figure_.title, width()) + "\n";
        for (const Panel& panel : figure_.panels) all += draw_panel(panel);
        return all + legend();
    }

  private:
    std::size_t width() const { return static_cast<std::size_t>(plot_.width); }
    bool uses_letters() const { return !plot_.color && pens_.size() > 1; }
    int pen_of(const Curve& curve) const {
        const auto found = pens_.find(curve.label);
        return found == pens_.end() ? guide_pen : found->second;
    }
    static char letter_of(int pen) { return letters[static_cast<std::size_t>(pen) % letters.size()]; }

    std::string draw_panel(const Panel& panel) const {
        std::string heading = panel.title;
        if (!panel.y_label.empty()) heading += (heading.empty() ? "" : ": ") + panel.y_label;
        heading = cut(heading, width()) + "\n";
        double low_x = std::numeric_limits<double>::infinity(), high_x = -low_x, low_y = low_x, high_y = -low_x;
        std::vector<std::vector<CanvasPoint>> curves;
        for (const Curve& curve : panel.curves) {
            curves.push_back(drawable_points_of(panel, curve.x, curve.y));
            for (const CanvasPoint& p : curves.back()) {
                low_x = std::min(low_x, p.x), high_x = std::max(high_x, p.x);
                low_y = std::min(low_y, p.y), high_y = std::max(high_y, p.y);
            }
        }
        if (!(low_x <= high_x)) return heading + "  no data to plot\n";
        if (panel.x_limits) low_x = panel.x_limits->low, high_x = panel.x_limits->high;
        if (panel.y_limits) low_y = panel.y_limits->low, high_y = panel.y_limits->high;
        const Axis y = make_axis(panel.log_y, low_y, high_y, std::max(3, plot_.rows * 2 / 5), 0.02);
        const std::vector<TextTic> y_tics = text_tics(y);
        std::size_t margin = 0;
        for (const TextTic& tic : y_tics) margin = std::max(margin, tic.label.size());
        const int columns = plot_.width - static_cast<int>(margin) - 1;
        const Axis x = make_axis(panel.log_x, low_x, high_x, std::max(2, columns / 12), 0);

        Canvas canvas(columns, plot_.rows);
        const auto dot_x = [&](double value) { return fraction(x, value) * (canvas.dots_wide() - 1); };
        const auto dot_y = [&](double value) { return (1 - fraction(y, value)) * (canvas.dots_high() - 1); };
        const auto trace = [&](const std::vector<CanvasPoint>& points, int pen, int stride) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                const CanvasPoint &from = points[i > 0 ? i - 1 : 0], &to = points[i];
                canvas.line(dot_x(from.x), dot_y(from.y), dot_x(to.x), dot_y(to.y), pen, stride);
            }
        };
        for (const Guide& guide : panel.guides) {
            const bool level = guide.x.empty() && guide.y.size() == 1;
            trace(level ? drawable_points_of(panel, {x.low, x.high}, {guide.y[0], guide.y[0]})
                        : drawable_points_of(panel, guide.x, guide.y),
                  guide_pen, 4);
        }
        for (std::size_t i = 0; i < curves.size(); ++i) trace(curves[i], pen_of(panel.curves[i]), 1);
        if (uses_letters())
            for (std::size_t i = 0; i < curves.size(); ++i)
                draw_letters(canvas, panel.curves[i], curves[i], dot_x, dot_y);

        std::vector<std::string> labels(static_cast<std::size_t>(plot_.rows));
        for (const TextTic& tic : y_tics)
            labels[static_cast<std::size_t>(std::lround(dot_y(tic.value))) / 4] = tic.label;
        std::string text = heading;
        for (int r = 0; r < plot_.rows; ++r) {
            const std::string& label = labels[static_cast<std::size_t>(r)];
            text += fmt::format("{:>{}}{}{}\n", label, margin, label.empty() ? "│" : "┤", canvas.row(r, plot_.color));
        }
        return text + x_axis(x, panel.x_label, static_cast<int>(margin), columns);
    }

    /// Marks the curve with its letter every few columns; different curves are offset from each other.
    template <class X, class Y>
    void draw_letters(Canvas& canvas, const Curve& curve, const std::vector<CanvasPoint>& points, const X& dot_x,
                      const Y& dot_y) const {
        constexpr int apart = 18;
        const int pen = pen_of(curve);
        if (pen < 0) return;
        int next = 2 + pen * apart / static_cast<int>(pens_.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const CanvasPoint &from = points[i > 0 ? i - 1 : 0], &to = points[i];
            const double begin = dot_x(from.x) / 2, end = dot_x(to.x) / 2;
            while (next < canvas.dots_wide() / 2 && begin <= next && next <= end) {
                const double share = end > begin ? (next - begin) / (end - begin) : 0;
                const double y = dot_y(from.y) + share * (dot_y(to.y) - dot_y(from.y));
                const int row = static_cast<int>(std::lround(y)) / 4;
                if (row >= 0 && row < canvas.dots_high() / 4) canvas.sign(next, row, letter_of(pen), pen);
                next += apart;
            }
        }
    }

    std::string x_axis(const Axis& axis, const std::string& label, int margin, int columns) const {
        std::vector<bool> marked(static_cast<std::size_t>(columns));
        std::string numbers;
        for (const TextTic& tic : text_tics(axis)) {
            const int column = static_cast<int>(std::lround(fraction(axis, tic.value) * (2 * columns - 1))) / 2;
            marked[static_cast<std::size_t>(column)] = true;
            // below its tic, within the line, clear of the previous label
            const int length = static_cast<int>(tic.label.size());
            const int begin = std::min(margin + 1 + column - length / 2, plot_.width - length);
            if (begin <= static_cast<int>(numbers.size()) && !numbers.empty()) continue;
            numbers +=
                std::string(static_cast<std::size_t>(std::max(0, begin - static_cast<int>(numbers.size()))), ' ');
            numbers += tic.label;
        }
        std::string text = std::string(static_cast<std::size_t>(margin), ' ') + "└";
        for (const bool mark : marked) text += mark ? "┬" : "─";
        text += "\n" + numbers + "\n";
        if (!label.empty()) text += fmt::format("{:>{}}\n", cut(label, width()), (plot_.width + margin) / 2 + 4);
        return text;
    }

    std::string legend() const {
        std::vector<std::pair<int, std::string>> entries;
        for (const auto& [label, pen] : pens_) entries.emplace_back(pen, label);
        std::ranges::sort(entries);
        std::string text, line;
        std::size_t used = 0;
        for (const auto& [pen, label] : entries) {
            const std::string words = cut(label, width() - 4);
            const std::size_t length = shown_width(words) + 4;
            if (used > 0 && used + 3 + length > width()) text += line + "\n", line.clear(), used = 0;
            if (used > 0) line += "   ", used += 3;
            const std::string sample = uses_letters() ? fmt::format("⠤{}⠤", letter_of(pen)) : repeated("⠤", 3);
            line += plot_.color ? fmt::format("{}{}\x1b[0m {}", Canvas::escape(pen), sample, words)
                                : fmt::format("{} {}", sample, words);
            used += length;
        }
        return line.empty() ? text : text + line + "\n";
    }

    const Figure& figure_;
    CharacterPlot plot_;
    std::map<std::string, int> pens_;
};

}  // namespace

std::string character_plot(const Figure& figure, const CharacterPlot& plot) { return Plotter(figure, plot).text(); }

}  // namespace polhode
