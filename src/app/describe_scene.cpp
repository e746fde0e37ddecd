// What there is to say about a scene before it is solved.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/describe.h"
#include "app/polhode_picture.h"
#include "integrators/method.h"
#include "motion/conserved.h"
#include "motion/problem.h"
#include "scene/message.h"
#include "scene/scene_file.h"
#include "table/decimal.h"

namespace polhode {
namespace {

std::string number(double value) { return shortest_decimal(value); }
std::string text(const Vector3<double>& v) {
    return fmt::format("({}, {}, {})", number(v[0]), number(v[1]), number(v[2]));
}
std::string text(const Quaternion<double>& q) {
    return fmt::format("({}, {}, {}, {})", number(q.w), number(q.x), number(q.y), number(q.z));
}
std::string text(const Matrix3<double>& m) {
    if (m == diagonal(Vector3<double>(m[0][0], m[1][1], m[2][2])))
        return "diagonal " + text(Vector3<double>(m[0][0], m[1][1], m[2][2]));
    return fmt::format("{}, {}, {}", text(m[0]), text(m[1]), text(m[2]));
}
std::string text(Frame frame) { return frame == Frame::body ? "body" : "world"; }

// A titled block; entries of two columns.
class Report {
  public:
    void title(const std::string& words) { text_ += (text_.empty() ? "" : "\n") + words + "\n"; }
    void line(const std::string& name, const std::string& value) {
        text_ += fmt::format("  {:<26}  {}\n", name, value);
    }
    void line(const std::string& words) { text_ += "  " + words + "\n"; }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
};

void mass_properties(Report& report, const Problem& problem) {
    const Body& body = problem.scene.body;
    report.title("Mass properties");
    report.line("mass", number(body.mass) + " kg");
    report.line("centre of mass", text(body.center_of_mass) + " m, from the body's origin");
    report.line("inertia about it", text(body.inertia_B) + " kg m^2, body axes");
    if (problem.scene.pivot) {
        report.line("pivot", text(*problem.scene.pivot) + " m, from the body's origin");
        report.line("inertia about the pivot", text(problem.body.inertia_B) + " kg m^2, body axes");
    }
    const char* symmetry = problem.needs.symmetry == Symmetry::spherical   ? "spherical: all three equal"
                           : problem.needs.symmetry == Symmetry::symmetric ? "symmetric: two are equal"
                                                                           : "asymmetric: all three differ";
    report.line("principal moments", text(problem.principal.moments) + " kg m^2; " + symmetry);
    report.line("principal axes", problem.principal.q_BP == Quaternion<double>{}
                                      ? "the body's own"
                                      : "q " + text(problem.principal.q_BP) + ", principal to body");
}

struct LoadText {
    std::string operator()(const Gravity& load) const { return "gravity " + text(load.acceleration_W) + " m/s^2"; }
    std::string operator()(const Torque& load) const {
        return fmt::format("torque {} N m, constant in {} axes", text(load.vector), text(load.frame));
    }
    std::string operator()(const Force& load) const {
        return fmt::format("force {} N, constant in {} axes, at {} m in the {}", text(load.vector), text(load.frame),
                           text(load.point), text(load.point_frame));
    }
    std::string operator()(const Impulse& load) const {
        return fmt::format("impulse {} N s, in {} axes, at {} m in the {}, at t = {} s", text(load.vector),
                           text(load.frame), text(load.point), text(load.point_frame), number(load.at));
    }
    std::string operator()(const Drag& load) const {
        return fmt::format("drag, rotational {} N m s, translational {} N s/m", text(load.rotational),
                           number(load.translational));
    }
    std::string operator()(const Spring& load) const {
        return fmt::format("torsional spring {} N m, at rest at {}", number(load.stiffness),
                           text(load.rest_orientation));
    }
    std::string operator()(const UserTorque& load) const { return "torque of the user's own: " + load.name; }
};

void loads(Report& report, const Problem& problem) {
    report.title("Loads");
    if (problem.scene.loads.empty()) report.line("none");
    for (const Load& load : problem.scene.loads) {
        const Window window = window_of(load);
        std::string when;
        if (std::isfinite(window.from)) when += fmt::format(", from {} s", number(window.from));
        if (std::isfinite(window.until)) when += fmt::format(", until {} s", number(window.until));
        report.line(std::visit(LoadText{}, load) + when);
    }
}

std::string equations(System system) {
    switch (system) {
        case System::principal_axis_rotation:
            return "dw/dt = tau(c, s, w) / I;  dc/dt = -w s / 2;  ds/dt = w c / 2;  q = q0 (c, s e)";
        case System::free_rotation:
            return "I dw/dt = -w x Iw;  dq/dt = q (0, w) / 2";
        case System::loaded_rotation:
            return "I dw/dt = tau(t, q, w) - w x Iw;  dq/dt = q (0, w) / 2";
        case System::loaded_motion:
            return "I dw/dt = tau(t, q, w, p) - w x Iw;  dq/dt = q (0, w) / 2;  dp/dt = v;  dv/dt = F(t, q, v) / m";
        case System::full_motion:
            break;
    }
    return "J dw/dt = tau(t, q, w, p, v) - w x Jw, full tensor;  dq/dt = q (0, w) / 2;  dp/dt = v;  dv/dt = F / m";
}

// What tau consists of on the segment.
std::string torque_terms(const Forcing<double>& f) {
    std::vector<std::string> terms;
    if (!f.body_points.empty()) terms.push_back("forces constant in the world at body points");
    if (f.has_world_torque) terms.push_back("a torque constant in the world");
    if (f.has_torque) terms.push_back("a torque constant in the body");
    if (f.has_damping) terms.push_back("drag");
    if (!f.springs.empty()) terms.push_back("springs");
    if (!f.world_points.empty()) terms.push_back("forces at world points");
    if (!f.user_torques.empty()) terms.push_back("the user's torque");
    return terms.empty() ? "no torque" : listed(terms);
}

void system_posed(Report& report, const Problem& problem) {
    const Needs& needs = problem.needs;
    report.title("System posed");
    report.line("system", fmt::format("{}, {} variables", name_of(needs.system), needs.dimension));
    report.line("equations", equations(needs.system));
    report.line("axes", problem.q_BP == Quaternion<double>{} ? "the body's own" : "the principal ones");
    report.line("about", problem.body.pivoted ? "the pivot" : "the centre of mass");
    const char* translation = needs.translation == Translation::fixed         ? "none of its own"
                              : needs.translation == Translation::closed_form ? "closed form"
                                                                              : "integrated";
    report.line("translation", translation);
    if (problem.needs.system == System::principal_axis_rotation)
        report.line("axis e", text(problem.axis) + ", in these axes");
    for (const Segment& segment : problem.segments) {
        std::string acts = torque_terms(segment.forcing);
        if (!segment.impulses.empty())
            acts = fmt::format("{} impulse{}, then {}", segment.impulses.size(),
                               segment.impulses.size() == 1 ? "" : "s", acts);
        report.line(fmt::format("{} s to {} s", number(segment.begin), number(segment.end)), acts);
    }
    report.title("Left out, and why");
    if (needs.left_out.empty()) report.line("nothing");
    for (const LeftOut& one : needs.left_out) report.line(one.what, one.why);
}

void invariants(Report& report, const Problem& problem) {
    report.title("Invariants, with their values at t = 0");
    const std::vector<Conserved> all = conserved(problem);
    if (all.empty()) report.line("none: the loads change energy and every component of momentum");
    for (const Conserved& one : all) {
        const bool vector = one.value.size() == 3;
        std::string value =
            vector ? text(Vector3<double>(one.value[0], one.value[1], one.value[2])) : number(one.value[0]);
        report.line(one.name, value + "; " + one.formula);
        if (one.name.ends_with("along u")) report.line("", "u = " + text(one.direction) + ", world axes");
        if (one.name.starts_with("spin")) report.line("", "e = " + text(one.direction) + ", axes of the system posed");
    }
}

// Angle between the attitudes at T, rad.
double attitude_difference(const Sample& a, const Sample& b) {
    const Quaternion<double> r = conjugate(a.q) * b.q;
    return 2 * std::atan2(std::hypot(r.x, r.y, r.z), std::abs(r.w));
}

std::optional<Sample> at_end(const Scene& scene) {
    const Problem problem = pose(scene);
    Settings settings;
    settings.samples = 1, settings.max_steps = 2'000'000, settings.seconds_limit = 2;
    const Trajectory trajectory = solve(problem, *choose_method(problem).method, settings);
    if (trajectory.status != Status::ok) return std::nullopt;
    return trajectory.samples.back();
}

// By how much small changes of the start have grown at T: the largest attitude change over six of them, each 1e-5 rad
// about a body axis or 1e-5 of the largest rate along one, per unit of the change. Central differences.
void conditioning(Report& report, const Problem& problem) {
    constexpr double size = 1e-5;
    report.title("Conditioning at T");
    const Scene& scene = problem.scene;
    const Vector3<double>& w = problem.body.angular_velocity_B;
    const double rate = std::max({std::abs(w[0]), std::abs(w[1]), std::abs(w[2]), 1 / scene.duration});
    double by_attitude = 0, by_rate = 0;
    for (int i = 0; i < 6; ++i) {
        std::optional<Sample> end[2];
        for (int side = 0; side < 2; ++side) {
            Scene moved = scene;
            moved.initial.angular_velocity = w, moved.initial.angular_velocity_frame = Frame::body;
            moved.initial.orientation = problem.body.q;
            const double change = side == 0 ? size : -size;
            if (i < 3) {
                Quaternion<double> turn{std::cos(change / 2), 0, 0, 0};
                (i == 0 ? turn.x : i == 1 ? turn.y : turn.z) = std::sin(change / 2);
                moved.initial.orientation = normalized(problem.body.q * turn);
            } else {
                moved.initial.angular_velocity[i - 3] += change * rate;
            }
            end[side] = at_end(moved);
            if (!end[side]) {
                report.line("not known: the perturbed motions could not be solved within 2 s each");
                return;
            }
        }
        const double growth = attitude_difference(*end[0], *end[1]) / (2 * size);
        (i < 3 ? by_attitude : by_rate) = std::max(i < 3 ? by_attitude : by_rate, growth);
    }
    report.line("to the attitude at t = 0", fmt::format("{:.3g} rad at T for each rad", by_attitude));
    report.line("to the rate at t = 0", fmt::format("{:.3g} rad at T for each relative change of w", by_rate));
    report.line("so binary64 can tell",
                fmt::format("attitudes at T to {:.1g} rad at best", std::max(by_attitude, by_rate) * 0x1p-53));
}

void polhode_drawing(Report& report, const Problem& problem) {
    report.title("Polhode: the angular velocity in principal axes");
    const PolhodeCurve polhode = polhode_curve(problem);
    if (!polhode.fault.empty()) {
        report.line("not drawn: " + polhode.fault);
        return;
    }
    if (polhode.energy == 0) {
        report.line("none: the body never turns");
        return;
    }
    const auto rounded = [](const Vector3<double>& v) {
        return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]);
    };
    report.line("ellipsoid", fmt::format("2 E = I1 w1^2 + I2 w2^2 + I3 w3^2, E = {:.6g} J{}", polhode.energy,
                                         polhode.energy_of_start ? " at t = 0" : ", the largest"));
    report.line("its semi-axes", rounded(polhode.semi_axes) + " rad/s");
    report.line("shown", fmt::format("0 s to {:.4g} s{}", polhode.until,
                                     polhode.closed  ? ", once round"
                                     : !polhode.free ? "; off the ellipsoid where a torque or an impulse takes it"
                                                     : ""));
    report.line("signs", "solid in front, dotted behind; sparse the ellipsoid's outline; o the start");
    for (const std::string& line : polhode_text(polhode)) report.line(line);
}

}  // namespace

std::string describe_scene(const Scene& scene) {
    const Problem problem = pose(scene);
    Report report;
    report.title(one_line(scene.name, 200));
    if (!scene.about.empty()) report.line(one_line(scene.about, 2000));
    if (!scene.source.empty()) report.line("Source: " + one_line(scene.source, 2000));
    report.line("duration", number(scene.duration) + " s");
    mass_properties(report, problem);
    report.title("Start");
    report.line("attitude", text(problem.body.q) + ", body to world");
    report.line("angular velocity", text(problem.body.angular_velocity_B) + " rad/s, body axes");
    report.line("centre of mass at", text(problem.body.position_W) + " m, world axes");
    report.line("its velocity", text(problem.body.velocity_W) + " m/s, world axes");
    loads(report, problem);
    system_posed(report, problem);
    invariants(report, problem);
    conditioning(report, problem);
    polhode_drawing(report, problem);
    return report.text();
}

}  // namespace polhode
