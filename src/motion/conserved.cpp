// Conserved quantities of a scene of one body.
//
// A quantity is reported only if the form of the loads and planes implies it. Kicks collects the directions in which
// loads, impulses and planes change a momentum; the momentum is conserved along directions perpendicular to all of
// them. Energy requires time-independent potential loads, spin an axis of symmetry that all loads respect, and the
// integrals of Kovalevskaya and of Goryachev and Chaplygin their special moments of inertia with the centre of mass
// on the equator.

#include "motion/conserved.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "body/elementary.h"
#include "motion/conserved_by_mechanism.h"
#include "motion/contact.h"
#include "motion/formula_potential.h"
#include "motion/systems.h"

namespace polhode {
namespace {

using VectorD = Vector3<double>;

constexpr double tolerance = 1e-12;

bool parallel(const VectorD& a, const VectorD& b) {
    return hypotenuse(cross(a, b)) <= tolerance * hypotenuse(a) * hypotenuse(b);
}
std::vector<double> components(const VectorD& v) { return {v[0], v[1], v[2]}; }

// Finds the world directions u along which X is conserved: every change (kick) of X must be perpendicular to u.
// `along`: the kicks are perpendicular to these vectors at any attitude, so u must be parallel to each of them.
// `across`: the kicks are along these vectors, so u must be perpendicular to each of them.
struct MomentumChanges {
    bool arbitrary = false;  ///< kicks without a fixed direction: nothing is conserved
    std::vector<VectorD> along, across;

