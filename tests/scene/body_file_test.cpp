// Bodies from every kind of source, compared with closed forms, with each other, and with the same body given by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "body/shapes.h"
#include "body/tessellation.h"
#include "places.h"
#include "scene/body_hull.h"
#include "scene/body_source.h"
#include "scene/mesh_file.h"
#include "scene/robot_file.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

const std::string bodies = source_dir() + "/tests/scene/bodies";

Scene scene_of(const std::string& body, const std::string& more = "") {
    return parse_scene(R"({"name": "s", "duration": 1, "body": {)" + body + "}" + more + "}", "s.json", bodies);
}

double largest(const Matrix3<double>& m) {
    double most = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(m[i][j]));
    return most;
}

void expect_same(const Body& a, const Body& b, double tolerance) {
    EXPECT_NEAR(a.mass, b.mass, tolerance * b.mass);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(a.center_of_mass[i], b.center_of_mass[i], tolerance);
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(a.inertia_B[i][j], b.inertia_B[i][j], tolerance * largest(b.inertia_B));
    }
}

// Mass 2 kg; moments from textbook tables, in their printed form.
TEST(BodyFile, ShapesHaveTheMomentsOfTheTables) {
    const auto moments = [](const char* shape) {
        const Body body = scene_of(std::string(R"("mass": 2, "shape": )") + shape).body;
        EXPECT_EQ(body.mass, 2);
        EXPECT_EQ(body.center_of_mass, Vector3<double>());
        return Vector3<double>(body.inertia_B[0][0], body.inertia_B[1][1], body.inertia_B[2][2]);
    };
    const auto expect = [](const Vector3<double>& I, double x, double y, double z) {
        EXPECT_NEAR(I[0], x, 1e-15 * x);
        EXPECT_NEAR(I[1], y, 1e-15 * y);
        EXPECT_NEAR(I[2], z, 1e-15 * z);
    };
    expect(moments(R"({"type": "box", "half_extents": [1, 2, 3]})"), 2 * 13 / 3.0, 2 * 10 / 3.0, 2 * 5 / 3.0);
    expect(moments(R"({"type": "sphere", "radius": 3})"), 7.2, 7.2, 7.2);
    const double hollow = 2 * 2 * (243 - 32) / (5.0 * (27 - 8));
    expect(moments(R"({"type": "hollow_sphere", "outer_radius": 3, "inner_radius": 2})"), hollow, hollow, hollow);
    expect(moments(R"({"type": "cylinder", "radius": 3, "half_height": 2})"), 2 * (27 + 16) / 12.0,
           2 * (27 + 16) / 12.0, 9);
    expect(moments(R"({"type": "hollow_cylinder", "outer_radius": 3, "inner_radius": 2, "half_height": 2})"),
           2 * (39 + 16) / 12.0, 2 * (39 + 16) / 12.0, 13);
    expect(moments(R"({"type": "cone", "radius": 2, "height": 3})"), 2 * (0.6 + 27 / 80.0), 2 * (0.6 + 27 / 80.0), 2.4);
    expect(moments(R"({"type": "ellipsoid", "semi_axes": [1, 2, 3]})"), 2 * 13 / 5.0, 2 * 10 / 5.0, 2 * 5 / 5.0);
    expect(moments(R"({"type": "torus", "major_radius": 3, "minor_radius": 1})"), 2 * (9 + 1.25) / 2,
           2 * (9 + 1.25) / 2, 2 * (9 + 0.75));
    // a rod has a zero moment, so it must be a part: here with two point masses off its axis
    const Body rod = scene_of(R"("parts": [{"mass": 2, "shape": {"type": "rod", "length": 3}},
                                          {"points": [[1, 1, 0, 0], [1, -1, 0, 0]]}])")
                         .body;
    expect({rod.inertia_B[0][0], rod.inertia_B[1][1], rod.inertia_B[2][2]}, 1.5, 1.5 + 2, 2);
    expect(moments(R"({"type": "disc", "radius": 2})"), 2, 2, 4);
    expect(moments(R"({"type": "plate", "half_extents": [1, 2]})"), 2 * 4 / 3.0, 2 / 3.0, 2 * 5 / 3.0);
    // a cone cut at half its height: the whole cone minus its tip, by the parallel axis theorem
    const double V = std::numbers::pi * 4 * 4 / 3, v = V / 8, m = 2 * V / (V - v), n = m - 2;
    const double z = (m * 1 - n * 2.5) / 2;  // centre above the base: h/4 for the cone, 2 + 2/4 for the tip
    const double across =
        m * (3.0 / 20 * 4 + 3.0 / 80 * 16 + (1 - z) * (1 - z)) - n * (3.0 / 20 + 3.0 / 80 * 4 + (2.5 - z) * (2.5 - z));
    const double along = 0.3 * (m * 4 - n);
    const Vector3<double> frustum = moments(R"({"type": "frustum", "bottom_radius": 2, "top_radius": 1, "height": 2})");
    EXPECT_NEAR(frustum[0], across, 1e-14 * across);
    EXPECT_NEAR(frustum[2], along, 1e-14 * along);
    // a capsule as its parts: the centres of the hemispheres are 3 r / 8 beyond the tube
    const double tube = 4.0, caps = 4.0 / 3, k = 2 / (tube + caps);
    const double half = 0.4 - 9 / 64.0;  // hemisphere of mass 1: moment across its axis, about its centre of mass
    const double tumble = k * (tube * (3 + 16) / 12 + caps * (half + (2 + 3 / 8.0) * (2 + 3 / 8.0)));
    const Vector3<double> capsule = moments(R"({"type": "capsule", "radius": 1, "half_height": 2})");
    EXPECT_NEAR(capsule[0], tumble, 1e-15 * tumble);
    EXPECT_NEAR(capsule[2], k * (tube / 2 + caps * 0.4), 1e-15);
}

