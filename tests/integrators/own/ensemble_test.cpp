// Ensembles of single bodies, row by row against closed forms, the truth and other methods; bits and failures.
#include "integrators/own/ensemble.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "build_kind.h"
#include "integrators/own/ensemble_scenes.h"
#include "integrators/scenes.h"
#include "integrators/truth/reference.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

using testing::Draw;
using testing::free_bodies;
using testing::free_scene;
using testing::scene_of;
using testing::top_scene;
using testing::tops;

constexpr std::size_t many_bodies = optimised_build ? 512 : 24, few_bodies = optimised_build ? 40 : 9;

struct Worst {
    double attitude = 0, w = 0, p = 0;
};

// Compares each row with the named method on a scene of this body alone.
Worst worst_against(const char* method, const Scene& scene, const std::vector<EnsembleBody>& bodies,
                    const std::vector<EnsembleRow>& rows, std::optional<double> tolerance = {}) {
    Worst worst;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        EXPECT_EQ(rows[i].status, Status::ok) << "row " << i << ": " << rows[i].message;
        Settings settings;
        settings.samples = 1, settings.tolerance = tolerance;
        const Trajectory alone = solve(scene_of(scene, bodies[i]), *find_method(method), settings);
        if (alone.status != Status::ok) {
            ADD_FAILURE() << method << ": " << alone.message;
            return worst;
        }
        const Sample &a = rows[i].end, &b = alone.samples.back();
        EXPECT_EQ(a.t, b.t);
        worst.attitude = std::max(worst.attitude, testing::attitude_error(a.q, b.q));
        const Vector3<double> dw = a.angular_velocity_B - b.angular_velocity_B, dp = a.position_W - b.position_W;
        worst.w = std::max(worst.w, std::sqrt(dot(dw, dw)));
        worst.p = std::max(worst.p, std::sqrt(dot(dp, dp)));
    }
    return worst;
}

TEST(Ensemble, FreeBodiesAgreeWithTheClosedFormOneByOne) {
    const Scene scene = free_scene(10);
    const auto bodies = free_bodies(many_bodies, 1);
    const Worst worst = worst_against("exact", scene, bodies, solve_ensemble(scene, bodies));
    EXPECT_LT(worst.attitude, 1e-12);
    EXPECT_LT(worst.w, 1e-12);
    EXPECT_GT(worst.attitude, 0) << "the same computation twice";
}

TEST(Ensemble, NextToTheSeparatrix) {
    const Scene scene = free_scene(10);
    auto bodies = free_bodies(many_bodies, 2);
    Draw draw(3);
    for (EnsembleBody& b : bodies) {
        // I1 (I2 - I1) w1^2 = I3 (I3 - I2) w3^2 up to a relative 1e-1 .. 1e-15, with the moments in ascending order
        std::size_t axis[3] = {0, 1, 2};
        std::sort(axis, axis + 3, [&](auto i, auto j) { return b.inertia_B[i][i] < b.inertia_B[j][j]; });
        const double I1 = b.inertia_B[axis[0]][axis[0]], I2 = b.inertia_B[axis[1]][axis[1]],
                     I3 = b.inertia_B[axis[2]][axis[2]];
        const double off = std::pow(10, draw.uniform(-15, -1)) * (draw.uniform(0, 1) < 0.5 ? -1 : 1);
        Vector3<double>& w = b.angular_velocity;
        w[axis[0]] = (1 + off) * w[axis[2]] * std::sqrt(I3 * (I3 - I2) / (I1 * (I2 - I1)));
        w = (1.5 / std::sqrt(dot(w, w))) * w;
    }
    const Worst worst = worst_against("exact", scene, bodies, solve_ensemble(scene, bodies));
    EXPECT_LT(worst.attitude, 1e-10);
    EXPECT_LT(worst.w, 1e-10);
}

