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

// The acceleration towards a plane where nothing but gravity acts, all the time; else there is none that is known.
std::optional<double> fall_towards(const Scene& scene, const Vector3<double>& normal_W) {
    double sum = 0;
    for (const Load& load : scene.loads) {
        const auto* g = std::get_if<Gravity>(&load);
        if (!g || g->window.from > 0 || std::isfinite(g->window.until)) return {};
        sum -= dot(g->acceleration_W, normal_W) / length(normal_W);
    }
    return sum;
}

// A row and the next, between which a body that does not turn comes back from a plane or stops there.
struct Bounce {
    double before = 0, after = 0;  // speed towards the plane, speed away from it, m/s
    double distance = 0;           // of the first row, m
    double h = 0;                  // s
    bool gone_on = false;          // the row before had left no room for the step: the bounce could have been there
};

// The bounces of a body that does not turn: then all of its points have one velocity.
std::vector<Bounce> bounces_of(const ContactGeometry<double>& geometry, std::size_t plane, const TrajectoryFile& file,
                               const std::vector<Placement<double>>& rows) {
    std::vector<Bounce> all;
    for (std::size_t k = 1; k + 1 < rows.size(); ++k) {
        if (length(rows[k].angular_velocity_W) > 0 || length(rows[k + 1].angular_velocity_W) > 0) return {};
        const Approach now = approach(geometry, plane, rows[k]), next = approach(geometry, plane, rows[k + 1]);
        const double h = file.rows[k + 1].t - file.rows[k].t;
        if (now.rate < 0 && next.rate >= 0 && now.distance < -2 * now.rate * h + 1e-9)
            all.push_back({-now.rate, next.rate, now.distance, h, now.distance < 0});
    }
    return all;
}

double share(const std::vector<Bounce>& bounces, auto&& is) {
    if (bounces.empty()) return 0;
    return static_cast<double>(std::ranges::count_if(bounces, is)) / static_cast<double>(bounces.size());
}

// What an engine does to bounces of a body that falls on a plane and does not turn.
std::optional<Diagnosis> bounce_fault(const std::vector<Bounce>& bounces, double gravity, double restitution,
                                      std::size_t plane) {
    constexpr double most = 0.7;
    if (bounces.size() < 2) return {};
    const auto comes_back_with = [](const Bounce& b, double speed) {
        return std::abs(b.after - speed) < 1e-6 * (b.before + speed);
    };
    const auto slowest_back = [&] {
        double slowest = HUGE_VAL;
        for (const Bounce& b : bounces)
            if (b.after > 1e-9 * b.before) slowest = std::min(slowest, b.before);
        return slowest;
    }();
    if (gravity > 0 && restitution > 0) {
        const auto by_whole_step = [&](const Bounce& b) {
            return comes_back_with(b, restitution * (b.before + gravity * b.h));
        };
        if (share(bounces, by_whole_step) >= most)
            return Diagnosis{
                "bounce_gains_energy",
                fmt::format("{} bounces on plane {} mirror the velocity after a whole step of gravity: each "
                            "gains g h = {:.3g} m/s; apply gravity up to the time of contact and from there "
                            "on, or correct the speed by the depth",
                            bounces.size(), plane, gravity * bounces.front().h),
                "", gravity * bounces.front().h / bounces.front().before, 0};
    }
    std::vector<double> back;
    for (const Bounce& b : bounces)
        if (b.after > 1e-9 * b.before) back.push_back(b.after / b.before);
    std::ranges::sort(back);
    const double usual = back.empty() ? 0 : back[back.size() / 2];
    if (restitution > 0.05 && restitution < 0.95 && !back.empty() &&
        std::abs(usual - restitution * restitution) < 0.05 * restitution && std::abs(usual - restitution) > 0.05)
        return Diagnosis{"restitution_applied_twice",
                         fmt::format("bounces on plane {} give back {:.3g} of the speed, the square of the restitution "
                                     "{:.3g}; apply it once, or give one of the two bodies a restitution of 1",
                                     plane, usual, restitution),
                         "", std::abs(usual - restitution), 0};
    // rests that a speed far above a step's gravity ends in
    for (const Bounce& b : bounces)
        if (restitution > 0.05 && b.after <= 1e-9 * b.before && b.before > 4 * gravity * b.h && b.before < slowest_back)
            return Diagnosis{
                "bounce_dies_below_threshold",
                fmt::format("a bounce on plane {} at {:.3g} m/s gives back nothing, where faster ones do: a "
                            "threshold of speed; lower the engine's threshold for restitution",
                            plane, b.before),
                "", 1, 0};
    if (share(bounces, [](const Bounce& b) { return b.gone_on && -b.distance > 0.02 * b.before * b.h; }) >= 0.9)
        return Diagnosis{
            "bounce_late",
            fmt::format("all {} bounces on plane {} come a step late: the body is behind the plane before, "
                        "by up to the way of a step; find the time of contact within the step",
                        bounces.size(), plane),
            "", 1, 0};
    return {};
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
        if (const std::optional<double> fall = fall_towards(scene, scene.planes[plane].normal_W))
            if (std::optional<Diagnosis> fault = bounce_fault(bounces_of(geometry, plane, file, rows), *fall,
                                                              scene.planes[plane].restitution, plane)) {
                told.push_back(*std::move(fault));
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
