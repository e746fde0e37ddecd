// Formula loads of mechanisms against built-in loads and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "formula/formula_scene.h"
#include "measure/scene_measure.h"
#include "text/message.h"

namespace polhode {
namespace {

// A cart on a rail, an arm that hangs from it with tilted axes, and a free body. `joint`: further members of both
// joints, `members`: of the scene.
std::string mechanism_text(const std::string& members, const std::string& slide = "", const std::string& hinge = "") {
    return R"json({"name": "mechanism", "duration": 0.75,
      "bodies": [{"name": "cart", "body": {"mass": 2, "inertia": [0.3, 0.4, 0.5], "center_of_mass": [0.1, 0, 0.2]}},
                 {"name": "left arm", "body": {"mass": 1, "inertia": [0.1, 0.15, 0.2], "center_of_mass": [0.1, 0.05, -0.5]}},
                 {"name": "kite", "body": {"mass": 0.5, "inertia": [0.2, 0.3, 0.35], "center_of_mass": [0, 0.1, 0]},
                  "initial": {"position": [0.5, 1, 2], "velocity": [0.25, -0.5, 1], "angular_velocity": [1, 2, -0.5],
                              "orientation": [0.8, 0.36, -0.48, 0]}}],
      "joints": [{"name": "slide", "type": "prismatic", "parent": "world", "child": "cart", "axis": [1, 0, 0],
                  "initial": {"displacement": 0.3, "speed": -0.4})json" +
           slide + R"json(},
                 {"name": "hinge", "type": "revolute", "parent": "cart", "child": "left arm",
                  "parent_orientation": [0.8, 0, 0.6, 0], "parent_point": [0, 0.1, -0.1], "child_point": [0, 0, 0.25],
                  "axis": [0, 0.6, 0.8], "initial": {"angle": 0.5, "rate": 1.5})json" +
           hinge + "}], " + members + "}";
}
Scene mechanism_scene(const std::string& members, const std::string& slide = "", const std::string& hinge = "") {
    return parse_scene(mechanism_text(members, slide, hinge), "mechanism.json", "");
}

struct MechanismPair {
    const char *name = "", *built_in = "", *formula = "", *slide = "", *hinge = "";
};
// The same loads, built in and as formulas.
const MechanismPair mechanism_pairs[] = {
    {"gravity", R"json([{"type": "gravity", "acceleration": [0, 0.5, -9.75]}])json",
     R"json([{"type": "force", "body": "cart", "frame": "world", "formula": "mass*[0, k, -9.75]"},
             {"type": "force", "body": "left arm", "frame": "world", "formula": "\"left arm\".mass*[0, k, -9.75]"},
             {"type": "force", "body": "kite", "frame": "world", "formula": "[0, k, -9.75]*kite.mass"}])json"},
    {"torques",
     R"json([{"type": "torque", "body": "left arm", "frame": "body", "vector": [0.1, 0.2, -0.3], "from": 0.25, "until": 0.5},
             {"type": "torque", "body": "kite", "frame": "world", "vector": [0.1, 0.2, -0.3]}])json",
     R"json([{"type": "torque", "body": "left arm", "frame": "body", "formula": "[0.1, 0.2, -0.3]", "from": 0.25, "until": 0.5},
             {"type": "torque", "body": "kite", "frame": "world", "formula": "[0.1, 0.2, -0.3]"}])json"},
    {"forces",
     R"json([{"type": "force", "body": "left arm", "frame": "world", "vector": [1, 0.5, -2], "point": [0.5, 0.25, 0]},
             {"type": "force", "body": "kite", "frame": "body", "vector": [0.1, 0.2, -0.3], "point": [0.5, 0.25, 0]},
             {"type": "force", "body": "left arm", "frame": "body", "vector": [0.1, 0.2, -3], "point": [0.5, 0.25, 0],
              "point_frame": "world"}])json",
     R"json([{"type": "force", "body": "left arm", "frame": "world", "formula": "[1, k, -2]", "point": [0.5, 0.25, 0]},
             {"type": "force", "body": "kite", "frame": "body", "formula": "[0.1, 0.2, -0.3]", "point": [0.5, 0.25, 0]},
             {"type": "force", "body": "left arm", "frame": "body", "formula": "[0.1, 0.2, -3]", "point": [0.5, 0.25, 0],
              "point_frame": "world"}])json"},
    {"drag",
     R"json([{"type": "drag", "body": "left arm", "rotational": [0.5, 0.25, 0.75], "translational": 0.5},
             {"type": "drag", "body": "kite", "rotational": [0.5, 0.5, 0.5], "translational": 0.5}])json",
     R"json([{"type": "torque", "body": "left arm", "frame": "body", "formula": "[-k*w.x, -0.25*w.y, -0.75*w.z]"},
             {"type": "force", "body": "left arm", "frame": "world",
              "formula": "-k*velocity_at(\"left arm\", [0.1, 0.05, -0.5])"},
             {"type": "torque", "body": "kite", "frame": "world", "formula": "-k*kite.w_W"},
             {"type": "force", "body": "kite", "frame": "body", "formula": "-k*to_body(v)"}])json"},
    {"spring between points",
     R"json([{"type": "point_spring", "first": "left arm", "first_point": [0, 0.1, -1], "second": "kite",
              "second_point": [0.25, 0, 0], "stiffness": 4, "rest_length": 0.5}])json",
     R"json([{"type": "force", "body": "left arm", "frame": "world", "point": [0, 0.1, -1], "formula": "pull"},
             {"type": "force", "body": "kite", "frame": "world", "point": [0.25, 0, 0], "formula": "-pull"}],
       "let": {"d": "at(kite, [0.25, 0, 0]) - at(\"left arm\", [0, 0.1, -1])", "pull": "4*(norm(d) - k)*unit(d)"})json"},
    {"potentials",
     R"json([{"type": "gravity", "acceleration": [0, 0.5, -9.75]},
             {"type": "point_spring", "first": "left arm", "first_point": [0, 0.1, -1], "second": "kite",
              "second_point": [0.25, 0, 0], "stiffness": 4, "rest_length": 0.5, "from": 0.25}])json",
     R"json([{"type": "potential", "formula": "-dot([0, k, -9.75], cart.mass*cart.p + \"left arm\".mass*\"left arm\".p)"},
             {"type": "potential", "body": "kite", "formula": "-mass*dot([0, k, -9.75], p)"},
             {"type": "potential", "formula": "2*(norm(d) - k)^2", "from": 0.25}],
       "let": {"d": "at(kite, [0.25, 0, 0]) - at(\"left arm\", [0, 0.1, -1])"})json"},
    {"motors",
     R"json([{"type": "motor", "joint": "slide", "force": 2}, {"type": "motor", "joint": "hinge", "torque": -1, "until": 0.5}])json",
     R"json([{"type": "motor", "joint": "slide", "formula": "4*k"}, {"type": "motor", "joint": "hinge", "formula": "-1", "until": 0.5}])json"},
    {"springs and dampers of joints", R"json([])json",
     R"json([{"type": "motor", "joint": "slide", "formula": "-3*(slide.displacement - k) - 0.25*slide.speed"},
             {"type": "motor", "joint": "hinge", "formula": "-k*(hinge.angle - 0.125) - 0.75*hinge.rate"}])json",
     R"json(, "stiffness": 3, "rest": 0.5, "damping": 0.25)json",
     R"json(, "stiffness": 0.5, "rest": 0.125, "damping": 0.75)json"},
};

