#include "check/joint_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "body/orientation.h"
#include "check/convention.h"
#include "integrators/maximal/mechanism.h"
#include "text/message.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;
using maximal::Kind;
using JointLink = maximal::Link<double>;

// Pose and velocity of a body in a row. The default is the world.
struct Pose {
    Quaternion<double> q{1, 0, 0, 0};
    Vector position_W, velocity_W, angular_velocity_W;
};

// The poses of a joint's two bodies in the rows of a file.
struct JointRows {
    std::vector<double> t;
    std::vector<Pose> from, to;
};

// largest number of moments that are tested
constexpr std::size_t most_rows = 4000;

class FilePoses {
  public:
    FilePoses(const maximal::Mechanism<double>& mechanism, const TrajectoryFile& file)
        : mechanism_(mechanism), file_(file) {
        const std::vector<NamedBody>& bodies = mechanism.scene().bodies;
        place_.assign(bodies.size(), -1);
        for (std::size_t b = 0; b < bodies.size(); ++b)
            for (std::size_t i = 0; i < file.bodies.size(); ++i)
                if (file.bodies[i] == bodies[b].name) place_[b] = static_cast<int>(i);
    }

    // Reads the rows of a joint. `length_unit` and `origin`: interpretation of positions.
    std::optional<JointRows> of(const JointLink& link, double length_unit, bool origin) const {
        for (const int b : {link.from.body, link.to.body})
            if (b != mechanism_.world() && place_[static_cast<std::size_t>(b)] < 0) return {};
        JointRows rows;
        const std::size_t at_once = file_.bodies_at_once(), count = std::min(file_.rows.size() / at_once, most_rows);
        const auto pose = [&](std::size_t k, int b) {
            Pose p;
            if (b == mechanism_.world()) return p;
            const TrajectoryRow& row =
                file_.rows[k * at_once + static_cast<std::size_t>(place_[static_cast<std::size_t>(b)])];
            p.q = normalized(row.q);
            p.position_W = length_unit * row.position_W;
            if (origin)
                p.position_W = p.position_W + rotate(p.q, mechanism_.bodies[static_cast<std::size_t>(b)].center);
            p.velocity_W = length_unit * row.velocity_W, p.angular_velocity_W = row.angular_velocity_W;
            return p;
        };
        for (std::size_t k = 0; k < count; ++k) {
            rows.t.push_back(file_.rows[k * at_once].t);
            rows.from.push_back(pose(k, link.from.body)), rows.to.push_back(pose(k, link.to.body));
        }
        return rows;
    }

  private:
    const maximal::Mechanism<double>& mechanism_;
    const TrajectoryFile& file_;
    std::vector<int> place_;  // index in the file of each body; -1 if it is missing
};

// Vector from the joint's point on the parent to that on the child, world axes; normal to the axis if prismatic.
Vector gap_W(const JointLink& link, const Pose& from, const Pose& to) {
    const Vector apart =
        to.position_W + rotate(to.q, link.to.arm_B) - from.position_W - rotate(from.q, link.from.arm_B);
    if (link.kind != Kind::prismatic) return apart;
    const Vector axis_W = rotate(from.q, link.axis_from);
    return apart - dot(axis_W, apart) * axis_W;
}
// Relative velocity of the two points.
Vector slip_W(const JointLink& link, const Pose& from, const Pose& to) {
    return to.velocity_W + cross(to.angular_velocity_W, rotate(to.q, link.to.arm_B)) - from.velocity_W -
           cross(from.angular_velocity_W, rotate(from.q, link.from.arm_B));
}

std::string text_of(const Vector& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]); }

// Mean of vectors, rms deviation from it, and largest length.
struct MeanVector {
    Vector mean;
    double deviation = 0, largest = 0;

