#include "app/polhode_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "body/elementary.h"
#include "integrators/method.h"

namespace polhode {
namespace {

using V = Vector3<double>;

constexpr long samples = 8192;
// relative to the size of the ellipsoid; smaller distances are not visible
constexpr double resolution = 1e-3;

V quotient(const V& v, const V& scale) { return {v[0] / scale[0], v[1] / scale[1], v[2] / scale[2]}; }

double rotational_energy(const V& moments, const V& w) {
    return (moments[0] * w[0] * w[0] + moments[1] * w[1] * w[1] + moments[2] * w[2] * w[2]) / 2;
}

bool has_later_impulse(const Problem& problem) {
    if (!problem.scene.planes.empty()) return true;
    return std::any_of(problem.segments.begin() + 1, problem.segments.end(),
                       [](const Segment& segment) { return !segment.impulses.empty(); });
}

// Returns whether an impulse or impact occurs within begin < t <= end.
bool struck(const Problem& problem, const Trajectory& run, double begin, double end) {
    if (std::any_of(run.impact_times.begin(), run.impact_times.end(), [&](double t) { return begin < t && t <= end; }))
        return true;
    return std::any_of(problem.segments.begin(), problem.segments.end(), [&](const Segment& segment) {
        return !segment.impulses.empty() && begin < segment.begin && segment.begin <= end;
    });
}

// Returns the index at which a closed curve returns to its start after leaving it, or 0.
std::size_t find_period_end(const Polyline& line, const V& scale) {
    double travelled = 0;
    bool away = false;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double step = hypotenuse(quotient(line[i] - line[i - 1], scale));
        const double from_start = hypotenuse(quotient(line[i] - line[0], scale));
        travelled += step;
        away = away || from_start > std::max(3 * step, resolution);
        // about half a step from the start: the curve passes the start here
        if (away && from_start <= 0.75 * step && travelled > 2 * step) return i;
    }
    return 0;
}

// |w1 / w3| = sqrt(I3 (I3 - I2) / (I1 (I2 - I1))), with axes ordered by their moments.
std::vector<Polyline> separatrix_of(const V& moments, const V& semi_axes) {
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int i, int j) { return moments[i] < moments[j]; });
    const auto [a, b, c] = order;
    const double ratio = std::sqrt(moments[c] * (moments[c] - moments[b]) / (moments[a] * (moments[b] - moments[a])));
    const double outer = 1 / std::hypot(ratio / semi_axes[a], 1 / semi_axes[c]);
    std::vector<Polyline> ellipses;
    for (const double side : {1.0, -1.0}) {
        Polyline& line = ellipses.emplace_back();
        for (int k = 0; k <= 96; ++k) {
            const double angle = 2 * std::numbers::pi * k / 96;
            V w;
            w[b] = semi_axes[b] * std::cos(angle);
            w[c] = outer * std::sin(angle);
            w[a] = side * ratio * w[c];
            line.push_back(w);
        }
    }
    return ellipses;
}

void mark_vertices(const Polyline& line, const V& scale, double tolerance, std::size_t first, std::size_t last,
                   std::vector<bool>& is_vertex) {
    const V start = quotient(line[first], scale), along = quotient(line[last], scale) - start;
    const double squared = dot(along, along);
    double farthest = 0;
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i) {
        const V offset = quotient(line[i], scale) - start;
        const double share = squared > 0 ? std::clamp(dot(offset, along) / squared, 0.0, 1.0) : 0;
        const double distance = hypotenuse(offset - share * along);
        if (distance > farthest) farthest = distance, at = i;
    }
    if (farthest <= tolerance) return;
    is_vertex[at] = true;
    mark_vertices(line, scale, tolerance, first, at, is_vertex);
    mark_vertices(line, scale, tolerance, at, last, is_vertex);
}

}  // namespace

Polyline simplify(const Polyline& line, const Vector3<double>& scale, double tolerance) {
    if (line.size() < 3) return line;
    std::vector<bool> is_vertex(line.size(), false);
    is_vertex.front() = is_vertex.back() = true;
    mark_vertices(line, scale, tolerance, 0, line.size() - 1, is_vertex);
    Polyline result;
    for (std::size_t i = 0; i < line.size(); ++i)
        if (is_vertex[i]) result.push_back(line[i]);
    return result;
}

PolhodeCurve polhode_curve(const Problem& problem) {
    PolhodeCurve polhode;
    if (!std::holds_alternative<OneBody>(problem.system)) {
        polhode.fault = "a polhode requires a scene of one body with built-in loads";
        return polhode;
    }
    Settings settings;
    settings.samples = samples, settings.max_steps = 2'000'000, settings.seconds_limit = 2;
    const Trajectory run = solve(problem, *choose_method(problem).method, settings);
    if (run.status != Status::ok || run.samples.empty()) {
        polhode.fault = "the motion could not be solved within 2 s";
        return polhode;
    }
    const V& moments = polhode.moments = problem.body.principal.moments;
    const Quaternion<double>& q_BP = problem.body.principal.q_BP;
    polhode.body_axes = q_BP == Quaternion<double>{};
    polhode.free = problem.needs.torque_free && !has_later_impulse(problem);

    polhode.curve.emplace_back();
    double largest_energy = 0;
    for (std::size_t i = 0; i < run.samples.size(); ++i) {
        const Sample& sample = run.samples[i];
        if (i > 0 && struck(problem, run, run.samples[i - 1].t, sample.t)) polhode.curve.emplace_back();
        polhode.curve.back().push_back(rotate_back(q_BP, sample.angular_velocity_B));
        largest_energy = std::max(largest_energy, rotational_energy(moments, polhode.curve.back().back()));
    }
    polhode.until = run.samples.back().t;
    polhode.energy = rotational_energy(moments, polhode.curve.front().front());
    polhode.energy_of_start = polhode.energy > 0;
    if (!polhode.energy_of_start) polhode.energy = largest_energy;
    if (!(polhode.energy > 0)) return polhode;
    for (int i = 0; i < 3; ++i) polhode.semi_axes[i] = std::sqrt(2 * polhode.energy / moments[i]);

    if (polhode.free) {
        Polyline& line = polhode.curve.front();
        if (const std::size_t end = find_period_end(line, polhode.semi_axes); end > 0) {
            polhode.until = run.samples[end].t;
            line.resize(end);
            line.push_back(line.front());
            polhode.closed = true;
        }
        if (problem.needs.symmetry == Symmetry::asymmetric)
            polhode.separatrix = separatrix_of(moments, polhode.semi_axes);
    }
    for (Polyline& line : polhode.curve) line = simplify(line, polhode.semi_axes, resolution);
    return polhode;
}

}  // namespace polhode