Scene built_in_scene(const MechanismPair& pair) {
    return mechanism_scene(std::string("\"loads\": ") + pair.built_in, pair.slide, pair.hinge);
}
Scene formula_scene_of(const MechanismPair& pair) {
    return mechanism_scene(std::string(R"json("parameters": {"k": 0.5}, "loads": )json") + pair.formula);
}

TEST(FormulaMechanism, HasTheReferenceOfTheBuiltInLoads) {
    for (const MechanismPair& pair : mechanism_pairs) {
        const Reference built_in = reference(built_in_scene(pair), 2, 30);
        const Reference formula = reference(formula_scene_of(pair), 2, 30);
        ASSERT_TRUE(built_in.available) << pair.name << ": " << built_in.message;
        ASSERT_TRUE(formula.available) << pair.name << ": " << formula.message;
        EXPECT_LT(test::difference(built_in, formula), 1e-28) << pair.name;
        EXPECT_LT(formula.bound, 1e-30) << pair.name;
    }
}

// Potentials count as energy: the same energy as that of the built-in loads, and a constant one.
TEST(FormulaMechanism, CountsPotentialsAsEnergy) {
    const auto pair = std::ranges::find_if(
        mechanism_pairs, [](const MechanismPair& one) { return std::string_view(one.name) == "potentials"; });
    const Scene built_in = built_in_scene(*pair), formula = formula_scene_of(*pair);
    const SceneMeasure<Wide> of_built_in(built_in), of_formula(formula);
    const Reference truth = reference(formula, 4, 30);
    ASSERT_TRUE(truth.available) << truth.message;
    const std::size_t bodies = formula.bodies.size();
    double first = 0;
    for (std::size_t k = 0; k < truth.samples.size() / bodies; ++k) {
        std::vector<BodyMotion<Wide>> motions;
        for (std::size_t b = 0; b < bodies; ++b) motions.push_back(true_motion<Wide>(truth.samples[k * bodies + b]));
        JointCoordinates coordinates(formula), others(built_in);
        const double t = truth.samples[k * bodies].t;
        const Wide energy = of_formula.invariants(t, motions, coordinates).energy;
        EXPECT_NEAR(static_cast<double>(energy - of_built_in.invariants(t, motions, others).energy), 0, 1e-28) << t;
        // the spring acts from 0.25 s on
        if (k == 2) first = static_cast<double>(energy);
        if (k > 2) {
            EXPECT_NEAR(static_cast<double>(energy) / first, 1, 1e-15) << t;
        }
    }
}