    bool none() const { return !arbitrary && along.empty() && across.empty(); }
    std::vector<VectorD> conserved_directions() const {
        if (arbitrary) return {};
        if (!along.empty()) {
            const VectorD u = (1 / hypotenuse(along.front())) * along.front();
            for (const VectorD& v : along)
                if (!parallel(u, v)) return {};
            for (const VectorD& v : across)
                if (std::abs(dot(u, v)) > tolerance * hypotenuse(v)) return {};
            return {u};
        }
        // perpendicular to one direction there are two, to two directions one, to three none
        const VectorD first = (1 / hypotenuse(across.front())) * across.front();
        std::optional<VectorD> normal;
        for (const VectorD& v : across) {
            if (parallel(first, v)) continue;
            const VectorD n = cross(first, v);
            if (normal && !parallel(*normal, n)) return {};
            if (!normal) normal = (1 / hypotenuse(n)) * n;
        }
        if (normal) return {*normal};
        VectorD axis;
        const VectorD magnitude(std::abs(first[0]), std::abs(first[1]), std::abs(first[2]));
        const int smallest = magnitude[0] <= magnitude[1] && magnitude[0] <= magnitude[2] ? 0
                             : magnitude[1] <= magnitude[2]                               ? 1
                                                                                          : 2;
        axis[smallest] = 1;
        const VectorD u = cross(first, axis);
        const VectorD unit = (1 / hypotenuse(u)) * u;
        return {unit, cross(first, unit)};
    }
};

// Parallel world forces of one direction u: together one force u at the arm m, with the torque m x R^T u.
struct UniformField {
    VectorD moment;       // posed axes, N m
    VectorD direction_W;  // unit
};

bool has_field(const Forcing<double>& forcing) {
    return std::any_of(forcing.field.moment.begin(), forcing.field.moment.end(),
                       [](const VectorD& moment) { return !(moment == VectorD()); });
}

// Returns nothing if the forces have more than one direction.
std::optional<UniformField> uniform_field(const FieldMoments<double>& field) {
    int largest = 0;
    for (int b = 1; b < 3; ++b)
        if (hypotenuse(field.moment[b]) > hypotenuse(field.moment[largest])) largest = b;
    const VectorD& m = field.moment[largest];
    VectorD u;
    for (int b = 0; b < 3; ++b) {
        if (hypotenuse(cross(field.moment[b], m)) > tolerance * dot(m, m)) return std::nullopt;
        u[b] = dot(field.moment[b], m) / dot(m, m);
    }
    return UniformField{hypotenuse(u) * m, (1 / hypotenuse(u)) * u};
}

void add(std::vector<VectorD>& list, const VectorD& v) {
    if (!(v == VectorD())) list.push_back(v);
}

MomentumChanges angular_momentum_changes(const Problem& problem) {
    MomentumChanges changes;
    for (std::size_t i = 0; i < problem.segments.size(); ++i) {
        const Forcing<double>& f = problem.segments[i].forcing;
        changes.arbitrary =
            changes.arbitrary || f.has_torque || f.has_damping || !f.springs.empty() || !f.user_torques.empty();
        if (f.has_world_torque) add(changes.across, f.torque_W);
        if (has_field(f)) {
            if (const auto field = uniform_field(f.field))
                add(changes.along, field->direction_W);
            else
                changes.arbitrary = true;
        }
        for (const auto& load : f.world_points) {
            if (load.frame == Frame::world)
                add(changes.along, load.force);
            else
                changes.arbitrary = true;
        }
        for (const auto& impulse : problem.segments[i].impulses) {
            if (i == 0 || impulse.vector == VectorD()) continue;  // impulses at t = 0 act before the first sample
            const bool world_point = impulse.point_frame == Frame::world;
            if (!world_point && cross(impulse.point, impulse.vector) == VectorD() && impulse.frame == Frame::body)
                continue;
            if (!world_point && impulse.point == VectorD()) continue;
            if (impulse.frame == Frame::body)
                changes.arbitrary = true;
            else if (world_point && problem.body.pivoted)
                add(changes.across, cross(impulse.point, impulse.vector));
            else
                add(changes.along, impulse.vector);
        }
    }
    for (const ContactPlane<double>& plane : problem.body.geometry->planes) {
        if (plane.friction > 0) changes.arbitrary = true;
        add(changes.along, plane.normal_W);
    }
    return changes;
}

MomentumChanges linear_momentum_changes(const Problem& problem) {
    MomentumChanges changes;
    for (std::size_t i = 0; i < problem.segments.size(); ++i) {
        const Forcing<double>& f = problem.segments[i].forcing;
        changes.arbitrary = changes.arbitrary || f.has_translational_drag || f.has_body_force;
        add(changes.across, f.acceleration_W);
        for (const auto& impulse : problem.segments[i].impulses) {
            if (i == 0 || impulse.vector == VectorD()) continue;
            if (impulse.frame == Frame::body)
                changes.arbitrary = true;
            else
                add(changes.across, impulse.vector);
        }
    }
    for (const ContactPlane<double>& plane : problem.body.geometry->planes) {
        if (plane.friction > 0) changes.arbitrary = true;
        add(changes.across, plane.normal_W);
    }
    return changes;
}

bool same_potential(const Forcing<double>& a, const Forcing<double>& b, bool pivoted) {
    if (a.field.moment != b.field.moment || a.springs.size() != b.springs.size()) return false;
    for (std::size_t i = 0; i < a.springs.size(); ++i)
        if (!(a.springs[i].stiffness == b.springs[i].stiffness && a.springs[i].rest == b.springs[i].rest)) return false;
    return pivoted || a.acceleration_W == b.acceleration_W;
}

bool conserves_energy(const Problem& problem) {
    for (const ContactPlane<double>& plane : problem.body.geometry->planes)
        if (plane.restitution < 1 || plane.friction > 0) return false;
    const bool pivoted = problem.body.pivoted;
    for (std::size_t i = 0; i < problem.segments.size(); ++i) {
        const Forcing<double>& f = problem.segments[i].forcing;
        if (f.has_torque || f.has_world_torque || f.has_damping || !f.world_points.empty() || !f.user_torques.empty())
            return false;
        if (!pivoted && (f.has_body_force || f.has_translational_drag)) return false;
        if (!same_potential(problem.segments.front().forcing, f, pivoted)) return false;
        for (const auto& impulse : problem.segments[i].impulses)
            if (i > 0 && !(impulse.vector == VectorD())) return false;
    }
    return true;
}

// w in posed axes
VectorD rate_in_posed_axes(const Problem& problem, const Sample& sample) {
    return rotate_back(problem.body.q_BP, sample.angular_velocity_B);
}

// The world vector v in posed axes.
VectorD to_posed_axes(const Problem& problem, const Sample& sample, const VectorD& v_W) {
    const VectorD v_B = (1 / squared_norm(sample.q)) * rotate_back(sample.q, v_W);
    return rotate_back(problem.body.q_BP, v_B);
}

Invariants<double> invariants_of(const Problem& problem, const Sample& s) {
    return invariants(problem.scene, problem.body, s.t, normalized(s.q), s.angular_velocity_B, s.position_W,
                      s.velocity_W);
}

std::vector<double> energy(const Problem& problem, const Conserved&, const Sample& s) {
    return {invariants_of(problem, s).energy};
}
std::vector<double> angular_momentum(const Problem& problem, const Conserved&, const Sample& s) {
    return components(invariants_of(problem, s).angular_momentum_W);
}
std::vector<double> angular_momentum_along(const Problem& problem, const Conserved& which, const Sample& s) {
    return {dot(which.direction, invariants_of(problem, s).angular_momentum_W)};
}
std::vector<double> linear_momentum(const Problem& problem, const Conserved&, const Sample& s) {
    return components(problem.body.mass * s.velocity_W);
}
std::vector<double> linear_momentum_along(const Problem& problem, const Conserved& which, const Sample& s) {
    return {problem.body.mass * dot(which.direction, s.velocity_W)};
}
std::vector<double> spin(const Problem& problem, const Conserved& which, const Sample& s) {
    const VectorD w = rate_in_posed_axes(problem, s);
    const VectorD& I = problem.body.principal.moments;
    return {dot(which.direction, VectorD(I[0] * w[0], I[1] * w[1], I[2] * w[2]))};
}

// The posed axis about which the body is symmetric: the principal axis with the distinct moment. For an isotropic
// body every axis is one; returns that along the arm of the load.
std::optional<VectorD> symmetry_axis(const Problem& problem) {
    const VectorD& I = problem.body.principal.moments;
    const double largest = std::max({I[0], I[1], I[2]});
    const auto equal = [&](int i, int j) { return std::abs(I[i] - I[j]) <= tolerance * largest; };
    if (equal(0, 1) && equal(1, 2)) {
        for (const Segment& segment : problem.segments)
            for (const VectorD& moment : segment.forcing.field.moment)
                if (!(moment == VectorD())) return (1 / hypotenuse(moment)) * moment;
        return std::nullopt;
    }
    for (int i = 0; i < 3; ++i) {
        VectorD axis;
        axis[i] = 1;
        if (equal((i + 1) % 3, (i + 2) % 3)) return axis;
    }
    return std::nullopt;
}

// Whether A A^T belongs to a disc perpendicular to e or to an ellipsoid of revolution about e: it maps e to a
// multiple of e and acts on all perpendicular vectors as a multiple of the identity.
bool disc_about(const SupportPiece<double>& piece, const VectorD& e) {
    if (!piece.extended) return true;
    const Matrix3<double> square = piece.semi_axes * transposed(piece.semi_axes);
    const double trace = square[0][0] + square[1][1] + square[2][2], along = dot(e, square * e);
    const double across = (trace - along) / 2;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double expected = (i == j ? across : 0) + (along - across) * e[i] * e[j];
            if (std::abs(square[i][j] - expected) > tolerance * trace) return false;
        }
    return true;
}

// Whether every normal of the hull intersects the axis e through the centre of mass: all pieces are of revolution
// about e.
bool is_of_revolution(const ContactGeometry<double>& geometry, const VectorD& e) {
    const auto off_axis = [&](const SupportPiece<double>& piece) {
        return hypotenuse(cross(e, piece.center)) > tolerance * geometry.reach || !disc_about(piece, e);
    };
    return std::none_of(geometry.pieces.begin(), geometry.pieces.end(), off_axis);
}

bool conserves_spin(const Problem& problem, const VectorD& e) {
    if (problem.body.geometry->any()) {
        for (const ContactPlane<double>& plane : problem.body.geometry->planes)
            if (plane.friction > 0) return false;
        if (!is_of_revolution(*problem.body.geometry, e)) return false;
    }
    for (std::size_t i = 0; i < problem.segments.size(); ++i) {
        const Forcing<double>& f = problem.segments[i].forcing;
        if (f.has_world_torque || !f.world_points.empty() || !f.springs.empty() || !f.user_torques.empty())
            return false;
        if (f.has_torque && std::abs(dot(e, f.torque)) > tolerance * hypotenuse(f.torque)) return false;
        if (f.has_damping && !(transposed(f.damping) * e == VectorD())) return false;
        for (const VectorD& moment : f.field.moment)
            if (!parallel(moment, e)) return false;
        for (const auto& impulse : problem.segments[i].impulses) {
            if (i == 0 || impulse.vector == VectorD()) continue;
            if (impulse.point_frame == Frame::world || !parallel(impulse.point, e)) return false;
        }
    }
    return true;
}

// If energy is conserved: the uniform field that acts at all times, if nothing else acts.
std::optional<UniformField> sole_field(const Problem& problem) {
    const Forcing<double>& forcing = problem.segments.front().forcing;
    if (!has_field(forcing) || !forcing.springs.empty()) return std::nullopt;
    return uniform_field(forcing.field);
}

// Principal axes with I_x = I_y = ratio I_z and the centre of mass on the equator; z is perpendicular to the arm.
struct EquatorialAxes {
    int x, y, z;
};
std::optional<EquatorialAxes> equatorial_axes(const Problem& problem, const VectorD& arm, double ratio) {
    const VectorD& I = problem.body.principal.moments;
    for (int z = 0; z < 3; ++z) {
        const int x = (z + 1) % 3, y = (z + 2) % 3;
        const bool shape =
            std::abs(I[x] - ratio * I[z]) <= tolerance * I[x] && std::abs(I[y] - ratio * I[z]) <= tolerance * I[y];
        if (shape && std::abs(arm[z]) <= tolerance * hypotenuse(arm)) return EquatorialAxes{x, y, z};
    }
    return std::nullopt;
}

// Rates p along the arm, q perpendicular to it on the equator, r along the axis of symmetry z; g: unit vector
// opposite to the force, in the same axes; c = m g l / I_z.
struct EquatorialTop {
    double p, q, r, g1, g2, g3, c;
};
EquatorialTop equatorial_top(const Problem& problem, const Sample& s, double ratio) {
    const UniformField field = *sole_field(problem);
    const EquatorialAxes axes = *equatorial_axes(problem, field.moment, ratio);
    const VectorD w = rate_in_posed_axes(problem, s), against = to_posed_axes(problem, s, -field.direction_W);
    const double mgl = hypotenuse(field.moment), cosine = field.moment[axes.x] / mgl, sine = field.moment[axes.y] / mgl;
    const auto along = [&](const VectorD& v) { return cosine * v[axes.x] + sine * v[axes.y]; };
    const auto beside = [&](const VectorD& v) { return cosine * v[axes.y] - sine * v[axes.x]; };
    return {along(w),
            beside(w),
            w[axes.z],
            along(against),
            beside(against),
            against[axes.z],
            mgl / problem.body.principal.moments[axes.z]};
}

// |(p + i q)^2 - c (g1 + i g2)|^2 (Kowalevski 1889): this complex number rotates at the rate r and keeps its modulus.
std::vector<double> kovalevskaya_integral(const Problem& problem, const Conserved&, const Sample& s) {
    const auto [p, q, r, g1, g2, g3, c] = equatorial_top(problem, s, 2);
    const double real = p * p - q * q - c * g1, imaginary = 2 * p * q - c * g2;
    return {real * real + imaginary * imaginary};
}

// r (p^2 + q^2) - c p g3 (Goryachev 1900, Chaplygin 1901): its rate is -c q / 4 times L . g / I_z, which vanishes.
std::vector<double> goryachev_chaplygin_integral(const Problem& problem, const Conserved&, const Sample& s) {
    const auto [p, q, r, g1, g2, g3, c] = equatorial_top(problem, s, 4);
    return {r * (p * p + q * q) - c * p * g3};
}

// Whether L along the field is zero. If so, it stays zero.
bool has_no_momentum_along(const Problem& problem, const UniformField& field, const Sample& start) {
    const std::vector<double> L = angular_momentum(problem, {}, start);
    const VectorD L_W(L[0], L[1], L[2]);
    return std::abs(dot(L_W, field.direction_W)) <= tolerance * hypotenuse(L_W);
}

// The motion at t = 0, after impulses there.
Sample first_sample(const Problem& problem) {
    return with_one_body(problem, [&]<class SystemType>() {
        SystemType system(problem);
        double y[SystemType::dimension];
        system.initial(y);
        system.enter(problem.segments.front(), y);
        return system.motion(0, y);
    });
}

std::vector<double> energy_with_formulas(const Problem& problem, const Conserved&, const Sample& s) {
    return {invariants_of(problem, s).energy +
            formula_potential<double>(problem.scene, s.t, normalized(s.q), s.position_W)};
}

// The energy, if all formulas are potentials that act at all times and do not depend on the time. Symmetries of
// formulas are not searched, so no momentum is reported.
std::vector<Conserved> conserved_by_formulas(const Problem& problem) {
    const std::shared_ptr<const FormulaSet> set = compile_formulas(problem.scene, problem.scene.name);
    bool has_energy = conserves_energy(problem);
    std::vector<int> potentials;
    for (const FormulaTerm& term : set->terms) {
        const Window& window = term.load.window;
        has_energy = has_energy && term.load.kind == FormulaKind::potential && window.from <= 0 &&
                     window.until > problem.scene.duration;
        potentials.push_back(term.potential);
    }
    if (!has_energy) return {};
    const std::vector<char> needed = formula::find_needed(set->expression, potentials);
    for (std::size_t i = 0; i < needed.size(); ++i) {
        const formula::Node& node = set->expression.nodes()[i];
        if (needed[i] && node.operation == formula::Operation::input && node.a == FormulaInputs::time) return {};
    }
    Conserved energy{ConservedKind::energy, "energy", "E, kinetic and potential, J", {}, energy_with_formulas, {}};
    energy.value = energy.of(problem, energy, first_sample(problem));
    return {energy};
}

}  // namespace

