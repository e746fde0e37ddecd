// Hashes all trajectories: every built-in scene by every method computed in this process except the truth, and
// ensembles of random bodies. The hashes do not depend on compiler, optimisation, instruction set or number of threads.
//
// Runs are bounded by settings, not by the clock: each scene runs for its duration in 200 steps or to a tolerance of
// 1e-6. A run ends as `failed` after 400 steps or 8000 evaluations (both divided by the number of bodies), with the
// samples reached by then. The hash of a run covers every bit of every sample, reaction and impact time, the status and
// the counts. All NaNs hash alike, because IEEE 754 leaves their sign and payload open.
//
// One difference remains: the C library's sin, pow and similar functions are not correctly rounded. Their last bit
// differs on a processor without FMA and in other C libraries. `libm` hashes some of their values. Where that hash
// differs, the methods listed as affected may differ too.
//
// The program links only the libraries below the truth, so that another compiler builds it in minutes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "integrators/lanes/lanes.h"
#include "integrators/method.h"
#include "integrators/own/ensemble.h"
#include "integrators/own/mechanism_ensemble.h"
#include "scene/joint_motions.h"
#include "scene/scene_file.h"
#include "text/content_hash.h"
#include "text/parallel.h"

namespace polhode {

// this program omits the truth and methods that run in other processes
extern const std::span<const Method> truth_method_methods;
const std::span<const Method> truth_method_methods{};

namespace {

/// Collects the bytes of numbers.
class Bytes {
  public:
    void add(std::uint64_t bits) {
        for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<char>(bits >> shift & 0xFF));
    }
    void add(long count) { add(static_cast<std::uint64_t>(count)); }
    void add(const std::optional<long>& count) { add(count ? *count : -1L); }
    void add(double x) { add(std::isnan(x) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(x)); }
    void add(const Vector3<double>& v) { add(v[0]), add(v[1]), add(v[2]); }
    void add(const Sample& s) {
        add(s.t), add(s.q.w), add(s.q.x), add(s.q.y), add(s.q.z);
        add(s.angular_velocity_B), add(s.position_W), add(s.velocity_W);
    }
    void add(const Trajectory& t) {
        add(static_cast<long>(t.status)), add(static_cast<long>(t.bodies)), add(static_cast<long>(t.samples.size()));
        for (const Sample& sample : t.samples) add(sample);
        for (const double defect : t.orthogonality_defect) add(defect);
        for (const Reaction<double>& reaction : t.reactions) add(reaction.force_W), add(reaction.torque_W);
        for (const double time : t.impact_times) add(time);
        add(t.steps), add(t.rhs_evaluations - t.sample_evaluations), add(t.step);
        add(t.counts.rejected_steps), add(t.counts.newton_failures), add(t.counts.order_reductions);
    }
    std::string hash() const { return content_hash(bytes_); }

  private:
    std::string bytes_;
};

struct Asked {
    int threads = 1;
    std::string instructions, expected, only_scene, only_method;
    bool interpreted = false, each = false;
};

/// One kind of run (a method with a step or a tolerance, or an ensemble), with the hash of each scene.
struct Kind {
    std::string name;
    std::vector<std::pair<std::string, std::string>> hash_of_scene;

    std::string hash() const {
        std::string all;
        for (const auto& [scene, hash] : hash_of_scene) all += hash;
        return content_hash(all);
    }
};

/// Limits divided by the number of bodies, since the cost of a step grows at least in proportion to it.
Settings bounded_settings(const Problem& problem) {
    const long bodies = std::max(1L, static_cast<long>(problem.scene.bodies.size()));
    Settings settings;
    settings.samples = 10;
    settings.max_steps = std::max(400 / bodies, 10L);
    settings.max_evaluations = std::max(8000 / bodies, 200L);
    settings.seconds_limit = 1e9;  // s: the clock must not affect results
    return settings;
}

/// A method and its setting. The name is NAME:step or NAME:tolerance for methods that take both, else NAME.
struct ToldMethod {
    const Method* method;
    std::string name;
    bool step, tolerance;

