// Midpoint columns of any recorded system, one per lane.
#pragma once

#include <cstddef>
#include <vector>

#include "integrators/own/extrapolation_columns.h"
#include "integrators/tape/tape_series.h"

namespace polhode {

/// Computes z_n of z_(m+1) = z_(m-1) + 2h f(y + z_m), z_0 = 0, z_1 = h f(y), side by side for up to eight substep
/// counts n over the same step; with `careful` also its rounding error. All instruction sets give the same bits.
class LaneColumns {
  public:
    explicit LaneColumns(const Recording<double>& recording);

    /// Computes all columns of a step H from y.
    void step(const double* y, double H, const ExtrapolationRow& row, bool careful);
    /// The increment of variable i in a column, and its rounding error.
    double increment(int column, int i) const { return increment_[index_of(i, column)]; }
    double lost(int column, int i) const { return increment_lost_[index_of(i, column)]; }

  private:
    static constexpr int lanes = TapeRates::lanes;
    using Lanes = std::vector<double, LineAllocator<double>>;
    static std::size_t index_of(int i, int column) {
        return static_cast<std::size_t>(i) * lanes + static_cast<std::size_t>(column);
    }

    int size_;
    TapeRates rates_;
    Lanes start_, before_, now_, lost_before_, lost_, y_, rate_, increment_, increment_lost_;
};

}  // namespace polhode
