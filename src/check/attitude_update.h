// How an attitude goes on with an angular velocity: exactly, or by an engine's first-order update.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "motion/trajectory_csv.h"

namespace polhode {

/// q + (h/2) w q, normalised, where exp(h w / 2) q is right.
struct FirstOrderUpdate {
    double step = 0;       ///< h, s
    double error = 0;      ///< rad, root mean square over the rows: what exact updates leave of the turn between two
    double explained = 0;  ///< what the first-order update leaves
};

/// Whether the attitudes of the file's first rows follow its w by first-order updates (old, middle or new w, a row a
/// step or up to 20 steps a row) at least ten times better than by any exponential ones. Nothing where they do not,
/// where less than 1e-6 rad a row is to be explained, or where rows are too far apart (more than a radian) to tell.
std::optional<FirstOrderUpdate> first_order_update(const TrajectoryFile& file);

}  // namespace polhode