// The closed forms are accurate to the last digits of binary64, compared with 128 bits.
TEST(BodyFile, ClosedFormsAreRightToTheLastDigits) {
    const Shape shapes[] = {Box{{0.3, 1.7, 0.013}},
                            SolidSphere{0.7},
                            HollowSphere{1.1, 1.0999},
                            Cylinder{0.3, 1.9},
                            HollowCylinder{1.1, 1.0999, 0.3},
                            Capsule{0.3, 1.7},
                            Cone{0.7, 1.3},
                            Ellipsoid{{0.1, 0.9, 1.3}},
                            Torus{1.3, 0.7},
                            ThinRod{1.7},
                            ThinDisc{0.9},
                            ThinPlate{{0.7, 1.9}},
                            Tetrahedron{{Vector3<double>(0.1, 0.2, 0.3), Vector3<double>(1.1, 0.4, -0.3),
                                         Vector3<double>(0.7, 1.9, 0.1), Vector3<double>(-0.2, 0.5, 2.3)}},
                            Frustum{1.1, 0.3, 0.7}};
    static_assert(std::size(shapes) == std::variant_size_v<Shape>);
    for (const Shape& shape : shapes) {
        const MassProperties<double> body = body_from_density<double>(shape, 2.7);
        const MassProperties<Wide> truth = body_from_density<Wide>(shape, Wide(2.7));
        EXPECT_NEAR(body.mass, double(truth.mass), 1e-14 * body.mass) << shape.index();
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double off = std::abs(double(Wide(body.inertia[i][j]) - truth.inertia[i][j]));
                // moments relative to themselves, products relative to the largest entry
                EXPECT_LE(off, 1e-14 * (i == j ? body.inertia[i][i] : largest(body.inertia)))
                    << shape.index() << i << j;
            }
    }
}