TEST(Ensemble, SpecialMotions) {
    Scene scene = free_scene(10);
    const Quaternion<double> q{0.5, -0.5, 0.5, 0.5};
    std::vector<EnsembleBody> bodies;
    // spheres, two equal moments in each position, three different moments; at rest, rotating about one, two and
    // three axes; each also changed by one ulp
    for (const Vector3<double>& I :
         {Vector3<double>(2, 2, 2), Vector3<double>(1, 1, 1.5), Vector3<double>(1.5, 1, 1), Vector3<double>(1, 1.5, 1),
          Vector3<double>(1, 1, 0.5), Vector3<double>(1, 2, 2.5), Vector3<double>(1, 1 + 0x1p-52, 1.5),
          Vector3<double>(1, 1.5, 1.5 + 0x1p-51), Vector3<double>(3, 4, 6)})
        for (const Vector3<double>& w :
             {Vector3<double>(0, 0, 0), Vector3<double>(1.2, 0, 0), Vector3<double>(0, -0.7, 0),
              Vector3<double>(0, 0, 1), Vector3<double>(0.3, 0.4, 0), Vector3<double>(0, 0.4, -0.3),
              Vector3<double>(2, 0, 1), Vector3<double>(1e-9, 1, 1e-12), Vector3<double>(1, 1e-30, 0),
              Vector3<double>(0.3, -1.1, 0.7), Vector3<double>(1e-200, 1, 1e-250)})
            bodies.push_back({1, diagonal(I), q, w, {}, {}});
    const Worst worst = worst_against("exact", scene, bodies, solve_ensemble(scene, bodies));
    EXPECT_LT(worst.attitude, 1e-12);
    EXPECT_LT(worst.w, 1e-12);
}

TEST(Ensemble, FullTensorsFlightAndWorldRates) {
    Scene scene = free_scene(7);
    scene.body.center_of_mass = {0.1, 0.2, -0.3};
    scene.initial.angular_velocity_frame = Frame::world;
    scene.loads = {Gravity{{0.1, 0, -9.8}, {1, 4}}, Drag{{0, 0, 0}, 0.3, {}},
                   Force{{0.2, 0.1, 0}, Frame::world, {0.1, 0.2, -0.3}, Frame::body, {}},
                   Impulse{{0.1, 0.4, -0.2}, Frame::world, {0.4, 0.1, 0}, Frame::body, 2}};
    auto bodies = free_bodies(few_bodies, 4);
    Draw draw(5);
    for (EnsembleBody& b : bodies) {
        const Matrix3<double> R = rotation_matrix(draw.orientation());
        b.inertia_B = R * b.inertia_B * transposed(R);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < i; ++j) b.inertia_B[i][j] = b.inertia_B[j][i];
        b.mass = draw.uniform(0.5, 2), b.position_W = draw.vector(3), b.velocity_W = draw.vector(3);
    }
    const Worst worst = worst_against("exact", scene, bodies, solve_ensemble(scene, bodies));
    EXPECT_LT(worst.attitude, 1e-11);
    EXPECT_LT(worst.w, 1e-11);
    EXPECT_LT(worst.p, 1e-11);
}

TEST(Ensemble, TopsAgreeWithTheirClosedForm) {
    const Scene scene = top_scene(10);
    const auto bodies = tops(many_bodies, true, 6);
    const Worst worst = worst_against("exact", scene, bodies, solve_ensemble(scene, bodies));
    EXPECT_LT(worst.attitude, 1e-9);
    EXPECT_LT(worst.p, 1e-9);
    EnsembleSettings sharp;
    sharp.tolerance = 1e-14;
    EXPECT_LT(worst_against("exact", scene, bodies, solve_ensemble(scene, bodies, sharp)).attitude, 2e-12);
}

