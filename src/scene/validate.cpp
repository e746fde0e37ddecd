// Checks the rules for the values of a scene, whether read from a file or built in memory.
//
// validate() checks limits, body, initial state, pivot, loads, planes and error limits, and delegates scenes of
// several bodies to mechanism_check.cpp. Principal moments come from the 113-bit principal frame (body/rigid_body.h).
// Errors name a JSON pointer.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "body/rigid_body.h"
#include "scene/body_hull.h"
#include "scene/body_source.h"
#include "scene/joint_motions.h"
#include "scene/plane_file.h"
#include "scene/scene_check.h"
#include "scene/scene_formulas.h"
#include "scene/sphere_contacts.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr double shape_tolerance = 1e-12;  // relative to the largest moment: triangle inequality, symmetry
constexpr double least_moment = 1e-30;     // relative to the largest moment, for moments found by diagonalisation
constexpr double start_tolerance = 1e-12;  // relative to the body's reach: initial penetration due to rounding

template <class S>
bool is_diagonal(const Matrix3<S>& J) {
    bool all_vanish = true;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (i != j) all_vanish = all_vanish && J[i][j] == 0;
    return all_vanish;
}

// Checks the triangle inequality: no moment exceeds the sum of the others.
void check_moments(const SceneCheck& check, const Vector3<double>& I, const std::string& place, bool single_places) {
    const double largest = std::max({I[0], I[1], I[2]});
    for (int i = 0; i < 3; ++i) {
        const auto at = [&](int index) { return single_places ? fmt::format("{}/{}", place, index) : place; };
        const double others = I[(i + 1) % 3] + I[(i + 2) % 3];
        if (!(I[i] - others <= shape_tolerance * largest))
            check.fail(at(i),
                       fmt::format("{} {} is more than the sum {} of the other two",
                                   single_places ? "moment" : "principal moment", shortest_decimal(I[i]),
                                   shortest_decimal(others)),
                       "moments of inertia must satisfy the triangle inequality within 1e-12 of the largest");
    }
}

void check_inertia(const SceneCheck& check, const std::string& body_place, const Body& body, BodyRole role) {
    // an error in a body that was computed from a source is reported for the body as a whole
    const bool given = !body.source;
    const std::string place = given ? body_place + "/inertia" : body_place;
    const Matrix3<double>& J = body.inertia_B;
    const bool axes_are_principal = is_diagonal(J);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!axes_are_principal) check.finite(fmt::format("{}/{}/{}", place, i, j), J[i][j]);
    if (!given)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (!std::isfinite(J[i][j]))
                    check.fail(place, "has moments of inertia that are too large for binary64",
                               "give smaller sizes or masses");
    const bool may_vanish = role == BodyRole::mechanism;
    if (may_vanish && body.mass == 0) {
        if (!(J == Matrix3<double>()))
            check.fail(place, "is not zero, but the mass is 0",
                       "a body without mass must have zero moments of inertia");
        return;
    }
    if (axes_are_principal && given) {
        for (int i = 0; i < 3; ++i) {
            const std::string at = fmt::format("{}/{}", place, i);
            may_vanish ? check.not_negative(at, J[i][i], "a moment of inertia")
                       : check.positive(at, J[i][i], "a moment of inertia");
        }
        check_moments(check, {J[0][0], J[1][1], J[2][2]}, place, true);
        return;
    }
    const Vector3<double> I = principal_frame(cast<Wide>(J)).moments;
    const double largest = std::max({I[0], I[1], I[2]});
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < i; ++j)
            if (!(std::abs(J[i][j] - J[j][i]) <= shape_tolerance * largest))
                check.fail(fmt::format("{}/{}/{}", place, i, j),
                           fmt::format("is {}, but the transposed entry is {}", shortest_decimal(J[i][j]),
                                       shortest_decimal(J[j][i])),
                           "the inertia tensor must be symmetric within 1e-12 of its largest moment");
    for (int i = 0; i < 3; ++i) {
        check.finite(place, I[i]);
        if (may_vanish) {
            if (!(I[i] >= -shape_tolerance * largest))
                check.fail(place, "has the principal moment " + shortest_decimal(I[i]),
                           "every principal moment must be >= 0");
            continue;
        }
        // a smaller value is a zero within the 113 bits of the diagonalisation
        if (!(I[i] > least_moment * largest) || !std::isfinite(1 / I[i]))
            check.fail(place, "has the principal moment " + shortest_decimal(I[i]),
                       "every principal moment must be > 0");
    }
    check_moments(check, I, place, false);
}

