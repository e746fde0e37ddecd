#include "figure/figure_layout.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "figure/curve_style.h"

namespace polhode {

namespace {

// space around a panel's frame: tic labels and axis labels left and below, title above
constexpr double room_left = 46, room_right = 12, room_above = 20, room_below = 32;

// space between panels with shared axes
constexpr double gap = 10;

double panel_width(std::size_t columns) { return columns == 1 ? 260 : columns == 2 ? 254 : columns == 3 ? 200 : 180; }

// four panels fill the width of a page
double shared_plot_width(std::size_t columns) { return columns <= 2 ? 180 : columns == 3 ? 140 : 105; }

std::vector<LegendEntry> legend_entries(const Figure& figure) {
    std::vector<LegendEntry> entries;
    std::set<std::string> seen;
    bool cut = false;
    for (const Panel& panel : figure.panels) {
        if (!panel.map) continue;
        for (const MapClass& c : panel.map->classes)
            if (seen.insert(c.label).second) entries.push_back({c.label, nullptr, color_of_shade(c.shade)});
    }
    for (const Panel& panel : figure.panels) {
        for (const Curve& curve : panel.curves) {
            cut = cut || curve.cut;
            if (curve.label.empty() || !seen.insert(curve.label).second) continue;
            entries.push_back({curve.label, &curve, ""});
        }
    }
    if (cut) entries.push_back({"truncated curve", nullptr, ""});
    return entries;
}

std::string whole_note(const Figure& figure) {
    for (const Panel& panel : figure.panels)
        for (const Curve& curve : panel.curves)
            if (curve.cut) return figure.note + ' ' + figure.truncation_note;
    return figure.note;
}

/// Arranges the entries in columns as wide as the longest one. Returns the total height.
double place_legend(std::vector<LegendEntry>& entries, double top, double width) {
    if (entries.empty()) return 0;
    double widest = 0;
    for (const LegendEntry& entry : entries) widest = std::max(widest, text_width(entry.label, text_size));
    const double cell = legend_sample + 4 + widest + 10;
    const std::size_t most = std::max<std::size_t>(1, static_cast<std::size_t>((width - 12) / cell));
    const std::size_t rows = (entries.size() + most - 1) / most;
    const std::size_t columns = (entries.size() + rows - 1) / rows;
    const double left = std::max(6.0, (width - cell * static_cast<double>(columns) + 10) / 2);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::size_t column = i / rows;
        entries[i].x = left + cell * static_cast<double>(column);
        entries[i].y = top + line_height * (static_cast<double>(i % rows) + 0.5);
    }
    return line_height * static_cast<double>(rows) + 4;
}

std::vector<std::string> wrapped(const std::string& text, double width, double size) {
    std::vector<std::string> lines;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (!lines.empty() && text_width(lines.back() + ' ' + word, size) <= width) {
            lines.back() += ' ' + word;
        } else {
            lines.push_back(word);
        }
    }
    return lines;
}

}  // namespace

double text_width(const std::string& text, double size) {
    const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    return 0.56 * size * static_cast<double>(std::count_if(text.begin(), text.end(), starts_character));
}

FigureLayout layout_of(const Figure& figure) {
    FigureLayout layout;
    const std::size_t panels = std::max<std::size_t>(1, figure.panels.size());
    const std::size_t columns = std::min(panels, static_cast<std::size_t>(std::max(1, figure.columns)));
    const std::size_t rows = (panels + columns - 1) / columns;
    const double top = figure.title.empty() ? 2 : 18;
    const bool shared = figure.shared_axes;
    const double plot_width = shared ? shared_plot_width(columns) : panel_width(columns) - room_left - room_right;
    const double plot_height = std::round(0.72 * plot_width);
    const double across = shared ? gap : room_left + room_right, down = room_above + (shared ? 0 : room_below);
    layout.width = static_cast<double>(columns) * (plot_width + across) + (shared ? room_left + room_right - gap : 0);
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        const std::size_t row = i / columns, column = i % columns;
        const double left = room_left + static_cast<double>(column) * (plot_width + across);
        const double upper = top + room_above + static_cast<double>(row) * (plot_height + down);
        layout.plots.push_back({left, upper, left + plot_width, upper + plot_height});
        layout.labels_x.push_back(!shared || i + columns >= figure.panels.size());
        layout.labels_y.push_back(!shared || column == 0);
    }
    double bottom = top + static_cast<double>(rows) * (plot_height + down) + (shared ? room_below : 0) + 4;
    layout.legend = legend_entries(figure);
    bottom += place_legend(layout.legend, bottom, layout.width);
    layout.note_lines = wrapped(whole_note(figure), layout.width - 16, text_size);
    layout.first_note_line = bottom + line_height / 2;
    layout.height = std::ceil(bottom + line_height * static_cast<double>(layout.note_lines.size()) + 4);
    return layout;
}

}  // namespace polhode
