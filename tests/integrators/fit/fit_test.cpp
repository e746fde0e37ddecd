// Fits with a closed form, and what is refused. tests/python/test_sensitivity.py tests error bars on noisy data.
#include "integrators/fit/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "text/message.h"

namespace polhode {
namespace {

// A point mass that is thrown: p = p0 + v0 t + g t^2 / 2.
Scene thrown_body() {
    Scene scene;
    scene.name = "thrown", scene.duration = 1;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 1, 1));
    scene.initial.velocity_W = {3, 0, 4};
    scene.loads.push_back(Gravity{{0, 0, -10}, {}});
    return scene;
}

FitData data_of(const std::vector<std::string>& names, const std::vector<std::string>& bodies = {}) {
    FitData data;
    for (const std::string& name : names) data.columns.push_back(fit_column(name, bodies));
    return data;
}

// One number v of p_x = v t with measurements x_i: v = sum t x / sum t^2, with the variance sigma^2 / sum t^2.
TEST(Fits, AreThoseOfLinearRegression) {
    FitData data = data_of({"px"});
    data.times = {0.5, 1, 1.5, 2};
    data.values = {1.1, 1.9, 3.2, 3.9};
    double tt = 0, tx = 0;
    for (std::size_t i = 0; i < 4; ++i) tt += data.times[i] * data.times[i], tx += data.times[i] * data.values[i];
    const SceneNumbers scene(thrown_body(), "thrown");
    FitSettings settings;
    settings.deviations = {0.1};
    const Fit fit = fit_numbers(scene, {"/initial/velocity/0"}, data, settings);
    ASSERT_EQ(fit.status, Status::ok) << fit.message;
    EXPECT_NEAR(fit.values[0], tx / tt, 1e-12);
    EXPECT_NEAR(fit.errors[0], 0.1 / std::sqrt(tt), 1e-12);
    double squares = 0;
    for (std::size_t i = 0; i < 4; ++i) squares += std::pow(tx / tt * data.times[i] - data.values[i], 2);
    EXPECT_NEAR(fit.residuals[0], std::sqrt(squares / 4), 1e-12);
    // without deviations, the variance is estimated by 4 - 1 degrees of freedom
    const Fit estimated = fit_numbers(scene, {"/initial/velocity/0"}, data);
    EXPECT_NEAR(estimated.errors[0], std::sqrt(squares / 3 / tt), 1e-12);
}

// Two numbers that are correlated: height z0 + v t + g t^2 / 2 with the covariance sigma^2 (J^T J)^-1.
TEST(Fits, HaveTheCovarianceOfTheNormalEquations) {
    FitData data = data_of({"pz"});
    double t1 = 0, t2 = 0;
    for (const double t : {0.25, 0.5, 0.75, 1.0}) {
        data.times.push_back(t);
        data.values.push_back(2 + 7 * t - 5 * t * t);
        t1 += t, t2 += t * t;
    }
    FitSettings settings;
    settings.deviations = {0.5};
    const Fit fit = fit_numbers(SceneNumbers(thrown_body(), "thrown"), {"/initial/position/2", "/initial/velocity/2"},
                                data, settings);
    ASSERT_EQ(fit.status, Status::ok) << fit.message;
    EXPECT_NEAR(fit.values[0], 2, 1e-11);
    EXPECT_NEAR(fit.values[1], 7, 1e-11);
    const double determinant = 4 * t2 - t1 * t1;
    EXPECT_NEAR(fit.covariance[0], 0.25 * t2 / determinant, 1e-10);
    EXPECT_NEAR(fit.covariance[1], -0.25 * t1 / determinant, 1e-10);
    EXPECT_NEAR(fit.covariance[3], 0.25 * 4 / determinant, 1e-10);
}

// A rotor about z: the angle is w t. The quaternions of the data have either sign.
TEST(Fits, AcceptQuaternionsOfEitherSign) {
    Scene rotor;
    rotor.name = "rotor", rotor.duration = 3;
    rotor.body.inertia_B = diagonal(Vector3<double>(1, 1, 1.5));
    rotor.initial.angular_velocity = {0, 0, 1.9};
    FitData data = data_of({"qw", "qz"});
    double sign = 1;
    for (const double t : {0.5, 1.0, 1.5, 2.5}) {
        data.times.push_back(t);
        data.values.insert(data.values.end(), {sign * std::cos(t), sign * std::sin(t)});  // 2 rad/s
        sign = -sign;
    }
    const Fit fit = fit_numbers(SceneNumbers(rotor, "rotor"), {"/initial/angular_velocity/2"}, data);
    ASSERT_EQ(fit.status, Status::ok) << fit.message;
    EXPECT_NEAR(fit.values[0], 2, 1e-11);
}

