// An experiment as a file that reads back to it.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "experiment/plan/experiment.h"
#include "experiment/run/findings.h"
#include "experiment/run/sweep.h"
#include "text/decimal.h"
#include "text/json_document.h"

namespace polhode {

inline std::string write_experiment(const Experiment& e) {
    const auto strings = [](const std::vector<std::string>& values) {
        std::string list;
        for (const std::string& value : values) list += (list.empty() ? "" : ", ") + json_string(value);
        return "[" + list + "]";
    };
    const auto numbers = [](const std::vector<double>& values) {
        std::string list;
        for (const double value : values) list += (list.empty() ? "" : ", ") + shortest_decimal(value);
        return "[" + list + "]";
    };
    std::string settings, vary;
    const auto list = [&](const char* key, const std::vector<double>& values) {
        if (!values.empty())
            settings += fmt::format("{}\"{}\": {}", settings.empty() ? "" : ", ", key, numbers(values));
    };
    list("steps", e.steps), list("tolerances", e.tolerances);
    list("evaluations_per_revolution", e.evaluations_per_revolution);
    const std::string evaluations = e.max_evaluations == Experiment().max_evaluations
                                        ? ""
                                        : fmt::format(", \"max_evaluations\": {}", e.max_evaluations);
    for (const Variation& variation : e.vary)
        vary += fmt::format("{}{}: [{}]", vary.empty() ? "" : ", ", json_string(variation.pointer),
                            fmt::join(variation.values, ", "));
    if (e.kind->make) {
        std::string text = fmt::format("{{\"name\": {}, \"about\": {}, \"kind\": \"{}\"", json_string(e.name),
                                       json_string(e.about), e.kind->name);
        for (const std::string_view key : e.kind->reads) {
            if (key == "scenes" && !e.scenes.empty()) text += ", \"scenes\": " + strings(e.scenes);
            if (key == "methods" && !e.methods.empty()) text += ", \"methods\": " + strings(e.methods);
            if (key == "settings" && !settings.empty()) text += ", \"settings\": {" + settings + "}";
            if (key == "repeats") text += fmt::format(", \"repeats\": {}", e.repeats);
            if (key == "samples") text += fmt::format(", \"samples\": {}", e.samples);
        }
        return text + "}";
    }
    return fmt::format(
        "{{\"name\": {}, \"about\": {}, \"kind\": \"{}\", \"scenes\": {}, \"methods\": {}, \"settings\": {{{}}}, "
        "\"vary\": {{{}}}, \"samples\": {}, \"repeats\": {}, \"seconds_per_run\": {}, \"max_steps\": {}{}}}",
        json_string(e.name), json_string(e.about), e.kind->name, strings(e.scenes), strings(e.methods), settings, vary,
        e.samples, e.repeats, shortest_decimal(e.seconds_per_run), e.max_steps, evaluations);
}

}  // namespace polhode
