// Midpoint columns of any recorded system, each in a lane of its own.
#pragma once

#include <cstddef>
#include <vector>

#include "integrators/own/extrapolation_columns.h"
#include "integrators/tape/tape_series.h"

namespace polhode {

/// z_n of z_(m+1) = z_(m-1) + 2h f(y + z_m), z_0 = 0, z_1 = h f(y), for up to eight numbers of substeps n over the same
/// step side by side; with care, also what was rounded away. The same bits by all instructions.
class LaneColumns {
  public:
    explicit LaneColumns(const Recording<double>& recording);

    /// From y over the step H.
    void step(const double* y, double H, const ExtrapolationRow& row, bool careful);
    /// Of the i-th variable: the increment that the column found, and what it lost.
    double increment(int column, int i) const { return found_[place(i, column)]; }
    double lost(int column, int i) const { return found_lost_[place(i, column)]; }

  private:
    static constexpr int lanes = TapeRates::lanes;
    using Lanes = std::vector<double, LineAllocator<double>>;
    static std::size_t place(int i, int column) {
        return static_cast<std::size_t>(i) * lanes + static_cast<std::size_t>(column);
    }

    int size_;
    TapeRates rates_;
    Lanes start_, before_, now_, lost_before_, lost_, y_, rate_, found_, found_lost_;
};

}  // namespace polhode
