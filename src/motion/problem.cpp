#include "motion/problem.h"

#include <algorithm>
#include <cmath>

#include "motion/needs.h"
#include "motion/rounded.h"
#include "motion/translation.h"

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

// p and v a time `after` the segment's begin
void translate(const Segment& s, double after, Vector3<double>& p, Vector3<double>& v) {
    p = s.position_W, v = s.velocity_W;
    translate(s.forcing.acceleration_W, s.forcing.has_translational_drag ? s.forcing.specific_drag : 0, after, p, v);
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

}  // namespace

Problem pose(const Scene& scene, Formulation formulation) {
    Problem problem;
    problem.scene = scene;
    problem.formulation = formulation;
    const ExactBody<Wide> exact = exact_body<Wide>(scene);
    problem.body = rounded(exact);
    problem.wide_principal = wide_principal_frame(exact.inertia_B);
    problem.wide_initial_angular_velocity = rotate_back(problem.wide_principal.q_BP, exact.angular_velocity_B);
    problem.principal = rounded(problem.wide_principal);
    problem.principal_inertia = {problem.principal.gyroscopic, problem.principal.inverse_moments, false};
    problem.full_inertia = {problem.body.inertia_B, cast<double>(inverse(exact.inertia_B))};
    problem.q_BP = formulation == Formulation::full ? Quaternion<double>{} : problem.principal.q_BP;

    const Quaternion<Wide> q_BP = normalized(cast<Wide>(problem.q_BP));
    problem.initial_angular_velocity = cast<double>(rotate_back(q_BP, exact.angular_velocity_B));
    problem.initial_q = cast<double>(exact.q * q_BP);
    problem.axis = Vector3<double>(0, 0, 1);

    std::vector<Forcing<Wide>> forcings;
    for (const Leg& leg : itinerary(scene)) {
        Segment segment;
        static_cast<Leg&>(segment) = leg;
        forcings.push_back(forcing_at(scene, exact, segment.begin, q_BP));
        segment.forcing = rounded<double>(forcings.back());
        segment.impulses = rounded(impulses_at(scene, exact, segment.begin, q_BP));
        for (const Load& load : scene.loads)
            if (const auto* user = std::get_if<UserTorque>(&load); user && acts(user->window, segment.begin))
                segment.forcing.user_torques.push_back(posed_user_torque(*user, problem.q_BP));
        segment.forcing.only_field = !segment.forcing.any_torque_beside_field();
        problem.segments.push_back(std::move(segment));
    }
    const ContactGeometry<Wide> geometry = contact_geometry(scene, exact.center, q_BP);
    for (const ContactPlane<Wide>& plane : geometry.planes)
        problem.geometry.planes.push_back(
            {cast<double>(plane.normal_W), double(plane.offset), double(plane.restitution), double(plane.friction)});
    for (const SupportPiece<Wide>& piece : geometry.pieces)
        problem.geometry.pieces.push_back(
            {cast<double>(piece.center), piece.extended, cast<double>(piece.semi_axes), double(piece.radius)});
    problem.geometry.reach = double(geometry.reach);
    find_needs(problem, exact, q_BP, forcings);

    if (problem.needs.translation != Translation::integrated) {
        Vector3<double> p = problem.body.position_W, v = problem.body.velocity_W;
        for (std::size_t i = 0; i < problem.segments.size(); ++i) {
            Segment& segment = problem.segments[i];
            if (i > 0) translate(problem.segments[i - 1], segment.begin - problem.segments[i - 1].begin, p, v);
            for (const auto& impulse : segment.impulses) v = v + (1 / problem.body.mass) * impulse.vector;
            segment.position_W = p, segment.velocity_W = v;
        }
    }
    find_scales(problem);
    return problem;
}

std::size_t segment_at(const Problem& problem, double t) {
    std::size_t i = problem.segments.size() - 1;
    while (i > 0 && !acts_before_sample(problem.segments[i].begin, t)) --i;
    return i;
}

const char* name_of(Formulation formulation) {
    switch (formulation) {
        case Formulation::reduced:
            return "reduced";
        case Formulation::full_principal:
            return "full in the principal frame";
        case Formulation::full:
            break;
    }
    return "full as written";
}

const char* name_of(System system) {
    switch (system) {
        case System::principal_axis_rotation:
            return "rotation about a principal axis";
        case System::free_rotation:
            return "free rotation";
        case System::loaded_rotation:
            return "loaded rotation";
        case System::loaded_motion:
            return "loaded rotation and translation";
        case System::full_motion:
            break;
    }
    return "full motion";
}

double energy_bound(const Problem& problem) {
    const Vector3<double>& moments = problem.principal.moments;
    const double largest = std::max({moments[0], moments[1], moments[2]});
    const Scales& s = problem.scales;
    double scale = largest * s.angular_velocity * s.angular_velocity / 2;
    if (!problem.body.pivoted) scale += problem.body.mass * s.velocity * s.velocity / 2;
    return 1e6 * scale;
}

template <>
PrincipalAxisRotation<double> system_on(const Problem&, const Segment& segment) {
    return segment.about_axis;
}
template <>
FreeRotation<double> system_on(const Problem& problem, const Segment&) {
    return {problem.principal_inertia};
}
template <>
LoadedRotation<double> system_on(const Problem& problem, const Segment& segment) {
    return {problem.principal_inertia, &segment.forcing};
}
template <>
LoadedMotion<double> system_on(const Problem& problem, const Segment& segment) {
    return {problem.principal_inertia, &segment.forcing};
}
template <>
FullMotion<double> system_on(const Problem& problem, const Segment& segment) {
    return {problem.full_inertia, &segment.forcing};
}