    explicit MeanVector(const std::vector<Vector>& all) {
        const double n = static_cast<double>(all.size());
        for (const Vector& v : all) mean = mean + (1 / n) * v, largest = std::max(largest, length(v));
        for (const Vector& v : all) deviation += dot(v - mean, v - mean) / n;
        deviation = std::sqrt(deviation);
    }
};

double reach_of(const JointLink& link) { return std::max({length(link.from.arm_B), length(link.to.arm_B), 1e-3}); }

// Diagnoses a displaced anchor: the gap is constant in the axes of one of the bodies.
std::optional<Diagnosis> anchor_fault(const JointLink& link, const JointRows& rows, const std::string& name,
                                      const std::string& parent, const std::string& child) {
    std::vector<Vector> in_from, in_to;
    for (std::size_t k = 0; k < rows.t.size(); ++k) {
        const Vector gap = gap_W(link, rows.from[k], rows.to[k]);
        in_from.push_back(rotate_back(rows.from[k].q, gap)), in_to.push_back(rotate_back(rows.to[k].q, gap));
    }
    const MeanVector of_parent(in_from), of_child(in_to);
    const auto is_constant = [&](const MeanVector& m) {
        return length(m.mean) > 2e-3 * reach_of(link) && m.deviation < 0.15 * length(m.mean);
    };
    // bodies that drift apart start without a gap
    if (!(length(gap_W(link, rows.from[0], rows.to[0])) >
          0.5 * std::min(length(of_parent.mean), length(of_child.mean))))
        return {};
    if (!is_constant(of_parent) && !is_constant(of_child)) return {};
    const bool by_child =
        is_constant(of_child) && (!is_constant(of_parent) || of_child.deviation <= of_parent.deviation);
    const std::string on_child = fmt::format("on body \"{}\" by {} m in its axes", child, text_of(-of_child.mean)),
                      on_parent =
                          fmt::format("on {} by {} m in its axes",
                                      parent == "world" ? parent : "body \"" + parent + '"', text_of(of_parent.mean));
    const bool both = is_constant(of_parent) && is_constant(of_child);
    return Diagnosis{
        "joint_anchor_off",
        fmt::format("the anchor of joint \"{}\" is displaced {}{}: the joint's two points are always {:.3g} m "
                    "apart; give the engine the joint's points, measured from the bodies' origins",
                    name, by_child ? on_child : on_parent, both ? ", or " + (by_child ? on_parent : on_child) : "",
                    by_child ? length(of_child.mean) : length(of_parent.mean)),
        "", by_child ? length(of_child.mean) : length(of_parent.mean), 0};
}

// Common axis of rotations (unit vector), and the rms angle (rad) of the rotations' axes from it.
struct CommonAxis {
    Vector axis;
    double scatter = 0;
};
std::optional<CommonAxis> common_axis(const std::vector<Quaternion<double>>& turns) {
    Vector largest, sum;
    for (const Quaternion<double>& q : turns)
        if (const Vector v = vector_part(q); length(v) > length(largest)) largest = v;
    if (!(length(largest) > 0.02)) return {};
    double off = 0, all = 0;
    for (const Quaternion<double>& q : turns) {
        const Vector v = vector_part(q);
        sum = sum + (dot(v, largest) < 0 ? -1.0 : 1.0) * v;
    }
    const Vector axis = (1 / length(sum)) * sum;
    for (const Quaternion<double>& q : turns) {
        const Vector v = vector_part(q), across = v - dot(v, axis) * axis;
        off += dot(across, across), all += dot(v, v);
    }
    if (!(off < 4e-4 * all)) return {};
    return CommonAxis{axis, std::sqrt(off / all)};
}

