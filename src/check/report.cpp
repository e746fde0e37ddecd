#include "check/report.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

const char* verdict(const AttitudeLimit& limit, const CheckedFile& checked) {
    return !limit.attitude ? "reported" : limit.exceeded_by(checked) ? "failed" : "passed";
}

// "angular velocity, relative"
std::string title_of(const Measure& measure) {
    return fmt::format("{}{}{}", measure.title, measure.unit.empty() ? "" : ", ", measure.unit);
}

// the measures whose growth is told
std::vector<std::size_t> told_over_time(const Judgement& judgement) {
    std::vector<std::size_t> told;
    for (std::size_t m = 0; m < measures().size(); ++m)
        if (measures()[m].over_time && judgement[m]) told.push_back(m);
    return told;
}

std::string sentence(const AttitudeLimit& limit, const CheckedFile& c) {
    std::string text = fmt::format("attitude error at most {:.3g} rad, at t = {} s", c.judgement["attitude"]->max,
                                   shortest_decimal(c.judgement["attitude"]->max_time));
    if (limit.attitude)
        text += fmt::format("; {}{} rad allowed ({})", limit.exceeded_by(c) ? "more than the " : "",
                            shortest_decimal(*limit.attitude), limit.from);
    return text;
}

std::string over_time(const CheckedFile& c) {
    const Judgement& j = c.judgement;
    std::string text = "  largest up to t";
    for (const std::size_t m : told_over_time(j)) text += fmt::format("{:>11}", measures()[m].name);
    if (!c.floor_over_time.empty()) text += "   float64 and float32 floor";
    text += '\n';
    for (std::size_t k = 0; k < j.over_time.size(); ++k) {
        text += fmt::format("  {:>15.6g}", j.over_time[k].until);
        for (const std::size_t m : told_over_time(j)) text += fmt::format("  {:9.2e}", j.over_time[k].error[m]);
        if (k < c.floor_over_time.size())
            text += fmt::format("     {:8.1e}    {:8.1e}", c.floor_over_time[k].float64, c.floor_over_time[k].float32);
        text += '\n';
    }
    return text;
}

std::string text_of(const AttitudeLimit& limit, const CheckedFile& c) {
    std::string report = fmt::format("{}: {}: {}\n", one_line(c.path, 300), verdict(limit, c), sentence(limit, c));
    report +=
        fmt::format("  {} samples, t = {} to {} s\n", c.samples, shortest_decimal(c.from), shortest_decimal(c.until));
    report += fmt::format("  {:<28}{:>10}  {:>14}  {:>10}\n", "error", "worst", "at t, s", "final");
    for (std::size_t m = 0; m < measures().size(); ++m) {
        const std::optional<ErrorSummary>& error = c.judgement[m];
        const std::string title = title_of(measures()[m]);
        report += error ? fmt::format("  {:<28}{:>10.3e}  {:>14.8g}  {:>10.3e}\n", title, error->max, error->max_time,
                                      error->final)
                        : fmt::format("  {:<28}{:>10}\n", title, "-");
    }
    if (c.floor)
        report += fmt::format("  {:<28}{:>10.2e}\n  {:<28}{:>10.2e}\n", "float64 floor, rad", c.floor->float64,
                              "float32 floor, rad", c.floor->float32);
    report += fmt::format("  {:<28}{:>10.2e}\n", "bound of the truth", c.truth_bound);
    if (c.judgement.over_time.size() > 1) report += over_time(c);
    for (const std::string& remark : c.remarks) report += fmt::format("  remark: {}\n", remark);
    for (const Diagnosis& d : c.diagnoses) report += fmt::format("  diagnosis: {}\n", d.message);
    return report;
}

// JSON has no word for what is not finite
std::string number(double value) { return std::isfinite(value) ? shortest_decimal(value) : "null"; }

// two blanks a level
class Printer : public tinyxml2::XMLPrinter {
  protected:
    void PrintSpace(int depth) override {
        for (int i = 0; i < depth; ++i) Write("  ");
    }
};

}  // namespace

std::string check_text(const AttitudeLimit& limit, const std::vector<CheckedFile>& all) {
    std::string report;
    for (const CheckedFile& c : all) report += text_of(limit, c);
    return report;
}

