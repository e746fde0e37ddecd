#include "motion/problem.h"

#include <fmt/format.h>

#include <algorithm>

#include "motion/contact.h"
#include "motion/finer_frame.h"
#include "motion/formula_model.h"
#include "motion/mechanism.h"
#include "motion/needs.h"
#include "motion/rounded.h"
#include "motion/translation.h"
#include "motion/user_system.h"
#include "text/message.h"

namespace polhode {
namespace {

ExactBody<double> rounded(const ExactBody<Wide>& b) {
    ExactBody<double> r;
    r.mass = double(b.mass);
    r.inertia_B = cast<double>(b.inertia_B);
    r.pivoted = b.pivoted;
    r.center = cast<double>(b.center);
    r.origin = cast<double>(b.origin);
    r.arm = cast<double>(b.arm);
    r.q = cast<double>(b.q);
    r.angular_velocity_B = cast<double>(b.angular_velocity_B);
    r.position_W = cast<double>(b.position_W);
    r.velocity_W = cast<double>(b.velocity_W);
    return r;
}

PosedUserTorque posed_user_torque(const UserTorque& load, const Quaternion<double>& q_BP) {
    return [torque_B = load.torque_B, q_BP](double t, const Quaternion<double>& q, const Vector3<double>& w,
                                            const Vector3<double>& p, const Vector3<double>& v) {
        return rotate_back(q_BP, torque_B({t, q * conjugate(q_BP), rotate(q_BP, w), p, v}));
    };
}

template <class P>
std::vector<PosedImpulse<double>> rounded(const std::vector<PosedImpulse<P>>& impulses) {
    std::vector<PosedImpulse<double>> r;
    for (const auto& i : impulses) r.push_back({cast<double>(i.vector), i.frame, cast<double>(i.point), i.point_frame});
    return r;
}

// Throws if the equations of several bodies would ignore a part of the scene. validate() refuses these parts, too;
// this check also covers callers that do not validate.
void refuse_parts_of_one_body(const Scene& scene) {
    const auto fail = [&](const std::string& place, const char* fault, const char* remedy) {
        throw InputError(scene.name, place, fault, remedy);
    };
    for (std::size_t i = 0; i < scene.loads.size(); ++i)
        if (std::holds_alternative<UserTorque>(scene.loads[i]))
            fail(fmt::format("/loads/{}", i),
                 "is a user-defined torque, which scenes with several bodies do not support",
                 "give a load of type torque or force with \"body\", or a motor on a joint");
    if (scene.pivot)
        fail("/pivot", "is given in a scene with several bodies",
             "connect a body to the world by a joint whose parent is \"world\"");
    const bool has_contacts = !scene.planes.empty() || !scene.contacts.empty();
    if (has_contacts && !scene.joints.empty())
        fail(scene.contacts.empty() ? "/planes" : "/contacts", "are given together with joints", "remove them");
    const Body &body = scene.body, no_body;
    if (body.mass != no_body.mass || !(body.inertia_B == no_body.inertia_B) ||
        !(body.center_of_mass == no_body.center_of_mass) || body.source)
        fail("/body", "is given in a scene with several bodies", "move its properties into one of \"bodies\"");
    const Initial &initial = scene.initial, at_rest;
    if (!(initial.orientation == at_rest.orientation && initial.angular_velocity == at_rest.angular_velocity &&
          initial.position_W == at_rest.position_W && initial.velocity_W == at_rest.velocity_W))
        fail("/initial", "is given in a scene with several bodies", "move it into one of \"bodies\" or into a joint");
}

// Throws if the equations of one body would ignore a part of the scene.
void refuse_parts_of_several_bodies(const Scene& scene) {
    const char* remedy = "use \"bodies\" instead of \"body\"";
    if (!scene.joints.empty()) throw InputError(scene.name, "/joints", "are given in a scene with one body", remedy);
    if (!scene.loops.empty()) throw InputError(scene.name, "/loops", "are given in a scene with one body", remedy);
    if (!scene.couplings.empty())
        throw InputError(scene.name, "/couplings", "are given in a scene with one body", remedy);
    if (!scene.contacts.empty())
        throw InputError(scene.name, "/contacts", "are given in a scene with one body", remedy);
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
        const Load& load = scene.loads[i];
        if (!load_body(load).empty() || std::holds_alternative<Motor>(load) ||
            std::holds_alternative<PointSpring>(load))
            throw InputError(scene.name, fmt::format("/loads/{}", i), "needs several bodies, but the scene has one",
                             remedy);
    }
}

// Sets the inertia tensor, the principal frame and the frame in which the body is posed.
void pose_inertia(const Scene& scene, const ExactBody<Wide>& exact, Problem& problem) {
    problem.body.wide_principal = wide_principal_frame(exact.inertia_B);
    problem.body.wide_initial_angular_velocity =
        rotate_back(problem.body.wide_principal.q_BP, exact.angular_velocity_B);
    problem.body.principal = rounded(problem.body.wide_principal);
    problem.body.full_inertia = {problem.body.inertia_B, cast<double>(inverse(exact.inertia_B))};
    const bool moved = exact.pivoted && !(exact.arm == Vector3<Wide>());
    if (needs_finer_frame(exact.inertia_B, moved, problem.body.principal.moments)) {
        const FinerFrame finer = finer_frame(scene);
        problem.body.wide_principal = finer.wide, problem.body.principal = finer.nearest;
        problem.body.wide_initial_angular_velocity = finer.angular_velocity_B;
        problem.body.full_inertia.inverse = finer.inverse_inertia;
    }
    problem.body.principal_inertia = {problem.body.principal.gyroscopic, problem.body.principal.inverse_moments, false};
    problem.body.q_BP = problem.formulation == Formulation::full ? Quaternion<double>{} : problem.body.principal.q_BP;
}

// Sets the segments. Returns the unrounded forcing of each.
std::vector<Forcing<Wide>> pose_segments(const Scene& scene, const ExactBody<Wide>& exact, const Quaternion<Wide>& q_BP,
                                         Problem& problem) {
    std::vector<Forcing<Wide>> forcings;
    for (const Leg& leg : itinerary(scene)) {
        Segment segment;
        static_cast<Leg&>(segment) = leg;
        forcings.push_back(forcing_at(scene, exact, segment.begin, q_BP));
        segment.forcing = rounded<double>(forcings.back());
        segment.impulses = rounded(impulses_at(scene, exact, segment.begin, q_BP));
        for (const Load& load : scene.loads)
            if (const auto* user = std::get_if<UserTorque>(&load); user && acts(user->window, segment.begin))
                segment.forcing.user_torques.push_back(posed_user_torque(*user, problem.body.q_BP));
        segment.forcing.only_field = !segment.forcing.any_torque_beside_field();
        problem.segments.push_back(std::move(segment));
    }
    return forcings;
}

ContactGeometry<double> rounded_geometry(const ContactGeometry<Wide>& geometry) {
    ContactGeometry<double> result;
    for (const ContactPlane<Wide>& plane : geometry.planes)
        result.planes.push_back(
            {cast<double>(plane.normal_W), double(plane.offset), double(plane.restitution), double(plane.friction)});
    for (const SupportPiece<Wide>& piece : geometry.pieces)
        result.pieces.push_back(
            {cast<double>(piece.center), piece.extended, cast<double>(piece.semi_axes), double(piece.radius)});
    result.reach = double(geometry.reach);
    return result;
}

// Sets position and velocity at the start of each segment of a translation in closed form.
void pose_translation(Problem& problem) {
    Vector3<double> p = problem.body.position_W, v = problem.body.velocity_W;
    for (std::size_t i = 0; i < problem.segments.size(); ++i) {
        Segment& segment = problem.segments[i];
        if (i > 0) translated(problem.segments[i - 1], segment.begin - problem.segments[i - 1].begin, p, v);
        for (const auto& impulse : segment.impulses) v = v + (1 / problem.body.mass) * impulse.vector;
        segment.position_W = p, segment.velocity_W = v;
    }
}

}  // namespace

