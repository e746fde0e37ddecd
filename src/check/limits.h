// What a file's errors are held to, block by block, and the verdict.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "check/judge.h"
#include "scene/scene.h"

namespace polhode {

/// A part of the motion that is judged against a limit of its own; its name is one of tolerated_blocks.
struct JudgedBlock {
    std::string_view name;     ///< "angular_velocity": --max-angular-velocity, and a key of the scene's `tolerated`
    std::string_view title;    ///< for people
    std::string_view measure;  ///< whose error it is
    std::string_view unit;     ///< of a limit given as a number; empty: it is relative
    double relative;           ///< the default: part of the motion's size; 0 where there is an absolute one alone
    double absolute;           ///< and in SI, where the motion has no size; 0 where there is none
};

/// All, in the order of reports. The defaults are what a game could live with: 0.05 rad (3 degrees) of the attitude,
/// 5 % of the motion's own size of the angular velocity, distance from the start, speed, energy and angular momentum
/// (the largest of the run), and of joints gaps of 0.01 m and turns of 0.05 rad.
std::span<const JudgedBlock> judged_blocks();

/// A limit of one block.
struct ErrorLimit {
    double value = 0;
    bool relative = false;  ///< to the motion's size, else in SI
    std::string from;       ///< who set it: "--max-attitude", "tolerated by the scene", "by default"
};

/// What one block of a file comes to.
struct BlockVerdict {
    const JudgedBlock* block = nullptr;
    std::optional<double> error;     ///< the largest, in SI (energy and momentum: relative); empty: not in the file
    std::optional<double> relative;  ///< the same relative to the motion's size, where it has any
    ErrorLimit limit;
    bool failed = false;
};

/// The limits of all blocks.
class ErrorLimits {
  public:
    /// What the scene tolerates, and the defaults.
    explicit ErrorLimits(const Scene& scene);

    /// A limit of the user's own, "0.01" in SI or "5%" of the motion's size. Throws std::invalid_argument with a line
    /// that names the fault and the remedy.
    void set(std::string_view block, std::string_view text);
    const ErrorLimit& operator[](std::string_view block) const;

    /// What each block of a file comes to.
    std::vector<BlockVerdict> verdicts(const Judgement& judgement) const;
    /// Whether any block that the file has is beyond its limit, and that is not only to be reported.
    bool refuses(const Judgement& judgement) const;

    bool report_only = false;  ///< errors are told, and none is too large

  private:
    std::array<ErrorLimit, tolerated_blocks.size()> limits_;
};

}  // namespace polhode
