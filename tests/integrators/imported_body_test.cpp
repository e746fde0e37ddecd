// A body given by shapes, meshes or files moves like the same body given by numbers, and its truth is that of the
// exact body, not of the rounded one.
#include <gtest/gtest.h>

#include <boost/multiprecision/mpfr.hpp>
#include <cmath>

#include "integrators/method.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/reference.h"
#include "motion/exact_body_of.h"
#include "places.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

const std::string body_files = source_dir() + "/tests/scene/bodies";

Scene scene_of(const std::string& body) {
    return parse_scene(R"({"name": "s", "duration": 3, "body": {)" + body +
                           R"(}, "pivot": [0, 0, 0], "initial": {"angular_velocity": [1, 2, 3]},
                           "loads": [{"type": "gravity", "acceleration": [0, 0, -9.8]}]})",
                       "s.json", body_files);
}

TEST(ImportedBody, MovesBitForBitAsTheOneWrittenByHand) {
    const Scene imported = scene_of(R"("import": {"file": "arm.urdf", "link": "base"})");
    const Scene by_hand = scene_of(R"("mass": 2.5, "center_of_mass": [0.1, -0.2, 0.3],
        "inertia": [[0.4, 0.05, -0.02], [0.05, 0.5, 0.01], [-0.02, 0.01, 0.6]])");
    for (const char* name : {"cvode_adams", "odeint_rk4", "article_mended", "odeint_fehlberg78"}) {
        const Method& method = *find_method(name);
        Settings settings;
        settings.samples = 30;
        const Trajectory a = solve(imported, method, settings), b = solve(by_hand, method, settings);
        ASSERT_EQ(a.samples.size(), b.samples.size());
        ASSERT_EQ(a.status, Status::ok) << a.message;
        for (std::size_t k = 0; k < a.samples.size(); ++k) {
            EXPECT_EQ(a.samples[k].q, b.samples[k].q);
            EXPECT_EQ(a.samples[k].angular_velocity_B, b.samples[k].angular_velocity_B);
            EXPECT_EQ(a.samples[k].position_W, b.samples[k].position_W);
        }
    }
}

// Every scalar type evaluates the same exact function: 128 bits agree with 100 digits, with rotated parts as well.
TEST(ImportedBody, IsExactInEveryScalar) {
    using R =
        boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;
    for (const char* body :
         {R"("import": {"file": "arm.urdf", "link": "turned"})", R"("mesh": "cube.obj", "mass": 0.7)",
          R"("parts": [{"shape": {"type": "torus", "major_radius": 0.3, "minor_radius": 0.1},
                                           "density": 0.7, "position": [0.1, 0.2, 0.3],
                                           "orientation": [0.36, 0.48, 0.8, 0]},
                                          {"shape": {"type": "capsule", "radius": 0.1, "half_height": 0.2},
                                           "density": 0.3}])"}) {
        const Scene scene = scene_of(body);
        const ExactBody<Wide> wide = exact_body<Wide>(scene);
        const ExactBody<R> exact = exact_body<R>(scene);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double high = double(wide.inertia_B[i][j]), low = double(wide.inertia_B[i][j] - Wide(high));
                const R off = exact.inertia_B[i][j] - R(high) - R(low);
                EXPECT_LT(std::abs(off.convert_to<double>()), 1e-31) << body << i << j;
            }
        EXPECT_EQ(double(wide.mass), exact.mass.convert_to<double>());
    }
}

// The binary64 tensor of a composite differs from its exact tensor: over 60 s of free tumbling the two motions differ
// by more than the truth's bound, and the truth is that of the parts.
TEST(ImportedBody, HasTheTruthOfItsPartsNotOfTheirRoundedSum) {
    const FreshCache cache;
    Scene parts = find_scene("l_shape");
    parts.duration = 60;
    Scene rounded = parts;
    rounded.body.source = nullptr;
    const Reference a = reference(parts, 10), b = reference(rounded, 10);
    ASSERT_TRUE(a.available && b.available) << a.message << b.message;
    double apart = 0;
    for (std::size_t k = 0; k < a.samples.size(); ++k)
        apart = std::max(apart, std::abs((a.samples[k].q.w.high - b.samples[k].q.w.high) +
                                         (a.samples[k].q.w.low - b.samples[k].q.w.low)));
    EXPECT_GT(apart, 1e3 * a.bound);
    EXPECT_LT(apart, 1e-12);
}

}  // namespace
}  // namespace polhode
