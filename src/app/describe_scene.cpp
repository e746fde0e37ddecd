// The description of a scene of one body, and describe_scene().
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/describe.h"
#include "app/description.h"
#include "app/polhode_picture.h"
#include "body/orientation.h"
#include "check/limits.h"
#include "integrators/analysis/conditioning.h"
#include "integrators/method.h"
#include "integrators/run/stiffness.h"
#include "motion/contact.h"
#include "motion/problem.h"
#include "scene/contact_shape.h"
#include "scene/plane_file.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

using namespace description;

constexpr double heavy_mesh = 1e5;  // kg

std::string describe_definition(const BodyDefinition& source) {
    struct Words {
        std::string operator()(const NumericBody&) const { return "mass and inertia"; }
        std::string operator()(const ShapedBody& b) const {
            return fmt::format("a {} of uniform density", name_of(b.shape));
        }
        std::string operator()(const PointsBody& b) const { return fmt::format("{} point masses", b.points.size()); }
        std::string operator()(const MeshBody& b) const {
            return fmt::format("the volume enclosed by {}, {} triangles", b.file, b.mesh.triangles.size());
        }
        std::string operator()(const PartsBody& b) const {
            if (const Shape* hull = contact_shape(b))
                return fmt::format("mass and inertia; contact shape: {}", name_of(*hull));
            return fmt::format("{} parts", b.parts.size());
        }
        std::string operator()(const ImportedBody& b) const { return fmt::format("the link {} of {}", b.link, b.file); }
    };
    return one_line(std::visit(Words{}, source), 200);
}

// angle between the angular velocity and the angular momentum
void momentum_direction(Report& report, const Problem& problem) {
    const Vector3<double>& w = problem.body.angular_velocity_B;
    const double aside = angle_between(w, problem.body.inertia_B * w);
    if (dot(w, w) > 0) report.line("angle from w to L", number(aside) + " rad at t = 0");
}

void mass_properties(Report& report, const Problem& problem) {
    const Body& body = problem.scene.body;
    report.title("Mass properties");
    if (body.source) report.line("defined by", describe_definition(body.source->definition));
    report.line("mass", number(body.mass) + " kg");
    if (body.source && std::holds_alternative<MeshBody>(body.source->definition) && body.mass > heavy_mesh)
        report.line("", "heavier than 1e5 kg: if the file's coordinates are in millimetres, give \"scale\": 0.001");
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
                                      ? "body axes"
                                      : "q " + text(problem.body.principal.q_BP) + ", principal to body");
    momentum_direction(report, problem);
}

void planes(Report& report, const Problem& problem) {
    if (problem.scene.planes.empty()) return;
    report.title("Planes");
    for (std::size_t i = 0; i < problem.scene.planes.size(); ++i) {
        const Plane& plane = problem.scene.planes[i];
        std::string laws = fmt::format(
            "{} . x > {} m, restitution {}, {}", text(plane.normal_W), number(plane.offset), number(plane.restitution),
            plane.friction > 0 ? "Coulomb friction " + number(plane.friction) : "without friction");
        if (plane.restitution_law != RestitutionLaw::stronge)
            laws += fmt::format(", law of restitution {}", name_of(plane.restitution_law));
        if (plane.torsional_friction > 0) laws += fmt::format(", torsional {} m", number(plane.torsional_friction));
        if (plane.rolling_friction > 0) laws += fmt::format(", rolling {} m", number(plane.rolling_friction));
        report.line(one_line(plane_name(problem.scene, i), 200), laws);
    }
    const std::size_t pieces = problem.body.geometry->pieces.size();
    report.line("hull", fmt::format("{} piece{} (points, balls or discs), at most {} m from the centre of mass", pieces,
                                    pieces == 1 ? "" : "s", number(problem.body.geometry->reach)));
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
        case SystemKind::user_defined:
        case SystemKind::mechanism:
        case SystemKind::body_with_formulas:
        case SystemKind::mechanism_with_formulas:
            break;
    }
    return "J dw/dt = tau(t, q, w, p, v) - w x Jw, full tensor;  dq/dt = q (0, w) / 2;  dp/dt = v;  dv/dt = F / m";
}

// Lists the terms of tau on the segment.
std::string torque_terms(const Forcing<double>& f) {
    std::vector<std::string> terms;
    if (!f.body_points.empty()) terms.push_back("forces constant in the world at body points");
    if (f.has_world_torque) terms.push_back("a torque constant in the world");
    if (f.has_torque) terms.push_back("a torque constant in the body");
    if (f.has_damping) terms.push_back("drag");
    if (!f.springs.empty()) terms.push_back("springs");
    if (!f.world_points.empty()) terms.push_back("forces at world points");
    if (!f.user_torques.empty()) terms.push_back("a user-defined torque");
    return terms.empty() ? "no torque" : join_with_commas(terms);
}

