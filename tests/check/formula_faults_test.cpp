// Diagnosis of faults of loads given by formulas, from trajectories of accurate methods on scenes with the fault.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "check/diagnosis.h"
#include "integrators/method.h"
#include "motion/problem.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

constexpr int formula_rows = 50;

// A body with a torque and a force given by formulas; `torque`, `force`: the loads as written.
Scene formula_fault_scene(const std::string& torque, const std::string& force) {
    return parse_scene(R"json({"name": "formula faults", "duration": 2,
        "body": {"mass": 2, "inertia": [0.4, 0.7, 1]},
        "initial": {"orientation": [0.8, 0.48, 0, 0.36], "angular_velocity": [0.9, 1.3, 0.4], "position": [1, 0.5, 0],
                    "velocity": [0.5, -1, 0.75]},
        "parameters": {"k": 1.5}, "loads": [)json" +
                           torque + (torque.empty() || force.empty() ? "" : ", ") + force + "]}",
                       "faults.json", "");
}
std::string torque_load(const std::string& formula, const char* frame = "body") {
    return R"json({"type": "torque", "frame": ")json" + std::string(frame) + R"json(", "formula": ")json" + formula +
           "\"}";
}
std::string force_load(const std::string& formula, const char* frame = "world") {
    return R"json({"type": "force", "frame": ")json" + std::string(frame) + R"json(", "formula": ")json" + formula +
           "\"}";
}

// The file that an accurate engine writes for a scene.
TrajectoryFile file_of(const Scene& scene) {
    Settings settings;
    settings.samples = formula_rows, settings.tolerance = 1e-13;
    const Trajectory run = solve(pose(scene), *find_method("dop853"), settings);
    EXPECT_EQ(run.status, Status::ok) << run.message;
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    for (const Sample& s : run.samples)
        file.rows.push_back({s.t, s.q, rotate(s.q, s.angular_velocity_B), s.position_W, s.velocity_W});
    return file;
}
std::vector<std::string> faults_of(const Scene& scene, const Scene& given) {
    std::vector<std::string> all;
    for (const Diagnosis& one : diagnose(scene, file_of(given)).faults) all.push_back(one.fault);
    return all;
}

const char* const law = "-k*rotation_error([1, 0, 0, 0]) - 0.5*w";
const char* const pull = "-k*p - 0.25*norm(v)*v";

TEST(FormulaFaults, AreNotReportedForACorrectFile) {
    const Scene scene = formula_fault_scene(torque_load(law), force_load(pull));
    EXPECT_EQ(faults_of(scene, scene), std::vector<std::string>());
}

TEST(FormulaFaults, AreDiagnosed) {
    const Scene scene = formula_fault_scene(torque_load(law), force_load(pull));
    const auto wrapped = [](const char* factor, const char* formula) {
        return factor + std::string("*(") + formula + ")";
    };
    const struct {
        const char* name = "";
        Scene given;
    } cases[] = {
        {"formula_force_missing", formula_fault_scene(torque_load(law), "")},
        {"formula_force_reversed", formula_fault_scene(torque_load(law), force_load(wrapped("-1", pull)))},
        {"formula_torque_scaled", formula_fault_scene(torque_load(wrapped("1.7", law)), force_load(pull))},
        {"formula_torque_in_other_axes", formula_fault_scene(torque_load(law, "world"), force_load(pull))},
        {"formula_held", formula_fault_scene(torque_load("hold(" + std::string(law) + ", 0.04)"),
                                             force_load("hold(" + std::string(pull) + ", 0.04)"))},
    };
    for (const auto& one : cases) {
        const std::vector<std::string> found = faults_of(scene, one.given);
        ASSERT_FALSE(found.empty()) << one.name;
        EXPECT_EQ(found[0], one.name);
    }
}

}  // namespace
}  // namespace polhode