// The largest difference of attitudes, rates, positions and velocities.
double difference_of(const Trajectory& a, const Trajectory& b) {
    double worst = a.samples.size() == b.samples.size() ? 0 : HUGE_VAL;
    for (std::size_t i = 0; i < std::min(a.samples.size(), b.samples.size()); ++i) {
        const Sample &x = a.samples[i], &y = b.samples[i];
        const Quaternion<double> between = conjugate(x.q) * y.q;
        const Vector3<double> w = x.angular_velocity_B - y.angular_velocity_B, p = x.position_W - y.position_W,
                              v = x.velocity_W - y.velocity_W;
        worst = std::max({worst, 2 * std::sqrt(dot(vector_part(between), vector_part(between))), std::sqrt(dot(w, w)),
                          std::sqrt(dot(p, p)), std::sqrt(dot(v, v))});
    }
    return worst;
}

TEST(FormulaMechanism, IsSolvedByMethodsLikeTheBuiltInLoads) {
    for (const MechanismPair& pair : mechanism_pairs)
        for (const char* method : {"taylor", "extrapolation", "dop853", "radau", "cvode_bdf"}) {
            const double tolerance = method == std::string("cvode_bdf") ? 1e-10 : 1e-14;
            const Trajectory built_in = test::solve_with(built_in_scene(pair), method, tolerance, 3);
            const Trajectory formula = test::solve_with(formula_scene_of(pair), method, tolerance, 3);
            ASSERT_EQ(formula.status, Status::ok) << pair.name << " " << method << ": " << formula.message;
            EXPECT_LT(difference_of(built_in, formula), method == std::string("cvode_bdf") ? 1e-6 : 1e-12)
                << pair.name << " " << method;
        }
}

const char* const smooth_laws = R"json("parameters": {"k": 0.5}, "loads": [
    {"type": "gravity", "acceleration": [0, 0, -9.75]},
    {"type": "motor", "joint": "hinge", "formula": "-k*tanh(hinge.rate) + sin(3*t)*exp(-t)"},
    {"type": "motor", "joint": "slide", "formula": "-2*slide.displacement*cosh(slide.speed) + atan2(kite.p.x, 2)"},
    {"type": "force", "body": "left arm", "frame": "world", "point": [0, 0, -1],
     "formula": "-k*norm(velocity_at(\"left arm\", [0, 0, -1]))*velocity_at(\"left arm\", [0, 0, -1])"},
    {"type": "torque", "body": "kite", "frame": "body", "formula": "cross(to_body([0, 0, 1]), inertia(w))*log(2 + kite.w.x^2)"}])json";

