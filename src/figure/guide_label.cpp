#include "figure/guide_label.h"

#include <algorithm>
#include <cmath>

namespace polhode {
namespace {

// The guide's height at x; the guide is drawn from left to right.
double height_at(const std::vector<Point>& guide, double x) {
    for (std::size_t i = 1; i < guide.size(); ++i)
        if (guide[i].x >= x) {
            const Point &from = guide[i - 1], &to = guide[i];
            return to.x > from.x ? from.y + (to.y - from.y) * std::clamp((x - from.x) / (to.x - from.x), 0.0, 1.0)
                                 : to.y;
        }
    return guide.back().y;
}

// How much of the curves and their marks the rectangle covers: the number of points sampled along them, several per
// segment.
long covered_points(const Rectangle& label, const std::vector<std::vector<Point>>& curves) {
    constexpr int pieces = 16;
    constexpr double mark = 2.5;
    long inside = 0;
    const auto count = [&](double x, double y, double beyond) {
        if (x > label.left - beyond && x < label.right + beyond && y > label.top - beyond && y < label.bottom + beyond)
            ++inside;
    };
    for (const std::vector<Point>& curve : curves)
        for (std::size_t i = 0; i < curve.size(); ++i) {
            const Point &from = curve[i], &to = curve[i + 1 < curve.size() ? i + 1 : i];
            count(from.x, from.y, mark);
            // the label may lie between two distant points
            const int steps = std::max(pieces, static_cast<int>(std::abs(to.x - from.x) + std::abs(to.y - from.y)));
            for (int k = 1; k < steps; ++k)
                count(from.x + (to.x - from.x) * k / steps, from.y + (to.y - from.y) * k / steps, 0);
        }
    return inside;
}

}  // namespace

std::optional<GuideLabel> guide_label(const std::string& text, double size, const std::vector<Point>& guide,
                                      const std::vector<std::vector<Point>>& curves, const Rectangle& plot) {
    constexpr double margin = 3;
    constexpr int places = 24;
    const double width = text_width(text, size), height = size + 2;
    const double first = guide.front().x + margin, last = guide.back().x - margin - width;
    std::optional<GuideLabel> best;
    // try the ends first, then the positions in between
    for (int i = 0; i <= places; ++i)
        for (const bool above : {true, false}) {
            const int k = i == 0 ? places : i == 1 ? 0 : i - 1;
            Rectangle label;
            label.left = first + (last - first) * k / places;
            if (k == places) label.left = last;
            label.right = label.left + width;
            const bool right = k == places;
            double edge = height_at(guide, label.left);
            for (const Point& point : guide)
                if (point.x >= label.left && point.x <= label.right)
                    edge = above ? std::min(edge, point.y) : std::max(edge, point.y);
            const double there = height_at(guide, label.right);
            edge = above ? std::min(edge, there) : std::max(edge, there);
            label.top = above ? edge - 1 - height : edge + 1;
            label.bottom = label.top + height;
            if (label.top < plot.top || label.bottom > plot.bottom) continue;
            if (label.left < plot.left || label.right > plot.right) continue;
            const long hidden = covered_points(label, curves);
            if (best && hidden >= best->covered_points) continue;
            best = GuideLabel{right ? label.right : label.left, (label.top + label.bottom) / 2, right, hidden};
            if (hidden == 0) return best;
        }
    return best;
}

}  // namespace polhode