TEST(Ensemble, TopsAboutAnyAxis) {
    // the same top with renamed axes and gravity along another world axis
    const auto upright = tops(few_bodies, true, 7);
    for (const int s : {0, 1}) {
        Scene scene = top_scene(3);
        const int i = (s + 1) % 3, j = (s + 2) % 3;
        scene.body.center_of_mass = {}, scene.body.center_of_mass[s] = 0.5;
        Vector3<double> g;
        g[s] = -10, g[i] = 1;
        scene.loads = {Gravity{g, {}}};
        std::vector<EnsembleBody> bodies = upright;
        for (EnsembleBody& b : bodies) {
            const EnsembleBody from = b;
            const Vector3<double> I(from.inertia_B[0][0], from.inertia_B[1][1], from.inertia_B[2][2]);
            b.inertia_B = {};
            b.inertia_B[i][i] = I[0], b.inertia_B[j][j] = I[1], b.inertia_B[s][s] = I[2];
            for (const auto& [to, at] : {std::pair(i, 0), std::pair(j, 1), std::pair(s, 2)})
                b.angular_velocity[to] = from.angular_velocity[at];
        }
        const Worst worst = worst_against("odeint_fehlberg78", scene, bodies, solve_ensemble(scene, bodies), 1e-13);
        EXPECT_LT(worst.attitude, 1e-9) << "axis " << s;
    }
}

TEST(Ensemble, HeavyBodiesAgreeWithTheTruth) {
    Scene scene = top_scene(2);
    scene.body.center_of_mass = {0.1, -0.05, 0.5};
    const auto bodies = tops(2, false, 8);
    const auto rows = solve_ensemble(scene, bodies);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        ASSERT_EQ(rows[i].status, Status::ok);
        const Reference truth = reference(scene_of(scene, bodies[i]), 1, 17);
        ASSERT_TRUE(truth.available) << truth.message;
        const auto& q = truth.samples.back().q;
        EXPECT_LT(testing::attitude_error(rows[i].end.q, {q.w.high, q.x.high, q.y.high, q.z.high}), 2e-10);
    }
}

TEST(Ensemble, GeneralHeavyBodies) {
    Scene scene = top_scene(10);
    scene.body.center_of_mass = {0.1, -0.05, 0.5};
    const auto bodies = tops(few_bodies, false, 9);
    EnsembleSettings settings;
    settings.tolerance = 1e-11;
    const Worst worst =
        worst_against("odeint_fehlberg78", scene, bodies, solve_ensemble(scene, bodies, settings), 1e-13);
    EXPECT_LT(worst.attitude, 1e-9);
}

// Every load supported by the lanes, with windows and impulses.
Scene scene_of_lane_loads(bool pivoted) {
    Scene scene = free_scene(5);
    scene.body.center_of_mass = {0.1, -0.2, 0.15};
    scene.initial.angular_velocity_frame = Frame::world;
    if (pivoted) scene.pivot = Vector3<double>(0.05, 0.1, -0.1);
    scene.loads = {Gravity{{0.3, -0.4, -1.5}, {}},
                   Torque{{0.1, -0.05, 0.07}, Frame::body, {1, 3}},
                   Torque{{-0.04, 0.05, 0.06}, Frame::world, {}},
                   Force{{0.1, 0.2, -0.3}, Frame::world, {0.3, 0, 0.1}, Frame::body, {}},
                   Impulse{{0.1, -0.1, 0.05}, Frame::world, {0.2, 0.1, 0}, Frame::body, 2.5},
                   Drag{{0.02, 0.03, 0.01}, 0.1, {}},
                   Spring{0.4, {0.8, 0.6, 0, 0}, {0.5, 4}}};
    if (pivoted) scene.loads.push_back(Force{{0.1, -0.1, 0.1}, Frame::body, {0, 0.2, 0.1}, Frame::body, {}});
    return scene;
}

TEST(Ensemble, LoadsInWindows) {
    for (const bool pivoted : {false, true}) {
        const Scene scene = scene_of_lane_loads(pivoted);
        auto bodies = free_bodies(few_bodies, 10);
        Draw draw(11);
        for (EnsembleBody& b : bodies) {
            const Matrix3<double> R = rotation_matrix(draw.orientation());
            b.inertia_B = R * (diagonal(Vector3<double>(0.2, 0.2, 0.2)) + b.inertia_B) * transposed(R);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < i; ++j) b.inertia_B[i][j] = b.inertia_B[j][i];
            b.mass = draw.uniform(0.5, 2);
            if (!pivoted) b.position_W = draw.vector(1), b.velocity_W = draw.vector(1);
        }
        const Worst worst = worst_against("odeint_fehlberg78", scene, bodies, solve_ensemble(scene, bodies), 1e-13);
        EXPECT_LT(worst.attitude, 1e-9) << pivoted;
        EXPECT_LT(worst.w, 1e-8) << pivoted;
        EXPECT_LT(worst.p, 1e-9) << pivoted;
    }
}

