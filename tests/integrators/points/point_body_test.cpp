// Point bodies in place of a rigid body: mass properties, attitude and loads, compared with explicit sums.
#include "integrators/points/point_body.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "body/mass_properties.h"
#include "integrators/points/point_motion.h"
#include "integrators/scenes.h"
#include "motion/moderate_scene.h"

namespace polhode {
namespace {

using namespace polhode::testing;

constexpr Arrangement simplex{Arrangement::Kind::simplex};

std::vector<double> placed(const PointBody& body, const Quaternion<double>& q, const Vector3<double>& at) {
    std::vector<double> r(static_cast<std::size_t>(3 * body.count()));
    for (int i = 0; i < body.count(); ++i) put(r.data(), 3 * i, at + rotate(q, body.rest_B[i]));
    return r;
}

double largest_difference(const Matrix3<double>& a, const Matrix3<double>& b) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(a[i][j] - b[i][j]));
    return largest;
}

void expect_mass_properties(const PointBody& points, const Body& body) {
    RC_ASSERT(points.refusal.empty());
    std::vector<PointMass<double>> masses;
    for (const Vector3<double>& x : points.rest_B) masses.push_back({points.point_mass, x});
    const MassProperties<double> sum = body_from_points(masses);
    RC_ASSERT(std::abs(sum.mass - body.mass) < 1e-14 * body.mass);
    RC_ASSERT(std::sqrt(dot(sum.center, sum.center)) < 1e-14);
    RC_ASSERT(largest_difference(sum.inertia, body.inertia_B) < 4e-14);
}

RC_GTEST_PROP(PointBody, HasTheMassTheCentreAndTheTensorOfTheBody, ()) {
    const Scene scene = moderate_scene();
    const Problem problem = pose(scene);
    expect_mass_properties(point_body(problem, simplex), scene.body);
    for (const int n : {2, 3, 4}) {
        const PointBody box = point_body(problem, {Arrangement::Kind::box, n});
        RC_ASSERT(box.count() == n * n * n);
        expect_mass_properties(box, scene.body);
    }
}

RC_GTEST_PROP(PointBody, OfAFlatBodyIsATriangle, ()) {
    Scene scene;
    scene.name = "flat", scene.duration = 1;
    scene.body.mass = moderate(0.2, 3);
    const double a = moderate(0.1, 2), b = moderate(0.1, 2);
    Vector3<double> moments(a, b, a + b);
    std::swap(moments[2], moments[static_cast<std::size_t>(*rc::gen::inRange(0, 3))]);
    scene.body.inertia_B = diagonal(moments);
    for (const Arrangement arrangement : {simplex, Arrangement{}}) {
        const PointBody points = point_body(pose(scene), arrangement);
        RC_ASSERT(points.count() == 3);
        RC_ASSERT(points.links.size() == 3u);
        expect_mass_properties(points, scene.body);
    }
}

TEST(PointBody, LinksAsManyAsItSays) {
    const Problem problem = pose(symmetric_body(1));
    EXPECT_EQ(point_body(problem, simplex).links.size(), 6u);
    EXPECT_EQ(point_body(problem, {}).links.size(), 28u);
    // of n^3 points: 3 directions along edges, 6 along face diagonals, 4 along cell diagonals
    for (const std::size_t n : {3u, 4u}) {
        const std::size_t m = n - 1;
        EXPECT_EQ(point_body(problem, {Arrangement::Kind::box, static_cast<int>(n)}).links.size(),
                  3 * n * n * m + 6 * n * m * m + 4 * m * m * m);
    }
}

TEST(PointBody, RefusesARodAndAPivotOutsideAFlatBody) {
    Scene scene;
    scene.name = "rod", scene.duration = 1;
    scene.body.inertia_B = diagonal(Vector3<double>(1e-13, 1, 1));
    EXPECT_NE(point_body(pose(scene), {}).refusal.find("rod"), std::string::npos);
    scene = free_body(1);
    scene.initial.position_W = {}, scene.initial.velocity_W = {};
    scene.pivot = Vector3<double>(0, 0, 0.1);
    EXPECT_NE(point_body(pose(scene), {}).refusal.find("pivot"), std::string::npos);
    scene.pivot = Vector3<double>(0.1, 0, 0);
    scene.body.inertia_B = diagonal(Vector3<double>(3, 2, 1));
    EXPECT_NE(point_body(pose(scene), {}).refusal.find("pivot"), std::string::npos);
    scene.pivot = Vector3<double>(0, 0.1, -0.2);
    EXPECT_EQ(point_body(pose(scene), {}).refusal, "");
}

RC_GTEST_PROP(PointBody, HoldsThePivotByItsWeights, ()) {
    Scene scene = moderate_scene();
    scene.initial.position_W = {}, scene.initial.velocity_W = {};
    scene.pivot = moderate_vector();
    for (const Arrangement arrangement : {simplex, Arrangement{}}) {
        const PointBody body = point_body(pose(scene), arrangement);
        Vector3<double> at = scene.body.center_of_mass;
        double sum = 0;
        for (int i = 0; i < body.count(); ++i) {
            at = at + body.pivot_weights[i] * body.rest_B[i];
            sum += body.pivot_weights[i];
        }
        RC_ASSERT(std::abs(sum - 1) < 1e-13);
        RC_ASSERT(distance(at, *scene.pivot) < 1e-13);
    }
}

RC_GTEST_PROP(BestRotation, FindsTheRotation, ()) {
    const bool flat = *rc::gen::arbitrary<bool>();
    const PointBody body = point_body(pose(flat ? free_body(1) : moderate_scene()), {});
    const Quaternion<double> q = moderate_orientation();
    const Vector3<double> at = moderate_vector();
    const std::vector<double> r = placed(body, q, at);
    RC_ASSERT(attitude_error(best_rotation(body.rest_B, r.data(), at), q) < 1e-14);
}

