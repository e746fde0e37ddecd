#include "figure/guide_label.h"

#include <algorithm>

namespace polhode {
namespace {

// How much of the curves the rectangle covers: points along them, a few to each piece.
long covered(const Rectangle& label, const std::vector<std::vector<Point>>& curves) {
    constexpr int pieces = 16;
    long inside = 0;
    for (const std::vector<Point>& curve : curves)
        for (std::size_t i = 0; i < curve.size(); ++i) {
            const Point &from = curve[i], &to = curve[i + 1 < curve.size() ? i + 1 : i];
            for (int k = 0; k < pieces; ++k) {
                const double x = from.x + (to.x - from.x) * k / pieces, y = from.y + (to.y - from.y) * k / pieces;
                if (x > label.left && x < label.right && y > label.top && y < label.bottom) ++inside;
            }
        }
    return inside;
}

}  // namespace

std::optional<GuideLabel> guide_label(const std::string& text, double size, const std::vector<Point>& guide,
                                      const std::vector<std::vector<Point>>& curves, const Rectangle& plot) {
    constexpr double margin = 3;
    const double width = text_width(text, size), height = size + 2;
    std::optional<GuideLabel> best;
    long least = 0;
    for (const bool right : {true, false})
        for (const bool above : {true, false}) {
            Rectangle label;
            label.right = right ? guide.back().x - margin : guide.front().x + margin + width;
            label.left = label.right - width;
            double edge = right ? guide.back().y : guide.front().y;
            for (const Point& point : guide)
                if (point.x >= label.left && point.x <= label.right)
                    edge = above ? std::min(edge, point.y) : std::max(edge, point.y);
            label.top = above ? edge - 1 - height : edge + 1;
            label.bottom = label.top + height;
            if (label.top < plot.top || label.bottom > plot.bottom) continue;
            if (label.left < plot.left || label.right > plot.right) continue;
            const long hidden = covered(label, curves);
            if (best && hidden >= least) continue;
            best = GuideLabel{right ? label.right : label.left, (label.top + label.bottom) / 2, right};
            least = hidden;
        }
    return best;
}

}  // namespace polhode
