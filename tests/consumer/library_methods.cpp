// Solves a scene by methods of the library, writes the trajectory to CSV and reads it back.
#include <cstddef>

#include "expect.h"
#include "parts.h"
#include "scene_in_code.h"

using namespace polhode;

void solve_by_the_library() {
    for (const char* name : {"odeint_fehlberg78", "cvode_adams"}) {
        const Method* method = find_method(name);
        expect(name, method != nullptr);
        if (!method) continue;
        Settings settings;
        settings.tolerance = 1e-12;
        const Trajectory trajectory = solve(symmetric_body(), *method, settings);
        expect_ok(name, trajectory);
        // at most 1000 steps, each with a local error of up to 1e-12 of each component, adding up linearly
        expect_below(name, worst_attitude_error(trajectory), 1e-9);

        // numbers read back to the same binary64
        const TrajectoryFile file = parse_trajectory(trajectory_csv(trajectory), "trajectory.csv");
        expect("one row per sample", file.rows.size() == trajectory.samples.size());
        for (std::size_t k = 0; k < file.rows.size() && k < trajectory.samples.size(); ++k)
            expect("the attitude reads back", file.rows[k].q == trajectory.samples[k].q);
    }
}