TEST(FormulaMechanism, IsSolvedByEveryMethodOrRefused) {
    const Scene scene = mechanism_scene(smooth_laws);
    const Problem problem = pose(scene);
    const Reference truth = reference(scene, 6, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    Trajectory exact;
    for (const ReferenceSample& sample : truth.samples) exact.samples.push_back(sample.rounded());
    int solved = 0;
    for (const Method* method : methods()) {
        if (method->family == Family::engine) continue;
        Settings settings;
        settings.samples = 6;
        if (takes_tolerance(*method))
            settings.tolerance = 1e-9;
        else if (takes_step(*method))
            settings.step = 2e-3;
        const Trajectory trajectory = solve(problem, *method, settings);
        if (trajectory.status == Status::unsupported) {
            EXPECT_NE(trajectory.message, "") << method->name;
            continue;
        }
        EXPECT_EQ(trajectory.status, Status::ok) << method->name << ": " << trajectory.message;
        if (trajectory.status == Status::ok) {
            EXPECT_LT(difference_of(trajectory, exact), 5e-2) << method->name;
        }
        ++solved;
    }
    EXPECT_GT(solved, 20);
    EXPECT_LT(difference_of(test::solve_with(scene, "taylor", 1e-15, 6), exact), 1e-12);
    EXPECT_LT(difference_of(test::solve_with(scene, "extrapolation", 1e-13, 6), exact), 1e-10);
    EXPECT_LT(difference_of(test::solve_with(scene, "dop853", 1e-13, 6), exact), 1e-10);
    EXPECT_LT(difference_of(test::solve_with(scene, "radau", 1e-12, 6), exact), 1e-9);
}

// A flywheel with I = 0.5 kg m^2 about its axis.
Scene flywheel(const std::string& law, double angle, double rate, double duration) {
    return parse_scene(R"json({"name": "flywheel", "duration": )json" + std::to_string(duration) +
                           R"json(, "bodies": [{"name": "wheel", "body": {"mass": 1, "inertia": [0.3, 0.3, 0.5]}}],
        "joints": [{"name": "axle", "type": "revolute", "parent": "world", "child": "wheel", "axis": [0, 0, 1],
                    "initial": {"angle": )json" +
                           std::to_string(angle) + ", \"rate\": " + std::to_string(rate) + R"json(}}],
        "loads": [{"type": "motor", "joint": "axle", "formula": ")json" +
                           law + "\"}]}",
                       "flywheel.json", "");
}
// The angle about z of an attitude, from the half-angle.
double angle_of(const Quaternion<double>& q) { return 2 * std::atan2(q.z, q.w); }

// I x'' = -k (x - 1) - c x' from rest at x = 0: x = 1 - e^(-a t) (cos b t + a/b sin b t), a = c/2I, b^2 = k/I - a^2
TEST(FormulaMechanism, FollowsTheClosedFormOfALinearController) {
    const double I = 0.5, k = 8, c = 2, a = c / (2 * I), b = std::sqrt(k / I - a * a);
    const Scene scene = flywheel("8*(1 - axle.angle) - 2*axle.rate", 0, 0, 3);
    const Reference truth = reference(scene, 12, 25);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = test::solve_with(scene, "taylor", 1e-15, 12);
    const Trajectory radau = test::solve_with(scene, "radau", 1e-13, 12);
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const double t = truth.samples[i].t;
        const double x = 1 - std::exp(-a * t) * (std::cos(b * t) + a / b * std::sin(b * t));
        const double rate = std::exp(-a * t) * (a * a + b * b) / b * std::sin(b * t);
        EXPECT_NEAR(angle_of(truth.samples[i].rounded().q), x, 1e-15);
        EXPECT_NEAR(truth.samples[i].angular_velocity_B[2].high, rate, 1e-15);
        EXPECT_NEAR(angle_of(taylor.samples[i].q), x, 1e-14);
        EXPECT_NEAR(angle_of(radau.samples[i].q), x, 1e-12);
    }
}

// 0.5 w' = clamp(-10 w, -1, 1): w = 2 - 2 t until w = 0.1, then exponential with rate 20
TEST(FormulaMechanism, LocatesSwitchesOfAMotor) {
    const Scene scene = flywheel("clamp(-10*axle.rate, -1, 1)", 0, 2, 2);
    const Reference truth = reference(scene, 8, 22);
    ASSERT_TRUE(truth.available) << truth.message;
    const Trajectory taylor = test::solve_with(scene, "taylor", 1e-14, 8);
    ASSERT_EQ(taylor.status, Status::ok) << taylor.message;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const double t = truth.samples[i].t, expected = t < 0.95 ? 2 - 2 * t : 0.1 * std::exp(-20 * (t - 0.95));
        EXPECT_NEAR(truth.samples[i].angular_velocity_B[2].high, expected, 1e-15);
        EXPECT_NEAR(taylor.samples[i].angular_velocity_B[2], expected, 1e-14);
    }
}

// The kinetic energy changes by the work of the loads: motors -U'(x) of both joints and a force -grad V of the kite.
TEST(FormulaMechanism, ChangesTheEnergyByTheWorkOfItsLoads) {
    const Scene scene = mechanism_scene(R"json("loads": [
        {"type": "motor", "joint": "hinge", "formula": "-sin(hinge.angle)"},
        {"type": "motor", "joint": "slide", "formula": "-4*slide.displacement^3"},
        {"type": "force", "body": "kite", "frame": "world", "formula": "-2*at(kite, [0, 0, 1])", "point": [0, 0, 1]}])json");
    const Reference truth = reference(scene, 6, 28);
    ASSERT_TRUE(truth.available) << truth.message;
    const auto total = [&](std::size_t i) {
        const Sample cart = truth.samples[3 * i].rounded(), arm = truth.samples[3 * i + 1].rounded(),
                     kite = truth.samples[3 * i + 2].rounded();
        // the cart's centre of mass is 0.1 m ahead of its origin
        const double x = cart.position_W[0] - 0.1;
        const Quaternion<double> turn = conjugate(Quaternion<double>{0.8, 0, 0.6, 0}) * conjugate(cart.q) * arm.q;
        const double angle = 2 * std::atan2(dot(vector_part(turn), Vector3<double>(0, 0.6, 0.8)), turn.w);
        const Vector3<double> tip = kite.position_W + rotate(kite.q, Vector3<double>(0, -0.1, 1));
        return truth.system[i].kinetic.high - std::cos(angle) + x * x * x * x + dot(tip, tip);
    };
    for (std::size_t i = 1; i <= 6; ++i) EXPECT_NEAR(total(i), total(0), 1e-13 * std::abs(total(0))) << i;
}

// A four-bar linkage with a damper of the catalogue's size, as a joint's damping and as a motor.
TEST(FormulaMechanism, ClosesLoops) {
    Scene built_in = find_scene("mechanisms/four_bar"), formula = built_in;
    built_in.duration = formula.duration = 0.5;
    built_in.joints[0].damping[0] = 0.75;
    FormulaLoad damper;
    damper.kind = FormulaKind::motor, damper.joint = "main_bearing", damper.formula = "-0.75*main_bearing.rate";
    formula.loads.push_back(damper);
    const Reference expected = reference(built_in, 2, 22), truth = reference(formula, 2, 22);
    ASSERT_TRUE(expected.available && truth.available) << truth.message;
    EXPECT_LT(test::difference(expected, truth), 1e-21);
    EXPECT_LT(
        difference_of(test::solve_with(built_in, "taylor", 1e-14, 2), test::solve_with(formula, "taylor", 1e-14, 2)),
        1e-11);
}

std::string mechanism_fault(const std::string& members) {
    try {
        mechanism_scene(members);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(FormulaMechanism, ReportsFaults) {
    const struct {
        const char *members, *message;
    } cases[] = {
        {R"json("loads": [{"type": "motor", "joint": "hinge", "formula": "-hinge.rte"}])json",
         "/loads/0/formula: column 8: \"hinge\" has no quantity \"rte\"; give one of angle, rate"},
        {R"json("loads": [{"type": "motor", "joint": "slide", "formula": "slide.angle"}])json",
         "\"slide\" has no quantity \"angle\"; give one of displacement, speed"},
        {R"json("loads": [{"type": "motor", "joint": "elbow", "formula": "1"}])json", "/loads/0/joint: "},
        {R"json("loads": [{"type": "motor", "joint": "hinge", "formula": "[1, 2, 3]"}])json",
         "the formula is a vector, but a motor's force is a scalar"},
        {R"json("loads": [{"type": "motor", "joint": "hinge", "formula": "w.x"}])json", "unknown name \"w\""},
        {R"json("loads": [{"type": "motor", "joint": "hinge", "formula": "norm(at(kites, [0, 0, 0])) + kite.p.x"}])json",
         "column 9: unknown body \"kites\"; did you mean kite?"},
        {R"json("loads": [{"type": "motor", "joint": "hinge", "formula": "at(kite).x"}])json", "write at(body, point)"},
        {R"json("loads": [{"type": "torque", "frame": "body", "formula": "[0, 0, 1]"}])json",
         "/loads/0: does not name a body"},
        {R"json("loads": [{"type": "torque", "body": "bird", "frame": "body", "formula": "[0, 0, 1]"}])json",
         "/loads/0/body: "},
        {R"json("loads": [{"type": "potential", "formula": "dot(kite.p, kite.v)"}])json",
         "column 1: the potential depends on a velocity or a held value"},
        {R"json("loads": [{"type": "potential", "formula": "hinge.angle^2 + kite.p.z"}])json",
         "column 1: the potential depends on the coordinate of a joint; give a motor"},
        {R"json("loads": [{"type": "potential", "formula": "sin(t)"}])json",
         "column 1: the potential does not depend on the position or attitude of a body"},
        {R"json("loads": [{"type": "potential", "body": "bird", "formula": "p.z"}])json", "/loads/0/body: "},
        {R"json("let": {"d": "to_body([0, 0, 1])"}, "loads": [])json", "\"to_body\" is not available here"},
    };
    for (const auto& one : cases)
        EXPECT_NE(mechanism_fault(one.members).find(one.message), std::string::npos) << one.members << "\n"
                                                                                     << mechanism_fault(one.members);
}

}  // namespace
}  // namespace polhode
