// The whole job: a scene, the truth with its bound, the errors of several methods, a table of results.
#include <cstdio>
#include <string>
#include <vector>

#include "expect.h"
#include "own_method.h"
#include "parts.h"
#include "scene_in_code.h"

using namespace polhode;

namespace {

// A scene as its file has it: gravity about a fixed point, torsional spring, drag. Nothing here has a closed form.
constexpr const char* scene_text = R"({
  "name": "damped_pendulum",
  "duration": 5,
  "body": {"mass": 2, "inertia": [0.3, 0.2, 0.1], "center_of_mass": [0, 0, -0.5]},
  "initial": {"orientation": [0.8, 0.6, 0, 0], "angular_velocity": [0, 1, 2]},
  "pivot": [0, 0, 0],
  "loads": [{"type": "gravity", "acceleration": [0, 0, -9.80665]},
            {"type": "drag", "rotational": [0.1, 0.1, 0.1], "translational": 0}]
})";

std::vector<Cell> row(const Method& method, const Trajectory& trajectory, const Errors& errors) {
    return {std::string(method.name),        std::string(name_of(trajectory.status)), cell_of(errors["attitude"].max),
            cell_of(errors["momentum"].max), cell_of(errors["energy"].max),           trajectory.seconds};
}

}  // namespace

void make_a_table() {
    const Scene scene = parse_scene(scene_text, "damped_pendulum.json");
    Settings settings;
    settings.samples = 20;
    settings.tolerance = 1e-10;
    Settings by_step;
    by_step.samples = 20;
    by_step.step = 1e-3;

    const Reference truth = reference(scene, settings.samples);
    expect("the damped pendulum has a truth", truth.available);
    // 25 digits are asked for where nothing else is said
    expect_below("bound of the truth", truth.bound, 1e-25);

    struct Run {
        const Method* method;
        const Settings* settings;
        double limit;  // rad
    };
    // By tolerance: some 1e3 steps, each with a local error of up to 1e-10 that the damped motion hardly magnifies.
    // Heun: of the order of T h^2 max |y'''| with rates of up to 10 rad/s, 5 * 1e-6 * 1e3 = 5e-3.
    const Run runs[] = {{find_method("taylor"), &settings, 1e-7},
                        {find_method("cvode_adams"), &settings, 1e-7},
                        {&heun, &by_step, 5e-3}};
    Table table{{"method", "status", "attitude_error", "momentum_error", "energy_error", "seconds"}, {}};
    for (const Run& run : runs) {
        const Trajectory trajectory = solve(scene, *run.method, *run.settings);
        expect_ok(std::string(run.method->name).c_str(), trajectory);
        const Errors off = errors(error_series(scene, trajectory, truth), trajectory, truth);
        expect_below(("attitude error of " + std::string(run.method->name)).c_str(), off["attitude"].max.value_or(4),
                     run.limit);
        table.rows.push_back(row(*run.method, trajectory, off));
    }
    std::fputs(markdown(table).c_str(), stdout);
    expect("a table reads back", parse_csv(csv(table)).rows.size() == table.rows.size());
}
