// Impulses of contacts: conservation, Hecker's formula, friction computed by hand, simultaneous contacts.
#include "motion/impact.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "motion/contact.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

ImpactBody<double> moderate_body() {
    return {1 / moderate(0.2, 3), inverse(moderate_inertia()), moderate_vector(), moderate_vector(), moderate_vector()};
}

Vector3<double> moderate_direction() {
    const Vector3<double> v = vector_part(moderate_orientation());
    const double size = length(v);
    return size > 1e-3 ? (1 / size) * v : Vector3<double>(0, 0, 1);
}

double kinetic_energy(const ImpactBody<double>& body) {
    if (body.inverse_mass == 0) return 0;
    const Vector3<double>& w = body.angular_velocity_W;
    return dot(body.velocity_W, body.velocity_W) / (2 * body.inverse_mass) +
           dot(w, inverse(body.inverse_inertia_W) * w) / 2;
}

Vector3<double> momentum(const ImpactBody<double>& body) { return (1 / body.inverse_mass) * body.velocity_W; }
/// Angular momentum about the world's origin.
Vector3<double> angular_momentum(const ImpactBody<double>& body) {
    return inverse(body.inverse_inertia_W) * body.angular_velocity_W + cross(body.position_W, momentum(body));
}

/// Two colliding bodies before and after the impact.
struct Meeting {
    ImpactBody<double> a, b, a_after, b_after;
    Contact<double> contact;
    Vector3<double> impulse;

    Vector3<double> before() const { return a.velocity_at(contact.point_W) - b.velocity_at(contact.point_W); }
    Vector3<double> after() const {
        return a_after.velocity_at(contact.point_W) - b_after.velocity_at(contact.point_W);
    }
    double gained_energy() const {
        return kinetic_energy(a_after) + kinetic_energy(b_after) - kinetic_energy(a) - kinetic_energy(b);
    }
    double energy() const { return kinetic_energy(a) + kinetic_energy(b); }
};

/// A random impact; in one of four cases the second body is immovable.
Meeting moderate_meeting(double restitution, double friction, bool both_movable = false) {
    Meeting m;
    m.a = moderate_body();
    if (both_movable || *rc::gen::inRange(0, 4) != 0) m.b = moderate_body();
    m.contact = {moderate_vector(), moderate_direction(), restitution, friction};
    // in three of four cases the bodies approach
    if (dot(m.contact.normal_W, m.before()) > 0 && *rc::gen::inRange(0, 2) == 0)
        m.contact.normal_W = -m.contact.normal_W;
    m.impulse = contact_impulse(m.a, m.b, m.contact);
    m.a_after = m.a, m.b_after = m.b;
    m.a_after.apply_impulse(m.contact.point_W, m.impulse);
    m.b_after.apply_impulse(m.contact.point_W, -m.impulse);
    return m;
}

// Rounding of several dozen operations on numbers between 1 and 10, with moments down to 0.2.
constexpr double rounding = 1e-11;

RC_GTEST_PROP(ContactImpulse, KeepsBothMomenta, ()) {
    const Meeting m = moderate_meeting(moderate(0, 1), moderate(0, 2), true);
    RC_ASSERT(distance(momentum(m.a_after) + momentum(m.b_after), momentum(m.a) + momentum(m.b)) < rounding);
    RC_ASSERT(distance(angular_momentum(m.a_after) + angular_momentum(m.b_after),
                       angular_momentum(m.a) + angular_momentum(m.b)) < 10 * rounding);
}

RC_GTEST_PROP(ContactImpulse, ReversesTheNormalSpeedByTheRestitution, ()) {
    const double e = moderate(0, 1);
    const Meeting m = moderate_meeting(e, 0);
    const double before = dot(m.contact.normal_W, m.before()), after = dot(m.contact.normal_W, m.after());
    if (before >= 0) {
        RC_ASSERT(m.impulse == Vector3<double>());
    } else {
        RC_ASSERT(std::abs(after + e * before) < rounding);
    }
}

