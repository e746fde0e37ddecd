#include "check/report.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

using nlohmann::ordered_json;

const char* verdict(const ErrorLimits& limits, const CheckedFile& checked) {
    return limits.report_only ? "reported" : limits.refuses(checked.file_errors) ? "failed" : "passed";
}

const char* verdict(const ErrorLimits& limits, const BlockVerdict& block) {
    return !block.error ? "not in the file" : limits.report_only ? "reported" : block.failed ? "failed" : "passed";
}

// Indices of the measures that are reported over time.
std::vector<std::size_t> measures_over_time(const FileErrors& file_errors) {
    std::vector<std::size_t> reported;
    for (std::size_t m = 0; m < measures().size(); ++m)
        if (measures()[m].over_time && file_errors[m]) reported.push_back(m);
    return reported;
}

// Formats a limit: "0.05 rad" or "5 %".
std::string format_limit(const BlockVerdict& v) {
    if (v.limit.relative) return fmt::format("{} %", shortest_decimal(100 * v.limit.value));
    return fmt::format("{} {}", shortest_decimal(v.limit.value), v.block->unit);
}

// Describes the blocks that exceed their limits, or the attitude error if there is none.
std::string summarize(const ErrorLimits& limits, const CheckedFile& c) {
    std::string text;
    for (const BlockVerdict& v : limits.verdicts(c.file_errors)) {
        if (!v.failed || limits.report_only) continue;
        const ErrorSummary& error = *c.file_errors[v.block->measure];
        text += fmt::format("{}{} error {:.3g}{}{} at t = {} s exceeds the limit of {} ({})", text.empty() ? "" : "; ",
                            v.block->title, v.limit.relative && v.relative ? 100 * *v.relative : *v.error,
                            v.limit.relative ? " %" : " ", v.limit.relative ? "" : v.block->unit,
                            shortest_decimal(error.max_time), format_limit(v), v.limit.from);
    }
    if (!text.empty()) return text;
    return fmt::format("largest attitude error {:.3g} rad at t = {} s", c.file_errors["attitude"]->max,
                       shortest_decimal(c.file_errors["attitude"]->max_time));
}

std::string verdicts(const ErrorLimits& limits, const CheckedFile& c) {
    std::string text = fmt::format("  {:<18}{:>10}{:>7}{:>11}{:>10}{:>12}{:>12}   {}\n", "block", "largest", "",
                                   "relative", "at t (s)", "final", "limit", "verdict");
    for (const BlockVerdict& v : limits.verdicts(c.file_errors)) {
        const std::optional<ErrorSummary>& error = c.file_errors[v.block->measure];
        // the summary is in the measure's unit, the verdict in the block's
        const double unit = error && error->max > 0 ? *v.error / error->max : 1;
        const std::string& worst = v.block->name == "joint_gap"    ? c.file_errors.worst_gap
                                   : v.block->name == "joint_turn" ? c.file_errors.worst_turn
                                                                   : std::string();
        text += fmt::format("  {:<18}{:>10}{:>7}{:>11}{:>10}{:>12}{:>12}   {}{}\n", v.block->title,
                            v.error ? fmt::format("{:.2e}", *v.error) : "-", v.error ? v.block->unit : "",
                            v.relative ? fmt::format("{:.2e}", *v.relative) : "-",
                            error ? fmt::format("{:.5g}", error->max_time) : "",
                            error ? fmt::format("{:.2e}", unit * error->final) : "", format_limit(v),
                            verdict(limits, v), worst.empty() ? "" : ", at joint " + one_line(worst, 100));
    }
    const auto line = [&](const char* title, double value, const char* unit) {
        text += fmt::format("  {:<18}{:>10.2e}{:>7}\n", title, value, unit);
    };
    if (const auto& norm = c.file_errors["norm"]) line("norm error of q", norm->max, "");
    if (const auto& p = c.file_errors["linear_momentum"]) line("linear momentum", p->max, "");
    if (!c.file_errors.worst_body.empty())
        text +=
            fmt::format("  {:<18}{} (largest attitude error)\n", "worst body", one_line(c.file_errors.worst_body, 100));
    if (c.floor) line("float64 floor", c.floor->float64, "rad"), line("float32 floor", c.floor->float32, "rad");
    line("truth bound", c.truth_bound, "");
    return text;
}

