// Proofs for right-hand sides with quotients, roots and sines, and for trees of joints: bounds against the bounded
// quantity, and motions against the truth that two formulations agree on.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "build_kind.h"
#include "catalogue.h"
#include "integrators/series/real.h"
#include "integrators/truth/balls/certified.h"
#include "integrators/truth/balls/flow.h"
#include "integrators/truth/balls/openness_of_loops.h"
#include "integrators/truth/balls/taylor.h"
#include "integrators/truth/balls/transition.h"
#include "integrators/truth/fresh_cache.h"
#include "integrators/truth/jointed_start.h"
#include "integrators/truth/reference.h"
#include "integrators/truth/tree_form.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"

namespace polhode::truth {
namespace {

// one of each operation, and the sine of a sum
struct Mixed {
    template <class S>
    void derivative(const S* y, S* dy) const {
        S s, c, s2, c2;
        sine_cosine(y[0], s, c);
        sine_cosine(S(y[0] + S(0.5) * y[1]), s2, c2);
        dy[0] = s2 / (S(2) + c) + y[1];
        dy[1] = square_root(S(S(3) + y[0] * y[0])) * c2 - S(1) / (S(1.5) + y[1] * y[1]);
    }
};

// the polynomial with the midpoints of the coefficients, and its derivative
void polynomial(const Series<Ball>& series, const Ball& t, Ball* p, Ball* slope) {
    for (int i = 0; i < series.dimension(); ++i) {
        p[i] = Ball(0), slope[i] = Ball(0);
        for (int k = series.order(); k >= 0; --k) {
            slope[i] = slope[i] * t + p[i];
            p[i] = p[i] * t + series.coefficient(i, k).midpoint();
        }
    }
}

TEST(DefectOfEveryOperation, HoldsWhatIsMissed) {
    const WorkingPrecision precision(300);
    for (const int order : {8, 13, 30}) {
        Series<Ball> series(record<Ball>(Mixed{}, 2), order);
        for (const double at : {0.25, -1.0, 2.5}) {
            const Ball start[2] = {Ball(at), Ball(1 - at / 2)};
            series.expand(start);
            const double h = 0.0625;
            const Defect bounds = defect(series.recording(), term_bounds(series, Bound(h)));
            double largest = 0;
            for (const double t : {h / 3, h / 2, h}) {
                Ball p[2], slope[2], rate[2];
                polynomial(series, Ball(t), p, slope);
                Mixed{}.derivative(p, rate);
                for (int i = 0; i < 2; ++i) {
                    const double missed = Bound(slope[i] - rate[i]).near();
                    EXPECT_LE(missed, bounds.rate[i].near()) << order << ' ' << at << ' ' << t;
                    largest = std::max(largest, missed / bounds.rate[i].near());
                }
            }
            // the bounds are not larger by orders of magnitude, or they would be useless
            EXPECT_GT(largest, 1e-3) << order << ' ' << at;
        }
    }
}

// a divisor that is zero at y_0 = 0.1
struct Pole {
    template <class S>
    void derivative(const S* y, S* dy) const {
        dy[0] = S(1);
        dy[1] = S(1) / (y[0] * y[0] - S(0.01));
    }
};

TEST(DefectOfEveryOperation, HasNoBoundWhereADivisorMayVanish) {
    const WorkingPrecision precision(128);
    Series<Ball> series(record<Ball>(Pole{}, 2), 12);
    const Ball start[2] = {Ball(0), Ball(0)};
    series.expand(start);
    const auto rate_within = [&](double h) {
        return defect(series.recording(), term_bounds(series, Bound(h))).rate[1];
    };
    EXPECT_TRUE(rate_within(0.05).is_finite());
    EXPECT_FALSE(rate_within(0.11).is_finite());
}

TEST(ChangeOfRates, HoldsThatOfEveryOperation) {
    const WorkingPrecision precision(200);
    Series<Ball> series(record<Ball>(Mixed{}, 2), 16);
    const Ball start[2] = {Ball(0.25), Ball(1)};
    series.expand(start);
    const double h = 0.0625;
    const Defect along = defect(series.recording(), term_bounds(series, Bound(h)));
    for (const double e : {1e-9, 1e-3, 0.1}) {
        const std::vector<Bound> bounds = change_of_rates(series.recording(), along, {Bound(e), Bound(2 * e)});
        double largest = 0;
        for (const double t : {0.0, h / 2, h})
            for (const double sign : {-1.0, 1.0}) {
                Ball p[2], slope[2], here[2], there[2];
                polynomial(series, Ball(t), p, slope);
                Mixed{}.derivative(p, here);
                p[0] += Ball(e), p[1] += Ball(sign * 2 * e);
                Mixed{}.derivative(p, there);
                for (int i = 0; i < 2; ++i) {
                    const double change = Bound(there[i] - here[i]).near();
                    EXPECT_LE(change, bounds[i].near()) << e << ' ' << t;
                    largest = std::max(largest, change / bounds[i].near());
                }
            }
        EXPECT_GT(largest, 0.01) << e;
    }
}

TEST(JacobianOfEveryOperation, IsTheLimitOfDifferences) {
    const WorkingPrecision precision(300);
    const Recording<Ball> recording = record<Ball>(Mixed{}, 2);
    const Ball y[2] = {Ball(0.75), Ball(-0.5)}, small(0x1p-100);
    const std::vector<Ball> J = jacobian_of(recording, y);
    Ball here[2];
    Mixed{}.derivative(y, here);
    for (int j = 0; j < 2; ++j) {
        Ball moved[2] = {y[0], y[1]}, there[2];
        moved[j] += small;
        Mixed{}.derivative(moved, there);
        for (int i = 0; i < 2; ++i)
            EXPECT_LT(Bound((there[i] - here[i]) / small - J[i * 2 + j]).near(), 1e-28) << i << ' ' << j;
    }
}

// y + 2^-60 e_j moves as W(h) 2^-60 e_j predicts, to second order in 2^-60.
TEST(TransitionOfTree, HoldsWhatNeighbouringMotionsDo) {
    const WorkingPrecision precision(300);
    const Scene scene = random_tree(7, 3, false);
    TreeForm<Ball> form(scene);
    const int n = form.dimension();
    std::vector<Ball> point(n);
    form.initial(point.data());
    form.enter(0, point.data());
    for (Ball& y : point) y = y.midpoint();
    PiecePlan plan;
    plan.dimension = n, plan.weights.assign(n * n, 0), plan.scales.assign(n, 1);
    for (int i = 0; i < n; ++i) plan.weights[i * n + i] = 1;
    const WeightedNorm norm(plan);
    const Recording<Ball> equations = record<Ball>(form, n);
    Transition transition(equations, 40);
    const Ball h(0x1p-6);
    const Bound growth(16.0), near = norm.length(std::vector<Bound>(n, Bound(0x1p-58)));
    transition.expand(point, Bound(h), growth * near, growth, Bound(0x1p40), norm);
    const std::vector<Ball> W = transition.at(h);
    Series<Ball> series(equations, 50);
    const auto flowed = [&](const std::vector<Ball>& from) {
        std::vector<Ball> end(n);
        series.expand(from.data());
        series.evaluate(h, end.data());
        return end;
    };
    const std::vector<Ball> end = flowed(point);
    bool turned = false;
    for (int j = 0; j < n; ++j) {
        const Ball small(0x1p-60);
        std::vector<Ball> moved(point);
        moved[j] += small;
        const std::vector<Ball> there = flowed(moved);
        for (int i = 0; i < n; ++i) {
            const Ball slope = (there[i] - end[i]) / small;
            EXPECT_TRUE((slope - W[i * n + j]).contains_zero()) << i << ' ' << j;
            EXPECT_LT(Bound::radius_of(W[i * n + j]).near(), 1e-6) << i << ' ' << j;
            turned = turned || (i != j && std::abs(W[i * n + j].near()) > 1e-3);
        }
    }
    EXPECT_TRUE(turned) << "nothing happened";
}

using R = Real<50>;

// the number of proven values farther than their radius from the truth of the two formulations to `digits` digits
int outside(const Scene& scene, const CertifiedReference& certified, int digits = 40) {
    const DecimalReference truth = decimal_reference(scene, static_cast<long>(certified.times.size()) - 1, digits);
    EXPECT_TRUE(truth.available) << truth.message;
    EXPECT_EQ(truth.bodies, certified.bodies);
    EXPECT_EQ(truth.columns.size(), certified.columns.size());
    if (truth.columns.size() != certified.columns.size()) return -1;
    R size(1);
    for (const DecimalColumns& columns : truth.columns)
        for (const std::string& value : columns) size = std::max(size, R(abs(R(value))));
    const R margin = R(fmt::format("1e-{}", digits)) * size;
    int count = 0;
    for (std::size_t i = 0; i < truth.columns.size(); ++i)
        for (int c = 0; c < 13; ++c) {
            const CertifiedNumber& number = certified.columns[i][c];
            if (abs(R(R(truth.columns[i][c]) - R(number.value))) > R(number.radius) + margin) ++count;
        }
    return count;
}

// Every type of joint, with loads that start and end, a force at a world point and an impulse.
TEST(CertifiedTree, EnclosesTheAgreementOfTwoFormulations) {
    const FreshCache cache;
    const int count = optimised_build ? 5 : 1;
    for (int i = 0; i < count; ++i) {
        const unsigned seed = 300 + static_cast<unsigned>(i);
        Scene scene = random_tree(seed, 2 + i % 2, i % 2 == 1);
        Dice dice(seed);
        scene.loads.push_back(Gravity{{0, 0, -9.75}, {}});
        scene.loads.push_back(Force{dice.vector(), Frame::world, dice.vector(), Frame::world, {0.03, 0.09}, "b1"});
        scene.loads.push_back(Impulse{dice.vector(), Frame::body, dice.vector(), Frame::body, 0.0625, "b1"});
        const CertifiedReference certified = certified_reference(scene, 3, 30);
        ASSERT_TRUE(certified.available) << seed << ' ' << certified.message;
        EXPECT_GE(certified.digits, 30);
        EXPECT_EQ(certified.bodies, static_cast<int>(scene.bodies.size()));
        EXPECT_EQ(outside(scene, certified), 0) << seed;
    }
}

TEST(CertifiedTree, EnclosesScenesOfTheCatalogue) {
    const FreshCache cache;
    for (const auto& [name, duration] :
         {std::pair("mechanisms/double_pendulum", 2.0), std::pair("mechanisms/gimbal_gyroscope", 0.125),
          std::pair("mechanisms/masses_on_spring", 0.0625), std::pair("mechanisms/furuta_pendulum", 0.5)}) {
        Scene scene = find_scene(name);
        scene.duration = duration;
        const CertifiedReference certified = certified_reference(scene, 2, 25);
        ASSERT_TRUE(certified.available) << name << ' ' << certified.message;
        EXPECT_EQ(outside(scene, certified), 0) << name;
    }
}

// A body on a spherical joint equals a body with a pivot, whose proof uses other equations.
TEST(CertifiedTree, OfOneBodyIsThatBodys) {
    Scene joint = find_scene("mechanisms/top_on_spherical_joint"), pivot = find_scene("lagrange_top");
    joint.duration = pivot.duration = 1;
    const CertifiedReference a = certified_reference(joint, 2, 30), b = certified_reference(pivot, 2, 30);
    ASSERT_TRUE(a.available) << a.message;
    ASSERT_TRUE(b.available) << b.message;
    ASSERT_EQ(a.columns.size(), b.columns.size());
    for (std::size_t i = 0; i < a.columns.size(); ++i)
        for (int c = 0; c < 13; ++c) {
            const CertifiedNumber &x = a.columns[i][c], &y = b.columns[i][c];
            // the joint and the pivot are both at the origin
            EXPECT_LE(abs(R(R(x.value) - R(y.value))), R(x.radius) + R(y.radius)) << i << ' ' << c;
        }
}

TEST(CertifiedTree, ReportsWhatItCannotProve) {
    const FreshCache cache;
    Scene four_bar = find_scene("mechanisms/four_bar");
    four_bar.duration = 0.1;
    const CertifiedReference loops = certified_reference(four_bar, 2, 20);
    EXPECT_FALSE(loops.available);
    EXPECT_NE(loops.message.find("loops are not supported"), std::string::npos) << loops.message;
    EXPECT_NE(loops.message.find("remove --certified"), std::string::npos) << loops.message;
    const CertifiedReference many = certified_reference(random_tree(5, 6, false), 2, 600);
    EXPECT_FALSE(many.available);
    EXPECT_NE(many.message.find("memory"), std::string::npos) << many.message;
}

// Formulas of every function, read from time and state, on one body and on joints; held values.
Scene formula_body() {
    return parse_scene(R"json({"name": "formulas of one body", "duration": 0.75,
        "body": {"mass": 1.5, "inertia": [1, 2, 2.5]},
        "initial": {"angular_velocity": [0.3, -0.2, 0.5], "position": [1, 0.5, 0.25], "velocity": [0.1, -0.3, 0.2]},
        "parameters": {"a": 0.7}, "let": {"u": "exp(-a*t)", "s": "log(2 + p.x^2)"},
        "loads": [
          {"type": "torque", "frame": "body", "formula": "[u*w.y, atan2(p.y, 2 + p.x), tanh(w.z)]"},
          {"type": "torque", "frame": "body", "formula": "[sinh(0.25*w.x), cbrt(3 + w.y), 0]", "from": 0.25},
          {"type": "force", "frame": "world", "formula": "[asin(0.25*u), acos(0.5*u), (2 + s)^1.5]"},
          {"type": "potential", "formula": "0.5*dot(p, p) + 0.125*norm(v - v + p)^3"},
          {"type": "torque", "frame": "body", "formula": "-0.5*w", "hold": 0.25}]})json",
                       "formulas");
}
Scene formula_tree() {
    Scene scene = find_scene("mechanisms/double_pendulum");
    scene.duration = 0.5;
    const auto motor = [](const std::string& joint, const std::string& formula) {
        FormulaLoad load;
        load.kind = FormulaKind::motor, load.joint = joint, load.formula = formula;
        return load;
    };
    scene.loads.push_back(motor(scene.joints[0].name, "-2*\"" + scene.joints[0].name + "\".angle + exp(-t)"));
    scene.loads.push_back(motor(scene.joints[1].name, "tanh(sin(3*t)) - 0.1*\"" + scene.joints[1].name + "\".rate"));
    return scene;
}

