// Measures the order of a user-defined method.
#include "own_method.h"

#include <cmath>

#include "expect.h"
#include "parts.h"
#include "scene_in_code.h"

using namespace polhode;

void add_a_method() {
    double errors[2];
    for (int i = 0; i < 2; ++i) {
        Settings settings;
        settings.step = i == 0 ? 2e-3 : 1e-3;
        const Trajectory trajectory = solve(symmetric_body(), heun, settings);
        expect_ok("user-defined method", trajectory);
        errors[i] = worst_attitude_error(trajectory);
    }
    // the next term of the error is h times smaller: a few 1e-3 of the order
    expect_below("user-defined method: |observed order - 2|", std::fabs(std::log2(errors[0] / errors[1]) - 2), 0.02);
    expect_below("user-defined method: error at h = 1e-3", errors[1], 1e-4);
}
