#include "check/impact_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "body/orientation.h"
#include "motion/contact.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

// What one plane sees of the body in a row.
struct Approach {
    double distance = 0;  // of the nearest piece, m
    double rate = 0;      // of that piece, m/s
    std::size_t piece = 0;
    double second = 0;  // distance of the next piece, m
};

Approach approach(const ContactGeometry<double>& geometry, std::size_t plane, const Placement<double>& at) {
    Approach found;
    found.distance = found.second = HUGE_VAL;
    for (std::size_t i = 0; i < geometry.pieces.size(); ++i) {
        const Gap<double> gap = geometry.gap(plane * geometry.pieces.size() + i, at);
        if (gap.distance < found.distance)
            found = {gap.distance, gap.rate, i, found.distance};
        else
            found.second = std::min(found.second, gap.distance);
    }
    return found;
}

// largest acceleration of a constant field, m/s^2
double gravity_of(const Scene& scene) {
    double sum = 0;
    for (const Load& load : scene.loads)
        if (const auto* g = std::get_if<Gravity>(&load)) sum += length(g->acceleration_W);
    return sum;
}

}  // namespace

std::vector<Diagnosis> impact_faults(const Scene& scene, const TrajectoryFile& file) {
    if (scene.planes.empty() || !scene.body.source || !file.has_angular_velocity || !file.has_velocity ||
        !(file.has_position || file.has_origin) || file.rows.size() < 3)
        return {};
    const ExactBody<double> body = exact_body<double>(scene);
    const ContactGeometry<double> geometry = contact_geometry<double>(scene, body.center, {});
    const double gravity = gravity_of(scene);
    std::vector<Placement<double>> rows;
    for (const TrajectoryRow& row : file.rows) {
        const Quaternion<double> q = normalized(row.q);
        const Vector3<double> origin = file.has_origin ? rotate(q, body.center) : Vector3<double>();
        rows.push_back({q, row.position_W + origin, row.velocity_W, row.angular_velocity_W});
    }
    std::vector<Diagnosis> told;
    for (std::size_t plane = 0; plane < geometry.planes.size(); ++plane) {
        std::vector<double> returned;
        double deepest = 0, deepest_at = 0, entered_at = 0;
        int inside = 0, longest_inside = 0;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const Approach now = approach(geometry, plane, rows[k]);
            // deeper than a step's way: no contact was seen
            const double dt = k > 0 ? file.rows[k].t - file.rows[k - 1].t : 0;
            const double way = (length(rows[k].velocity_W) + length(rows[k].angular_velocity_W) * geometry.reach) * dt;
            if (-now.distance > 2 * way + 0.02 * geometry.reach) {
                if (inside++ == 0) entered_at = file.rows[k].t;
                longest_inside = std::max(longest_inside, inside);
                if (-now.distance > deepest) deepest = -now.distance, deepest_at = file.rows[k].t;
            } else
                inside = 0;
            if (k + 1 == rows.size()) continue;
            const double ahead = file.rows[k + 1].t - file.rows[k].t;
            const double after = geometry.gap(plane * geometry.pieces.size() + now.piece, rows[k + 1]).rate;
            const double spin = dot(rows[k].angular_velocity_W, rows[k].angular_velocity_W) * geometry.reach;
            const double change = (gravity + spin) * ahead;  // of the rate, within a row
            if (now.rate < -40 * change && std::abs(now.distance) < -2 * now.rate * ahead &&
                now.second - now.distance > -4 * now.rate * ahead && after > -change)
                returned.push_back(-after / now.rate);
        }
        // a body that rests may sink a little; one that went through is gone
        if (longest_inside >= 3 && deepest > geometry.reach) {
            told.push_back({"impact_missed",
                            fmt::format("the body passes through plane {} at t = {:.6g} s, and is {:.3g} m behind it "
                                        "at t = {:.6g} s; let the engine collide the body with the plane, in shorter "
                                        "steps or with continuous detection where it is fast",
                                        plane, entered_at, deepest, deepest_at),
                            "", 1, 0});
            continue;
        }
        if (returned.empty()) continue;
        std::ranges::sort(returned);
        const double found = returned[returned.size() / 2], wanted = geometry.planes[plane].restitution;
        if (std::abs(found - wanted) > 0.08)
            told.push_back({"restitution_wrong",
                            fmt::format("impacts on plane {} give back {:.3g} of the normal speed (the median of {}) "
                                        "where its restitution is {:.3g}; give the engine the scene's restitution, and "
                                        "see how it combines those of two bodies",
                                        plane, found, returned.size(), wanted),
                            "", std::abs(found - wanted), 0});
    }
    return told;
}

}  // namespace polhode
