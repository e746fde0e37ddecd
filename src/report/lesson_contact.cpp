#include "report/lesson_contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "motion/contact.h"
#include "motion/exact_body.h"

namespace polhode {
namespace {

// all digits of binary64: the page computes with these numbers
constexpr int exact_contact_digits = 17;

Json exact_list(const Vector3<double>& v) {
    Json list = Json::array();
    for (const double x : v.component) list.push_back(number_json(x, exact_contact_digits));
    return list;
}

// Whether the piece is a ball that contains the other piece.
bool contains(const SupportPiece<double>& ball, const SupportPiece<double>& other) {
    SupportPiece<double> moved = other;
    moved.center = other.center - ball.center;
    return !ball.extended && moved.reach() <= ball.radius;
}

// Whether the contact point of the piece moves smoothly over it: a ball, or an ellipsoid of full rank.
bool is_smooth(const SupportPiece<double>& piece) {
    const Matrix3<double>& A = piece.semi_axes;
    return piece.extended ? dot(A[0], cross(A[1], A[2])) != 0 : piece.radius > 0;
}

// The piece of the hull that touches.
const SupportPiece<double>& touching_piece(const JsonNode& node, const ContactGeometry<double>& geometry) {
    for (const SupportPiece<double>& piece : geometry.pieces)
        if (is_smooth(piece) && std::ranges::all_of(geometry.pieces, [&](const SupportPiece<double>& other) {
                return &other == &piece || contains(piece, other);
            }))
            return piece;
    node.fail("has a body with corners or several parts that can touch",
              "give a scene in which a sphere or an ellipsoid touches");
}

void require_plain_contact(const JsonNode& node, const Scene& scene) {
    if (scene.pivot) node.fail("has planes and a pivot", "remove one of them");
    if (scene.planes.size() > 1) node.fail("has several planes", "give a scene with one plane");
    const Plane& plane = scene.planes.front();
    if (plane.torsional_friction > 0 || plane.rolling_friction > 0)
        node.fail("has torsional or rolling friction", "remove it");
    if (std::ranges::none_of(scene.loads, [](const Load& load) { return std::holds_alternative<Gravity>(load); }))
        node.fail("has a plane without gravity", "add gravity");
}

// Refuses a start that does not touch the plane, or moves towards or away from it.
void require_contact(const JsonNode& node, const ContactGeometry<double>& geometry, const ExactBody<double>& body) {
    constexpr double tolerance = 1e-9;
    const Placement<double> start{body.q, body.position_W, body.velocity_W, rotate(body.q, body.angular_velocity_B)};
    const double gap = geometry.distance(start);
    if (std::abs(gap) > tolerance * geometry.reach)
        node.fail(fmt::format("has a body {:.3g} m away from the plane at the start", gap),
                  "give a scene in which it touches");
    double nearest = HUGE_VAL, approach = 0;
    for (std::size_t k = 0; k < geometry.size(); ++k) {
        const Gap<double> one = geometry.gap(k, start);
        if (one.distance < nearest) nearest = one.distance, approach = one.rate;
    }
    const double speed = length(body.velocity_W) + geometry.reach * length(body.angular_velocity_B);
    if (std::abs(approach) > tolerance * speed)
        node.fail(fmt::format("has a body that meets the plane at {:.3g} m/s", -approach),
                  "give a scene in which it slides, rolls or rests");
}

}  // namespace

Json lesson_contact_json(const JsonNode& node, const Scene& scene) {
    if (scene.planes.empty()) return {};
    require_plain_contact(node, scene);
    const ExactBody<double> body = exact_body<double>(scene);
    const ContactGeometry<double> geometry = contact_geometry<double>(scene, body.center, {});
    const SupportPiece<double>& piece = touching_piece(node, geometry);
    require_contact(node, geometry, body);
    const ContactPlane<double>& plane = geometry.planes.front();
    Json axes = Json::array();
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            axes.push_back(number_json(piece.extended ? piece.semi_axes[i][k] : 0, exact_contact_digits));
    return {{"center", exact_list(piece.center)},
            {"axes", axes},
            {"radius", number_json(piece.radius, exact_contact_digits)},
            {"reach", number_json(geometry.reach, exact_contact_digits)},
            {"normal", exact_list(plane.normal_W)},
            {"offset", number_json(plane.offset, exact_contact_digits)},
            {"restitution", number_json(plane.restitution, exact_contact_digits)},
            {"friction", number_json(plane.friction, exact_contact_digits)},
            {"position", exact_list(body.position_W)},
            {"velocity", exact_list(body.velocity_W)}};
}

}  // namespace polhode