/// For distorted points: no nearby rotation fits better, and the points have no first moment about their centre.
RC_GTEST_PROP(BestRotation, IsTheBest, ()) {
    const PointBody body = point_body(pose(moderate_scene()), {});
    std::vector<double> r = placed(body, moderate_orientation(), {});
    for (double& x : r) x += 0.1 * body.extent * moderate(-1, 1);
    const Vector3<double> center = compute_cloud(1, r.data(), body.count()).center;
    const Quaternion<double> q = best_rotation(body.rest_B, r.data(), center);
    RC_ASSERT(q.w >= 0);
    const auto squares = [&](const Quaternion<double>& p) {
        double sum = 0;
        for (int i = 0; i < body.count(); ++i) {
            const Vector3<double> d = vector_at(r.data(), 3 * i) - center - rotate(p, body.rest_B[i]);
            sum += dot(d, d);
        }
        return sum;
    };
    Vector3<double> moment;
    for (int i = 0; i < body.count(); ++i)
        moment = moment + cross(rotate(q, body.rest_B[i]), vector_at(r.data(), 3 * i) - center);
    RC_ASSERT(std::sqrt(dot(moment, moment)) < 1e-13 * body.extent * body.extent);
    const double least = squares(q);
    for (int b = 0; b < 3; ++b)
        for (const double angle : {-0.1, 0.1, 2.0}) {
            Vector3<double> axis;
            axis[b] = std::sin(angle / 2);
            RC_ASSERT(squares(Quaternion<double>{std::cos(angle / 2), axis[0], axis[1], axis[2]} * q) > least);
        }
}

RC_GTEST_PROP(PointMotion, StartsAsTheBodyDoes, ()) {
    const Scene scene = moderate_scene();
    const Problem problem = pose(scene);
    const PointBody body = point_body(problem, {});
    PointMotion motion(problem, body);
    std::vector<double> y(static_cast<std::size_t>(6 * body.count()));
    motion.initial(y.data());
    const Sample sample = motion.sample(0, y.data());
    // rounding of positions relative to the extent of the points
    const double tolerance = 1e-13 / body.extent;
    RC_ASSERT(attitude_error(sample.q, problem.body.q) < tolerance);
    RC_ASSERT(distance(sample.angular_velocity_B, problem.body.angular_velocity_B) < 100 * tolerance);
    RC_ASSERT(distance(sample.position_W, problem.body.position_W) < 1e-14);
    RC_ASSERT(distance(sample.velocity_W, problem.body.velocity_W) < 1e-13);
}

/// The sums of the points' forces and torques equal the loads as the scene file defines them.
RC_GTEST_PROP(PointMotion, SpreadsForceAndTorqueExactly, ()) {
    Scene scene = moderate_scene();
    scene.initial.position_W = scene.initial.velocity_W = {};
    const bool held = scene.pivot.has_value();
    const Problem problem = pose(scene);
    const PointBody body = point_body(problem, {});
    PointMotion motion(problem, body);
    const int n = body.count();
    std::vector<double> y(static_cast<std::size_t>(6 * n)), a(static_cast<std::size_t>(3 * n));
    motion.initial(y.data());
    motion.enter(problem.segments.front(), y.data());
    motion.add_loads(0, y.data(), a.data());
    Vector3<double> force, about;
    for (int i = 0; i < n; ++i) {
        const Vector3<double> f = body.point_mass * vector_at(a.data(), 3 * i);
        force = force + f;
        about = about + cross(vector_at(y.data(), 3 * i), f);
    }
    const ExactBody<double>& start = problem.body;
    const Vector3<double> c = start.position_W, v = start.velocity_W, w_B = start.angular_velocity_B;
    Vector3<double> F, tau;  // about W's origin
    const auto at = [&](const Vector3<double>& f, const Vector3<double>& r) { F = F + f, tau = tau + cross(r, f); };
    const auto in_world = [&](const Vector3<double>& u, Frame frame) {
        return frame == Frame::world ? u : rotate(start.q, u);
    };
    for (const Load& load : scene.loads) {
        const Window window = window_of(load);
        if (!(window.from <= 0 && 0 < window.until)) continue;
        if (const auto* g = std::get_if<Gravity>(&load)) at(scene.body.mass * g->acceleration_W, c);
        if (const auto* t = std::get_if<Torque>(&load)) tau = tau + in_world(t->vector, t->frame);
        if (const auto* f = std::get_if<Force>(&load))
            at(in_world(f->vector, f->frame),
               f->point_frame == Frame::world ? f->point : c + rotate(start.q, f->point - scene.body.center_of_mass));
        if (const auto* d = std::get_if<Drag>(&load)) {
            const Vector3<double>& k = d->rotational;
            tau = tau + rotate(start.q, Vector3<double>(-k[0] * w_B[0], -k[1] * w_B[1], -k[2] * w_B[2]));
            at(-d->translational * v, c);
        }
        if (const auto* s = std::get_if<Spring>(&load)) {
            const Quaternion<double> r = conjugate(normalized(s->rest_orientation)) * start.q;
            tau = tau + rotate(start.q, (-2 * s->stiffness * r.w) * vector_part(r));
        }
    }
    const double tolerance = 1e-11 / (body.extent * body.extent);
    RC_ASSERT(distance(about, tau) < tolerance);
    // the pivot's reaction takes the force
    if (!held) RC_ASSERT(distance(force, F) < tolerance);
}

}  // namespace
}  // namespace polhode
