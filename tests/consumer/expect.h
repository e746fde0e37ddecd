// Checks of the parts of this program.
#pragma once

#include <polhode/polhode.h>

/// Prints the value and its limit. Counts a fault if the value is not below the limit, or is NaN.
void expect_below(const char* what, double value, double limit);

/// Counts a fault unless `holds`.
void expect(const char* what, bool holds);

/// Counts a fault, and prints the reason, unless the run completed.
void expect_ok(const char* what, const polhode::Trajectory& trajectory);

/// The number of faults.
int faults();