/// The impulse agrees with Hecker's formula from the slides, term by term.
RC_GTEST_PROP(ContactImpulse, IsHeckersFormula, ()) {
    const double e = moderate(0, 1);
    const Meeting m = moderate_meeting(e, 0);
    const Vector3<double>& n = m.contact.normal_W;
    if (dot(n, m.before()) >= 0) return;
    const Vector3<double> ra = m.contact.point_W - m.a.position_W, rb = m.contact.point_W - m.b.position_W;
    const double j =
        -(1 + e) * dot(m.before(), n) /
        (m.a.inverse_mass + m.b.inverse_mass +
         dot(n, cross(m.a.inverse_inertia_W * cross(ra, n), ra) + cross(m.b.inverse_inertia_W * cross(rb, n), rb)));
    RC_ASSERT(distance(m.impulse, j * n) < rounding * (1 + j));
}

RC_GTEST_PROP(ContactImpulse, KeepsEnergyAtFullRestitutionWithoutFriction, ()) {
    const Meeting m = moderate_meeting(1, 0);
    RC_ASSERT(std::abs(m.gained_energy()) < rounding * (1 + m.energy()));
}

/// Without friction the impulse has no component along the plane.
RC_GTEST_PROP(ContactImpulse, IsAlongTheNormalWithoutFriction, ()) {
    const Meeting m = moderate_meeting(moderate(0, 1), 0);
    const Vector3<double>& n = m.contact.normal_W;
    const Vector3<double> change = momentum(m.a_after) - momentum(m.a);
    RC_ASSERT(length(change - dot(n, change) * n) < rounding);
    // therefore a sphere keeps its tangential velocity: the impulse passes through its centre
    ImpactBody<double> sphere = m.a;
    sphere.inverse_inertia_W = diagonal(Vector3<double>(2, 2, 2));
    Contact<double> under = m.contact;
    under.point_W = sphere.position_W - 0.5 * n;
    ImpactBody<double> after = sphere;
    after.apply_impulse(under.point_W, contact_impulse(sphere, {}, under));
    RC_ASSERT(distance(after.angular_velocity_W, sphere.angular_velocity_W) < rounding);
    RC_ASSERT(length(cross(n, after.velocity_W - sphere.velocity_W)) < rounding);
}

RC_GTEST_PROP(ContactImpulse, StaysInCoulombsConeAndGainsNoEnergy, ()) {
    const double e = moderate(0, 1), mu = moderate(0, 3);
    const Meeting m = moderate_meeting(e, mu);
    const Vector3<double>& n = m.contact.normal_W;
    const double before = dot(n, m.before()), normal = dot(n, m.impulse);
    RC_ASSERT(m.gained_energy() < rounding * (1 + m.energy()));
    RC_ASSERT(normal >= 0);
    RC_ASSERT(length(m.impulse - normal * n) <= mu * normal * (1 + 1e-9) + rounding);
    if (before < 0) {
        RC_ASSERT(std::abs(dot(n, m.after()) + e * before) < 1e-8);
    } else {
        RC_ASSERT(m.impulse == Vector3<double>());
    }
}

/// A rough ball with back spin, computed by hand: m = 2, r = 0.5, I = 2 m r^2 / 5, v = (3, 0, -4), w = (0, -10, 0).
TEST(ContactImpulse, OfARoughBallSticksOrSlides) {
    const double m = 2, r = 0.5, I = 0.4 * m * r * r, e = 0.5;
    const ImpactBody<double> ball{
        1 / m, diagonal(Vector3<double>(1 / I, 1 / I, 1 / I)), {0, 0, r}, {3, 0, -4}, {0, -10, 0}};
    // slip velocity at the ground 3 - w r = 3 + 5 = 8; normal impulse (1 + e) m 4 = 12
    const Vector3<double> sliding = contact_impulse<double>(ball, {}, {{0, 0, 0}, {0, 0, 1}, e, 0.1});
    EXPECT_LT(distance(sliding, {-1.2, 0, 12}), 1e-14);
    // sticking: J_t (1/m + r^2/I) = J_t 7/(2m) = 8, so J_t = 32/7, less than 12 mu for mu > 8/21
    const Vector3<double> sticking = contact_impulse<double>(ball, {}, {{0, 0, 0}, {0, 0, 1}, e, 0.5});
    EXPECT_LT(distance(sticking, {-32.0 / 7, 0, 12}), 1e-13);
    ImpactBody<double> after = ball;
    after.apply_impulse({0, 0, 0}, sticking);
    EXPECT_LT(distance(after.velocity_at({0, 0, 0}), {0, 0, 2}), 1e-13);
}