std::vector<Conserved> conserved(const Problem& problem) {
    if (std::holds_alternative<MechanismSystem>(problem.system)) return conserved_by_mechanism(problem);
    // symmetries of the formulas of several bodies are not searched
    if (problem.needs.system == SystemKind::mechanism_with_formulas) return {};
    if (problem.needs.system == SystemKind::body_with_formulas) return conserved_by_formulas(problem);
    std::vector<Conserved> found;
    const Sample start = first_sample(problem);
    const auto add_quantity = [&](ConservedKind kind, const char* name, const char* formula, decltype(Conserved::of) of,
                                  const VectorD& direction = VectorD()) {
        Conserved one{kind, name, formula, {}, of, direction};
        one.value = of(problem, one, start);
        found.push_back(std::move(one));
    };
    const bool pivoted = problem.body.pivoted, has_energy = conserves_energy(problem);
    if (has_energy) add_quantity(ConservedKind::energy, "energy", "E, kinetic and potential, J", energy);

    const MomentumChanges angular = angular_momentum_changes(problem);
    if (angular.none()) {
        add_quantity(
            ConservedKind::angular_momentum, "angular momentum",
            pivoted ? "L about the pivot, world axes, kg m^2/s" : "L about the centre of mass, world axes, kg m^2/s",
            angular_momentum);
    } else {
        for (const VectorD& u : angular.conserved_directions())
            add_quantity(ConservedKind::angular_momentum_component, "angular momentum along u",
                         pivoted ? "L . u about the pivot, kg m^2/s" : "L . u about the centre of mass, kg m^2/s",
                         angular_momentum_along, u);
    }
    if (!pivoted) {
        const MomentumChanges linear = linear_momentum_changes(problem);
        if (linear.none()) {
            add_quantity(ConservedKind::linear_momentum, "linear momentum", "m v, world axes, kg m/s", linear_momentum);
        } else {
            for (const VectorD& u : linear.conserved_directions())
                add_quantity(ConservedKind::linear_momentum_component, "linear momentum along u", "m v . u, kg m/s",
                             linear_momentum_along, u);
        }
    }
    if (const auto axis = symmetry_axis(problem); axis && conserves_spin(problem, *axis))
        add_quantity(ConservedKind::spin, "spin about the axis of symmetry", "L . e in the body, kg m^2/s", spin,
                     *axis);
    if (const auto field = sole_field(problem); has_energy && pivoted && field) {
        if (equatorial_axes(problem, field->moment, 2))
            add_quantity(ConservedKind::integral_of_a_special_top, "Kovalevskaya's integral",
                         "|(p + i q)^2 - (m g l / C) (g1 + i g2)|^2, s^-4", kovalevskaya_integral);
        if (equatorial_axes(problem, field->moment, 4) && has_no_momentum_along(problem, *field, start))
            add_quantity(ConservedKind::integral_of_a_special_top, "Goryachev and Chaplygin's integral",
                         "r (p^2 + q^2) - (m g l / C) p g3, s^-3", goryachev_chaplygin_integral);
    }
    return found;
}

}  // namespace polhode
