// Tests that the shapes in the page, read back as scene files, have the mass properties of the original bodies.
#include "report/body_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "body/mesh.h"
#include "scene/body_source.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

Body body_from(const Json& body) {
    return parse_scene(Json{{"name", "drawn"}, {"duration", 1}, {"body", body}}.dump(), "drawn.json").body;
}

double largest_entry(const Matrix3<double>& m) {
    double size = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) size = std::max(size, std::abs(m[i][j]));
    return size;
}

// Numbers in the page have six digits; positions are from the centre of mass.
void expect_same_about_its_center(const Body& drawn, const Body& body) {
    EXPECT_NEAR(drawn.mass, body.mass, 1e-5 * body.mass);
    const double size = largest_entry(body.inertia_B);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(drawn.center_of_mass[i], 0, 1e-5 * std::sqrt(size / body.mass));
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(drawn.inertia_B[i][j], body.inertia_B[i][j], 3e-5 * size) << i << j;
    }
}

TEST(BodyShape, PartsAreThoseOfTheBodyWithTheirSizesPlacesAndHoles) {
    const Json shapes[] = {
        {{"type", "box"}, {"half_extents", {0.5, 0.75, 1}}},
        {{"type", "sphere"}, {"radius", 0.75}},
        {{"type", "hollow_sphere"}, {"outer_radius", 1}, {"inner_radius", 0.5}},
        {{"type", "cylinder"}, {"radius", 0.5}, {"half_height", 0.75}},
        {{"type", "hollow_cylinder"}, {"outer_radius", 1}, {"inner_radius", 0.5}, {"half_height", 0.75}},
        {{"type", "capsule"}, {"radius", 0.5}, {"half_height", 0.75}},
        {{"type", "cone"}, {"radius", 0.5}, {"height", 2}},
        {{"type", "ellipsoid"}, {"semi_axes", {0.5, 0.75, 1.25}}},
        {{"type", "torus"}, {"major_radius", 1.5}, {"minor_radius", 0.5}},
        {{"type", "rod"}, {"length", 2}},
        {{"type", "disc"}, {"radius", 1.5}},
        {{"type", "plate"}, {"half_extents", {0.5, 1.25}}},
        {{"type", "tetrahedron"}, {"vertices", {{0, 0, 0}, {2, 0.25, 0}, {0.25, 1.5, 0}, {0.5, 0.25, 1.75}}}},
        {{"type", "frustum"}, {"bottom_radius", 1.25}, {"top_radius", 0.5}, {"height", 1.5}}};
    for (const Json& shape : shapes) {
        SCOPED_TRACE(shape["type"]);
        const Json written{
            {"parts",
             {{{"shape", shape}, {"density", 3}, {"position", {0.5, -0.25, 1}}, {"orientation", {0.5, 0.5, -0.5, 0.5}}},
              {{"shape", {{"type", "sphere"}, {"radius", 0.75}}}, {"density", 3}},
              {{"shape", {{"type", "sphere"}, {"radius", 0.25}}}, {"density", -3}}}}};
        const Body body = body_from(written);
        const Json drawn = body_shape_json("b", body);
        ASSERT_EQ(drawn["parts"].size(), 3u);
        EXPECT_EQ(drawn["parts"][0]["type"], shape["type"]);
        EXPECT_EQ(drawn["parts"][0]["hole"], false);
        EXPECT_EQ(drawn["parts"][2]["hole"], true);
        Json parts = Json::array();
        for (Json part : drawn["parts"]) {
            Json sizes{{"type", part["type"]}};
            sizes.update(part["sizes"]);
            if (part["type"] == "tetrahedron") {
                Json corners = Json::array();
                for (std::size_t i = 0; i < 12; i += 3)
                    corners.push_back({part["sizes"]["vertices"][i], part["sizes"]["vertices"][i + 1],
                                       part["sizes"]["vertices"][i + 2]});
                sizes["vertices"] = corners;
            }
            parts.push_back({{"shape", sizes},
                             {"density", part["hole"] == true ? -3 : 3},
                             {"position", part["position"]},
                             {"orientation", part["orientation"]}});
        }
        expect_same_about_its_center(body_from({{"parts", parts}}), body);
    }
}

