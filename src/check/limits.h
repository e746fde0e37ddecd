// Error limits of each block of a file, and verdicts.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "check/file_errors.h"
#include "scene/scene.h"

namespace polhode {

/// A part of the motion with its own error limit. Its name is one of tolerated_blocks.
struct ErrorBlock {
    std::string_view name;     ///< "angular_velocity": --max-angular-velocity, and a key of the scene's `tolerated`
    std::string_view title;    ///< for users
    std::string_view measure;  ///< the measure of the error
    std::string_view unit;     ///< unit of a limit; empty if limits are relative
    double relative;           ///< default limit relative to the motion's size; 0 if only `absolute` is used
    double absolute;           ///< smallest default limit in SI; 0 if there is none
};

/// All blocks in the order of reports. The default limits are acceptable for games: 0.05 rad (3 degrees) for the
/// attitude; 5 % of the largest value over the run for angular velocity, distance from the start, speed, energy and
/// angular momentum; 0.01 m for joint gaps and 0.05 rad for joint misalignment.
std::span<const ErrorBlock> error_blocks();

/// The limit of one block.
struct ErrorLimit {
    double value = 0;
    bool relative = false;  ///< relative to the motion's size, else in SI
    std::string from;       ///< "--max-attitude", "tolerated by the scene" or "by default"
};

/// The verdict on one block of a file.
struct BlockVerdict {
    const ErrorBlock* block = nullptr;
    std::optional<double> error;     ///< largest error in SI (relative for energy and momentum); empty: not in the file
    std::optional<double> relative;  ///< largest error relative to the motion's size, if this is not 0
    ErrorLimit limit;
    bool failed = false;
};

/// The limits of all blocks.
class ErrorLimits {
  public:
    /// Uses the scene's `tolerated` and the defaults.
    explicit ErrorLimits(const Scene& scene);

    /// Sets a limit: "0.01" in SI or "5%" of the motion's size. Throws std::invalid_argument with a one-line message.
    void set(std::string_view block, std::string_view text);
    const ErrorLimit& operator[](std::string_view block) const;

    /// The verdicts on all blocks of a file.
    std::vector<BlockVerdict> verdicts(const FileErrors& file_errors) const;
    /// Whether a block of the file exceeds its limit. Always false with report_only.
    bool refuses(const FileErrors& file_errors) const;

    bool report_only = false;  ///< report errors without failing

  private:
    std::array<ErrorLimit, tolerated_blocks.size()> limits_;
};

}  // namespace polhode