    Settings settings(const Problem& problem) const {
        Settings settings = bounded_settings(problem);
        if (step) settings.step = problem.scene.duration / 200;
        if (tolerance) settings.tolerance = 1e-6;
        return settings;
    }
};

std::vector<ToldMethod> told_methods(const Asked& asked) {
    std::vector<ToldMethod> all;
    for (const Method* method : methods()) {
        const std::string name(method->name);
        if (!asked.only_method.empty() && name != asked.only_method) continue;
        if (takes_step(*method) && takes_tolerance(*method)) {
            all.push_back({method, name + ":step", true, false});
            all.push_back({method, name + ":tolerance", false, true});
        } else {
            all.push_back({method, name, takes_step(*method), takes_tolerance(*method)});
        }
    }
    return all;
}

std::vector<Kind> trajectories(const Asked& asked) {
    const std::vector<ToldMethod> told = told_methods(asked);
    std::vector<std::string> scenes = builtin_scene_names();
    // formula_scenes() hashes these: formulas call functions of the C library, so that every method would depart
    // without FMA
    std::erase_if(scenes, [](const std::string& name) { return name.starts_with("formulas/"); });
    // joint_scenes() and joint_steps() hash these
    std::erase_if(scenes, [](const std::string& name) { return name.starts_with("joints/"); });
    if (!asked.only_scene.empty()) scenes = {asked.only_scene};
    std::vector<std::vector<std::string>> hashes(scenes.size(), std::vector<std::string>(told.size()));
    parallel_for(scenes.size(), asked.threads, [&](std::size_t s) {
        const Problem problem = pose(find_scene(scenes[s]));
        for (std::size_t m = 0; m < told.size(); ++m) {
            Bytes bytes;
            bytes.add(solve(problem, *told[m].method, told[m].settings(problem)));
            hashes[s][m] = bytes.hash();
        }
    });
    std::vector<Kind> kinds;
    for (std::size_t m = 0; m < told.size(); ++m) {
        kinds.push_back({told[m].name, {}});
        for (std::size_t s = 0; s < scenes.size(); ++s)
            kinds.back().hash_of_scene.emplace_back(scenes[s], hashes[s][m]);
    }
    return kinds;
}

/// Random numbers that are the same with every standard library: unlike the generator, distributions are not specified.
class Random {
  public:
    /// Uniform in [low, high), in steps of (high - low) / 2^32.
    double operator()(double low, double high) {
        return low + (high - low) * (static_cast<double>(generator_() >> 32) * 0x1p-32);
    }