template <class SystemType>
void initial_state(const Problem& problem, double* y) {
    if constexpr (SystemType::dimension == 3) {
        y[0] = dot(problem.axis, problem.initial_angular_velocity), y[1] = 1, y[2] = 0;
    } else {
        put(y, 0, problem.initial_angular_velocity);
        put(y, 3, problem.initial_q);
        if constexpr (SystemType::dimension == 13) {
            put(y, 7, problem.body.position_W);
            put(y, 10, problem.body.velocity_W);
        }
    }
}

template <class SystemType>
bool enter(const Problem& problem, const Segment& segment, double* y) {
    for (const PosedImpulse<double>& impulse : segment.impulses) {
        Vector3<double> w, p, v;
        Quaternion<double> q;
        if constexpr (SystemType::dimension == 3) {
            w = y[0] * problem.axis;
            q = problem.initial_q *
                Quaternion<double>{y[1], y[2] * problem.axis[0], y[2] * problem.axis[1], y[2] * problem.axis[2]};
        } else {
            w = vector_at(y, 0), q = quaternion_at(y, 3);
        }
        if constexpr (SystemType::dimension == 13) p = vector_at(y, 7), v = vector_at(y, 10);
        const Vector3<double> before = w;
        if (problem.formulation == Formulation::full)
            apply(impulse, problem.full_inertia, problem.body.mass, problem.body.pivoted, w, q, p, v);
        else
            apply(impulse, problem.principal_inertia, problem.body.mass, problem.body.pivoted, w, q, p, v);
        if constexpr (SystemType::dimension == 3) {
            y[0] += dot(problem.axis, w - before);
        } else {
            put(y, 0, w);
        }
        if constexpr (SystemType::dimension == 13) {
            if (problem.body.pivoted) pivoted_center(q, w, segment.forcing.arm, p, v);
            put(y, 10, v);
        }
    }
    return !segment.impulses.empty();
}

template <class SystemType>
Sample sample_of(const Problem& problem, double t, const double* y) {
    Sample sample;
    sample.t = t;
    Vector3<double> w;
    Quaternion<double> q;
    if constexpr (SystemType::dimension == 3) {
        w = y[0] * problem.axis;
        q = problem.initial_q *
            Quaternion<double>{y[1], y[2] * problem.axis[0], y[2] * problem.axis[1], y[2] * problem.axis[2]};
    } else {
        w = vector_at(y, 0), q = quaternion_at(y, 3);
    }
    const bool same_axes = problem.q_BP == Quaternion<double>{};
    sample.q = same_axes ? q : q * conjugate(problem.q_BP);
    sample.angular_velocity_B = same_axes ? w : rotate(problem.q_BP, w);
    if constexpr (SystemType::dimension == 13) {
        sample.position_W = vector_at(y, 7), sample.velocity_W = vector_at(y, 10);
    } else if (problem.body.pivoted) {
        pivoted_center(sample.q, sample.angular_velocity_B, problem.body.arm, sample.position_W, sample.velocity_W);
    } else {
        const Segment& segment = problem.segments[segment_at(problem, t)];
        translate(segment, t - segment.begin, sample.position_W, sample.velocity_W);
    }
    return sample;
}

Placement<double> placement_of(const double* y) {
    const Quaternion<double> q = normalized(quaternion_at(y, 3));
    return {q, vector_at(y, 7), vector_at(y, 10), rotate(q, vector_at(y, 0))};
}

ImpactOutcome strike_planes(const Problem& problem, double tolerance, double* y) {
    const Placement<double> at = placement_of(y);
    const std::vector<Contact<double>> touching = problem.geometry.contacts(at, tolerance);
    if (touching.empty()) return {};
    const Matrix3<double> inverse_inertia = problem.formulation == Formulation::full
                                                ? problem.full_inertia.inverse
                                                : diagonal(problem.principal_inertia.inverse_moments);
    StruckBody<double> body{1 / problem.body.mass, rotated(inverse_inertia, at.q), at.position_W, at.velocity_W,
                            at.angular_velocity_W};
    const ImpactOutcome outcome = resolve_impact(body, touching);
    if (outcome.struck) {
        // the change alone is turned back: a component that no impulse touches keeps its bits but for that
        put(y, 0, vector_at(y, 0) + rotate_back(at.q, body.angular_velocity_W - at.angular_velocity_W));
        put(y, 10, body.velocity_W);
    }
    return outcome;
}

template <class SystemType>
void component_scales(const Problem& problem, double* scales) {
    constexpr int n = SystemType::dimension;
    const int rates = n == 3 ? 1 : 3;
    std::fill(scales, scales + rates, problem.scales.angular_velocity);
    std::fill(scales + rates, scales + (n == 3 ? 3 : 7), 1.0);
    if constexpr (n == 13) {
        std::fill(scales + 7, scales + 10, problem.scales.position);
        std::fill(scales + 10, scales + 13, problem.scales.velocity);
    }
}

#define POLHODE_INSTANTIATE(SYSTEM)                                                   \
    template void initial_state<SYSTEM<double>>(const Problem&, double*);             \
    template bool enter<SYSTEM<double>>(const Problem&, const Segment&, double*);     \
    template Sample sample_of<SYSTEM<double>>(const Problem&, double, const double*); \
    template void component_scales<SYSTEM<double>>(const Problem&, double*);
POLHODE_INSTANTIATE(PrincipalAxisRotation)
POLHODE_INSTANTIATE(FreeRotation)
POLHODE_INSTANTIATE(LoadedRotation)
POLHODE_INSTANTIATE(LoadedMotion)
POLHODE_INSTANTIATE(FullMotion)

}  // namespace polhode
