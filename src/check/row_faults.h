// What is wrong with a file's rows, whatever it is that moves.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"

namespace polhode {

/// Rows that are no states of an engine, one after each step: states shown twice and more ("rows_repeated"), rows in
/// between two states, two a step and more ("rows_interpolated"). Predictions from one row to the next mean nothing
/// there.
std::vector<Diagnosis> rows_between_steps(const TrajectoryFile& file);

/// Quaternions whose length leaves 1 by more than 1e-3, and grows as that of first-order updates that are not
/// normalised
/// ("quaternion_not_normalised"), which scales what is turned by them. Quaternions whose length grows by the same law
/// and returns to 1 in every n-th row ("quaternion_seldom_normalised"), by any deviation that rounding does not hide:
/// at least three such periods, each other row within a fifth of the same growth.
std::vector<Diagnosis> lengths_of_quaternions(const TrajectoryFile& file);

}  // namespace polhode
