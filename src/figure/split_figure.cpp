#include "figure/split_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "figure/axis.h"

namespace polhode {
namespace {

struct RankedCurve {
    std::string label, group;
    double rank = 0;  ///< mean over the panels; lower is better
};

/// The sort key of a curve in its panel: lower is better; `second` breaks ties of `first`.
struct CurveScore {
    double first = std::numeric_limits<double>::infinity(), second = std::numeric_limits<double>::infinity();
    bool operator<(const CurveScore& other) const {
        return first != other.first ? first < other.first : second < other.second;
    }
};

struct DrawablePoint {
    double x, y;
};
std::vector<DrawablePoint> points_of(const Panel& panel, const Curve& curve) {
    std::vector<DrawablePoint> points;
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i)
        if (drawable(curve.x[i], panel.log_x) && drawable(curve.y[i], panel.log_y))
            points.push_back({curve.x[i], curve.y[i]});
    return points;
}

double lowest(const std::vector<DrawablePoint>& points) {
    double least = std::numeric_limits<double>::infinity();
    for (const DrawablePoint& point : points) least = std::min(least, point.y);
    return least;
}

/// The y that at least half of the curves reach (their median minimum).
double common_level(const std::vector<std::vector<DrawablePoint>>& curves) {
    std::vector<double> least;
    for (const auto& points : curves)
        if (!points.empty()) least.push_back(lowest(points));
    if (least.empty()) return 0;
    std::ranges::sort(least);
    return least[(least.size() - 1) / 2];
}

/// The x at which the curve reaches the level; linear interpolation between points as drawn.
std::optional<double> crossing_of_level(const Panel& panel, const std::vector<DrawablePoint>& points, double level,
                                        bool at_least) {
    const auto to = [](double v, bool logarithmic) { return logarithmic ? std::log(v) : v; };
    std::optional<double> best;
    const auto take = [&](double x) {
        if (!best || (at_least ? x < *best : x > *best)) best = x;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].y > level) continue;
        take(points[i].x);
        for (const std::size_t j : {i - 1, i + 1}) {
            if (j >= points.size() || points[j].y <= level) continue;
            const double from = to(points[i].y, panel.log_y), over = to(points[j].y, panel.log_y);
            const double share = (to(level, panel.log_y) - from) / (over - from);
            const double a = to(points[i].x, panel.log_x), b = to(points[j].x, panel.log_x);
            const double x = a + share * (b - a);
            take(panel.log_x ? std::exp(x) : x);
        }
    }
    return best;
}

CurveScore score(const Panel& panel, const std::vector<DrawablePoint>& points, double level, Best best) {
    if (points.empty()) return {};
    if (best == Best::lowest_end) return {points.back().y, 0};
    const std::optional<double> x = crossing_of_level(panel, points, level, best == Best::least_x);
    // curves that do not reach the level come last, ordered by their minimum
    if (!x) return {std::numeric_limits<double>::max(), lowest(points)};
    return {best == Best::least_x ? *x : -*x, 0};
}

std::vector<RankedCurve> ranking(const Figure& figure) {
    std::vector<RankedCurve> all;
    std::map<std::string, std::size_t> place;
    for (const Panel& panel : figure.panels)
        for (const Curve& curve : panel.curves)
            if (!curve.label.empty() && !curve.group.empty() && !points_of(panel, curve).empty() &&
                place.emplace(curve.label, all.size()).second)
                all.push_back({curve.label, curve.group});
    std::vector<double> sum(all.size());
    for (const Panel& panel : figure.panels) {
        std::vector<std::vector<DrawablePoint>> curves(all.size());
        for (const Curve& curve : panel.curves)
            if (const auto found = place.find(curve.label); found != place.end() && curves[found->second].empty())
                curves[found->second] = points_of(panel, curve);
        const double level = common_level(curves);
        std::vector<CurveScore> scores;
        for (const auto& points : curves) scores.push_back(score(panel, points, level, figure.best));
        for (std::size_t i = 0; i < all.size(); ++i)
            sum[i] += static_cast<double>(
                std::ranges::count_if(scores, [&](const CurveScore& other) { return other < scores[i]; }));
    }
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i].rank = sum[i] / static_cast<double>(std::max<std::size_t>(1, figure.panels.size()));
    return all;
}