TEST(CertifiedFormulas, EncloseTheAgreementOfTwoFormulations) {
    const FreshCache cache;
    std::vector<Scene> scenes{formula_body(), formula_tree()};
    if (optimised_build)
        for (const char* name : {"formulas/kepler_orbit", "formulas/quadratic_drag", "formulas/flywheel_servo"})
            scenes.push_back(find_scene(name));
    for (const Scene& scene : scenes) {
        // the truth of several bodies with formulas has at most 50 working digits
        const int digits = scene.bodies.empty() ? 40 : 32;
        const CertifiedReference certified = certified_reference(scene, 3, digits - 6);
        ASSERT_TRUE(certified.available) << scene.name << ' ' << certified.message;
        EXPECT_GE(certified.digits, digits - 6) << scene.name;
        EXPECT_EQ(outside(scene, certified, digits), 0) << scene.name;
    }
}

TEST(CertifiedFormulas, AreRefusedWhereTheySwitchOrHaveNoSeries) {
    const FreshCache cache;
    const CertifiedReference switched = certified_reference(find_scene("formulas/saturated_regulator"), 2, 20);
    EXPECT_FALSE(switched.available);
    EXPECT_NE(switched.message.find("formulas that switch"), std::string::npos) << switched.message;
    Scene from_rest = find_scene("formulas/quadratic_drag");
    from_rest.initial.velocity_W = {};
    const CertifiedReference at_rest = certified_reference(from_rest, 2, 20);
    EXPECT_FALSE(at_rest.available);
    EXPECT_NE(at_rest.message.find("square root"), std::string::npos) << at_rest.message;
    EXPECT_NE(at_rest.message.find("t = 0 s"), std::string::npos) << at_rest.message;
}

