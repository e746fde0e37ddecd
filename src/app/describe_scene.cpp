// What there is to say about a scene before it is solved.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/describe.h"
#include "app/polhode_picture.h"
#include "body/orientation.h"
#include "check/limits.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/method.h"
#include "integrators/run/stiffness.h"
#include "motion/conserved.h"
#include "motion/contact.h"
#include "motion/problem.h"
#include "scene/scene_file.h"
#include "text/decimal.h"
#include "text/message.h"

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

std::string made_of(const MadeOf& source) {
    struct Words {
        std::string operator()(const GivenBody&) const { return "numbers"; }
        std::string operator()(const ShapedBody& b) const {
            return fmt::format("a {} of uniform density", name_of(b.shape));
        }
        std::string operator()(const PointsBody& b) const { return fmt::format("{} point masses", b.points.size()); }
        std::string operator()(const MeshBody& b) const {
            return fmt::format("what {} encloses with {} triangles", b.file, b.mesh.triangles.size());
        }
        std::string operator()(const PartsBody& b) const { return fmt::format("{} parts", b.parts.size()); }
        std::string operator()(const ImportedBody& b) const { return fmt::format("the link {} of {}", b.link, b.file); }
    };
    return one_line(std::visit(Words{}, source), 200);
}

// how far the momentum is from the rate it belongs to
void momentum_direction(Report& report, const Problem& problem) {
    const Vector3<double>& w = problem.body.angular_velocity_B;
    const double aside = angle_between(w, problem.body.inertia_B * w);
    if (dot(w, w) > 0) report.line("angle from w to L", number(aside) + " rad at t = 0");
}

void mass_properties(Report& report, const Problem& problem) {
    const Body& body = problem.scene.body;
    report.title("Mass properties");
    if (body.source) report.line("made of", made_of(body.source->made_of));
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
    report.line("principal moments", text(problem.body.principal.moments) + " kg m^2; " + symmetry);
    report.line("principal axes", problem.body.principal.q_BP == Quaternion<double>{}
                                      ? "the body's own"
                                      : "q " + text(problem.body.principal.q_BP) + ", principal to body");
    momentum_direction(report, problem);
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
    std::string operator()(const Motor& load) const {
        return fmt::format("motor of joint \"{}\", {} N m (N) along its axis", load.joint, number(load.force));
    }
    std::string operator()(const PointSpring& load) const {
        return fmt::format("spring {} N/m from {} m in {} to {} m in {}, {} m long at rest", number(load.stiffness),
                           text(load.first_point), load.first, text(load.second_point), load.second,
                           number(load.rest_length));
    }
};

// of several, the one that a load acts on
std::string on_body(const Load& load) {
    const std::string name = load_body(load);
    return name.empty() ? "" : fmt::format(", on body \"{}\"", name);
}

void loads(Report& report, const Problem& problem) {
    report.title("Loads");
    if (problem.scene.loads.empty()) report.line("none");
    for (const Load& load : problem.scene.loads) {
        const Window window = window_of(load);
        std::string when;
        if (std::isfinite(window.from)) when += fmt::format(", from {} s", number(window.from));
        if (std::isfinite(window.until)) when += fmt::format(", until {} s", number(window.until));
        report.line(std::visit(LoadText{}, load) + when + on_body(load));
    }
}

void planes(Report& report, const Problem& problem) {
    if (problem.scene.planes.empty()) return;
    report.title("Planes");
    for (const Plane& plane : problem.scene.planes)
        report.line(fmt::format(
            "{} . x > {} m, restitution {}, {}", text(plane.normal_W), number(plane.offset), number(plane.restitution),
            plane.friction > 0 ? "Coulomb friction " + number(plane.friction) : "without friction"));
    const std::size_t pieces = problem.body.geometry->pieces.size();
    report.line("hull", fmt::format("of {} point{}, balls or discs, none further than {} m from the centre of mass",
                                    pieces, pieces == 1 ? "" : "s", number(problem.body.geometry->reach)));
}

