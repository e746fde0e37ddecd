// A complete study: a scene, the truth with its bound, the errors of several methods, a table of results.
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "expect.h"
#include "other_process.h"
#include "own_method.h"
#include "parts.h"

using namespace polhode;

namespace {

// A scene as a file: gravity about a fixed point, and drag. Its motion has no closed form.
constexpr const char* scene_text = R"({
  "name": "damped_pendulum",
  "duration": 5,
  "body": {"mass": 2, "inertia": [0.3, 0.2, 0.1], "center_of_mass": [0, 0, -0.5]},
  "initial": {"orientation": [0.8, 0.6, 0, 0], "angular_velocity": [0, 1, 2]},
  "pivot": [0, 0, 0],
  "loads": [{"type": "gravity", "acceleration": [0, 0, -9.80665]},
            {"type": "drag", "rotational": [0.1, 0.1, 0.1], "translational": 0}]
})";

constexpr long samples = 20;

struct Run {
    const Method* method;
    Settings settings;
    double limit;  // maximum attitude error, rad
};

// Appends one row per run of a scene, and checks that the attitude error is below its limit.
void add_rows(Table& table, const Scene& scene, const std::vector<Run>& runs) {
    const Reference truth = reference(scene, samples);
    expect("the scene has a truth", truth.available);
    // the default is 25 digits
    expect_below("bound of the truth", truth.bound, 1e-25);
    for (const Run& run : runs) {
        const std::string name(run.method->name);
        const Trajectory trajectory = solve(scene, *run.method, run.settings);
        expect_ok(name.c_str(), trajectory);
        const Errors off = errors(error_series(scene, trajectory, truth), trajectory, truth);
        expect_below(("attitude error of " + name).c_str(), off["attitude"].max.value_or(4), run.limit);
        std::vector<Cell> row{scene.name, name, std::string(name_of(trajectory.status)), trajectory.seconds};
        for (std::size_t i = 0; i < measures().size(); ++i)
            if (measures()[i].tabled) row.push_back(cell_of(off[i].max));
        table.rows.push_back(row);
    }
}

}  // namespace

void make_a_table() {
    // the columns come from the list of measures, so that new measures of polhode appear as columns
    Table table{{"scene", "method", "status", "seconds"}, {}};
    for (const Measure& measure : measures())
        if (measure.tabled) table.columns.push_back(std::string(measure.name) + "_error_max");

    const Settings plain{.samples = samples}, by_tolerance{.tolerance = 1e-10, .samples = samples},
        by_step{.step = 1e-3, .samples = samples};

    // By tolerance: some 1e3 steps, each with a local error of up to 1e-10 that the damped motion hardly magnifies.
    // Heun: T h^2 times the third derivative of the motion, some (10 rad/s)^3, is 5 * 1e-6 * 1e3 = 5e-3.
    add_rows(table, parse_scene(scene_text, "damped_pendulum.json"),
             {{find_method("taylor"), by_tolerance, 1e-7},
              {find_method("cvode_adams"), by_tolerance, 1e-7},
              {&heun, by_step, 5e-3}});

    // The script: the half angle w t / 2, up to 3.75 rad, is rounded twice, by a part in 2^53 each: 1.7e-15 rad of the
    // angle; and its sine and cosine as they are written, 2e-16 rad.
    const std::shared_ptr<const Method> script = shell_script();
    add_rows(table, spinning_body(),
             {{find_method("exact"), plain, 3e-15},
              {find_method("cvode_adams"), by_tolerance, 1e-7},
              {script.get(), plain, 3e-15}});

    std::fputs(markdown(table).c_str(), stdout);
    expect("a table reads back", parse_csv(csv(table)).rows.size() == table.rows.size());
}
