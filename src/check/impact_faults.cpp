#include "check/impact_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "body/orientation.h"
#include "check/engine_model.h"
#include "motion/contact.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

// Impacts are measured if the normal speed is this many times its change in free flight within a row.
constexpr double least_changes = 4;
constexpr std::size_t most_impacts = 200;

// The distance of the body from one plane in a row.
struct Approach {
    double distance = 0;  // distance of the nearest piece, m
    double rate = 0;      // rate of this distance, m/s
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

// Largest acceleration by gravity, m/s^2.
double gravity_of(const Scene& scene) {
    double sum = 0;
    for (const Load& load : scene.loads)
        if (const auto* g = std::get_if<Gravity>(&load)) sum += length(g->acceleration_W);
    return sum;
}

// Returns the acceleration towards a plane if only gravity acts, at all times.
std::optional<double> fall_towards(const Scene& scene, const Vector3<double>& normal_W) {
    double sum = 0;
    for (const Load& load : scene.loads) {
        const auto* g = std::get_if<Gravity>(&load);
        if (!g || g->window.from > 0 || std::isfinite(g->window.until)) return {};
        sum -= dot(g->acceleration_W, normal_W) / length(normal_W);
    }
    return sum;
}

// Two successive rows between which a body bounces off a plane or stops at it.
struct Bounce {
    double before = 0, after = 0;  // speed towards the plane, speed away from it, m/s
    double distance = 0;           // distance in the first row, m
    double next_distance = 0;      // distance in the second row, m
    double h = 0;                  // time between the rows, s
    bool is_late = false;          // the first row is the first inside the plane, by at most the travel of a step
};

// Whether the normal through a contact passes through the centre of mass. An impact without friction then does not
// change the rotation, and the normal speed of the contact is that of the centre of mass.
bool is_without_arm(const ContactGeometry<double>& geometry, std::size_t plane, std::size_t piece,
                    const Placement<double>& at) {
    const Vector3<double>& normal_W = geometry.planes[plane].normal_W;
    const Vector3<double> arm_W = rotate(at.q, geometry.pieces[piece].lowest_point(rotate_back(at.q, normal_W)));
    return length(cross(arm_W, normal_W)) <= 1e-9 * geometry.reach * length(normal_W);
}

// Finds the bounces of a body that does not rotate or whose impacts do not change the rotation.
std::vector<Bounce> bounces_of(const ContactGeometry<double>& geometry, std::size_t plane, const TrajectoryFile& file,
                               const std::vector<Placement<double>>& rows, double fall) {
    std::vector<Bounce> all;
    for (std::size_t k = 1; k + 1 < rows.size(); ++k) {
        const Approach now = approach(geometry, plane, rows[k]), next = approach(geometry, plane, rows[k + 1]);
        const double h = file.rows[k + 1].t - file.rows[k].t;
        // a fast body was stopped if its speed in the next row is only that gained from gravity
        const double change = std::abs(fall) * h;
        const bool is_stopped = now.rate < -4 * change && next.rate >= -1.01 * change;
        if (!(now.rate < 0 && (next.rate >= 0 || is_stopped) && now.distance < -2 * now.rate * h + 1e-9)) continue;
        const bool rotates = length(rows[k].angular_velocity_W) > 0 || length(rows[k + 1].angular_velocity_W) > 0;
        if (rotates && !(is_without_arm(geometry, plane, now.piece, rows[k]) &&
                         is_without_arm(geometry, plane, next.piece, rows[k + 1])))
            return {};
        const bool is_late = now.distance < 0 && approach(geometry, plane, rows[k - 1]).distance >= 0 &&
                             -now.distance < -1.1 * now.rate * h;
        all.push_back({-now.rate, std::max(0.0, next.rate), now.distance, next.distance, h, is_late});
    }
    return all;
}

// Energy per mass (J/kg) after a bounce, in excess of the energy after a rebound at the plane with this restitution.
double energy_gained(const Bounce& b, double fall, double restitution) {
    const double at_contact = b.before * b.before / 2 + fall * b.distance;
    return b.after * b.after / 2 + fall * b.next_distance - restitution * restitution * at_contact;
}

double share(const std::vector<Bounce>& bounces, auto&& is) {
    if (bounces.empty()) return 0;
    return static_cast<double>(std::ranges::count_if(bounces, is)) / static_cast<double>(bounces.size());
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

// Diagnoses bounces of a falling body that do not change its rotation. `returned`: the measured restitutions.
std::optional<Diagnosis> bounce_fault(const std::vector<Bounce>& bounces, const std::vector<double>& returned,
                                      double gravity, double restitution, std::size_t plane) {
    constexpr double most = 0.7;
    if (bounces.size() < 2) return {};
    const auto has_rebound_speed = [](const Bounce& b, double speed) {
        return std::abs(b.after - speed) < 1e-6 * (b.before + speed);
    };
    const auto slowest_rebound = [&] {
        double slowest = HUGE_VAL;
        for (const Bounce& b : bounces)
            if (b.after > 1e-9 * b.before) slowest = std::min(slowest, b.before);
        return slowest;
    }();
    std::vector<Bounce> fast;
    std::ranges::copy_if(bounces, std::back_inserter(fast),
                         [&](const Bounce& b) { return b.before > 4 * gravity * b.h; });
    if (gravity > 0 && restitution > 0) {
        // if the engine leaves the body inside the plane, the potential energy loses what the speed gains
        const auto by_whole_step = [&](const Bounce& b) {
            return has_rebound_speed(b, restitution * (b.before + gravity * b.h)) &&
                   energy_gained(b, gravity, restitution) > 0.2 * restitution * restitution * gravity * b.h * b.before;
        };
        if (fast.size() >= 2 && share(fast, by_whole_step) >= most)
            return Diagnosis{
                "bounce_gains_energy",
                fmt::format("{} bounces on plane {} reverse the velocity after a full step of gravity: each "
                            "gains g h = {:.3g} m/s; apply gravity up to the time of contact and from there "
                            "on, or correct the speed for the penetration depth",
                            fast.size(), plane, gravity * fast.front().h),
                "", gravity * fast.front().h / fast.front().before, 0};
    }
    if (fast.size() >= 2 && share(fast, [](const Bounce& b) { return b.is_late; }) >= 0.9)
        return Diagnosis{
            "bounce_late",
            fmt::format("bounces on plane {} come one step late ({} bounces): each starts behind the plane, by up to "
                        "the travel of one step; find the time of contact within the step",
                        plane, fast.size()),
            "", 1, 0};
    const double usual = returned.empty() ? 0 : median(returned);
    if (restitution > 0.05 && restitution < 0.95 && !returned.empty() &&
        std::abs(usual - restitution * restitution) < 0.05 * restitution && std::abs(usual - restitution) > 0.05)
        return Diagnosis{"restitution_applied_twice",
                         fmt::format("bounces on plane {} return {:.3g} of the speed, the square of the restitution "
                                     "{:.3g}; apply it once, or give one of the two bodies a restitution of 1",
                                     plane, usual, restitution),
                         "", std::abs(usual - restitution), 0};
    // the body rests although its rebound would be fast compared with the speed gained in a step
    for (const Bounce& b : bounces)
        if (restitution > 0.05 && b.after <= 1e-9 * b.before && b.before > 4 * gravity * b.h &&
            restitution * b.before > 2 * gravity * b.h && b.before < slowest_rebound)
            return Diagnosis{
                "bounce_dies_below_threshold",
                fmt::format("a bounce on plane {} at {:.3g} m/s returns no speed, but faster ones do: the engine has a "
                            "speed threshold; lower its threshold for restitution",
                            plane, b.before),
                "", 1, 0};
    return {};
}

// Measures the restitution of an impact between two rows. The motion is propagated from the first row forward to the
// contact, and from the second row backward to the contact. Motion in constant fields is reversible. There is a
// single impact if both ends have the same placement, and both momenta change by one impulse at the contact.
class Impacts {
  public:
    explicit Impacts(const Scene& scene) : model_(without_planes(scene)) {}

    std::optional<double> restitution(const ContactGeometry<double>& geometry, std::size_t plane,
                                      const TrajectoryFile& file, const std::vector<Placement<double>>& rows,
                                      std::size_t k) const {
        const double t = file.rows[k].t, h = file.rows[k + 1].t - t;
        const ModelState from = state_of(rows[k]);
        double open = 0, closed = h;
        if (geometry.distance(plane, placement_of(propagate(from, t, h))) > 0) return {};
        if (geometry.distance(plane, rows[k]) > 0)
            for (int i = 0; i < 40; ++i) {
                const double middle = (open + closed) / 2;
                (geometry.distance(plane, placement_of(propagate(from, t, middle))) > 0 ? open : closed) = middle;
            }
        const Placement<double> before = placement_of(propagate(from, t, open));
        ModelState later = reverse(state_of(rows[k + 1]));
        const Placement<double> after = placement_of(reverse(propagate(later, t, h - open)));
        const Approach contact = approach(geometry, plane, before);
        const std::size_t pair = plane * geometry.pieces.size() + contact.piece;
        const double travel = std::abs(contact.rate) * h;
        if (length(before.position_W - after.position_W) > most_apart * travel + geometry.reach * 1e-3 ||
            rotation_angle_between(before.q, after.q) * geometry.reach > most_apart * travel + geometry.reach * 1e-3)
            return {};
        if (!(contact.rate < 0)) return {};
        // a single impulse J acts at the contact: I dw = r x J, with J = m dv
        const Matrix3<double> A = rotation_matrix(before.q);
        const Vector3<double> normal_B = rotate_back(before.q, geometry.planes[plane].normal_W),
                              arm = rotate(before.q, geometry.pieces[contact.piece].lowest_point(normal_B)),
                              impulse = model_.body().mass * (after.velocity_W - before.velocity_W),
                              spin = A * (model_.body().inertia_B *
                                          (transposed(A) * (after.angular_velocity_W - before.angular_velocity_W)));
        if (length(spin - cross(arm, impulse)) > most_apart * geometry.reach * length(impulse)) return {};
        Placement<double> same = after;
        same.q = before.q, same.position_W = before.position_W;
        return -geometry.gap(pair, same).rate / contact.rate;
    }

  private:
    static constexpr double most_apart = 0.1;  // relative to the travel within a row and to the largest angular impulse

    EngineModel model_;

    static Cause without_planes(const Scene& scene) {
        Cause cause;
        cause.scene = scene;
        cause.scene.planes.clear();
        return cause;
    }
    static ModelState state_of(const Placement<double>& at) {
        return {{at.q, rotate_back(at.q, at.angular_velocity_W), at.position_W, at.velocity_W}, {}};
    }
    static Placement<double> placement_of(const ModelState& s) {
        return {s.q, s.position_W, s.velocity_W, rotate(s.q, s.angular_velocity_B)};
    }
    static ModelState reverse(ModelState s) {
        s.velocity_W = -s.velocity_W, s.angular_velocity_B = -s.angular_velocity_B;
        return s;
    }
    ModelState propagate(ModelState s, double t, double time) const {
        model_.advance(s, t, time, update_rules().front(), 1);
        return s;
    }
};

// Whether only gravity acts, at all times.
bool is_in_constant_field(const Scene& scene) {
    return !scene.pivot && std::ranges::all_of(scene.loads, [](const Load& load) {
        const auto* g = std::get_if<Gravity>(&load);
        return g && g->window.from <= 0 && !std::isfinite(g->window.until);
    });
}

// Collects the rows in which a body stays inside a plane although it no longer moves into it.
class Penetration {
  public:
    // `change`: largest change of the normal speed within a row, m/s; `reach`: of the body, m
    void add(double t, double dt, const Approach& now, double change, double reach) {
        const double travel = (std::abs(now.rate) + change) * dt;
        const bool stays = now.distance < 0 && -now.distance > travel + slop * reach && now.rate >= -change;
        if (!stays) {
            rows_ = 0;
            return;
        }
        if (rows_++ == 0) from_ = t, depth_ = 0;
        depth_ = std::max(depth_, -now.distance);
        if (rows_ >= least_rows && t - from_ >= least_time && rows_ > longest_.rows)
            longest_ = {rows_, from_, t, depth_};
    }
    std::optional<Diagnosis> diagnosis(std::size_t plane, double end, double reach) const {
        if (longest_.rows == 0) return {};
        const bool to_end = longest_.until >= end;
        return Diagnosis{"penetration_kept",
                         fmt::format("the body stays up to {:.3g} m inside plane {} from t = {:.6g} s {}; correct the "
                                     "penetration depth",
                                     longest_.depth, plane, longest_.from,
                                     to_end ? "to the end" : fmt::format("to {:.6g} s", longest_.until)),
                         "", longest_.depth / reach, 0};
    }

  private:
    // Engines let a resting body penetrate by a slop to keep its contacts. A penetration below this part of the
    // body's reach, or below its travel within a row, is accepted.
    static constexpr double slop = 0.02;
    // soft contacts and slow bounces last less than this, s
    static constexpr double least_time = 0.1;
    static constexpr int least_rows = 6;

    struct Stay {
        int rows = 0;
        double from = 0, until = 0, depth = 0;
    };
    int rows_ = 0;
    double from_ = 0, depth_ = 0;
    Stay longest_;  // the longest penetration
};

// The rows of a file near the planes of its scene.
class ContactRows {
  public:
    // The findings of one plane.
    struct Findings {
        std::vector<double> returned;                        // restitution of each impact
        double deepest = 0, deepest_at = 0, entered_at = 0;  // of rows too deep for a contact; m, s, s
        int longest_inside = 0;                              // number of these rows in sequence
        Penetration penetration;
    };

    // The arguments must outlive this object.
    ContactRows(const Scene& scene, const ExactBody<double>& body, const ContactGeometry<double>& geometry,
                const TrajectoryFile& file)
        : geometry_(geometry), file_(file), gravity_(gravity_of(scene)) {
        for (const TrajectoryRow& row : file.rows) {
            const Quaternion<double> q = normalized(row.q);
            const Vector3<double> origin = file.has_origin ? rotate(q, body.center) : Vector3<double>();
            rows_.push_back({q, row.position_W + origin, row.velocity_W, row.angular_velocity_W});
        }
        if (is_in_constant_field(scene)) impacts_.emplace(scene);
    }

    const std::vector<Placement<double>>& placements() const { return rows_; }

    Findings inspect(std::size_t plane) const {
        Findings found;
        int inside = 0;
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const Approach now = approach(geometry_, plane, rows_[k]);
            // deeper than the travel of a step: there was no contact
            const double dt = k > 0 ? file_.rows[k].t - file_.rows[k - 1].t : 0;
            const double travel =
                (length(rows_[k].velocity_W) + length(rows_[k].angular_velocity_W) * geometry_.reach) * dt;
            if (-now.distance > 2 * travel + 0.02 * geometry_.reach) {
                if (inside++ == 0) found.entered_at = file_.rows[k].t;
                found.longest_inside = std::max(found.longest_inside, inside);
                if (-now.distance > found.deepest) found.deepest = -now.distance, found.deepest_at = file_.rows[k].t;
            } else
                inside = 0;
            const double spin = is_without_arm(geometry_, plane, now.piece, rows_[k])
                                    ? 0
                                    : dot(rows_[k].angular_velocity_W, rows_[k].angular_velocity_W) * geometry_.reach;
            const double acceleration = gravity_ + spin;
            if (k > 0) found.penetration.add(file_.rows[k].t, dt, now, acceleration * dt, geometry_.reach);
            if (k + 1 == rows_.size() || found.returned.size() >= most_impacts) continue;
            if (const std::optional<double> e = restitution(plane, k, now, acceleration)) found.returned.push_back(*e);
        }
        return found;
    }

  private:
    const ContactGeometry<double>& geometry_;
    const TrajectoryFile& file_;
    double gravity_;  // m/s^2
    std::vector<Placement<double>> rows_;
    std::optional<Impacts> impacts_;  // if the motion between impacts is reversible

    // Restitution of an impact between row k and the next. `acceleration`: of the normal speed in free flight, m/s^2.
    std::optional<double> restitution(std::size_t plane, std::size_t k, const Approach& now,
                                      double acceleration) const {
        const double ahead = file_.rows[k + 1].t - file_.rows[k].t;
        const double after = geometry_.gap(plane * geometry_.pieces.size() + now.piece, rows_[k + 1]).rate;
        const double change = acceleration * ahead;  // change of the normal rate within a row
        if (!(now.distance < -2 * now.rate * ahead && after > -change)) return {};
        std::optional<double> e;
        if (impacts_ && now.rate < -least_changes * change)
            e = impacts_->restitution(geometry_, plane, file_, rows_, k);
        // use the speeds of the rows: engines differ in how they move the body in the step of an impact
        if (!e && now.rate < -40 * change && now.distance > 2 * now.rate * ahead &&
            now.second - now.distance > -4 * now.rate * ahead)
            e = -after / now.rate;
        return e;
    }
};

Diagnosis missed_impact(const ContactRows::Findings& found, std::size_t plane) {
    return {"impact_missed",
            fmt::format("the body passes through plane {} at t = {:.6g} s and is {:.3g} m behind it at "
                        "t = {:.6g} s; make the body collide with the plane, and if it is fast, use "
                        "shorter steps or continuous detection",
                        plane, found.entered_at, found.deepest, found.deepest_at),
            "", 1, 0};
}

std::optional<Diagnosis> wrong_restitution(const std::vector<double>& returned, std::size_t plane, double wanted) {
    if (returned.empty()) return {};
    const double found = median(returned);
    if (!(std::abs(found - wanted) > 0.08)) return {};
    return Diagnosis{"restitution_wrong",
                     fmt::format("impacts on plane {} return {:.3g} of the normal speed (median of {} impacts), but "
                                 "its restitution is {:.3g}; give the engine the scene's restitution, and check "
                                 "how it combines those of two bodies",
                                 plane, found, returned.size(), wanted),
                     "", std::abs(found - wanted), 0};
}

}  // namespace

