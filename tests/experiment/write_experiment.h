// Writes an experiment as JSON that parse_experiment() reads back.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "experiment/plan/experiment.h"

namespace polhode {

inline std::string write_experiment(const Experiment& e) {
    using nlohmann::ordered_json;
    ordered_json settings = ordered_json::object(), vary = ordered_json::object();
    if (!e.steps.empty()) settings["steps"] = e.steps;
    if (!e.tolerances.empty()) settings["tolerances"] = e.tolerances;
    if (!e.evaluations_per_revolution.empty()) settings["evaluations_per_revolution"] = e.evaluations_per_revolution;
    for (const Variation& variation : e.vary)
        for (const std::string& value : variation.values) vary[variation.pointer].push_back(ordered_json::parse(value));
    ordered_json file{{"name", e.name}, {"about", e.about}, {"kind", e.kind->name}};
    for (const std::string_view key : e.kind->reads) {
        if (key == "scenes" && !e.scenes.empty()) file[key] = e.scenes;
        if (key == "methods" && !e.methods.empty()) file[key] = e.methods;
        if (key == "settings" && !settings.empty()) file[key] = settings;
        if (key == "vary" && !vary.empty()) file[key] = vary;
        if (key == "samples") file[key] = e.samples;
        if (key == "repeats") file[key] = e.repeats;
        if (key == "seconds_per_run") file[key] = e.seconds_per_run;
        if (key == "max_steps") file[key] = e.max_steps;
        if (key == "max_evaluations" && e.max_evaluations != Experiment().max_evaluations)
            file[key] = e.max_evaluations;
    }
    return file.dump();
}

}  // namespace polhode
