// Faults of a file's rows that do not depend on the scene.
#pragma once

#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"

namespace polhode {

/// Diagnoses rows that are not the states after each step: repeated states ("rows_repeated") and rows interpolated
/// between states ("rows_interpolated"). Predictions from row to row are meaningless for such files.
std::vector<Diagnosis> rows_between_steps(const TrajectoryFile& file);

/// Diagnoses quaternions that are not normalised. "quaternion_not_normalised": the length differs from 1 by more than
/// 1e-3 and grows as in first-order updates without normalisation. "quaternion_seldom_normalised": the length grows
/// by this law and returns to 1 in every n-th row, for at least three periods, and the growth in all other rows
/// agrees within 20 %. Any deviation above rounding is sufficient.
std::vector<Diagnosis> find_length_faults(const TrajectoryFile& file);

}  // namespace polhode