std::string check_json(const Scene& scene, const AttitudeLimit& limit, const std::vector<CheckedFile>& all) {
    std::string report = fmt::format("{{\"scene\": {}, \"max_attitude\": {}, \"trajectories\": [",
                                     json_string(scene.name), limit.attitude ? number(*limit.attitude) : "null");
    for (const CheckedFile& c : all) {
        report += fmt::format("{}\n  {{\"file\": {}, \"verdict\": \"{}\", \"samples\": {}, \"from\": {}, \"until\": {}",
                              &c == &all.front() ? "" : ",", json_string(one_line(c.path, 4096)), verdict(limit, c),
                              c.samples, number(c.from), number(c.until));
        for (std::size_t m = 0; m < measures().size(); ++m) {
            const std::optional<ErrorSummary>& error = c.judgement[m];
            const auto put = [&](const char* what, double ErrorSummary::*member) {
                report += fmt::format(", \"{}_error_{}\": {}", measures()[m].name, what,
                                      error ? number((*error).*member) : "null");
            };
            put("max", &ErrorSummary::max), put("max_time", &ErrorSummary::max_time),
                put("final", &ErrorSummary::final);
        }
        report += fmt::format(", \"truth_bound\": {}, \"truth\": {}", number(c.truth_bound), json_string(c.truth));
        report += fmt::format(", \"float64_floor\": {}, \"float32_floor\": {}, \"float_judged_until\": {}",
                              c.floor ? number(c.floor->float64) : "null", c.floor ? number(c.floor->float32) : "null",
                              c.float_judged_until ? number(*c.float_judged_until) : "null");
        report += ",\n   \"over_time\": [";
        // what every file tells comes first
        std::vector<std::size_t> told = told_over_time(c.judgement);
        std::stable_partition(told.begin(), told.end(),
                              [](std::size_t m) { return (measures()[m].needs & ~known_truth) == 0; });
        for (std::size_t k = 0; k < c.judgement.over_time.size(); ++k) {
            const ErrorSpan& span = c.judgement.over_time[k];
            report += fmt::format("{}{{\"until\": {}", k == 0 ? "" : ", ", number(span.until));
            for (const std::size_t m : told)
                report += fmt::format(", \"{}_error\": {}", measures()[m].name, number(span.error[m]));
            if (k < c.floor_over_time.size())
                report += fmt::format(", \"float64_floor\": {}, \"float32_floor\": {}",
                                      number(c.floor_over_time[k].float64), number(c.floor_over_time[k].float32));
            report += '}';
        }
        report += "],\n   \"remarks\": [";
        for (const std::string& remark : c.remarks)
            report.append(&remark == &c.remarks.front() ? "" : ", ").append(json_string(remark));
        report += "],\n   \"diagnoses\": [";
        for (const Diagnosis& d : c.diagnoses)
            report += fmt::format(
                "{}\n    {{\"fault\": {}, \"message\": {}, \"convention\": {}, \"error\": {}, "
                "\"explained\": {}}}",
                &d == &c.diagnoses.front() ? "" : ",", json_string(d.fault), json_string(d.message),
                d.convention.empty() ? "null" : json_string(d.convention), number(d.error), number(d.explained));
        report += "]}";
    }
    return report + "\n]}\n";
}

std::string check_junit(const Scene& scene, const AttitudeLimit& limit, const std::vector<CheckedFile>& all) {
    const std::string suite = one_line("polhode check " + scene.name, 4096);
    const auto failures =
        std::count_if(all.begin(), all.end(), [&](const CheckedFile& c) { return limit.exceeded_by(c); });
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
        if (limit.exceeded_by(c)) {
            std::string causes;
            for (const Diagnosis& d : c.diagnoses) causes += d.message + '\n';
            xml.OpenElement("failure");
            xml.PushAttribute("message", one_line(sentence(limit, c), 4096).c_str());
            xml.PushText(causes.c_str());
            xml.CloseElement();
        }
        xml.OpenElement("system-out");
        xml.PushText(text_of(limit, c).c_str());
        xml.CloseElement();
        xml.CloseElement();
    }
    xml.CloseElement();
    xml.CloseElement();
    return xml.CStr();
}

}  // namespace polhode