TEST(BodyShape, PointsStandAboutTheirCenterOfMass) {
    const Body body = body_from({{"points", {{1, 1, 0, 0}, {2, 0, 2, 0}, {3, 0, 0, 3}, {1, 2, 2, 2}}}});
    const Json drawn = body_shape_json("b", body);
    ASSERT_EQ(drawn["points"].size(), 12u);
    EXPECT_TRUE(drawn["parts"].empty());
    EXPECT_TRUE(drawn["vertices"].is_null());
    Json points = Json::array();
    const double mass[] = {1, 2, 3, 1};
    for (std::size_t i = 0; i < 4; ++i)
        points.push_back({mass[i], drawn["points"][3 * i], drawn["points"][3 * i + 1], drawn["points"][3 * i + 2]});
    expect_same_about_its_center(body_from({{"points", points}}), body);
}

TEST(BodyShape, MeshesStandWhereTheirPartsDo) {
    const Mesh corner{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}}, {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};
    const auto mesh = body_source(MeshBody{"corner.obj", "", corner, {4, true}});
    const Body body =
        body_of(body_source(PartsBody{{{mesh, {1, 0, 0}, {1, 0, 0, 0}}, {mesh, {0, -1, 0.5}, {0.5, 0.5, 0.5, 0.5}}}}));
    const Json drawn = body_shape_json("b", body);
    ASSERT_EQ(drawn["vertices"].size(), 24u);
    ASSERT_EQ(drawn["faces"].size(), 24u);
    Mesh both;
    for (std::size_t i = 0; i < 8; ++i)
        both.vertices.emplace_back(drawn["vertices"][3 * i], drawn["vertices"][3 * i + 1],
                                   drawn["vertices"][3 * i + 2]);
    for (std::size_t i = 0; i < 8; ++i)
        both.triangles.push_back({drawn["faces"][3 * i], drawn["faces"][3 * i + 1], drawn["faces"][3 * i + 2]});
    expect_same_about_its_center(body_of(body_source(MeshBody{"both.obj", "", both, {4, true}})), body);

    // large meshes are drawn as the box of the moments
    Mesh fine = corner;
    fine.triangles.resize(4001, {0, 2, 1});
    Body large = body;
    large.source = std::make_shared<BodySource>(BodySource{MeshBody{"fine.obj", "", fine, {4, true}}, {}});
    EXPECT_TRUE(body_shape_json("b", large)["vertices"].is_null());
}

TEST(BodyShape, APointMassIsAPointAndABodyWithoutMassIsEmpty) {
    const Json point = body_shape_json("p", Body{2, {}, {}, nullptr});
    EXPECT_EQ(point["points"], Json({0, 0, 0}));
    const Json massless = body_shape_json("m", Body{0, {}, {}, nullptr});
    EXPECT_TRUE(massless["points"].is_null());
    for (const Json& drawn : {point, massless}) {
        EXPECT_EQ(drawn["moments"], Json({0, 0, 0}));
        EXPECT_EQ(drawn["principal"], Json({1, 0, 0, 0}));
    }
}

TEST(BodyShape, NumbersAloneAreABoxOfTheMoments) {
    const Body body = body_from({{"mass", 2}, {"inertia", {{2, 0.5, 0}, {0.5, 3, 0}, {0, 0, 4}}}});
    const Json drawn = body_shape_json("b", body);
    EXPECT_TRUE(drawn["parts"].empty());
    EXPECT_TRUE(drawn["points"].is_null());
    EXPECT_TRUE(drawn["faces"].is_null());
    EXPECT_EQ(drawn["mass"], 2);
    // the roots of (2 - x)(3 - x) = 1/4
    EXPECT_NEAR(drawn["moments"][0], 2.5 - std::sqrt(0.5), 1e-5);
    EXPECT_NEAR(drawn["moments"][1], 2.5 + std::sqrt(0.5), 1e-5);
    EXPECT_EQ(drawn["moments"][2], 4);
    // parallel axis theorem: 1 m along the third axis, 2 kg add 2 kg m^2 to the other two moments
    const Json about = principal_json(body, Vector3<double>(0, 0, 1));
    EXPECT_NEAR(about["moments"][0], 4.5 - std::sqrt(0.5), 1e-5);
    EXPECT_NEAR(about["moments"][1], 4.5 + std::sqrt(0.5), 1e-5);
    EXPECT_EQ(about["moments"][2], 4);
}

}  // namespace
}  // namespace polhode