TEST(Fits, NameNumbersThatTheDataDoNotDetermine) {
    Scene free;
    free.name = "free", free.duration = 3;
    free.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    free.initial.angular_velocity = {1, 2, 0.5};
    FitData data = data_of({"wx_B", "wy_B", "wz_B"});
    for (const double t : {1.0, 2.0, 3.0}) {
        data.times.push_back(t);
        data.values.insert(data.values.end(), {0.5, 1, 2});
    }
    // a common factor of all moments does not change the motion of a free body
    const Fit common =
        fit_numbers(SceneNumbers(free, "free"), {"/body/inertia/0", "/body/inertia/1", "/body/inertia/2"}, data);
    EXPECT_EQ(common.status, Status::failed);
    EXPECT_NE(common.message.find("common relative change +1 * /body/inertia/"), std::string::npos) << common.message;
    const Fit mass = fit_numbers(SceneNumbers(free, "free"), {"/body/mass"}, data);
    EXPECT_EQ(mass.status, Status::failed);
    EXPECT_EQ(mass.message, "the data do not depend on /body/mass");
}

TEST(Fits, FailByNameAfterTheLastEvaluation) {
    FitData data = data_of({"wx_B"});
    data.times = {1, 2, 3}, data.values = {0.5, 0.1, 0.7};
    Scene free;
    free.name = "free", free.duration = 3;
    free.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    free.initial.angular_velocity = {1, 2, 0.5};
    FitSettings settings;
    settings.max_evaluations = 2;
    const Fit fit = fit_numbers(SceneNumbers(free, "free"), {"/body/inertia/0"}, data, settings);
    EXPECT_EQ(fit.status, Status::failed);
    EXPECT_EQ(fit.message, "no convergence in 2 evaluations");
}

TEST(SceneNumbers, ChangeBothEntriesOfAnInertiaMatrix) {
    Scene scene = thrown_body();
    scene.body.inertia_B = Matrix3<double>{{Vector3<double>(2, 0.25, 0), {0.25, 2.5, 0}, {0, 0, 3}}};
    const SceneNumbers numbers(scene, "body.json");
    const std::string pointer = "/body/inertia/0/1";
    EXPECT_EQ(numbers.number(pointer), 0.25);
    const double half = 0.5;
    const Scene changed = numbers.replace({&pointer, 1}, {&half, 1});
    EXPECT_EQ(changed.body.inertia_B[0][1], 0.5);
    EXPECT_EQ(changed.body.inertia_B[1][0], 0.5);
    EXPECT_EQ(changed.body.inertia_B[0][0], 2);
}

std::string refusal_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "accepted";
}

TEST(SceneNumbers, RefusePointersToNoNumber) {
    const SceneNumbers numbers(thrown_body(), "body.json");
    const auto refusal = [&](const char* pointer) { return refusal_of([&] { (void)numbers.number(pointer); }); };
    EXPECT_EQ(refusal("body/mass"), "body.json: body/mass is not a JSON pointer; write it like /body/mass");
    EXPECT_EQ(refusal("/body/weight"),
              "body.json: /body: has no /weight; give the JSON pointer of a number that polhode show prints");
    EXPECT_EQ(refusal("/body/inertia"), "body.json: /body/inertia: is not a number; give the JSON pointer of a number");
}

TEST(FitData, RefusesBadTables) {
    const auto refusal = [](const char* text, std::vector<std::string> columns = {},
                            std::vector<std::string> bodies = {}) {
        return refusal_of([&] { parse_fit_data(text, "data.csv", bodies, columns); });
    };
    EXPECT_EQ(refusal(""), "data.csv: is empty; give a header and one line per time");
    EXPECT_EQ(refusal("t,wx\n"), "data.csv: has no line after the header; give one line per time");
    EXPECT_EQ(refusal("wx\n1\n"), "data.csv: line 1: has no column t; the columns are wx");
    EXPECT_EQ(refusal("t,wx,wx\n0,1,2\n"), "data.csv: line 1: has two columns wx; remove one");
    EXPECT_EQ(refusal("t,wx\n0,one\n"), "data.csv: line 2, column wx: \"one\" is not a finite number; give a number");
    EXPECT_EQ(refusal("t,wx\n0,1\n0,2\n"),
              "data.csv: line 3, column t: is not later than the line before; sort the lines by time");
    EXPECT_EQ(refusal("t,wx\n0,1,2\n"), "data.csv: line 2: has 3 cells; give 2, as in the header");
    EXPECT_EQ(refusal("t,wx\n0,1\n", {"wy"}), "data.csv: line 1: has no column wy; the columns are t, wx");
    EXPECT_NE(refusal("t,wx\n0,1\n", {"rate"}).find("there is no column rate; the columns are qw, qx"),
              std::string::npos);
    EXPECT_NE(refusal("t,wx\n0,1\n", {}, {"upper", "lower"}).find("after the name of a body"), std::string::npos);
    EXPECT_EQ(refusal("t,upper.wx,mood\n0,1,good\n", {}, {"upper", "lower"}), "accepted");
}

}  // namespace
}  // namespace polhode