// Loads that couple position and attitude, and several springs.
TEST(Ensemble, LoadsThatMoveTheBodyInFlight) {
    Scene scene = scene_of_lane_loads(false);
    scene.loads.push_back(Force{{0.2, -0.1, 0.15}, Frame::world, {0.3, 0.2, -0.4}, Frame::world, {0.5, 4.5}});
    scene.loads.push_back(Force{{0.1, 0.1, -0.2}, Frame::body, {-0.2, 0.1, 0.3}, Frame::world, {}});
    scene.loads.push_back(Force{{0.3, -0.2, 0.1}, Frame::body, {0.1, 0, 0.2}, Frame::body, {2, 3}});
    scene.loads.push_back(Spring{0.3, {0.6, 0, 0.8, 0}, {}});
    scene.loads.push_back(Impulse{{0.1, 0.2, -0.1}, Frame::body, {0.1, 0, 0.2}, Frame::world, 1.5});
    auto bodies = free_bodies(few_bodies, 21);
    Draw draw(22);
    for (EnsembleBody& b : bodies) {
        b.inertia_B = b.inertia_B + diagonal(Vector3<double>(0.2, 0.2, 0.2));
        b.mass = draw.uniform(0.5, 2), b.position_W = draw.vector(1), b.velocity_W = draw.vector(1);
    }
    const auto rows = solve_ensemble(scene, bodies);
    const Worst worst = worst_against("odeint_fehlberg78", scene, bodies, rows, 1e-13);
    EXPECT_LT(worst.attitude, 1e-8);
    EXPECT_LT(worst.w, 1e-8);
    EXPECT_LT(worst.p, 1e-8);
    // solving a body alone gives the same bits
    for (std::size_t i = 0; i < bodies.size(); i += 4) {
        const auto alone = solve_ensemble(scene, std::vector<EnsembleBody>{bodies[i]});
        EXPECT_EQ(alone[0].end.q, rows[i].end.q);
        EXPECT_EQ(alone[0].end.position_W, rows[i].end.position_W);
    }
}

