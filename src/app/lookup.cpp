#include "app/lookup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "app/commands.h"
#include "integrators/engines/engine_methods.h"
#include "scene/scene_file.h"
#include "scene/scene_limits.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

// Names of schemes in other libraries, and the nearest methods of polhode.
constexpr std::pair<std::string_view, std::string_view> elsewhere[] = {
    {"rk45", "odeint_dopri5, or dop853 of higher order"},
    {"RK45", "odeint_dopri5, or dop853 of higher order"},
    {"ode45", "odeint_dopri5, or dop853 of higher order"},
    {"dopri", "odeint_dopri5, or dop853 of higher order"},
    {"dopri5", "odeint_dopri5, or dop853 of higher order"},
    {"dop", "dop853"},
    {"DOP853", "dop853"},
    {"rk23", "arkode_erk3"},
    {"rk4", "odeint_rk4"},
    {"RK4", "odeint_rk4"},
    {"runge_kutta", "odeint_rk4, or dop853 with a tolerance"},
    {"rkf45", "odeint_cash_karp54"},
    {"rkf78", "odeint_fehlberg78"},
    {"euler", "odeint_euler, or gyroscopic_explicit as in game engines"},
    {"semi_implicit_euler", "gyroscopic_explicit, or article_mended"},
    {"symplectic_euler", "gyroscopic_explicit, or article_mended"},
    {"verlet", "splitting2"},
    {"leapfrog", "splitting2"},
    {"midpoint", "implicit_midpoint"},
    {"bdf", "cvode_bdf"},
    {"BDF", "cvode_bdf"},
    {"adams", "cvode_adams"},
    {"lsoda", "cvode, which uses BDF for stiff motion and Adams methods otherwise"},
    {"LSODA", "cvode, which uses BDF for stiff motion and Adams methods otherwise"},
    {"radauIIA", "radau"},
    {"Radau", "radau"},
};

}  // namespace

void add_engines_option(CLI::App& command) {
    command
        .add_option("--engines",
                    "JSON file of further engines (see integrators/engines/README.md), named ENGINE:SETTING")
        ->each([](const std::string& path) { add_engines(path); });
}

void add_outside_option(CLI::App& command) {
    command.add_flag_callback(
        "--allow-outside", [] { allow_outside_files(true); },
        "Allow scene and experiment files to name files outside their directories");
}

void require_states(const Scene& scene, long samples) {
    const long bodies = static_cast<long>(body_count(scene));
    if (samples > most_states / bodies)
        throw UsageError(fmt::format("--samples is {}; give at most {} for a scene of {} {}", samples,
                                     most_states / bodies, bodies, bodies == 1 ? "body" : "bodies"));
}

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const Method* method : methods()) names.emplace_back(method->name);
    for (const EngineMethod& engine : engines()) names.emplace_back(engine.method->name);
    return names;
}

const Method& method_named(const std::string& name) {
    if (const Method* method = find_method(name)) return *method;
    if (const EngineMethod* engine = find_engine(name)) return *engine->method;
    for (const OmittedMethod& method : omitted_methods())
        if (method.name == name)
            throw UsageError(fmt::format("there is no method {0}; polhode describe {0} prints why", name));
    std::string meant = did_you_mean(name, method_names());
    if (meant.empty())
        for (const auto& [known_as, here] : elsewhere)
            if (name == known_as) meant = fmt::format("the nearest in polhode: {}", here);
    throw UsageError(
        fmt::format("there is no method {}; {}", name, meant.empty() ? "see polhode list methods" : meant));
}

Scene read_scene_with_notes(const std::string& name_or_path) {
    Scene scene = find_scene(name_or_path);
    std::vector<std::string> kinds;
    for (const std::string& phrase : scene.omitted) kinds.push_back(phrase.substr(0, phrase.find(": ")));
    if (!kinds.empty())
        std::fputs(fmt::format("polhode: note: the robot file of {} has constructs that are not modelled: {}; "
                               "`polhode describe` lists them\n",
                               one_line(scene.name, 60), one_line(join_with_commas(kinds), 600))
                       .c_str(),
                   stderr);
    return scene;
}

}  // namespace polhode
