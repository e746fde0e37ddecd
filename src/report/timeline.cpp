#include "report/timeline.h"

#include <algorithm>
#include <utility>

#include "body/mass_properties.h"
#include "body/orientation.h"

namespace polhode {
namespace {

constexpr std::size_t most_timeline_rows = 40, most_modes = 300, most_timeline_events = 400;

}  // namespace

std::optional<std::size_t> Timeline::row(const std::string& name, const std::string& unit) {
    const auto found = std::ranges::find(rows_, name, &Row::name);
    if (found != rows_.end()) return static_cast<std::size_t>(found - rows_.begin());
    if (rows_.size() == most_timeline_rows) return {};
    rows_.push_back({name, unit, {}});
    return rows_.size() - 1;
}

void Timeline::add_mode(std::size_t row, double from, double to, const std::string& mode) {
    std::vector<Mode>& modes = rows_[row].modes;
    if (!modes.empty() && modes.back().mode == mode && modes.back().to == from)
        modes.back().to = to;
    else if (modes.size() < most_modes)
        modes.push_back({from, to, mode});
}

void Timeline::add_event(double t, std::optional<std::size_t> row, const std::string& kind, double normal,
                         double tangential) {
    ++total_;
    if (!row || events_.size() == most_timeline_events) return;
    events_.push_back({{"t", number_json(t, 8)},
                       {"row", *row},
                       {"kind", kind},
                       {"normal", number_json(normal, 4)},
                       {"tangential", number_json(tangential, 4)}});
}

Json Timeline::json() const {
    if (rows_.empty()) return nullptr;
    Json rows = Json::array();
    for (const Row& row : rows_) {
        Json modes = Json::array();
        for (const Mode& mode : row.modes)
            modes.push_back(
                {{"from", number_json(mode.from, 8)}, {"to", number_json(mode.to, 8)}, {"mode", mode.mode}});
        rows.push_back({{"name", row.name}, {"unit", row.unit}, {"modes", std::move(modes)}});
    }
    return {{"rows", std::move(rows)}, {"events", events_}, {"total", total_}};
}

std::vector<double> times_of_reference(const Reference& truth) {
    std::vector<double> times;
    for (std::size_t i = 0; i < truth.samples.size(); i += static_cast<std::size_t>(truth.bodies))
        times.push_back(truth.samples[i].t);
    return times;
}

bool is_near_truth(const std::vector<std::vector<BodyMotion<double>>>& motions, const Reference& truth,
                   const Tolerance& tolerance) {
    const std::size_t bodies = static_cast<std::size_t>(truth.bodies);
    for (std::size_t k = 0; k < std::min(motions.size(), truth.moments()); ++k)
        for (std::size_t b = 0; b < bodies; ++b) {
            const Sample expected = truth.samples[k * bodies + b].rounded();
            const BodyMotion<double>& found = motions[k][b];
            const double angle = rotation_angle_between(normalized(found.q), expected.q);
            const double distance = length(found.position_W - expected.position_W);
            if (!(angle <= tolerance.angle && distance <= tolerance.length)) return false;
        }
    return true;
}

}  // namespace polhode
