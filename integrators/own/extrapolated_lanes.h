// Many motions of one system side by side, a lane each, by extrapolation of the explicit midpoint rule with steps of
// each one's own.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "integrators/own/extrapolation_columns.h"
#include "integrators/tape/tape_series.h"
#include "motion/trajectory.h"

namespace polhode {

/// One motion on its way.
struct LaneMotion {
    double* y = nullptr;            ///< the variables of the recorded system, its parameters too: from, then to
    const double* sizes = nullptr;  ///< of each variable, > 0: what its errors are measured by, unless it grows larger
    double step = 0;                ///< s: 0, or what the span before has come to
    long steps = 0;                 ///< tried, on all spans
    enum class End { reached, not_finite, too_many_steps, too_short, interrupted } end = End::reached;
    double reached = 0;  ///< s, of the span asked
};

/// What is said of one that did not arrive, on a span that began at `begin` (s).
struct LaneFailure {
    Status status;
    std::string message;
};
LaneFailure failure_of(const LaneMotion& motion, double begin, long max_steps);

/// Two registers of eight lanes are under way at once, so that neither waits for itself. What becomes of a motion does
/// not depend on its neighbours, nor on the instructions.
class ExtrapolatedLanes {
  public:
    /// `units`: by variable, the first of those that are measured by their largest together. A step's error, that of
    /// the result less well extrapolated, is held to `tolerance` of each size.
    ExtrapolatedLanes(const Recording<double>& recording, std::vector<int> units, double tolerance, long max_steps,
                      const TapeOptions& options = {});

    /// Moves each over the span, s > 0. A lane is given to the next motion as soon as its own has arrived.
    void advance(std::vector<LaneMotion>& motions, double span);

  private:
    static constexpr int lanes = TapeRates::lanes;
    using Numbers8 = std::vector<double, LineAllocator<double>>;
    static std::size_t place(int i, int lane) {
        return static_cast<std::size_t>(i) * lanes + static_cast<std::size_t>(lane);
    }
    /// Where eight motions are in time, and what their steps suggest for the next.
    struct Control {
        alignas(64) double time[lanes]{}, step[lanes]{}, taken[lanes]{}, suggested[3][lanes]{};
        alignas(64) double ended[lanes]{};  ///< 0, or 1 + LaneMotion::End
    };
    /// Eight motions.
    struct Register {
        Numbers8 start, lost, sizes, rate, scratch, next, next_lost, twice_h;
        std::array<Numbers8, most_columns> column;
        Control control;
        std::array<double*, 2> now{};  ///< what a column has found, and what it had found before
        std::array<LaneMotion*, lanes> motion{};
        int busy = 0;
        bool has_new = false;  ///< motions whose first step is to be found
    };
    struct StepEnd;
    struct Kernels;

    int size_;
    int moving_ = 0;  ///< so many variables of the first, or fewer, are no parameters
    double tolerance_;
    long max_steps_;
    const ExtrapolationRow* row_;
    std::vector<int> units_;
    std::vector<char> is_moving_;
    const Kernels* kernels_;
    TapeRates rates_;
    std::array<Register, 2> registers_;

    void fill(Register& r, int lane, std::vector<LaneMotion>& motions, std::size_t& next);
    void begin_step(Register& r, double span);
    void end_step(Register& r, double span, std::vector<LaneMotion>& motions, std::size_t& next);
    double first_step(const Register& r, int lane, double span) const;
};

}  // namespace polhode
