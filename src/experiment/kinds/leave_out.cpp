// The kind `leave_out`: gain of the reduced formulation, from the same curve with all formulations.
#include <algorithm>
#include <cmath>
#include <utility>

#include "experiment/kinds/curves.h"
#include "experiment/kinds/kinds.h"
#include "experiment/kinds/sweep_tables.h"
#include "measure/statistics.h"
#include "motion/problem.h"

namespace polhode {
namespace {

struct Point {
    double setting, log_error, log_seconds;
};

std::vector<Point> points_of(const std::vector<Result>& results, const PlannedScene& scene, const PlannedCurve& curve,
                             Formulation formulation) {
    PlannedCurve same = curve;
    same.formulation = formulation;
    std::vector<Point> points;
    for (const Result* row : select_rows(results, scene, same))
        if (row->status == Status::ok && row->seconds_min && row->errors["attitude"].max.value_or(0) > 0)
            points.push_back({row->setting, std::log(*row->errors["attitude"].max), std::log(*row->seconds_min)});
    return points;
}

// Seconds at this error, by a least-squares line through log time over log error. The error is clamped to the range of
// the curve. If this range is smaller than a factor of three, returns the mean time.
std::optional<double> seconds_at(const std::vector<Point>& points, double log_error) {
    if (points.empty()) return {};
    std::vector<std::pair<double, double>> logs;
    for (const Point& p : points) logs.emplace_back(p.log_error, p.log_seconds);
    const Line line = least_squares_line(logs);
    const auto [low, high] = std::minmax_element(
        points.begin(), points.end(), [](const Point& a, const Point& b) { return a.log_error < b.log_error; });
    if (high->log_error - low->log_error < std::log(3.0)) return std::exp(line.y_mean);
    return std::exp(line.at(std::clamp(log_error, low->log_error, high->log_error)));
}

// geometric mean over the common settings of the ratio of errors
std::optional<double> error_ratio(const std::vector<Point>& of, const std::vector<Point>& to) {
    double sum = 0, count = 0;
    for (const Point& a : of)
        for (const Point& b : to)
            if (a.setting == b.setting) sum += a.log_error - b.log_error, count += 1;
    if (count == 0) return {};
    return std::exp(sum / count);
}

std::string omitted_variables(const Needs& needs) {
    std::string text;
    for (const Omission& one : needs.omitted) text += (text.empty() ? "" : "; ") + one.what;
    return text.empty() ? "nothing" : text;
}

}  // namespace

NamedTable gain_table(const Plan& plan, const std::vector<Result>& results) {
    NamedTable named = make_named_table("gain", "Gain of the reduced formulation",
                                        {{"scene", "scene"},
                                         {"method", "method"},
                                         {"setting_kind", "setting"},
                                         {"variables", "variables"},
                                         {"attitude_error", "attitude error (rad)"},
                                         {"seconds_as_written", "full (s)"},
                                         {"seconds_principal_frame", "full, principal frame (s)"},
                                         {"seconds_reduced", "reduced (s)"},
                                         {"gain", "gain"},
                                         {"error_ratio", "error at equal settings"},
                                         {"left_out", "omitted"}});
    for (const PlannedScene& scene : plan.scenes) {
        const Needs needs = pose(scene.scene).needs;
        for (const PlannedCurve& curve : plan.curves) {
            if (curve.formulation != Formulation::reduced) continue;
            const std::vector<Point> written = points_of(results, scene, curve, Formulation::full);
            const std::vector<Point> principal = points_of(results, scene, curve, Formulation::full_principal);
            const std::vector<Point> reduced = points_of(results, scene, curve, Formulation::reduced);
            std::vector<Cell> row{scene.label, std::string(curve.method->name), std::string(name_of(curve.kind)),
                                  long(needs.dimension)};
            std::optional<double> error, seconds[3], gain;
            if (!reduced.empty()) {
                const double log_error = reduced[reduced.size() / 2].log_error;
                error = std::exp(log_error);
                const std::vector<Point>* const curves[] = {&written, &principal, &reduced};
                for (int i = 0; i < 3; ++i) seconds[i] = seconds_at(*curves[i], log_error);
            }
            if (seconds[0] && seconds[2]) gain = *seconds[0] / *seconds[2];
            for (const auto& value : {error, seconds[0], seconds[1], seconds[2], gain, error_ratio(reduced, written)})
                row.push_back(cell_of(value));
            row.push_back(omitted_variables(needs));
            named.table.rows.push_back(std::move(row));
        }
    }
    return named;
}

Findings conclude_leave_out(const Plan& plan, const std::vector<Result>& rows) { return {{gain_table(plan, rows)}}; }

}  // namespace polhode
