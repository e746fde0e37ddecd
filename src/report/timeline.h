// Modes and events of contacts and joints over time, for the mode strip of the page.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "motion/trajectory.h"
#include "report/json_numbers.h"
#include "report/keyframes.h"

namespace polhode {

/// Collects the rows of Timeline of src/report/page/source/data.ts. Limits rows, modes and events, so that scenes with
/// thousands of events remain small.
class Timeline {
  public:
    /// The row with this name, which is added if it is new; none if there are too many. `unit`: of its impulses.
    std::optional<std::size_t> row(const std::string& name, const std::string& unit);
    /// Appends a mode to a row. A mode that continues the last one extends it.
    void add_mode(std::size_t row, double from, double to, const std::string& mode);
    /// Appends an event, with the normal impulse and the size of the tangential impulse (0 if there is none).
    void add_event(double t, std::optional<std::size_t> row, const std::string& kind, double normal, double tangential);
    /// The timeline; null without rows.
    Json json() const;

  private:
    struct Mode {
        double from = 0, to = 0;
        std::string mode;
    };
    struct Row {
        std::string name, unit;
        std::vector<Mode> modes;
    };
    std::vector<Row> rows_;
    Json events_ = Json::array();
    std::size_t total_ = 0;
};

/// The sample times of a reference, s.
std::vector<double> times_of_reference(const Reference& truth);

/// Whether motions of all bodies, by sample, are within the tolerance of the first samples of the truth.
bool is_near_truth(const std::vector<std::vector<BodyMotion<double>>>& motions, const Reference& truth,
                   const Tolerance& tolerance);

}  // namespace polhode