std::vector<Diagnosis> impact_faults(const Scene& scene, const TrajectoryFile& file) {
    if (scene.planes.empty() || !scene.body.source || !file.has_velocity || !(file.has_position || file.has_origin) ||
        file.rows.size() < 3)
        return {};
    const ExactBody<double> body = exact_body<double>(scene);
    const ContactGeometry<double> geometry = contact_geometry<double>(scene, body.center, {});
    // the rotation of a ball about its centre of mass has no influence
    if (!file.has_angular_velocity &&
        !(geometry.pieces.size() == 1 && is_without_arm(geometry, 0, 0, {{}, {}, {}, {}})))
        return {};
    const ContactRows rows(scene, body, geometry, file);
    std::vector<Diagnosis> diagnoses;
    for (std::size_t plane = 0; plane < geometry.planes.size(); ++plane) {
        const ContactRows::Findings found = rows.inspect(plane);
        // a resting body may sink a little; a body beyond its reach has passed through
        if (found.longest_inside >= 3 && found.deepest > geometry.reach) {
            diagnoses.push_back(missed_impact(found, plane));
            continue;
        }
        if (std::optional<Diagnosis> stay = found.penetration.diagnosis(plane, file.rows.back().t, geometry.reach))
            diagnoses.push_back(*std::move(stay));
        if (const std::optional<double> fall = fall_towards(scene, scene.planes[plane].normal_W))
            if (std::optional<Diagnosis> fault =
                    bounce_fault(bounces_of(geometry, plane, file, rows.placements(), *fall), found.returned, *fall,
                                 scene.planes[plane].restitution, plane)) {
                diagnoses.push_back(*std::move(fault));
                continue;
            }
        if (std::optional<Diagnosis> fault =
                wrong_restitution(found.returned, plane, geometry.planes[plane].restitution))
            diagnoses.push_back(*std::move(fault));
    }
    return diagnoses;
}

}  // namespace polhode