TEST(BodyFile, OneBoxInSixWays) {
    const Body box = scene_of(R"("shape": {"type": "box", "half_extents": [1, 1, 1]}, "density": 3)").body;
    for (const char* file : {"cube.obj", "cube_text.stl", "cube_binary.stl", "inside_out.stl"}) {
        SCOPED_TRACE(file);
        expect_same(scene_of(std::string(R"("mesh": ")") + file + R"(", "density": 3)").body, box, 1e-15);
        expect_same(scene_of(std::string(R"("mesh": ")") + file + R"(", "mass": 24)").body, box, 1e-15);
    }
    // two halves, and a larger box with two holes
    expect_same(scene_of(R"("parts": [
                            {"shape": {"type": "box", "half_extents": [1, 1, 0.5]}, "density": 3, "position": [0, 0, 0.5]},
                            {"shape": {"type": "box", "half_extents": [1, 0.5, 1]}, "mass": 12, "position": [0, 0, -0.5],
                             "orientation": [0.7071067811865476, 0.7071067811865476, 0, 0]}])")
                    .body,
                box, 1e-15);
    expect_same(scene_of(R"("parts": [
                            {"shape": {"type": "box", "half_extents": [2, 1, 1]}, "density": 3},
                            {"shape": {"type": "box", "half_extents": [0.5, 1, 1]}, "density": -3, "position": [1.5, 0, 0]},
                            {"shape": {"type": "box", "half_extents": [0.5, 1, 1]}, "density": -3, "position": [-1.5, 0, 0]}])")
                    .body,
                box, 1e-15);
    expect_same(scene_of(R"("points": [[3, 1, 0, 0], [3, -1, 0, 0], [3, 0, 1, 0], [3, 0, -1, 0], [3, 0, 0, 1],
                                      [3, 0, 0, -1], [6, 0, 0, 0]])")
                    .body,
                scene_of(R"("mass": 24, "inertia": [12, 12, 12])").body, 1e-15);
}

// Meshes of a sphere and a torus converge to the closed form with the square of the edge length; a box is exact.
TEST(BodyFile, SurfacesConverge) {
    const auto error = [](const Mesh& mesh, const Shape& shape) {
        EXPECT_EQ(mesh_fault(mesh), "");
        const Extent<double> extent = mesh_extent<double>(mesh);
        const MassProperties<double> body = uniform_body(extent, 2 * extent.size),
                                     truth = body_from_density<double>(shape, 2);
        return std::abs(body.inertia[0][0] / truth.inertia[0][0] - 1);
    };
    const Box box{{0.3, 0.7, 1.1}};
    EXPECT_LE(error(tessellate(box), box), 1e-15);
    const SolidSphere ball{0.7};
    const Torus torus{1.3, 0.4};
    for (int level = 3; level < 6; ++level) {
        EXPECT_NEAR(error(tessellate(ball, level), ball) / error(tessellate(ball, level + 1), ball), 4, 0.1);
        EXPECT_NEAR(error(tessellate(torus, 4 << level), torus) / error(tessellate(torus, 8 << level), torus), 4, 0.05);
    }
    EXPECT_LT(error(tessellate(ball, 5), ball), 1e-3);
}