/// The labels of the overview: the best of each group, then the next best.
std::vector<std::string> chosen(const std::vector<RankedCurve>& all, std::size_t most) {
    std::vector<const RankedCurve*> order;
    for (const RankedCurve& one : all) order.push_back(&one);
    std::ranges::stable_sort(order, {}, [](const RankedCurve* one) { return one->rank; });
    std::vector<std::string> labels, groups;
    for (const RankedCurve* one : order)
        if (labels.size() < most && std::ranges::find(groups, one->group) == groups.end())
            labels.push_back(one->label), groups.push_back(one->group);
    for (const RankedCurve* one : order)
        if (labels.size() < most && std::ranges::find(labels, one->label) == labels.end()) labels.push_back(one->label);
    return labels;
}

Figure select_curves(const Figure& whole, const std::vector<std::string>& labels) {
    Figure figure = whole;
    for (Panel& panel : figure.panels)
        std::erase_if(panel.curves, [&](const Curve& curve) {
            return !curve.label.empty() && !curve.group.empty() &&
                   std::ranges::find(labels, curve.label) == labels.end();
        });
    return figure;
}

std::string describe_criterion(Best best) {
    switch (best) {
        case Best::least_x:
            return "the curve furthest left at the level that half of all curves reach";
        case Best::greatest_x:
            return "the curve furthest right at the level that half of all curves reach";
        case Best::lowest_end:
            break;
    }
    return "the curve that ends lowest";
}

}  // namespace

std::vector<NamedFigure> split_figure(const NamedFigure& whole, std::size_t most) {
    const std::vector<RankedCurve> all = ranking(whole.figure);
    if (all.size() <= most || most == 0) return {whole};
    std::vector<std::string> groups;
    std::map<std::string, std::vector<std::string>> members;
    for (const RankedCurve& one : all) {
        if (!members.contains(one.group)) groups.push_back(one.group);
        members[one.group].push_back(one.label);
    }
    const std::vector<std::string> best = chosen(all, most);
    std::vector<NamedFigure> parts;
    for (const std::string& group : groups) {
        const std::vector<std::string>& labels = members[group];
        if (std::ranges::all_of(labels,
                                [&](const std::string& label) { return std::ranges::find(best, label) != best.end(); }))
            continue;
        const std::size_t pieces = (labels.size() + most - 1) / most;
        for (std::size_t piece = 0; piece < pieces; ++piece) {
            const auto edge = [&](std::size_t k) {
                return labels.begin() + static_cast<std::ptrdiff_t>(labels.size() * k / pieces);
            };
            NamedFigure part{whole.name + "_" + group, select_curves(whole.figure, {edge(piece), edge(piece + 1)})};
            part.figure.title += ": " + group;
            if (pieces > 1) {
                part.name += fmt::format("_{}", piece + 1);
                part.figure.title += fmt::format(", {} of {}", piece + 1, pieces);
            }
            parts.push_back(std::move(part));
        }
    }
    NamedFigure overview{whole.name, select_curves(whole.figure, best)};
    std::string note = fmt::format(
        "{} of {} curves: the best of each family, then the next best. The best is {}, by mean rank over the "
        "panels. Figures of complete families:",
        most, all.size(), describe_criterion(whole.figure.best));
    for (const NamedFigure& part : parts) note += fmt::format(" {}{}", part.name, &part == &parts.back() ? "." : ",");
    overview.figure.note += (overview.figure.note.empty() ? "" : " ") + note;
    parts.insert(parts.begin(), std::move(overview));
    return parts;
}

}  // namespace polhode