  private:
    std::mt19937_64 generator_{1};
};

EnsembleBody random_body(const EnsembleBody& start, bool pivoted, Random& random) {
    EnsembleBody body = start;
    // moments of three masses on the axes satisfy the triangle inequality
    const double a = random(0.1, 1), b = random(0.1, 1), c = random(0.1, 1);
    body.inertia_B = {};
    body.inertia_B[0][0] = b + c, body.inertia_B[1][1] = a + c, body.inertia_B[2][2] = a + b;
    body.orientation = {random(-1, 1), random(-1, 1), random(-1, 1), random(0.1, 1)};
    body.angular_velocity = {random(-5, 5), random(-5, 5), random(-5, 5)};
    if (!pivoted) body.velocity_W = {random(-1, 1), random(-1, 1), random(-1, 1)};
    return body;
}

constexpr std::string_view scenes_of_ensembles[] = {"free_asymmetric", "heavy_asymmetric_top", "every_load",
                                                    "stiff_drag",      "driven_top",           "tumbling_box_bounce"};
constexpr std::string_view scenes_of_mechanism_ensembles[] = {"mechanisms/double_pendulum", "mechanisms/four_bar"};

EnsembleSettings ensemble_settings(const Asked& asked) {
    EnsembleSettings settings;
    settings.threads = asked.threads;
    settings.tolerance = 1e-8;
    settings.max_steps = 2000;
    settings.seconds_limit = 1e9;
    return settings;
}

/// Not a multiple of the 8 or 16 lanes, so that the last batch is incomplete.
constexpr int bodies_of_ensemble = 203;

Kind ensembles(const Asked& asked) {
    Kind kind{"ensemble", {}};
    for (const std::string_view name : scenes_of_ensembles) {
        Scene scene = find_scene(std::string(name));
        scene.duration = std::min(scene.duration, 2.0);
        Random random;
        std::vector<EnsembleBody> bodies;
        for (int i = 0; i < bodies_of_ensemble; ++i)
            bodies.push_back(random_body(ensemble_body(scene), scene.pivot.has_value(), random));
        Bytes bytes;
        for (const EnsembleRow& row : solve_ensemble(scene, bodies, ensemble_settings(asked)))
            bytes.add(static_cast<long>(row.status)), bytes.add(static_cast<long>(row.moved)), bytes.add(row.end);
        kind.hash_of_scene.emplace_back(name, bytes.hash());
    }
    return kind;
}

Kind mechanism_ensembles(const Asked& asked) {
    Kind kind{"mechanism_ensemble", {}};
    for (const std::string_view name : scenes_of_mechanism_ensembles) {
        Scene scene = find_scene(std::string(name));
        scene.duration = std::min(scene.duration, 1.0);
        std::string text;
        for (const MechanismColumn& column : mechanism_columns(scene))
            if (column.name.ends_with(".rate")) text += (text.empty() ? "" : ",") + column.name;
        const long columns = std::ranges::count(text, ',') + 1;
        Random random;
        for (int i = 0; i < 35; ++i)
            for (long k = 0; k < columns; ++k) text += fmt::format("{}{}", k ? "," : "\n", random(-2, 2));
        Bytes bytes;
        const MechanismTable table = parse_ensemble(text + "\n", "random", scene, BadRows::pass_over).mechanisms;
        for (const MechanismRow& row : solve_mechanism_ensemble(scene, table, 4, ensemble_settings(asked))) {
            bytes.add(static_cast<long>(row.status));
            for (const Sample& sample : row.samples) bytes.add(sample);
        }
        kind.hash_of_scene.emplace_back(name, bytes.hash());
    }
    return kind;
}

/// The method taylor on the scenes of joints, most of which other methods do not support.
Kind joint_scenes() {
    Kind kind{"joint_scenes", {}};
    for (const std::string& name : builtin_scene_names()) {
        if (!name.starts_with("joints/")) continue;
        // formulas call functions of the C library
        if (has_joint_motions(find_scene(name))) continue;
        const Problem problem = pose(find_scene(name));
        Settings settings = bounded_settings(problem);
        settings.tolerance = 1e-6;
        Bytes bytes;
        bytes.add(solve(problem, *find_method("taylor"), settings));
        kind.hash_of_scene.emplace_back(name, bytes.hash());
    }
    return kind;
}

/// Methods with fixed steps that support limits and friction of joints, on the scenes of joints.
Kind joint_steps() {
    Kind kind{"joint_steps", {}};
    for (const std::string& name : builtin_scene_names()) {
        if (!name.starts_with("joints/") || has_joint_motions(find_scene(name))) continue;
        const Problem problem = pose(find_scene(name));
        Settings settings = bounded_settings(problem);
        settings.max_steps = 1000, settings.step = problem.scene.duration / 200;
        Bytes bytes;
        for (const char* method :
             {"sequential_impulses_10", "sequential_impulses_split_10_float32", "soft_step_4", "xpbd_joints_10",
              "xpbd_joints_1_float32", "mujoco_joints", "mujoco_joints_stiff", "bullet_joints"})
            bytes.add(solve(problem, *find_method(method), settings));
        kind.hash_of_scene.emplace_back(name, bytes.hash());
    }
    return kind;
}

/// Methods that record or compile formulas, on the scenes with formulas.
Kind formula_scenes() {
    Kind kind{"formula_scenes", {}};
    for (const std::string& name : builtin_scene_names()) {
        if (!name.starts_with("formulas/")) continue;
        const Problem problem = pose(find_scene(name));
        Bytes bytes;
        for (const char* method : {"taylor", "extrapolation", "dop853", "radau", "cvode_bdf", "odeint_rk4"}) {
            Settings settings = bounded_settings(problem);
            if (takes_step(*find_method(method)))
                settings.step = problem.scene.duration / 200;
            else
                settings.tolerance = 1e-6;
            bytes.add(solve(problem, *find_method(method), settings));
        }
        kind.hash_of_scene.emplace_back(name, bytes.hash());
    }
    return kind;
}

/// Values at random arguments of the C library functions that polhode calls in binary64.
Kind libm() {
    using Function = double (*)(double);
    constexpr Function functions[] = {std::sin,   std::cos,  std::tan,  std::atan, std::exp,
                                      std::expm1, std::cbrt, std::asin, std::acos};
    Random random;
    Bytes bytes;
    for (int i = 0; i < 20000; ++i) {
        const double x = random(-1, 1), y = random(0, 10);
        for (const Function function : functions) bytes.add(function(x)), bytes.add(function(10 * x));
        bytes.add(std::log(y)), bytes.add(std::log2(y)), bytes.add(std::pow(y, x)), bytes.add(std::atan2(x, y));
        bytes.add(std::hypot(x, y));
    }
    return {"libm", {{"", bytes.hash()}}};
}

/// The expected hashes: lines "NAME HASH", and "departs NAME" for methods that may differ where `libm` does.
struct Expected {
    std::map<std::string, std::string> hash_of;
    std::set<std::string> departing_with_libm;
};

Expected read_expected(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be read");
    Expected expected;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string name, value;
        if (!(words >> name >> value) || name.starts_with('#')) continue;
        if (name == "departs")
            expected.departing_with_libm.insert(value);
        else
            expected.hash_of[name] = value;
    }
    return expected;
}