std::string over_time(const CheckedFile& c) {
    const FileErrors& j = c.file_errors;
    std::string text = "  largest up to t";
    for (const std::size_t m : measures_over_time(j)) text += fmt::format("{:>11}", measures()[m].name);
    if (!c.floor_over_time.empty()) text += "   float64 and float32 floor";
    text += '\n';
    for (std::size_t k = 0; k < j.over_time.size(); ++k) {
        text += fmt::format("  {:>15.6g}", j.over_time[k].until);
        for (const std::size_t m : measures_over_time(j)) text += fmt::format("  {:9.2e}", j.over_time[k].error[m]);
        if (k < c.floor_over_time.size())
            text += fmt::format("     {:8.1e}    {:8.1e}", c.floor_over_time[k].float64, c.floor_over_time[k].float32);
        text += '\n';
    }
    return text;
}

std::string text_of(const ErrorLimits& limits, const CheckedFile& c) {
    std::string report = fmt::format("{}: {}: {}\n", one_line(c.path, 300), verdict(limits, c), summarize(limits, c));
    report +=
        fmt::format("  {} samples, t = {} to {} s\n", c.samples, shortest_decimal(c.from), shortest_decimal(c.until));
    report += verdicts(limits, c);
    if (c.file_errors.over_time.size() > 1) report += over_time(c);
    for (const std::string& remark : c.remarks) report += fmt::format("  remark: {}\n", remark);
    if (!c.missing_blocks.empty()) report += fmt::format("  not in the file and not evaluated: {}\n", c.missing_blocks);
    for (const Diagnosis& d : c.diagnosis.faults) report += fmt::format("  diagnosis: {}\n", d.message);
    if (c.diagnosis.update) report += fmt::format("  update: {}\n", c.diagnosis.update->message);
    return report;
}

// JSON cannot represent non-finite numbers.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }
ordered_json number(const std::optional<double>& value) { return value ? number(*value) : ordered_json(nullptr); }

// Adds the largest and final error of each measure, and the worst body and joints.
void add_errors_json(const CheckedFile& c, ordered_json& file) {
    for (std::size_t m = 0; m < measures().size(); ++m) {
        const std::optional<ErrorSummary>& error = c.file_errors[m];
        if (!measures()[m].of_one_body && !error) continue;
        const auto put = [&](const char* what, double ErrorSummary::*member) {
            file[fmt::format("{}{}_{}", measures()[m].name, measures()[m].suffix, what)] =
                error ? number((*error).*member) : ordered_json(nullptr);
        };
        put("max", &ErrorSummary::max), put("max_time", &ErrorSummary::max_time), put("final", &ErrorSummary::final);
    }
    const auto name = [&](const char* key, const std::string& worst) {
        if (!worst.empty()) file[key] = worst;
    };
    name("worst_body", c.file_errors.worst_body), name("joint_gap_worst", c.file_errors.worst_gap);
    name("joint_turn_worst", c.file_errors.worst_turn);
}

ordered_json over_time_json(const CheckedFile& c) {
    ordered_json rows = ordered_json::array();
    // measures that every file has come first
    std::vector<std::size_t> reported = measures_over_time(c.file_errors);
    std::stable_partition(reported.begin(), reported.end(),
                          [](std::size_t m) { return (measures()[m].needs & ~known_truth) == 0; });
    for (std::size_t k = 0; k < c.file_errors.over_time.size(); ++k) {
        const ErrorSpan& span = c.file_errors.over_time[k];
        ordered_json& row = rows.emplace_back(ordered_json{{"until", number(span.until)}});
        for (const std::size_t m : reported)
            row[fmt::format("{}{}", measures()[m].name, measures()[m].suffix)] = number(span.error[m]);
        if (k < c.floor_over_time.size()) {
            row["float64_floor"] = number(c.floor_over_time[k].float64);
            row["float32_floor"] = number(c.floor_over_time[k].float32);
        }
    }
    return rows;
}

void add_diagnosis_json(const CheckedFile& c, ordered_json& file) {
    file["diagnoses"] = ordered_json::array();
    for (const Diagnosis& d : c.diagnosis.faults)
        file["diagnoses"].push_back(
            {{"fault", d.fault},
             {"message", d.message},
             {"convention", d.convention.empty() ? ordered_json(nullptr) : ordered_json(d.convention)},
             {"error", number(d.error)},
             {"explained", number(d.explained)}});
    for (const TestedHypothesis& t : c.diagnosis.hypotheses)
        file["tried"].push_back({{"fault", t.fault}, {"what", t.what}, {"decades", number(t.decades)}});
    file["update"] = nullptr;
    if (const std::optional<UpdateMatch>& u = c.diagnosis.update)
        file["update"] = {{"method", u->method},
                          {"step", number(u->step)},
                          {"distance", number(u->distance)},
                          {"error", number(u->error)},
                          {"matches", u->matches},
                          {"left_at", u->departure_time ? number(*u->departure_time) : ordered_json(nullptr)},
                          {"message", u->message}};
}

