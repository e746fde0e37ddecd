// The controlled bodies of the kind `engine_joint_laws`, with methods whose errors are known.
#include <gtest/gtest.h>

#include <cmath>

#include "experiment/kinds/engine_joints.h"

namespace polhode {
namespace {

TEST(EngineControl, MeasuresErrorsOfControlledBodies) {
    const std::vector<ControlErrors> errors =
        measure_control({find_method("odeint_euler"), find_method("odeint_rk4"), find_method("splitting4")});
    ASSERT_EQ(errors.size(), 3u);
    const ControlErrors &euler = errors[0], &rk4 = errors[1], &refused = errors[2];
    for (std::size_t i = 0; i < 4; ++i) {
        ASSERT_TRUE(euler.usual[i] && euler.fine[i]) << euler.fault;
        ASSERT_TRUE(rk4.usual[i] && rk4.fine[i]) << rk4.fault;
        // errors of order 1 differ by the ratio of the steps, 16.7
        EXPECT_NEAR(*euler.usual[i] / *euler.fine[i], 16.7, 1.5);
        EXPECT_LT(*rk4.usual[i], 1e-6);
        EXPECT_FALSE(refused.usual[i]);
    }
    // the spacecraft's torque leaves its limit late: sampling changes the motion
    EXPECT_NE(*euler.usual[0], *euler.usual[1]);
    // the sampled wheel has a constant torque during a step, which RK4 integrates exactly
    EXPECT_LT(*rk4.usual[3], 1e-12);
    EXPECT_FALSE(refused.fault.empty());

    const NamedTable table = control_table(errors);
    EXPECT_EQ(table.table.rows.size(), 3u);
    EXPECT_EQ(table.table.columns.size(), 10u);
    const std::string text = describe_control(errors);
    EXPECT_NE(text.find("2 of 2 methods keep the attitude"), std::string::npos) << text;
    EXPECT_NE(text.find("exact to rounding in `odeint_rk4`."), std::string::npos) << text;
}

}  // namespace
}  // namespace polhode
