#include "integrators/method.h"

#include <gtest/gtest.h>

#include <string>

#include "scene/scene_file.h"

namespace polhode {
namespace {

Scene with_user_torque(const char* name) {
    Scene scene = find_scene(name);
    scene.loads.push_back(UserTorque{"of mine", [](const LoadState&) { return Vector3<double>(0, 0, 1e-3); }, {}});
    return scene;
}

TEST(Descriptors, SayWhatTheMethodsAre) {
    for (const Method* method : methods()) {
        EXPECT_NE(method->family, Family::unnamed) << method->name;
        EXPECT_EQ(method->precision == Precision::binary32, !method->binary64_name.empty()) << method->name;
        if (method->binary64_name.empty()) continue;
        const Method* same = find_method(method->binary64_name);
        ASSERT_NE(same, nullptr) << method->name;
        EXPECT_EQ(same->precision, Precision::binary64) << method->name;
        EXPECT_EQ(same->family, method->family) << method->name;
        EXPECT_EQ(same->order, method->order) << method->name;
    }
}

// refusal() and the status `unsupported` of a run agree, with the same message.
TEST(Descriptors, RefuseWhatTheMethodsDoNotSolve) {
    const Scene scenes[] = {find_scene("every_load"), find_scene("bouncing_ball"), with_user_torque("symmetric")};
    long refused = 0;
    for (const Scene& scene : scenes) {
        const Problem problem = pose(scene);
        for (const Method* method : methods()) {
            if (method->family == Family::reference) continue;  // the truth refuses scenes for its own reasons
            Settings settings;
            settings.samples = 2;
            settings.max_steps = 20;
            if (takes_step(*method))
                settings.step = scene.duration / 10;
            else if (takes_tolerance(*method))
                settings.tolerance = 1e-3;
            const std::string why = refusal(*method, problem);
            const Trajectory run = solve(problem, *method, settings);
            EXPECT_EQ(run.status == Status::unsupported, !why.empty()) << method->name << " on " << scene.name;
            if (!why.empty()) {
                EXPECT_EQ(run.message, why) << method->name;
            }
            refused += why.empty() ? 0 : 1;
        }
    }
    EXPECT_GT(refused, 0);
}

TEST(MadeMethod, CallsItsFunctionAndOwnsItsTexts) {
    std::shared_ptr<const Method> method;
    {
        std::string name = "a name longer than a short string is";
        const std::string says = "from the function";
        method = make_method({.name = name}, [says](const Problem&, const Settings&) {
            Trajectory trajectory;
            trajectory.message = says;
            return trajectory;
        });
        name.assign(name.size(), 'x');
    }
    EXPECT_EQ(method->name, "a name longer than a short string is");
    EXPECT_EQ(solve(find_scene("symmetric"), *method).message, "from the function");
}

}  // namespace
}  // namespace polhode