Scene formula_scene(const std::string& start, const std::string& loads) {
    return parse_scene(
        R"({"name": "formulas", "duration": 4, )" + start + R"("parameters": {"k": 0.3}, "loads": [)" + loads + "]}",
        "formulas.json");
}
// formulas that vanish in part of the run, with an impulse, transcendental functions and products of inertia
std::vector<Scene> formula_scenes() {
    const std::string body = R"("body": {"mass": 2, "inertia": [[1, 0.1, 0], [0.1, 2, -0.2], [0, -0.2, 2.5]]}, )";
    return {formula_scene(body, R"json(
                {"type": "torque", "frame": "body", "formula": "-k*w*norm(w) + to_body([0, 0, sin(2*t)])"},
                {"type": "force", "frame": "world", "formula": "-p - 0.1*v", "until": 3},
                {"type": "impulse", "vector": [0.5, 0, 1], "frame": "world", "point": [0, 0.1, 0], "at": 1.5},
                {"type": "drag", "rotational": [0.1, 0, 0], "translational": 0.2})json"),
            formula_scene(
                body, R"json({"type": "torque", "frame": "body", "formula": "-k*[tanh(w.x), w.y*exp(-t), 0]"})json"),
            formula_scene(body + R"("pivot": [0, 0, 0.5], )", R"json(
                {"type": "gravity", "acceleration": [0, 0, -9]},
                {"type": "potential", "formula": "k*to_world([1, 0, 0]).z^2"})json")};
}

TEST(Ensemble, FormulasAgreeWithBodiesOneByOne) {
    for (const Scene& scene : formula_scenes()) {
        std::vector<EnsembleBody> bodies = free_bodies(few_bodies, 31);
        Draw draw(32);
        for (EnsembleBody& b : bodies) {
            b.mass = scene.body.mass, b.inertia_B = scene.body.inertia_B;
            if (!scene.pivot) b.position_W = draw.vector(1), b.velocity_W = draw.vector(1);
        }
        // a body of another mass is solved alone
        bodies[3].mass = 3;
        const auto rows = solve_ensemble(scene, bodies);
        const Worst worst = worst_against("dop853", scene, bodies, rows, 1e-13);
        EXPECT_LT(worst.attitude, 1e-8);
        EXPECT_LT(worst.w, 1e-8);
        EXPECT_LT(worst.p, 1e-8);
        EXPECT_GT(worst.attitude, 0) << "the same computation twice";
    }
}

TEST(Ensemble, EveryLoadOfASceneFile) {
    const Scene scene = testing::everything(1);
    auto bodies = free_bodies(3, 12);
    bodies.push_back(ensemble_body(scene));
    for (EnsembleBody& b : bodies) b.inertia_B = b.inertia_B + diagonal(Vector3<double>(1, 1, 1));
    const Worst worst = worst_against("odeint_fehlberg78", scene, bodies, solve_ensemble(scene, bodies), 1e-13);
    EXPECT_LT(worst.attitude, 1e-9);
}

bool same_bits(const EnsembleRow& a, const EnsembleRow& b) {
    return a.status == b.status && a.message == b.message && a.moved == b.moved && a.end.t == b.end.t &&
           a.end.q == b.end.q && a.end.angular_velocity_B == b.end.angular_velocity_B &&
           a.end.position_W == b.end.position_W && a.end.velocity_W == b.end.velocity_W;
}

// A mixture of free bodies of every kind, and of symmetric and asymmetric tops.
std::vector<std::pair<Scene, std::vector<EnsembleBody>>> mixed() {
    auto free = free_bodies(61, 13);
    for (std::size_t i = 0; i < free.size(); i += 7) free[i].inertia_B = diagonal(Vector3<double>(1, 1, 1.5));
    for (std::size_t i = 3; i < free.size(); i += 11) free[i].angular_velocity = {0, 1, 0};
    free[5] = {1, diagonal(Vector3<double>(3, 4, 6)), {}, {2, 0, 1}, {}, {}};
    auto heavy = tops(14, true, 14);
    for (const EnsembleBody& b : tops(9, false, 15)) heavy.push_back(b);
    heavy[4].angular_velocity = {0, 0, 0};
    auto formula = free_bodies(23, 16);
    for (EnsembleBody& b : formula)
        b.mass = formula_scenes()[0].body.mass, b.inertia_B = formula_scenes()[0].body.inertia_B;
    return {{free_scene(10), free},
            {top_scene(optimised_build ? 10 : 0.5), heavy},
            {scene_of_lane_loads(false), free},
            {formula_scenes()[0], formula}};
}

TEST(Ensemble, SameBitsInAnyOrder) {
    for (const auto& [scene, bodies] : mixed()) {
        const auto rows = solve_ensemble(scene, bodies);
        std::vector<EnsembleBody> reversed(bodies.rbegin(), bodies.rend());
        reversed.erase(reversed.begin() + 2);
        const auto back = solve_ensemble(scene, reversed);
        for (std::size_t i = 0; i < reversed.size(); ++i) {
            const std::size_t other = bodies.size() - 1 - (i < 2 ? i : i + 1);
            EXPECT_TRUE(same_bits(back[i], rows[other])) << scene.name << " row " << other;
        }
    }
}

TEST(Ensemble, SameBitsWithAnyInstructions) {
    for (const auto& [scene, bodies] : mixed()) {
        const auto rows = solve_ensemble(scene, bodies);
        for (const InstructionSet set : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
            if (set > widest_instruction_set()) continue;
            EnsembleSettings settings;
            settings.instructions = set;
            const auto others = solve_ensemble(scene, bodies, settings);
            for (std::size_t i = 0; i < rows.size(); ++i)
                EXPECT_TRUE(same_bits(others[i], rows[i])) << scene.name << " row " << i << " " << name_of(set);
        }
    }
}

TEST(Ensemble, BodiesThatFailStopNoOthers) {
    Scene scene = top_scene(1);
    auto bodies = tops(20, false, 16);
    const auto good = solve_ensemble(scene, bodies);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    auto broken = bodies;
    broken[1].angular_velocity[1] = nan;
    broken[5].inertia_B = diagonal(Vector3<double>(1, 1, 3));
    broken[6].mass = -1;
    broken[9].orientation = {1, 1, 0, 0};
    broken[13].velocity_W = {1, 0, 0};
    broken[17].angular_velocity = {0, 1e5, 2e5};  // needs more steps than the limit
    EnsembleSettings settings;
    settings.max_steps = 1000;
    const auto rows = solve_ensemble(scene, broken, settings);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (broken[i] == bodies[i] || i == 20) {
            EXPECT_TRUE(same_bits(rows[i], good[i])) << i;
            continue;
        }
        EXPECT_EQ(rows[i].status, Status::failed) << i;
        EXPECT_FALSE(rows[i].message.empty()) << i;
        EXPECT_EQ(rows[i].moved, i == 17) << i;
    }
    EXPECT_NE(rows[17].message.find("1000 steps"), std::string::npos);
    EXPECT_GT(rows[17].end.t, 0);
    EXPECT_LT(rows[17].end.t, 1);
}

