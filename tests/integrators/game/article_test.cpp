// The article's update: compared with the article's code, with the exact motion, and with its known errors.
#include <gtest/gtest.h>

#include "integrators/game/game_scenes.h"

namespace polhode {
namespace {

using namespace polhode::testing;

/// The article's listing, line by line.
struct Rigid_Body {
    Vector3<double> position;
    Quaternion<double> orientation;
    Vector3<double> center_of_mass;
    Vector3<double> linear_velocity;
    double mass = 1;
    Matrix3<double> inertia;
    Vector3<double> angular_velocity;
};

void apply_torque(Rigid_Body* body, Vector3<double> force, Vector3<double> point, double delta_time) {
    const Vector3<double> world_com = body->position + body->center_of_mass;
    const Vector3<double> r = point - world_com;
    const Vector3<double> torque = cross(r, force);
    const Matrix3<double> orientation_matrix = rotation_matrix(body->orientation);
    const Matrix3<double> world_inertia = orientation_matrix * body->inertia * inverse(orientation_matrix);
    const Vector3<double> J = delta_time * (inverse(world_inertia) * torque);
    body->angular_velocity = body->angular_velocity + J;
}

void update_body_orientation(Rigid_Body* body, double delta_time) {
    const Matrix3<double> orientation_matrix = rotation_matrix(body->orientation);
    const Matrix3<double> world_inertia = orientation_matrix * body->inertia * inverse(orientation_matrix);
    const Vector3<double>& w = body->angular_velocity;
    body->angular_velocity = w + delta_time * (inverse(world_inertia) * cross(w, world_inertia * w));
    const Vector3<double> world_COM = body->position + rotate(body->orientation, body->center_of_mass);
    const Vector3<double> COM_to_pos = body->position - world_COM;
    const double length = std::sqrt(dot(w, w)), half = length * delta_time / 2, s = std::sin(half) / length;
    const Quaternion<double> theta{std::cos(half), s * w[0], s * w[1], s * w[2]};
    body->orientation = theta * body->orientation;
    body->position = world_COM + rotate(theta, COM_to_pos);
}

TEST(ArticleAsWritten, IsTheListing) {
    const Scene scene = pulled(1);
    Rigid_Body body;
    body.orientation = scene.initial.orientation;
    body.center_of_mass = scene.body.center_of_mass;
    body.position = scene.initial.position_W - rotate(body.orientation, body.center_of_mass);
    body.linear_velocity = scene.initial.velocity_W;
    body.mass = scene.body.mass, body.inertia = scene.body.inertia_B;
    body.angular_velocity = rotate(body.orientation, scene.initial.angular_velocity);
    const int n = 100;
    const double h = scene.duration / n;
    for (int i = 0; i < n; ++i) {
        for (const Load& load : scene.loads) {
            const Force& f = std::get<Force>(load);
            const bool fixed_in_body = f.point_frame == Frame::body;
            apply_torque(&body, f.vector, fixed_in_body ? body.position + rotate(body.orientation, f.point) : f.point,
                         h);
            body.linear_velocity = body.linear_velocity + (h / body.mass) * f.vector;
        }
        update_body_orientation(&body, h);
        body.position = body.position + h * body.linear_velocity;
    }
    const Sample end = with_step(scene, "article_as_written", h).samples.back();
    // the same operations except for the grouping of a few products: a few ulp per step
    EXPECT_LT(attitude_error(end.q, body.orientation), 1e-13);
    EXPECT_LT(distance(rotate(end.q, end.angular_velocity_B), body.angular_velocity), 1e-13);
    EXPECT_LT(distance(end.position_W, body.position + rotate(body.orientation, body.center_of_mass)), 1e-13);
    EXPECT_LT(distance(end.velocity_W, body.linear_velocity), 1e-13);
}

TEST(ArticleAsWritten, DoesNotTurnTheCentreOfMassIntoTheWorld) {
    // a sphere, which has no gyroscopic torque, rotated by pi about z, with its centre of mass at (1, 0, 0) in the body
    Scene scene;
    scene.name = "slip", scene.duration = 1e-3;
    scene.body.center_of_mass = {1, 0, 0};
    scene.initial.orientation = {0, 0, 0, 1};
    // a force through the centre of mass, at the world's origin: the exact torque is zero
    scene.loads = {Force{{0, 1, 0}, Frame::world, {1, 0, 0}, Frame::body, {}}};
    const Sample mended = with_step(scene, "article_mended", 1e-3).samples.back();
    EXPECT_LT(distance(mended.angular_velocity_B, {}), 1e-18);
    // as printed, the body's origin is at (1, 0, 0) and x_com at (2, 0, 0): r = (-2, 0, 0), a torque of -2 z for h
    const Sample written = with_step(scene, "article_as_written", 1e-3).samples.back();
    EXPECT_NEAR(written.angular_velocity_B[2], -2e-3, 1e-15);
    // each error alone: a sphere has no gyroscopic torque, so only the offset matters
    EXPECT_EQ(with_step(scene, "article_offset_as_written", 1e-3).samples.back().angular_velocity_B,
              written.angular_velocity_B);
    EXPECT_LT(distance(with_step(scene, "article_sign_as_written", 1e-3).samples.back().angular_velocity_B, {}), 1e-18);
}

TEST(ArticleAsWritten, IsTheSumOfTwoSlips) {
    // without a force at a point, or with the centre of mass at the origin, only the sign matters
    Scene centred = pulled(3);
    centred.body.center_of_mass = {};
    for (const Scene& scene : {free_body(3), centred}) {
        EXPECT_EQ(with_step(scene, "article_sign_as_written", 1e-3).samples.back().q,
                  with_step(scene, "article_as_written", 1e-3).samples.back().q);
        EXPECT_EQ(with_step(scene, "article_offset_as_written", 1e-3).samples.back().q,
                  with_step(scene, "article_mended", 1e-3).samples.back().q);
    }
    // with both, each single error gives another motion
    const Scene both = pulled(3);
    const Quaternion<double> mended = with_step(both, "article_mended", 1e-3).samples.back().q;
    for (const char* name : {"article_as_written", "article_offset_as_written", "article_sign_as_written"})
        EXPECT_GT(attitude_error(with_step(both, name, 1e-3).samples.back().q, mended), 0.05) << name;
}

TEST(ArticleBodyFrame, IsTheMendedUpdateButForRounding) {
    for (const Scene& scene : {everything(3), heavy_top(3), pulled(3), free_body(3)}) {
        const Trajectory world = with_step(scene, "article_mended", 1e-3, 10);
        const Trajectory body = with_step(scene, "article_body_frame", 1e-3, 10);
        ASSERT_EQ(world.status, Status::ok) << world.message;
        ASSERT_EQ(body.samples.size(), 11u);
        for (int i = 0; i <= 10; ++i) {
            // 3000 steps of a few ulp each, on motions without fast divergence
            EXPECT_LT(attitude_error(body.samples[i].q, world.samples[i].q), 1e-11) << scene.name;
            EXPECT_LT(distance(body.samples[i].angular_velocity_B, world.samples[i].angular_velocity_B), 1e-10);
            EXPECT_LT(distance(body.samples[i].position_W, world.samples[i].position_W), 1e-11);
            EXPECT_LT(distance(body.samples[i].velocity_W, world.samples[i].velocity_W), 1e-11);
        }
    }
}

/// Under every load, with windows and impulses, all parts of the state converge with order 1.
TEST(ArticleMended, ConvergesToTheMotionUnderEveryLoad) {
    const Scene scene = everything(2);
    const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-13).samples.back();
    std::array<std::array<double, 4>, 3> errors{};
    for (int i = 0; i < 3; ++i) {
        const Trajectory trajectory = with_step(scene, "article_mended", 1e-3 / (1 << i));
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        const Sample& end = trajectory.samples.back();
        errors[i] = {attitude_error(end.q, truth.q), distance(end.angular_velocity_B, truth.angular_velocity_B),
                     distance(end.position_W, truth.position_W), distance(end.velocity_W, truth.velocity_W)};
    }
    for (int part = 0; part < 4; ++part) {
        EXPECT_LT(errors[0][part], 0.02);
        EXPECT_NEAR(std::log2(errors[1][part] / errors[2][part]), 1, 0.1) << part;
    }
}

/// A user-defined torque receives the body's state, and a pivoted body takes forces and drag at its centre of mass.
TEST(ArticleMended, ConvergesOnAPivotedBodyWithDragAndUserTorque) {
    Scene scene = heavy_top(1);
    scene.loads.push_back(Drag{{0.1, 0.2, 0.3}, 0.5, {}});
    scene.loads.push_back(Force{{1, 2, 0}, Frame::body, {0.1, 0.2, 0.4}, Frame::body, {}});
    scene.loads.push_back(Impulse{{0.5, 0, 0.2}, Frame::world, {0.1, 0, 0.6}, Frame::body, 0.5});
    scene.loads.push_back(
        UserTorque{"swirl",
                   [](const LoadState& s) { return Vector3<double>(std::sin(s.t), s.q.x, -s.angular_velocity_B[2]); },
                   {}});
    const Sample truth = with_tolerance(scene, "odeint_fehlberg78", 1e-12).samples.back();
    const double coarse = attitude_error(with_step(scene, "article_mended", 2e-5).samples.back().q, truth.q);
    const double fine = attitude_error(with_step(scene, "article_mended", 1e-5).samples.back().q, truth.q);
    EXPECT_LT(coarse, 0.01);
    EXPECT_NEAR(std::log2(coarse / fine), 1, 0.1);
}

TEST(Article, KeepsTheLengthOfTheQuaternionByItself) {
    const Trajectory trajectory = with_step(free_body(100), "article_mended", 1e-3);
    // each product of unit quaternions has an error of about one ulp: at most 1e5 ulp after 1e5 steps
    EXPECT_LT(std::abs(squared_norm(trajectory.samples.back().q) - 1), 1e5 * 4.4e-16);
}

TEST(Article, LeavesABodyAtRestAlone) {
    Scene scene;
    scene.name = "rest", scene.duration = 1;
    scene.initial.orientation = {0.8, 0, 0.6, 0};
    for (const char* name : {"article_as_written", "article_offset_as_written", "article_sign_as_written",
                             "article_mended", "article_body_frame"}) {
        const Trajectory trajectory = with_step(scene, name, 0.01);
        ASSERT_EQ(trajectory.status, Status::ok) << trajectory.message;
        EXPECT_LT(attitude_error(trajectory.samples.back().q, scene.initial.orientation), 1e-15);
    }
}

TEST(Article, HasNoPlaceForAPivotElsewhere) {
    Scene scene = heavy_top(1);
    scene.pivot = Vector3<double>(0, 0, 0.1);
    for (const char* name : {"article_as_written", "article_offset_as_written", "article_sign_as_written",
                             "article_mended", "article_body_frame"}) {
        const Trajectory trajectory = with_step(scene, name, 0.01);
        EXPECT_EQ(trajectory.status, Status::unsupported);
        EXPECT_FALSE(trajectory.message.empty());
    }
}

}  // namespace
}  // namespace polhode