TEST(BodyFile, OneLinkInThreeFormats) {
    const auto imported = [](const char* file, const char* link) {
        return scene_of(std::string(R"("import": {"file": ")") + file + R"(", "link": ")" + link + R"("})").body;
    };
    const Body by_hand = scene_of(R"("mass": 2.5, "center_of_mass": [0.1, -0.2, 0.3],
        "inertia": [[0.4, 0.05, -0.02], [0.05, 0.5, 0.01], [-0.02, 0.01, 0.6]])")
                             .body;
    for (const auto& [file, link] :
         {std::pair{"arm.urdf", "base"}, std::pair{"arm.xml", "base"}, std::pair{"arm.sdf", "arm::base"}})
        expect_same(imported(file, link), by_hand, 0);
    // rotated by roll, pitch and yaw about fixed axes: R = Rz Ry Rx, written out
    const double a = 0.3, b = -0.7, c = 1.1;
    const Matrix3<double> R{
        {Vector3<double>(std::cos(c) * std::cos(b), std::cos(c) * std::sin(b) * std::sin(a) - std::sin(c) * std::cos(a),
                         std::cos(c) * std::sin(b) * std::cos(a) + std::sin(c) * std::sin(a)),
         Vector3<double>(std::sin(c) * std::cos(b), std::sin(c) * std::sin(b) * std::sin(a) + std::cos(c) * std::cos(a),
                         std::sin(c) * std::sin(b) * std::cos(a) - std::cos(c) * std::sin(a)),
         Vector3<double>(-std::sin(b), std::cos(b) * std::sin(a), std::cos(b) * std::cos(a))}};
    Body turned = by_hand;
    turned.inertia_B = R * by_hand.inertia_B * transposed(R);
    for (const char* file : {"arm.urdf", "arm.sdf"}) {
        SCOPED_TRACE(file);
        expect_same(imported(file, "turned"), turned, 1e-15);
        expect_same(imported(file, "turned"), imported("arm.urdf", "turned"), 0);
    }
    // MJCF rotates only the principal moments
    Body principal = by_hand;
    principal.inertia_B = R * diagonal(Vector3<double>(0.4, 0.5, 0.6)) * transposed(R);
    expect_same(imported("arm.xml", "turned"), principal, 1e-15);
    expect_same(imported("arm.xml", "zaxis"), scene_of(R"("mass": 1, "inertia": [2.5, 2, 1])").body, 1e-15);
    // a quarter rotation about z, by a quaternion of length 2.8, swaps the first two moments
    expect_same(imported("arm.xml", "principal"), scene_of(R"("mass": 1, "inertia": [2, 1, 2.5])").body, 1e-15);
}

TEST(BodyFile, AnglesOfMjcfAreReadByItsCompiler) {
    const auto body = [](const char* compiler, const char* euler) {
        const std::string text =
            std::string("<mujoco>") + compiler +
            "<worldbody><body name='b'><inertial pos='0 0 0' mass='1' diaginertia='1 2 2.5' euler='" + euler +
            "'/></body></worldbody></mujoco>";
        return body_of(body_source(parse_robot_body(text, "m.xml", "b")));
    };
    // degrees and the rotating axes x, y, z are the defaults
    const Body from_degrees = body("<compiler angle='degree' eulerseq='xyz'/>", "30 40 50");
    expect_same(body("", "30 40 50"), from_degrees, 0);
    expect_same(body("<compiler angle='radian'/>", "0.5235987755982988 0.6981317007977318 0.8726646259971648"),
                from_degrees, 1e-15);
    // fixed axes in the opposite order
    expect_same(body("<compiler eulerseq='ZYX'/>", "50 40 30"), from_degrees, 1e-15);
    EXPECT_THROW(body("<compiler eulerseq='xyZ'/>", "1 2 3"), InputError);
}

// A written scene reads back to the same body, and its text is canonical. A changed mesh file makes a different scene.
TEST(BodyFile, WritesWhatItRead) {
    for (
        const char* body :
        {R"("shape": {"type": "box", "half_extents": [0.1, 0.2, 0.3]}, "density": 1000)",
         R"("shape": {"type": "sphere", "radius": 0.1}, "mass": 1)",
         R"("shape": {"type": "hollow_sphere", "outer_radius": 0.2, "inner_radius": 0.1}, "mass": 1)",
         R"("shape": {"type": "cylinder", "radius": 0.1, "half_height": 0.3}, "mass": 1)",
         R"("shape": {"type": "hollow_cylinder", "outer_radius": 0.2, "inner_radius": 0, "half_height": 0.3}, "mass": 1)",
         R"("shape": {"type": "capsule", "radius": 0.1, "half_height": 0.3}, "mass": 1)",
         R"("shape": {"type": "cone", "radius": 0.1, "height": 0.3}, "mass": 1)",
         R"("shape": {"type": "ellipsoid", "semi_axes": [0.1, 0.2, 0.3]}, "mass": 1)",
         R"("shape": {"type": "torus", "major_radius": 0.3, "minor_radius": 0.1}, "mass": 1)",
         R"("shape": {"type": "disc", "radius": 0.1}, "density": 7)",
         R"("shape": {"type": "plate", "half_extents": [0.1, 0.2]}, "density": 7)",
         R"("shape": {"type": "tetrahedron", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}, "mass": 1)",
         R"("shape": {"type": "frustum", "bottom_radius": 0.1, "top_radius": 0, "height": 0.3}, "mass": 1)",
         R"("points": [[1, 0, 0, 0], [2, 1, 0, 0], [3, 0, 1, 0], [4, 0, 0, 1]])",
         R"("mesh": "cube.obj", "density": 1000)", R"("import": {"file": "arm.urdf", "link": "turned"})",
         R"("parts": [{"mass": 1, "inertia": [0, 0, 0], "center_of_mass": [1, 2, 3]},
                       {"parts": [{"shape": {"type": "rod", "length": 0.1}, "density": 2},
                                  {"mesh": "cube_binary.stl", "mass": 3, "position": [0.1, 0, 0]}],
                        "orientation": [0.6, 0, 0.8, 0]}])"}) {
        const Scene a = scene_of(body);
        const std::string text = write_scene(a);
        const Scene b = parse_scene(text, "written", bodies);
        EXPECT_EQ(write_scene(b), text);
        expect_same(b.body, a.body, 0);
        EXPECT_TRUE(a.body.source && b.body.source);
    }
    const std::string cube = write_scene(scene_of(R"("mesh": "cube.obj", "density": 1000)"));
    EXPECT_NE(cube.find(read_mesh(bodies + "/cube.obj").hash), std::string::npos);
}