TEST(Ensemble, AMotionBeyondBinary64Diverges) {
    Scene scene = free_scene(3000);
    scene.loads = {Drag{{-1, -1, -1}, 0, {}}};
    auto bodies = free_bodies(3, 17);
    bodies[1].angular_velocity = {0, 0, 0};
    const auto rows = solve_ensemble(scene, bodies);
    EXPECT_EQ(rows[1].status, Status::ok) << rows[1].message;
    for (const std::size_t i : {0u, 2u}) {
        EXPECT_NE(rows[i].status, Status::ok);
        EXPECT_FALSE(rows[i].message.empty());
    }
}

TEST(Ensemble, EveryToleranceEnds) {
    const Scene scene = top_scene(0.5);
    for (const bool symmetric : {false, true}) {
        const auto bodies = tops(3, symmetric, 18);
        double before = 1;
        for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-18, 1e-300}) {
            EnsembleSettings settings;
            settings.tolerance = tolerance;
            const auto rows = solve_ensemble(scene, bodies, settings);
            for (const EnsembleRow& row : rows) {
                EXPECT_EQ(row.status, tolerance < 1e-15 ? Status::tolerance_not_met : Status::ok) << tolerance;
                EXPECT_EQ(row.message.empty(), row.status == Status::ok);
            }
            const Worst worst = [&] {
                auto judged = rows;
                for (EnsembleRow& row : judged) row.status = Status::ok;
                return worst_against("odeint_fehlberg78", scene, bodies, judged, 1e-14);
            }();
            EXPECT_LT(worst.attitude, std::max(100 * tolerance, 1e-12)) << tolerance;
            EXPECT_LE(worst.attitude, std::max(before, 1e-12)) << tolerance;
            before = worst.attitude;
        }
    }
}

TEST(Ensemble, RefusesSettingsOutOfRange) {
    const Scene scene = free_scene(1);
    const auto bodies = free_bodies(2, 19);
    const auto with = [&](auto change) {
        EnsembleSettings settings;
        change(settings);
        return solve_ensemble(scene, bodies, settings);
    };
    for (const double tolerance :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_THROW(with([&](EnsembleSettings& s) { s.tolerance = tolerance; }), std::invalid_argument) << tolerance;
    EXPECT_THROW(with([](EnsembleSettings& s) { s.threads = 0; }), std::invalid_argument);
    EXPECT_THROW(with([](EnsembleSettings& s) { s.max_steps = 0; }), std::invalid_argument);
    std::vector<EnsembleRow> too_few(1);
    EXPECT_THROW(solve_ensemble(scene, bodies, EnsembleSettings{}, too_few), std::invalid_argument);
    EXPECT_TRUE(solve_ensemble(scene, {}).empty());
    Scene bad = scene;
    bad.duration = -1;
    EXPECT_THROW(solve_ensemble(bad, bodies), InputError);
}

}  // namespace
}  // namespace polhode