void check_pivot(const SceneCheck& check, const Scene& scene) {
    if (!scene.pivot) return;
    check.finite("/pivot", *scene.pivot);
    const Vector3<double> arm = scene.body.center_of_mass - *scene.pivot;
    const Matrix3<Wide> about_pivot =
        cast<Wide>(scene.body.inertia_B) + parallel_axis(Wide(scene.body.mass), cast<Wide>(arm));
    const Vector3<double> I = principal_frame(about_pivot).moments;
    if (!std::isfinite(I[0] + I[1] + I[2]))
        check.fail("/pivot", "makes the inertia about the pivot too large for binary64",
                   "give a closer pivot or a lighter body");
    // The tensor is lost if it vanishes in 113 bits next to mass times squared distance. A single small moment is
    // lost only if the axes must be computed.
    const double largest = std::max({I[0], I[1], I[2]}), least = std::min({I[0], I[1], I[2]});
    const Matrix3<double>& own = scene.body.inertia_B;
    const double size = own[0][0] + own[1][1] + own[2][2];
    if (!(size > least_moment * largest) || (!is_diagonal(about_pivot) && !(least > least_moment * largest)))
        check.fail("/pivot",
                   fmt::format("makes a principal moment about the pivot less than 1e-30 of the largest, {}",
                               shortest_decimal(largest)),
                   "give a tensor that is larger relative to the mass times the squared distance of the pivot");
    const Initial& initial = scene.initial;
    const char* remedy = "remove it: the pivot and the attitude determine the centre of mass";
    if (!(initial.position_W == Vector3<double>()))
        check.fail("/initial/position", "is given, but the scene has a pivot", remedy);
    if (!(initial.velocity_W == Vector3<double>()))
        check.fail("/initial/velocity", "is given, but the scene has a pivot", remedy);
}

void check_window(const SceneCheck& check, const std::string& place, const Window& window) {
    if (std::isnan(window.from) || window.from == HUGE_VAL)
        check.fail(place + "/from", "is " + shortest_decimal(window.from), "give a finite time in s");
    if (std::isnan(window.until) || window.until == -HUGE_VAL)
        check.fail(place + "/until", "is " + shortest_decimal(window.until), "give a finite time in s");
    if (!(window.from < window.until))
        check.fail(place + "/until",
                   fmt::format("is {}, not after \"from\" = {}", shortest_decimal(window.until),
                               shortest_decimal(window.from)),
                   "a load acts for from <= t < until: give until > from");
}

struct LoadCheck {
    const SceneCheck& check;
    const std::string& place;

    void operator()(const Gravity& load) const { check.finite(place + "/acceleration", load.acceleration_W); }
    void operator()(const Torque& load) const { check.finite(place + "/vector", load.vector); }
    void operator()(const Force& load) const {
        check.finite(place + "/vector", load.vector);
        check.finite(place + "/point", load.point);
    }
    void operator()(const Impulse& load) const {
        check.finite(place + "/vector", load.vector);
        check.finite(place + "/point", load.point);
        check.finite(place + "/at", load.at);
        if (load.at < 0)
            check.fail(place + "/at", "is " + shortest_decimal(load.at), "the time of an impulse must be >= 0 s");
    }
    void operator()(const Drag& load) const {
        check.finite(place + "/rotational", load.rotational);
        check.finite(place + "/translational", load.translational);
    }
    void operator()(const Spring& load) const {
        check.finite(place + "/stiffness", load.stiffness);
        check.unit(place + "/rest_orientation", load.rest_orientation);
    }
    void operator()(const UserTorque& load) const {
        if (!load.torque_B) check.fail(place, "is a user-defined torque without a function", "give a callable");
    }
    void operator()(const Motor&) const {}        // checked with its joint
    void operator()(const FormulaLoad&) const {}  // checked by check_formulas()
    void operator()(const PointSpring& load) const {
        check.finite(place + "/first_point", load.first_point);
        check.finite(place + "/second_point", load.second_point);
        check.finite(place + "/stiffness", load.stiffness);
        check.finite(place + "/rest_length", load.rest_length);
        if (!(load.rest_length >= 0))
            check.fail(place + "/rest_length", "is " + shortest_decimal(load.rest_length),
                       "a length in m must be >= 0");
    }
};