TEST(BodyFile, FilesAreBesideTheScene) {
    const Scene scene = read_scene(source_dir() + "/tests/scene/bodies/cube_scene.json");
    EXPECT_EQ(scene.body.mass, 8);
}

// The article's box with a sphere: its angular momentum is not parallel to its angular velocity.
TEST(BodyFile, AnAttachedSphereTurnsTheMomentumAside) {
    const Scene scene = find_scene("box_with_sphere");
    const Vector3<double> w = scene.initial.angular_velocity, L = scene.body.inertia_B * w;
    const Vector3<double> across = cross(w, L);
    EXPECT_GT(std::sqrt(dot(across, across) / (dot(w, w) * dot(L, L))), 0.2);
}

// The numbers remain as given, and the hull is that of the shape about the body's origin.
TEST(BodyFile, AContactShapeAddsAHullToNumbers) {
    const std::string numbers = R"("mass": 2, "inertia": [[1, 0.25, 0], [0.25, 2, 0], [0, 0, 2.5]],
                                   "center_of_mass": [0, 0, -0.25])";
    const std::string shape = R"({"type": "ellipsoid", "semi_axes": [3, 2, 1]})";
    const std::string floor = R"(, "initial": {"position": [0, 0, 0.75]}, "planes": [{"normal": [0, 0, 1],
                                "restitution": 0}])";
    const Scene scene = scene_of(numbers + R"(, "contact_shape": )" + shape, floor);
    expect_same(scene.body, scene_of(numbers).body, 0);
    const std::vector<SupportPiece<double>> pieces = hull<double>(*scene.body.source);
    ASSERT_EQ(pieces.size(), 1u);
    EXPECT_EQ(pieces[0].lowest({0, 0, 1}), -1);
    EXPECT_EQ(pieces[0].lowest({1, 0, 0}), -3);
    EXPECT_EQ(write_scene(parse_scene(write_scene(scene), "written")), write_scene(scene));
    EXPECT_NE(write_scene(scene).find("\"contact_shape\": {\"type\": \"ellipsoid\""), std::string::npos);
}

std::string refusal_of(const std::string& body, const std::string& more = "") {
    try {
        scene_of(body, more);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(BodyFile, ContactShapesAreChecked) {
    const std::string numbers = R"("mass": 2, "inertia": [1, 2, 2.5])",
                      sphere = R"(, "contact_shape": {"type": "sphere", "radius": 0.5})",
                      floor = R"(, "planes": [{"name": "floor", "normal": [0, 0, 1], "restitution": 0}])";
    EXPECT_NE(refusal_of(R"("shape": {"type": "sphere", "radius": 1}, "mass": 1)" + sphere).find("contact_shape"),
              std::string::npos);
    EXPECT_EQ(refusal_of(numbers + R"(, "contact_shape": {"type": "sphere", "radius": -1})")
                  .find("s.json: /body/contact_shape/radius: "),
              0u);
    EXPECT_EQ(refusal_of(R"("mass": 0)" + sphere).find("s.json: /body/inertia"), 0u)
        << refusal_of(R"("mass": 0)" + sphere);
    EXPECT_NE(refusal_of(numbers, floor).find("contact_shape"), std::string::npos);
    // 0.5 m of the ball are below the floor
    EXPECT_EQ(refusal_of(numbers + sphere, floor).find("s.json: /planes/0: (floor) is penetrated 0.5 m deep"), 0u)
        << refusal_of(numbers + sphere, floor);
}

}  // namespace
}  // namespace polhode