std::optional<Diagnosis> axis_fault(const JointLink& link, const JointRows& rows, const std::string& name) {
    if (link.kind != Kind::revolute) return {};
    const auto joint = [&](std::size_t k) { return conjugate(rows.from[k].q * link.orientation) * rows.to[k].q; };
    std::vector<Quaternion<double>> in_child, in_parent;
    const Quaternion<double> first = joint(0);
    for (std::size_t k = 1; k < rows.t.size(); ++k) {
        in_child.push_back(conjugate(first) * joint(k)), in_parent.push_back(joint(k) * conjugate(first));
    }
    const std::optional<CommonAxis> of_child = common_axis(in_child), of_parent = common_axis(in_parent);
    if (!of_child || !of_parent) return {};
    const Vector& axis = link.axes_to[0];
    const auto angle = [&](const Vector& a) { return std::asin(std::min(1.0, length(cross(a, axis)))); };
    // rad; a soft joint also deviates from its axis, but not by a constant angle
    const double plain = std::max(5e-3, 5 * std::max(of_child->scatter, of_parent->scatter));
    const double off_child = angle(of_child->axis), off_parent = angle(of_parent->axis);
    if (off_child < plain && off_parent < plain) return {};
    const bool on_child = off_child >= plain, on_parent = off_parent >= plain;
    const Vector found = on_child ? of_child->axis : of_parent->axis;
    return Diagnosis{
        "joint_axis_off",
        fmt::format(
            "the axis of joint \"{}\" is off by {:.3g} rad{}: the bodies rotate about {} instead of {} (in the {}); "
            "give the engine the joint's axis and the orientation of its frame",
            name, on_child ? off_child : off_parent,
            on_child && on_parent ? ""
            : on_child            ? " on the child"
                                  : " on the parent",
            text_of((dot(found, axis) < 0 ? -1.0 : 1.0) * found), text_of(axis),
            on_child ? "child's axes" : "parent's joint frame"),
        "", on_child ? off_child : off_parent, 0};
}

// Diagnoses a joint that separates. The rate of correction is fitted: slip = -b gap (Baumgarte), or change of gap =
// -b gap per row (position projection).
std::optional<Diagnosis> drift_fault(const JointLink& link, const JointRows& rows, const std::string& name,
                                     bool has_rates) {
    double largest = 0, at = 0;
    std::vector<Vector> gaps;
    for (std::size_t k = 0; k < rows.t.size(); ++k) {
        gaps.push_back(gap_W(link, rows.from[k], rows.to[k]));
        if (const double size = length(gaps.back()); size > largest) largest = size, at = rows.t[k];
    }
    if (!(largest > 2e-3 * reach_of(link))) return {};
    std::string pull;
    if (has_rates && link.kind != Kind::prismatic) {
        double gap_gap = 0, slip_gap = 0, slip_slip = 0, change_gap = 0, change_change = 0, h = 0;
        for (std::size_t k = 0; k + 1 < rows.t.size(); ++k) {
            const Vector slip = slip_W(link, rows.from[k + 1], rows.to[k + 1]);
            h = rows.t[k + 1] - rows.t[k];
            const Vector change = gaps[k + 1] - gaps[k] - h * slip;
            gap_gap += dot(gaps[k], gaps[k]), slip_gap += dot(slip, gaps[k]), slip_slip += dot(slip, slip);
            change_gap += dot(change, gaps[k]), change_change += dot(change, change);
        }
        // share of a sum of squares that -b gap explains
        const auto share = [&](double along, double all) { return all > 0 ? along * along / (gap_gap * all) : 0; };
        if (slip_gap < 0 && share(slip_gap, slip_slip) > 0.8)
            pull = fmt::format("; the gap is pulled back at {:.3g} 1/s, {:.2g} of it per row (Baumgarte)",
                               -slip_gap / gap_gap, -slip_gap / gap_gap * h);
        else if (change_gap < 0 && share(change_gap, change_change) > 0.8)
            pull =
                fmt::format("; {:.2g} of the gap is removed in each row (position projection)", -change_gap / gap_gap);
        else
            pull = "; the rows show no rate at which the gap is pulled back";
    }
    return Diagnosis{"joint_drifts",
                     fmt::format("joint \"{}\" separates by up to {:.3g} m, at t = {:.6g} s{}; take smaller steps or "
                                 "more iterations, or correct positions more strongly",
                                 name, largest, at, pull),
                     "", largest, 0};
}

