#include "app/polhode_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace polhode {
namespace {

using V = Vector3<double>;

constexpr double most_drawn_ratio = 3;
constexpr double pi = std::numbers::pi;

V unit(const V& v) { return (1 / std::hypot(v[0], v[1], v[2])) * v; }

}  // namespace

Vector3<double> drawn_semi_axes(const Vector3<double>& semi_axes) {
    const double longest = std::max({semi_axes[0], semi_axes[1], semi_axes[2]});
    const double shortest = std::min({semi_axes[0], semi_axes[1], semi_axes[2]});
    const double ratio = longest / shortest;
    const double power = ratio > most_drawn_ratio ? std::log(most_drawn_ratio) / std::log(ratio) : 1;
    V drawn;
    for (int i = 0; i < 3; ++i)
        drawn[i] = power == 1 ? semi_axes[i] / longest : std::pow(semi_axes[i] / longest, power);
    return drawn;
}

PolhodeView::PolhodeView(const PolhodeCurve& polhode, const Vector3<double>& toward, const Vector3<double>& right)
    : semi_axes_(polhode.semi_axes),
      drawn_(drawn_semi_axes(polhode.semi_axes)),
      toward_(toward),
      right_(right),
      up_(cross(toward, right)) {}

V PolhodeView::on_sphere(const V& rate) const {
    return {rate[0] / semi_axes_[0], rate[1] / semi_axes_[1], rate[2] / semi_axes_[2]};
}

PagePoint PolhodeView::at(const V& rate) const {
    const V s = on_sphere(rate), d(s[0] * drawn_[0], s[1] * drawn_[1], s[2] * drawn_[2]);
    return {dot(d, right_), dot(d, up_)};
}

// Returns whether the ray from the point to the viewer, s + t m with t > 0, intersects the unit sphere.
bool PolhodeView::hidden(const V& rate) const {
    constexpr double grain = 1e-3;  // simplified curves consist of chords that enter the ellipsoid by this much
    const V s = on_sphere(rate), m(toward_[0] / drawn_[0], toward_[1] / drawn_[1], toward_[2] / drawn_[2]);
    const double ss = dot(s, s), sm = dot(s, m), mm = dot(m, m);
    if (sm >= 0) return ss < 1 - 10 * grain;
    return ss - sm * sm / mm < 1 - grain;
}

VisibleLine PolhodeView::seen(const Polyline& line) const {
    VisibleLine seen;
    if (line.empty()) return seen;
    bool behind = hidden(line[0]);
    std::vector<PagePoint> part{at(line[0])};
    const auto finish = [&] {
        if (!part.empty()) (behind ? seen.behind : seen.front).push_back(part);
    };
    for (std::size_t i = 1; i < line.size(); ++i) {
        const bool now = hidden(line[i]);
        if (now != behind) {
            // find the point where visibility changes by bisection
            V first = line[i - 1], last = line[i];
            for (int k = 0; k < 12; ++k) {
                const V middle = 0.5 * (first + last);
                (hidden(middle) == behind ? first : last) = middle;
            }
            part.push_back(at(last));
            finish();
            part = {at(last)};
            behind = now;
        }
        part.push_back(at(line[i]));
    }
    finish();
    return seen;
}

std::vector<PagePoint> PolhodeView::outline() const {
    // the great circle of the unit sphere normal to m
    const V m = unit({toward_[0] / drawn_[0], toward_[1] / drawn_[1], toward_[2] / drawn_[2]});
    const V a = unit(cross(m, std::abs(m[2]) < 0.9 ? V(0, 0, 1) : V(1, 0, 0))), b = cross(m, a);
    std::vector<PagePoint> points;
    for (int k = 0; k <= 72; ++k) {
        const V s = std::cos(2 * pi * k / 72) * a + std::sin(2 * pi * k / 72) * b;
        points.push_back(at({s[0] * semi_axes_[0], s[1] * semi_axes_[1], s[2] * semi_axes_[2]}));
    }
    return points;
}

std::vector<Polyline> PolhodeView::wires() const {
    constexpr int pieces = 48, meridians = 6, parallels = 5;
    const auto on_ellipsoid = [&](double latitude, double longitude) {
        return V(semi_axes_[0] * std::cos(latitude) * std::cos(longitude),
                 semi_axes_[1] * std::cos(latitude) * std::sin(longitude), semi_axes_[2] * std::sin(latitude));
    };
    std::vector<Polyline> wires;
    for (int i = 0; i < meridians; ++i) {
        Polyline& line = wires.emplace_back();
        for (int k = 0; k <= pieces; ++k) line.push_back(on_ellipsoid(2 * pi * k / pieces, pi * i / meridians));
    }
    for (int i = 0; i < parallels; ++i) {
        Polyline& line = wires.emplace_back();
        for (int k = 0; k <= pieces; ++k)
            line.push_back(on_ellipsoid(pi * (i + 1) / (parallels + 1) - pi / 2, 2 * pi * k / pieces));
    }
    return wires;
}

}  // namespace polhode