ordered_json json_of(const ErrorLimits& limits, const CheckedFile& c) {
    ordered_json file{{"file", one_line(c.path, 4096)}, {"verdict", verdict(limits, c)}, {"samples", c.samples}};
    file["from"] = number(c.from), file["until"] = number(c.until);
    add_errors_json(c, file);
    for (const BlockVerdict& v : limits.verdicts(c.file_errors))
        file["blocks"][std::string(v.block->name)] = {
            {"verdict", verdict(limits, v)},  {"error", number(v.error)},           {"relative", number(v.relative)},
            {"limit", number(v.limit.value)}, {"limit_relative", v.limit.relative}, {"limit_from", v.limit.from}};
    file["not_in_the_file"] = c.missing_blocks;
    file["truth_bound"] = number(c.truth_bound), file["truth"] = c.truth;
    file["float64_floor"] = c.floor ? number(c.floor->float64) : nullptr;
    file["float32_floor"] = c.floor ? number(c.floor->float32) : nullptr;
    file["float_judged_until"] = number(c.float32_valid_until);
    file["over_time"] = over_time_json(c);
    file["remarks"] = c.remarks;
    add_diagnosis_json(c, file);
    return file;
}

// Indents by two spaces per level.
class Printer : public tinyxml2::XMLPrinter {
  protected:
    void PrintSpace(int depth) override {
        for (int i = 0; i < depth; ++i) Write("  ");
    }
};

}  // namespace

std::string check_text(const ErrorLimits& limits, const std::vector<CheckedFile>& all) {
    std::string report;
    for (const CheckedFile& c : all) report += text_of(limits, c);
    return report;
}

std::string explanation_text(const std::vector<CheckedFile>& all) {
    std::string text;
    for (const CheckedFile& c : all) {
        text += fmt::format(
            "{}: hypotheses tested, each with the sum over all questions of log10(relative prediction error)\n",
            one_line(c.path, 300));
        if (c.diagnosis.hypotheses.empty())
            text +=
                "  none: the file is within 1e-4 of the reference, or a known update predicts it to the precision of "
                "its numbers\n";
        else
            text += fmt::format("  {:8.2f}  no fault; best update: {}\n", c.diagnosis.sound, c.diagnosis.rule);
        for (const TestedHypothesis& t : c.diagnosis.hypotheses)
            text += fmt::format("  {:8.2f}  {}: {}\n", t.decades, t.fault, t.what);
    }
    return text;
}

std::string check_json(const Scene& scene, const ErrorLimits& limits, const std::vector<CheckedFile>& all) {
    ordered_json report{{"scene", scene.name}};
    report["max_attitude"] = limits.report_only ? ordered_json(nullptr) : number(limits["attitude"].value);
    report["trajectories"] = ordered_json::array();
    for (const CheckedFile& c : all) report["trajectories"].push_back(json_of(limits, c));
    return report.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string check_junit(const Scene& scene, const ErrorLimits& limits, const std::vector<CheckedFile>& all) {
    const std::string suite = one_line("polhode check " + scene.name, 4096);
    const auto fails = [&](const CheckedFile& c) { return limits.refuses(c.file_errors); };
    const auto failures = std::count_if(all.begin(), all.end(), fails);
    Printer xml;
    const auto open = [&](const char* element) {
        xml.OpenElement(element);
        if (std::string_view(element) == "testsuite") xml.PushAttribute("name", suite.c_str());
        xml.PushAttribute("tests", std::to_string(all.size()).c_str());
        xml.PushAttribute("failures", std::to_string(failures).c_str());
    };
    xml.PushDeclaration("xml version=\"1.0\" encoding=\"UTF-8\"");
    open("testsuites");
    open("testsuite");
    for (const CheckedFile& c : all) {
        xml.OpenElement("testcase");
        xml.PushAttribute("classname", suite.c_str());
        xml.PushAttribute("name", one_line(c.path, 4096).c_str());
        if (fails(c)) {
            std::string causes;
            for (const Diagnosis& d : c.diagnosis.faults) causes += d.message + '\n';
            xml.OpenElement("failure");
            xml.PushAttribute("message", one_line(summarize(limits, c), 4096).c_str());
            xml.PushText(causes.c_str());
            xml.CloseElement();
        }
        xml.OpenElement("system-out");
        xml.PushText(text_of(limits, c).c_str());
        xml.CloseElement();
        xml.CloseElement();
    }
    xml.CloseElement();
    xml.CloseElement();
    return xml.CStr();
}

}  // namespace polhode
