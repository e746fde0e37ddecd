// Wall clock times of several methods, measured in turn.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// A method at one setting, and its measured times.
struct TimedRun {
    const Problem* problem;
    const Method* method;
    Settings settings;
    double expected = 0;  ///< s, estimated time of one run

    std::vector<double> seconds{};  ///< one time per round
    std::string failure{};          ///< the message of a failed run; empty if none failed
    bool limit_reached = false;     ///< a run exceeded its limit
    double spent = 0;               ///< s, total over all rounds, with set-up

    double minimum() const;
    double median() const;
};

/// Times all runs, without recording samples. Each round times every run once, so that disturbances of the machine
/// affect all runs alike. A run shorter than 0.1 ms is repeated within one timing.
void time_interleaved(std::vector<TimedRun>& runs, int rounds, const std::atomic<bool>& stop);

}  // namespace polhode