// Checks that the names of the planes, given and default, are unique and fit into tables.
void check_plane_names(const SceneCheck& check, const Scene& scene) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < scene.planes.size(); ++i) {
        const std::string name = plane_name(scene, i), place = fmt::format("/planes/{}/name", i);
        check.text(place, name);
        if (one_line(name, name.size()) != name || name.find_first_of(",\"") != name.npos || name.front() == ' ' ||
            name.back() == ' ')
            check.fail(place, "is not a valid name for tables",
                       "use printable characters without commas, quotation marks and blanks at the ends");
        check.name(place, name);
        if (!names.insert(name).second)
            check.fail(place, fmt::format("names a second plane \"{}\"", one_line(name, 60)),
                       "give each plane a unique name");
    }
}

// Checks the numbers of each plane, and that there is no pivot.
void check_planes(const SceneCheck& check, const Scene& scene) {
    for (std::size_t i = 0; i < scene.planes.size(); ++i) {
        const Plane& plane = scene.planes[i];
        const std::string place = fmt::format("/planes/{}", i);
        check.finite(place + "/normal", plane.normal_W);
        check.finite(place + "/offset", plane.offset);
        check.finite(place + "/restitution", plane.restitution);
        check.finite(place + "/friction", plane.friction);
        const Wide length = square_root(dot(cast<Wide>(plane.normal_W), cast<Wide>(plane.normal_W)));
        if (!(length > 0)) check.fail(place + "/normal", "is zero", "give the direction from the plane to the body");
        if (!std::isfinite(double(1 / length)))
            check.fail(place + "/normal", "is too short",
                       "the length of a normal must have a finite inverse: >= 1e-307");
        if (!(plane.restitution >= 0 && plane.restitution <= 1))
            check.fail(place + "/restitution", "is " + shortest_decimal(plane.restitution),
                       "the coefficient of restitution must be from 0 (perfectly inelastic) to 1 (elastic)");
        if (!(plane.friction >= 0))
            check.fail(place + "/friction", "is " + shortest_decimal(plane.friction),
                       "the coefficient of Coulomb friction must be >= 0");
        check.not_negative(place + "/torsional_friction", plane.torsional_friction, "the torsional friction in m");
        check.not_negative(place + "/rolling_friction", plane.rolling_friction, "the rolling friction in m");
        if (scene.pivot)
            check.fail(place, "is given, but the scene has a pivot",
                       "remove one of them: a body with a pivot does not support planes");
    }
}

// Checks that a body has a shape and starts above a plane.
void check_start_above_plane(const SceneCheck& check, const Scene& scene, std::size_t body, std::size_t plane) {
    const auto& [name, properties, initial] = scene_body(scene, body);
    const std::string place = fmt::format("/planes/{}", plane);
    if (!properties.source || !has_shape(*properties.source))
        check.fail(place, "is given, but the body has no shape",
                   "give the body by \"shape\", \"parts\" with shapes or \"mesh\", or add a \"contact_shape\" to "
                   "its mass and inertia");
    const std::vector<SupportPiece<Wide>> pieces = hull<Wide>(*properties.source);
    if (pieces.empty())
        check.fail(place, "is given, but the body consists of holes only", "give the body a solid part");
    // the lowest point of the body along the plane's normal
    const Vector3<Wide> normal = cast<Wide>(scene.planes[plane].normal_W);
    const Wide length = square_root(dot(normal, normal));
    const Quaternion<Wide> q = normalized(cast<Wide>(initial.orientation));
    const Vector3<Wide> normal_W = (1 / length) * normal, n = rotate_back(q, normal_W);
    Wide lowest = pieces.front().lowest(n), reach = 0;
    for (const SupportPiece<Wide>& piece : pieces)
        lowest = std::min(lowest, piece.lowest(n)), reach = std::max(reach, piece.reach());
    const Wide gap = dot(normal_W, cast<Wide>(initial.position_W)) - dot(n, properties.source->wide.center) + lowest -
                     Wide(scene.planes[plane].offset) / length;
    if (!(gap >= -start_tolerance * reach))
        check.fail(place,
                   fmt::format("({}) is penetrated {} m deep by {} at the start",
                               one_line(plane_name(scene, plane), 60), shortest_decimal(-double(gap)),
                               name.empty() ? "the body" : fmt::format("\"{}\"", one_line(name, 60))),
                   fmt::format("start where normal . x > offset: raise {}/initial/position",
                               name.empty() ? "" : fmt::format("/bodies/{}", body)));
}

}  // namespace