// The coordinate of a revolute or prismatic joint in each row, rad or m. Angles are continuous.
std::vector<double> joint_coordinates(const JointLink& link, const JointRows& rows) {
    std::vector<double> x;
    for (std::size_t k = 0; k < rows.t.size(); ++k) {
        if (link.kind == Kind::prismatic) {
            const Vector apart = rows.to[k].position_W + rotate(rows.to[k].q, link.to.arm_B) - rows.from[k].position_W -
                                 rotate(rows.from[k].q, link.from.arm_B);
            x.push_back(dot(rotate(rows.from[k].q, link.axis_from), apart));
            continue;
        }
        const Quaternion<double> turn = conjugate(rows.from[k].q * link.orientation) * rows.to[k].q;
        const double whole = 2 * std::acos(-1.0),
                     angle = 2 * std::atan2(dot(link.axes_to[0], vector_part(turn)), turn.w);
        x.push_back(x.empty() ? angle : angle + whole * std::round((x.back() - angle) / whole));
    }
    return x;
}

// Diagnoses a limit: a coordinate is repeatedly stopped or reflected at the same value.
std::optional<Diagnosis> limit_fault(const JointLink& link, const JointRows& rows, const std::string& name,
                                     const std::function<bool(std::size_t)>& predicts) {
    if (link.kind != Kind::revolute && link.kind != Kind::prismatic) return {};
    const std::vector<double> x = joint_coordinates(link, rows);
    if (x.size() < 12) return {};
    std::vector<double> rate, changes;
    for (std::size_t k = 0; k + 1 < x.size(); ++k) rate.push_back((x[k + 1] - x[k]) / (rows.t[k + 1] - rows.t[k]));
    double fastest = 0;
    for (std::size_t k = 0; k + 1 < rate.size(); ++k) {
        changes.push_back(std::abs(rate[k + 1] - rate[k]));
        fastest = std::max(fastest, std::abs(rate[k]));
    }
    std::vector<double> sorted = changes;
    std::ranges::sort(sorted);
    const double usual = sorted[sorted.size() / 2];
    for (const double side : {1.0, -1.0}) {
        // places at which the rate towards this side vanishes within two rows, by far more than it changes elsewhere
        std::vector<double> places;
        double way = 0;
        std::size_t rests = 0;
        bool stopped = false;  // a significant rate vanishes at once
        for (std::size_t k = 1; k + 2 < rate.size(); ++k) {
            const double before = side * rate[k - 1], after = side * rate[k + 1];
            if (!(before > 0.02 * fastest && after <= 0.02 * before && before - after > 5 * usual &&
                  before - after > 0.5 * before))
                continue;
            if (predicts(k - 1) && predicts(k)) continue;
            places.push_back(side * std::max(side * x[k], side * x[k + 1]));
            way = std::max(way, before * (rows.t[k + 1] - rows.t[k]));
            stopped = stopped || (before > 0.2 * fastest && std::abs(after) < 0.02 * before);
            std::size_t still = 0;
            while (k + 1 + still < rate.size() && std::abs(rate[k + 1 + still]) < 1e-3 * before) ++still;
            rests = std::max(rests, still);
            k += 2;
        }
        if (places.empty() || (places.size() < 2 && rests < 5 && !stopped)) continue;
        const auto [least, most] = std::ranges::minmax(places);
        if (most - least > way + 1e-6) continue;
        const double limit = side > 0 ? most : least;
        return Diagnosis{
            "joint_limit_where_none",
            fmt::format("joint \"{}\" is stopped at {:.4g} {}, {} time{}: the scene has no such limit; disable the "
                        "engine's joint limit",
                        name, limit, link.kind == Kind::prismatic ? "m" : "rad", places.size(),
                        places.size() > 1 ? "s" : ""),
            "", 1, 0};
    }
    return {};
}