void system_posed(Report& report, const Problem& problem) {
    const Needs& needs = problem.needs;
    report.title("System posed");
    const bool has_formulas = has_formula_loads(problem.scene);
    report.line("system", fmt::format("{}, {} variables", name_of(needs.system), needs.dimension));
    report.line("equations", equations(needs.system));
    if (has_formulas) description::formulas(report, problem);
    report.line("axes", has_formulas || problem.body.q_BP == Quaternion<double>{} ? "body axes" : "principal axes");
    report.line("about", problem.body.pivoted ? "the pivot" : "the centre of mass");
    const char* translation = needs.translation == Translation::fixed         ? "none"
                              : needs.translation == Translation::closed_form ? "closed form"
                                                                              : "integrated";
    report.line("translation", translation);
    if (problem.needs.system == SystemKind::principal_axis_rotation)
        report.line("axis e", text(problem.body.axis) + ", in these axes");
    // sampled formulas have a segment per sample
    constexpr std::size_t most_segments = 60;
    for (const Segment& segment : problem.segments) {
        if (segment.index == most_segments) {
            report.line(fmt::format(".. {} more", problem.segments.size() - most_segments));
            break;
        }
        std::string acts = torque_terms(segment.forcing);
        if (has_formulas) acts = acts == "no torque" ? "formulas" : fmt::format("formulas, {}", acts);
        if (!segment.impulses.empty())
            acts = fmt::format("{} impulse{}, then {}", segment.impulses.size(),
                               segment.impulses.size() == 1 ? "" : "s", acts);
        report.line(fmt::format("{} s to {} s", number(segment.begin), number(segment.end)), acts);
    }
    report.title("Omitted, and why");
    if (needs.omitted.empty()) report.line("nothing");
    for (const Omission& one : needs.omitted) report.line(one.what, one.why);
}

void polhode_drawing(Report& report, const Problem& problem) {
    report.title("Polhode: the angular velocity in principal axes");
    const PolhodeCurve polhode = polhode_curve(problem);
    if (!polhode.fault.empty()) {
        report.line("not available: " + polhode.fault);
        return;
    }
    if (polhode.energy == 0) {
        report.line("none: the body does not rotate");
        return;
    }
    const auto rounded = [](const Vector3<double>& v) {
        return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]);
    };
    report.line("ellipsoid", fmt::format("2 E = I1 w1^2 + I2 w2^2 + I3 w3^2, E = {:.6g} J{}", polhode.energy,
                                         polhode.energy_of_start ? " at t = 0" : ", the largest of the run"));
    report.line("semi-axes", rounded(polhode.semi_axes) + " rad/s");
    report.line("shown", fmt::format("0 s to {:.4g} s{}", polhode.until,
                                     polhode.closed  ? ", one period of the curve"
                                     : !polhode.free ? "; a torque or an impulse moves the curve off the ellipsoid"
                                                     : ""));
    report.line("symbols", "solid: in front; dotted: behind; sparse: outline of the ellipsoid; o: start");
    for (const std::string& line : polhode_text(polhode)) report.line(line);
}

// Equally spaced times, and 50 per decade from T / 10^8, so that a run that stops early is resolved.
std::vector<double> conditioning_times(double T) {
    constexpr long decades = 8, per_decade = 50;
    std::vector<double> times = sample_times(T, 2000);
    for (long k = 1; k <= decades * per_decade; ++k)
        times.push_back(T * std::pow(10, -static_cast<double>(k) / static_cast<double>(per_decade)));
    std::sort(times.begin(), times.end());
    return times;
}

}  // namespace

std::string describe_scene(const Scene& scene, ConditioningBudget budget) {
    const Problem problem = pose(scene);
    Report report;
    report.title(one_line(scene.name, 200));
    if (!scene.about.empty()) report.line(one_line(scene.about, 2000));
    if (!scene.source.empty()) report.line("Source: " + one_line(scene.source, 2000));
    report.line("duration", number(scene.duration) + " s");
    if (is_mechanism(scene)) {
        description::mechanism(report, problem);
        if (has_sphere_contacts(scene)) contacts(report, problem);
        growth(report, problem, budget, sample_times(scene.duration, 200));
        return report.text();
    }
    mass_properties(report, problem);
    report.title("Start");
    report.line("attitude", text(problem.body.q) + ", body to world");
    report.line("angular velocity", text(problem.body.angular_velocity_B) + " rad/s, body axes");
    report.line("position", text(problem.body.position_W) + " m, centre of mass, world axes");
    report.line("velocity", text(problem.body.velocity_W) + " m/s, centre of mass, world axes");
    loads(report, problem.scene);
    planes(report, problem);
    contacts(report, problem);
    system_posed(report, problem);
    choice(report, problem);
    invariants(report, problem, "none: the loads change energy and every component of momentum");
    growth(report, problem, budget, conditioning_times(scene.duration));
    polhode_drawing(report, problem);
    return report.text();
}

}  // namespace polhode