/// Returns the number of kinds that differ from the expected hashes. Lists those missing in this build (GSL's).
int compare(const std::vector<Kind>& kinds, const Expected& expected) {
    int faults = 0, equal = 0, departed = 0;
    std::map<std::string, std::string> rest = expected.hash_of;
    const auto here = rest.extract("libm");
    const bool other_libm = !here || here.mapped() != libm().hash();
    if (other_libm)
        fmt::print(
            "the C library's functions have other last bits here; the methods listed under `departs` may differ\n");
    for (const Kind& kind : kinds) {
        const auto found = rest.extract(kind.name);
        const std::string wanted = found ? found.mapped() : "not in the list";
        if (wanted == kind.hash()) {
            ++equal;
        } else if (other_libm && expected.departing_with_libm.contains(kind.name)) {
            ++departed;
        } else {
            ++faults;
            fmt::print("{}: {}, expected {}\n", kind.name, kind.hash(), wanted);
        }
    }
    for (const auto& [name, hash] : rest) fmt::print("{} is not available in this build\n", name);
    fmt::print("{} equal, {} differ with the C library as listed, {} not equal\n", equal, departed, faults);
    return faults;
}

void print(const std::vector<Kind>& kinds, const Asked& asked) {
    std::string all;
    for (const Kind& kind : kinds) {
        for (const auto& [scene, hash] : kind.hash_of_scene)
            if (asked.each) fmt::print("{} {} {}\n", kind.name, scene, hash);
        if (!asked.each) fmt::print("{} {} {}\n", kind.name, kind.hash_of_scene.size(), kind.hash());
        all += kind.hash();
    }
    fmt::print("all {} {}\n", kinds.size(), content_hash(all));
}

int run(const Asked& asked) {
    // set before first use: the library reads these variables once
    if (!asked.instructions.empty()) ::setenv("POLHODE_INSTRUCTION_SET", asked.instructions.c_str(), 1);
    if (asked.interpreted) ::setenv("POLHODE_CODE", "interpreted", 1);
    if (!asked.instructions.empty() && asked.instructions != name_of(instruction_set())) {
        fmt::print(stderr, "this processor does not support {}; choose plain, avx2 or avx512\n", asked.instructions);
        return 3;
    }
    std::vector<Kind> kinds = trajectories(asked);
    if (asked.only_scene.empty() && asked.only_method.empty())
        kinds.push_back(ensembles(asked)), kinds.push_back(mechanism_ensembles(asked));
    if (asked.only_scene.empty() && (asked.only_method.empty() || asked.only_method == "joint_scenes"))
        kinds.push_back(joint_scenes()), kinds.push_back(joint_steps()), kinds.push_back(formula_scenes());
    if (asked.expected.empty()) {
        print(kinds, asked);
        fmt::print("libm 1 {}\n", libm().hash());
    }
    return asked.expected.empty() || compare(kinds, read_expected(asked.expected)) == 0 ? 0 : 1;
}

}  // namespace
}  // namespace polhode

int main(int argc, char** argv) try {
    polhode::Asked asked;
    CLI::App app("Prints hashes of all catalogue trajectories, one method per line: NAME SCENES HASH.");
    app.add_option("--threads", asked.threads, "Number of threads, at least 1")->check(CLI::PositiveNumber);
    app.add_option("--instructions", asked.instructions, "plain, avx2 or avx512 (default: the widest available)")
        ->check(CLI::IsMember({"plain", "avx2", "avx512"}));
    app.add_flag("--interpreted", asked.interpreted, "Interpret tapes instead of compiling them");
    app.add_option("--expect", asked.expected, "Compare with a file of lines NAME HASH; exit 1 if they differ");
    app.add_flag("--each", asked.each, "Print one line per method and scene: NAME SCENE HASH");
    app.add_option("--scene", asked.only_scene, "Hash only this scene, without ensembles");
    app.add_option("--method", asked.only_method, "Hash only this method, or joint_scenes, without ensembles");
    CLI11_PARSE(app, argc, argv);
    return polhode::run(asked);
} catch (const std::exception& error) {
    std::fprintf(stderr, "trajectory_hashes: %s\n", error.what());
    return 2;
}
