// What the parts of this program are held to.
#pragma once

#include <polhode/polhode.h>

/// Prints the value beside its limit; a value that is not below it, or not a number, is a fault.
void expect_below(const char* what, double value, double limit);

/// A fault unless `holds`.
void expect(const char* what, bool holds);

/// A fault, with the reason, unless the run reached its end.
void expect_ok(const char* what, const polhode::Trajectory& trajectory);

/// How many faults there were.
int faults();