std::string equations(SystemKind system) {
    switch (system) {
        case SystemKind::principal_axis_rotation:
            return "dw/dt = tau(c, s, w) / I;  dc/dt = -w s / 2;  ds/dt = w c / 2;  q = q0 (c, s e)";
        case SystemKind::free_rotation:
            return "I dw/dt = -w x Iw;  dq/dt = q (0, w) / 2";
        case SystemKind::loaded_rotation:
            return "I dw/dt = tau(t, q, w) - w x Iw;  dq/dt = q (0, w) / 2";
        case SystemKind::loaded_motion:
            return "I dw/dt = tau(t, q, w, p) - w x Iw;  dq/dt = q (0, w) / 2;  dp/dt = v;  dv/dt = F(t, q, v) / m";
        case SystemKind::full_motion:
        case SystemKind::own:
        case SystemKind::mechanism:
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
    report.line("axes", problem.body.q_BP == Quaternion<double>{} ? "the body's own" : "the principal ones");
    report.line("about", problem.body.pivoted ? "the pivot" : "the centre of mass");
    const char* translation = needs.translation == Translation::fixed         ? "none of its own"
                              : needs.translation == Translation::closed_form ? "closed form"
                                                                              : "integrated";
    report.line("translation", translation);
    if (problem.needs.system == SystemKind::principal_axis_rotation)
        report.line("axis e", text(problem.body.axis) + ", in these axes");
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

void choice(Report& report, const Problem& problem) {
    report.title("What auto takes");
    const Choice taken = choose_method(problem);
    report.line(std::string(taken.method->name), std::string(taken.why));
    const Stiffness found = stiffness(problem);
    if (found.decays > 0)
        report.line(found.stiff() ? "stiff" : "not stiff",
                    fmt::format("{:.3g} decay times of what decays fastest, while the body turns by {:.3g} rad",
                                found.decays, found.turning));
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

// How small changes of the start grow, and so from when on an engine's error says nothing about the engine.
void conditioning(Report& report, const Problem& problem) {
    report.title("Conditioning");
    const double T = problem.scene.duration;
    // evenly, and 50 a decade from T / 10^8 on: a run that is cut short is known to its end all the same
    constexpr long intervals = 2000, decades = 8, a_decade = 50;
    std::vector<double> times = sample_times(T, intervals);
    for (long k = 1; k <= decades * a_decade; ++k)
        times.push_back(T * std::pow(10, -static_cast<double>(k) / static_cast<double>(a_decade)));
    std::sort(times.begin(), times.end());
    ConditioningSettings settings;
    settings.max_steps = prompt_conditioning_steps;
    const Conditioning found = polhode::conditioning(problem, times, settings);
    if (found.times.empty()) {
        report.line("not known: " + found.message);
        return;
    }
    const std::size_t last = found.times.size() - 1;
    const std::string end = found.available ? "T" : fmt::format("t = {:.4g} s", found.times[last]);
    const Peak state = found.state_peak();
    if (!found.available) report.line("only until " + end, found.message);
    report.line(fmt::format("kappa({})", found.available ? "T" : fmt::format("{:.4g} s", found.times[last])),
                fmt::format("{:.4g} = ||d state / d state(0)||, each block in units of its scale", found.state[last]));
    report.line("its peak", fmt::format("{:.4g}, at t = {:.4g} s", state.value, state.time));
    report.line("of it the attitude",
                fmt::format("{:.4g} rad at {} for each relative change of the start; at most "
                            "{:.4g} rad, at t = {:.4g} s",
                            found.attitude[last], end, found.attitude_peak().value, found.attitude_peak().time));
    for (const auto& [name, roundoff] :
         {std::pair("floor in binary64", float64_roundoff), std::pair("floor in binary32", float32_roundoff)})
        report.line(name, fmt::format("{:.2g} rad at {}, {:.2g} rad at worst: by rounding the start alone",
                                      found.floor(last, roundoff), end, found.floor_peak(roundoff).value));
    const ErrorLimit allowed = ErrorLimits(problem.scene)["attitude"];
    std::size_t k = 0;
    while (k <= last && !(found.floor(k, float32_roundoff) > allowed.value)) ++k;
    const std::string until = k <= last         ? fmt::format("until t = {:.4g} s", found.times[k])
                              : found.available ? "the whole run"
                                                : "at least until " + end;
    report.line("a float engine", fmt::format("can be judged {}: so long its floor is within {} rad ({})", until,
                                              number(allowed.value), allowed.from));
    if (found.available) report.line("by", found.message);
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
    planes(report, problem);
    system_posed(report, problem);
    choice(report, problem);
    invariants(report, problem);
    conditioning(report, problem);
    polhode_drawing(report, problem);
    return report.text();
}

}  // namespace polhode
