#include "experiment/kinds/engine_standing.h"

#include <fmt/format.h>

#include <numeric>

#include "measure/statistics.h"

namespace polhode {
namespace {

// the message without the engine's name: "cannon_es: it does not support universal joints"
std::string find_reason(const Result& row) {
    const std::size_t colon = row.message.find(": ");
    return colon == std::string::npos ? row.message : row.message.substr(colon + 2);
}

}  // namespace

EngineStanding inspect_curve(const PlannedCurve& curve) {
    EngineStanding standing;
    standing.curve = &curve, standing.engine = engine_of(*curve.method);
    if (!standing.engine) return standing;
    standing.report = standing.engine->inspect(nullptr);
    for (const auto& [name, what] : standing.report.hello.settings)
        if (name == standing.engine->setting) standing.setting_description = what;
    return standing;
}

bool has_rows(const PlannedCurve& curve, const std::vector<Result>& rows) {
    return std::ranges::any_of(rows, [&](const Result& row) { return row.method == curve.method->name; });
}

void set_places(EngineStanding& standing, const std::vector<double>& places) {
    if (places.empty()) return;
    standing.median_place = median(places);
    standing.mean_place = std::accumulate(places.begin(), places.end(), 0.0) / static_cast<double>(places.size());
}

void add_incomplete(EngineStanding& standing, const Result& row, const std::string& scene) {
    if (row.status == Status::unsupported)
        gather(standing.refused, find_reason(row));
    else if (row.status != Status::ok)
        standing.lost.push_back(scene);
}

std::optional<double> largest_error(const Result& row, const char* measure) {
    return row.status == Status::ok ? row.errors[measure].max : std::nullopt;
}

void gather(std::vector<double>& values, const std::optional<double>& value) {
    if (value) values.push_back(*value);
}
void gather(std::vector<std::string>& words, const std::string& word) {
    if (std::ranges::find(words, word) == words.end()) words.push_back(word);
}

std::string listed_words(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

std::string format_amount(const std::optional<double>& value, const char* unit) {
    return value ? fmt::format("{:.2g}{}", *value, unit) : "not measured";
}

std::string describe_incomplete(const EngineStanding& standing) {
    std::string text;
    if (!standing.refused.empty()) text += " Reasons for unsupported scenes: " + listed_words(standing.refused) + ".";
    if (!standing.lost.empty())
        text += " Not completed at " + step_name(default_engine_step) + ": " + listed_words(standing.lost) + ".";
    return text;
}

std::string engine_heading(const EngineStanding& first) {
    const std::string& version = first.report.hello.version;
    std::string text = fmt::format("### {}{}{}\n\n", first.engine->engine, version.empty() ? "" : " ", version);
    if (!first.is_available()) text += fmt::format("Not compared: {}.\n", first.report.fault);
    return text;
}

std::string setting_heading(const EngineStanding& standing) {
    return fmt::format("- `{}`{}: place {}.", standing.engine->setting,
                       standing.setting_description.empty() ? "" : " (" + standing.setting_description + ")",
                       standing.place);
}

}  // namespace polhode
