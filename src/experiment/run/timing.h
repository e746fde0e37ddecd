// Wall clock of several methods in one run, taken in turn.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "integrators/method.h"

namespace polhode {

/// A method at one setting, about to be timed, and then its times.
struct TimedRun {
    const Problem* problem;
    const Method* method;
    Settings settings;
    double expected = 0;  ///< s, a first guess of one run's time

    std::vector<double> seconds{};  ///< one for each round it took part in
    std::string failure{};          ///< why it has no times
    bool limit_reached = false;     ///< it took longer than its limit
    double spent = 0;               ///< s, over all rounds, set-up included

    double minimum() const;
    double median() const;
};

/// Times all runs to their end state only, round by round, each once a round, so that whatever disturbs the machine
/// disturbs all alike. A run below 0.1 ms is repeated inside one timing until it
/// is above.
void time_interleaved(std::vector<TimedRun>& runs, int rounds, const std::atomic<bool>& stop);

}  // namespace polhode
