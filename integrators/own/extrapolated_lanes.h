// Integrates many motions of one system side by side, one per lane, by extrapolation of the explicit midpoint rule.
// Each motion has its own step sizes.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "integrators/own/extrapolation_columns.h"
#include "integrators/tape/tape_series.h"
#include "motion/trajectory.h"

namespace polhode {

/// One motion in progress.
struct LaneMotion {
    double* y = nullptr;            ///< variables of the recorded system, with parameters: initial, then final
    const double* sizes = nullptr;  ///< error scale of each variable, > 0; grows with the variable
    double step = 0;                ///< s; 0 on the first span, else the step size that the previous span ended with
    long steps = 0;                 ///< steps tried, over all spans
    enum class End { reached, not_finite, too_many_steps, too_short, interrupted } end = End::reached;
    double reached = 0;  ///< time reached in the current span, s
};

/// Status and message of a motion that did not reach the end of a span that started at `begin` (s).
struct LaneFailure {
    Status status;
    std::string message;
};
/// Describes why `motion` ended.
LaneFailure describe_failure(const LaneMotion& motion, double begin, long max_steps);

/// Two registers of eight lanes are processed alternately to hide latency. The result of a motion does not depend on
/// its neighbours or on the instruction set.
class ExtrapolatedLanes {
  public:
    /// `units`: by variable, the first variable of the group that shares its error scale, the largest in the group.
    /// The error of a step, estimated from the next lower extrapolation, is kept below `tolerance` times the scale.
    ExtrapolatedLanes(const Recording<double>& recording, std::vector<int> units, double tolerance, long max_steps,
                      const TapeOptions& options = {});

    /// Advances each motion over the span, s, > 0. A lane takes the next motion as soon as its current one is
    /// finished.
    void advance(std::vector<LaneMotion>& motions, double span);

  private:
    static constexpr int lanes = TapeRates::lanes;
    using Numbers8 = std::vector<double, LineAllocator<double>>;
    static std::size_t index_of(int i, int lane) {
        return static_cast<std::size_t>(i) * lanes + static_cast<std::size_t>(lane);
    }
    /// Times, step sizes and suggested steps of eight motions.
    struct Control {
        alignas(64) double time[lanes]{}, step[lanes]{}, taken[lanes]{}, suggested[3][lanes]{};
        alignas(64) double ended[lanes]{};  ///< 0, or 1 + LaneMotion::End
    };
    /// Eight motions.
    struct Register {
        Numbers8 start, lost, sizes, rate, scratch, next, next_lost, twice_h;
        std::array<Numbers8, max_columns> column;
        Control control;
        std::array<double*, 2> now{};  ///< current and previous increments of a column
        std::array<LaneMotion*, lanes> motion{};
        int busy = 0;
        bool has_new = false;  ///< the first step of some motion is still to be found
    };
    struct StepEnd;
    struct Kernels;

    int size_;
    int moving_ = 0;  ///< variables from this index on are all parameters
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