Problem pose(const Scene& scene, Formulation formulation) {
    if (is_mechanism(scene)) {
        refuse_parts_of_one_body(scene);
        return has_formula_loads(scene) ? pose_formula_mechanism(scene) : pose_mechanism(scene);
    }
    refuse_parts_of_several_bodies(scene);
    Problem problem;
    problem.scene = scene;
    problem.formulation = formulation;
    const ExactBody<Wide> exact = exact_body<Wide>(scene);
    static_cast<ExactBody<double>&>(problem.body) = rounded(exact);
    pose_inertia(scene, exact, problem);

    const Quaternion<Wide> q_BP = normalized(cast<Wide>(problem.body.q_BP));
    problem.body.initial_angular_velocity = cast<double>(rotate_back(q_BP, exact.angular_velocity_B));
    problem.body.initial_q = cast<double>(exact.q * q_BP);
    problem.body.axis = Vector3<double>(0, 0, 1);

    const std::vector<Forcing<Wide>> forcings = pose_segments(scene, exact, q_BP, problem);
    problem.body.geometry =
        std::make_shared<const ContactGeometry<double>>(rounded_geometry(contact_geometry(scene, exact.center, q_BP)));
    find_needs(problem, exact, q_BP, forcings);
    if (problem.needs.translation != Translation::integrated) pose_translation(problem);
    find_scales(problem);
    if (has_formula_loads(scene)) pose_formula_loads(problem);
    return problem;
}

std::size_t segment_at(const Problem& problem, double t) {
    std::size_t i = problem.segments.size() - 1;
    while (i > 0 && !acts_before_sample(problem.segments[i].begin, t)) --i;
    return i;
}

void translated(const Segment& segment, double after, Vector3<double>& position_W, Vector3<double>& velocity_W) {
    const Forcing<double>& f = segment.forcing;
    position_W = segment.position_W, velocity_W = segment.velocity_W;
    translate(f.acceleration_W, f.has_translational_drag ? f.specific_drag : 0, after, position_W, velocity_W);
}

const char* name_of(Formulation formulation) {
    constexpr const char* names[] = {"reduced", "full in the principal frame", "full as written"};
    return names[static_cast<std::size_t>(formulation)];
}

const char* name_of(SystemKind system) {
    constexpr const char* names[] = {"rotation about a principal axis",
                                     "free rotation",
                                     "loaded rotation",
                                     "loaded rotation and translation",
                                     "full motion",
                                     "user-defined system",
                                     "several bodies",
                                     "one body with formula loads",
                                     "several bodies with formula loads"};
    return names[static_cast<std::size_t>(system)];
}

double energy_bound(const Problem& problem) {
    if (const auto model = problem.model()) return model->energy_bound();
    const Vector3<double>& moments = problem.body.principal.moments;
    const double largest = std::max({moments[0], moments[1], moments[2]});
    const Scales& s = problem.scales;
    double scale = largest * s.angular_velocity * s.angular_velocity / 2;
    if (!problem.body.pivoted) scale += problem.body.mass * s.velocity * s.velocity / 2;
    return 1e6 * scale;
}

}  // namespace polhode