// Every type of loop is closed to the printed digits, and opens by the amount that a number is changed.
TEST(OpennessOfLoops, IsWhatAChangedNumberOpens) {
    const FreshCache cache;
    for (const char* name : {"mechanisms/four_bar", "mechanisms/spatial_slider_crank", "mechanisms/flyball_governor"}) {
        Scene scene = find_scene(name);
        scene.duration /= 64;
        DecimalReference truth = decimal_reference(scene, 1, 25);
        ASSERT_TRUE(truth.available) << truth.message;
        const double closed = openness_of_loops(scene, truth).near();
        EXPECT_LT(closed, 1e-24) << name;
        EXPECT_GT(closed, 0) << name;
        // the centre of mass of the loop's second body, in columns 7 to 9
        const int body = body_index(scene, scene.loops[0].second);
        ASSERT_GE(body, 0);
        for (int axis = 7; axis < 10; ++axis) {
            std::string& number = truth.columns[static_cast<std::size_t>(body)][static_cast<std::size_t>(axis)];
            number = R(R(number) + R("1e-9")).str(40);
        }
        const double open = openness_of_loops(scene, truth).near();
        EXPECT_GT(open, 1e-10) << name;
        EXPECT_LT(open, 2e-9) << name;
    }
}

}  // namespace
}  // namespace polhode::truth