void check_body(const SceneCheck& check, const std::string& place, const Body& body, BodyRole role) {
    if (body.source) {
        if (!(body.mass > 0))
            check.fail(place, fmt::format("has the total mass {}", shortest_decimal(body.mass)),
                       "the total mass must be > 0: make the holes smaller");
        check.positive(place, body.mass, "the total mass");
    } else if (role == BodyRole::mechanism) {
        check.not_negative(place + "/mass", body.mass, "the mass");
    } else {
        check.positive(place + "/mass", body.mass, "the mass");
    }
    check.finite(place + "/center_of_mass", body.center_of_mass);
    check_inertia(check, place, body, role);
}

void check_initial(const SceneCheck& check, const std::string& place, const Initial& initial) {
    check.unit(place + "/orientation", initial.orientation);
    check.finite(place + "/angular_velocity", initial.angular_velocity);
    check.finite(place + "/position", initial.position_W);
    check.finite(place + "/velocity", initial.velocity_W);
}

void validate(const Scene& scene, const std::string& file) {
    const SceneCheck check(file);
    check.text("/name", scene.name);
    check.shown("/about", scene.about), check.shown("/source", scene.source);
    if (scene.name.empty()) check.fail("/name", "is empty", "give the scene a name");
    if (one_line(scene.name, scene.name.size()) != scene.name)
        check.fail("/name", "contains control characters", "use printable characters");
    check.name("/name", scene.name);
    check.count("/bodies", scene.bodies.size(), most_bodies, "bodies");
    check.count("/joints", scene.joints.size(), most_bodies, "joints");
    check.count("/loops", scene.loops.size(), most_bodies, "loops");
    check.count("/couplings", scene.couplings.size(), most_bodies, "couplings");
    check.count("/loads", scene.loads.size(), most_loads, "loads");
    check.count("/planes", scene.planes.size(), most_planes, "planes");
    check.count("/contacts", scene.contacts.size(), most_contacts, "contacts");
    check.positive("/duration", scene.duration, "the duration in s");
    if (is_mechanism(scene)) {
        check_mechanism(check, scene);
        check_joint_motions(scene, file);
    } else {
        check_body(check, "/body", scene.body);
        check_initial(check, "/initial", scene.initial);
        check_pivot(check, scene);
        check_single_body_names(check, scene);
    }
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
        const std::string place = fmt::format("/loads/{}", i);
        std::visit(LoadCheck{check, place}, scene.loads[i]);
        check_window(check, place, window_of(scene.loads[i]));
    }
    check_plane_names(check, scene);
    check_planes(check, scene);
    check_sphere_contacts(check, scene);
    for (std::size_t plane = 0; plane < scene.planes.size(); ++plane)
        for (std::size_t body = 0; body < body_count(scene); ++body) check_start_above_plane(check, scene, body, plane);
    check_formulas(scene, file);
    for (const auto& [block, error] : scene.tolerated) {
        if (!has_quantity(scene, block))
            throw InputError(file, "/tolerated/" + block, "applies to joints, but the scene has one body", "remove it");
        if (std::ranges::find(tolerated_blocks, block) == tolerated_blocks.end())
            throw InputError(file, "/tolerated/" + one_line(block, 60), "is not the name of an error block",
                             fmt::format("give one of {}", fmt::join(tolerated_blocks, ", ")));
        check.positive("/tolerated/" + block, error, "the tolerated error");
    }
}

std::optional<double> tolerated_error(const Scene& scene, std::string_view block) {
    const auto found = scene.tolerated.find(std::string(block));
    return found == scene.tolerated.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace polhode
