#include "experiment/run/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene/scene_file.h"

namespace polhode {
namespace {

double spent(Scene scene, const char* method, SettingKind kind, double setting) {
    scene.duration = 100 * revolution_time(scene);
    Settings settings;
    (kind == SettingKind::step ? settings.step : settings.tolerance) = setting;
    const Trajectory trajectory = solve(scene, *find_method(method), settings);
    EXPECT_EQ(trajectory.status, Status::ok) << trajectory.message;
    return static_cast<double>(trajectory.rhs_evaluations) / 100;
}

TEST(Calibrate, ARevolutionIsOneTurn) {
    const Scene scene = find_scene("free_asymmetric");
    EXPECT_DOUBLE_EQ(revolution_time(scene), 2 * std::numbers::pi / std::sqrt(3.0));
}

TEST(Calibrate, StepsAndTolerancesUseTheRequestedBudget) {
    const Scene scene = find_scene("free_asymmetric");
    for (const double evaluations : {80.0, 400.0})
        for (const auto& [method, kind] : {std::pair{"odeint_rk4", SettingKind::step},
                                           {"odeint_dopri5", SettingKind::step},
                                           {"odeint_dopri5", SettingKind::tolerance},
                                           {"cvode_adams", SettingKind::tolerance}}) {
            const Calibration found = calibrate(scene, *find_method(method), kind, evaluations);
            ASSERT_TRUE(found.found) << method << ": " << found.message;
            // the start-up of a multistep method has a larger share of the short pilot run
            const double ratio = spent(scene, method, kind, found.setting) / evaluations;
            EXPECT_LT(ratio, 1.1) << method;
            EXPECT_GT(ratio, 0.75) << method;
        }
}

TEST(Calibrate, TheTightestToleranceIsTheEnd) {
    const Calibration found =
        calibrate(find_scene("symmetric"), *find_method("odeint_fehlberg78"), SettingKind::tolerance, 1e6);
    ASSERT_TRUE(found.found);
    EXPECT_EQ(found.setting, 1e-15);
}

TEST(Calibrate, ReportsUnreachableBudgets) {
    const Calibration dear =
        calibrate(find_scene("symmetric"), *find_method("odeint_dopri5"), SettingKind::tolerance, 3);
    EXPECT_FALSE(dear.found);
    EXPECT_NE(dear.message.find("evaluations per revolution at any tolerance"), std::string::npos) << dear.message;
    Scene rest = find_scene("symmetric");
    rest.initial.angular_velocity = {};
    const Calibration still = calibrate(rest, *find_method("odeint_rk4"), SettingKind::step, 100);
    EXPECT_FALSE(still.found);
    EXPECT_NE(still.message.find("at rest"), std::string::npos);
}

}  // namespace
}  // namespace polhode