// Returns the largest gap of all joints over the motion, relative to their reach, for this reading of positions.
double worst_gap(const maximal::Mechanism<double>& mechanism, const FilePoses& poses, double length_unit, bool origin) {
    double worst = 0;
    for (const JointLink& link : mechanism.links) {
        if (!link.is_joint()) continue;
        if (const std::optional<JointRows> rows = poses.of(link, length_unit, origin))
            for (std::size_t k = 0; k < rows->t.size(); ++k)
                worst = std::max(worst, length(gap_W(link, rows->from[k], rows->to[k])) / reach_of(link));
    }
    return worst;
}

}  // namespace

std::vector<Diagnosis> joint_faults(const Scene& scene, const TrajectoryFile& file,
                                    const std::function<bool(std::size_t)>& predicts) {
    const maximal::Mechanism<double> mechanism(scene);
    const FilePoses poses(mechanism, file);
    std::vector<Diagnosis> diagnoses;
    const bool has_place = file.has_position || file.has_origin;
    const double as_named = has_place ? worst_gap(mechanism, poses, 1, file.has_origin) : 0;
    // a wrong reading of positions opens all joints at once
    if (as_named > 2e-3) {
        constexpr double closed = 0.02;
        if (worst_gap(mechanism, poses, 1, !file.has_origin) < closed * as_named)
            return {file.has_origin
                        ? Diagnosis{"center_of_mass_for_origin",
                                    "ox,oy,oz are the centre of mass, not the body's origin: with this reading all "
                                    "joints close; name the columns px,py,pz",
                                    "", as_named, 0}
                        : Diagnosis{"origin_for_center_of_mass",
                                    "the position is the body's origin, not its centre of mass: with this reading all "
                                    "joints close; name the columns ox,oy,oz, or write the centre of mass",
                                    "", as_named, 0}};
        for (const char* unit : {"centimetres", "millimetres", "inches", "feet"})
            if (worst_gap(mechanism, poses, *length_unit(unit), file.has_origin) <
                closed * *length_unit(unit) * as_named)
                return {{std::string("lengths_in_") + unit,
                         fmt::format("positions are in {}: with this reading all joints close; write metres, or give "
                                     "--convention {}",
                                     unit, unit),
                         unit, as_named, 0}};
    }
    const auto body_name = [&](int b) {
        return b == mechanism.world() ? std::string("world")
                                      : one_line(scene.bodies[static_cast<std::size_t>(b)].name, 40);
    };
    for (const JointLink& link : mechanism.links) {
        if (!link.is_joint()) continue;
        const std::optional<JointRows> rows = poses.of(link, 1, file.has_origin);
        if (!rows || rows->t.size() < 4) continue;
        const std::string name = one_line(link.name, 40);
        if (std::optional<Diagnosis> axis = axis_fault(link, *rows, name)) diagnoses.push_back(*std::move(axis));
        if (has_place && as_named > 0) {
            std::optional<Diagnosis> gap =
                anchor_fault(link, *rows, name, body_name(link.from.body), body_name(link.to.body));
            if (!gap) gap = drift_fault(link, *rows, name, file.has_angular_velocity && file.has_velocity);
            if (gap) diagnoses.push_back(*std::move(gap));
        }
        // loops pass dead centres, which look like limits
        if (!scene.loops.empty()) continue;
        if (std::optional<Diagnosis> limit = limit_fault(link, *rows, name, predicts))
            diagnoses.push_back(*std::move(limit));
    }
    // a displaced anchor or axis also separates other joints
    const auto is_off = [](const Diagnosis& d) { return d.fault == "joint_anchor_off" || d.fault == "joint_axis_off"; };
    if (std::ranges::any_of(diagnoses, is_off))
        std::erase_if(diagnoses, [](const Diagnosis& d) { return d.fault == "joint_drifts"; });
    return diagnoses;
}

}  // namespace polhode