TEST(ContactImpulse, BetweenImmovableBodiesIsZero) {
    EXPECT_EQ(contact_impulse<double>({}, {}, {{0, 0, 0}, {0, 0, 1}, 1, 0}), Vector3<double>());
}

TEST(ContactImpulse, WorksInManyDigits) {
    using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>>;
    ImpactBody<Real> rod{Real(1) / 3,
                         diagonal(Vector3<Real>(Real(1) / 7, Real(1) / 7, Real(1))),
                         {Real(0), Real(0), Real(1)},
                         {Real(0), Real(0), Real(-1)},
                         {}};
    // j = 2 / (1/3 + 1/7) = 21/5 with an arm of 1 m
    const Vector3<Real> J = contact_impulse<Real>(rod, {}, {{Real(1), Real(0), Real(0)}, {Real(0), Real(0), Real(1)}});
    EXPECT_LT(abs(J[2] - Real(21) / 5), Real(1e-48));
}

std::vector<Contact<double>> under_box(double e, double friction, double bottom) {
    std::vector<Contact<double>> corners;
    for (int i = 0; i < 4; ++i)
        corners.push_back({{i & 1 ? 1.0 : -1.0, i & 2 ? 2.0 : -2.0, bottom}, {0, 0, 1}, e, friction});
    return corners;
}

/// A box that lands flat rebounds without spin: its four contacts are simultaneous.
TEST(ResolveImpact, OfABoxThatLandsFlatBringsNoSpin) {
    for (double e : {0.0, 0.5, 1.0}) {
        ImpactBody<double> box{0.5, diagonal(Vector3<double>(0.7, 1.1, 0.6)), {0, 0, 0.5}, {0.25, 0, -3}, {0, 0, 2}};
        const ImpactOutcome outcome = resolve_impact(box, under_box(e, 0, 0));
        EXPECT_TRUE(outcome.has_impact && outcome.resolved);
        EXPECT_LT(distance(box.velocity_W, {0.25, 0, 3 * e}), 1e-13);
        EXPECT_LT(distance(box.angular_velocity_W, {0, 0, 2}), 1e-13);
    }
}

/// Several contacts: their order does not matter, e = 1 conserves the energy, and no contact approaches afterwards.
RC_GTEST_PROP(ResolveImpact, DoesNotDependOnTheOrderOfContacts, ()) {
    const double e = *rc::gen::arbitrary<bool>() ? 1 : moderate(0, 1);
    ImpactBody<double> body = moderate_body();
    body.position_W = {0, 0, 1};
    std::vector<Contact<double>> contacts = under_box(e, 0, 0);
    contacts.push_back({{1.5, moderate(-1, 1), 1}, {-1, 0, 0}, e, 0});
    ImpactBody<double> reversed_order = body;
    const double energy = kinetic_energy(body);
    const ImpactOutcome outcome = resolve_impact(body, contacts);
    resolve_impact(reversed_order, std::vector<Contact<double>>(contacts.rbegin(), contacts.rend()));
    RC_ASSERT(outcome.resolved);
    RC_ASSERT(distance(body.velocity_W, reversed_order.velocity_W) < 1e-8);
    RC_ASSERT(distance(body.angular_velocity_W, reversed_order.angular_velocity_W) < 1e-8);
    for (const Contact<double>& contact : contacts)
        RC_ASSERT(dot(contact.normal_W, body.velocity_at(contact.point_W)) > -1e-12);
    if (e == 1)
        RC_ASSERT(std::abs(kinetic_energy(body) - energy) < 1e-10 * (1 + energy));
    else
        RC_ASSERT(kinetic_energy(body) <= energy * (1 + 1e-10));
}

RC_GTEST_PROP(ResolveImpact, WithFrictionGainsNoEnergy, ()) {
    ImpactBody<double> body = moderate_body();
    body.position_W = {0, 0, 1};
    const double energy = kinetic_energy(body);
    resolve_impact(body, under_box(moderate(0, 0.9), moderate(0, 1), 0));
    RC_ASSERT(kinetic_energy(body) <= energy * (1 + 1e-10));
}

}  // namespace
}  // namespace polhode
