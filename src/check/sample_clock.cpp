#include "check/sample_clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace polhode {
namespace {

// Half a unit in the last place of a binary32 number, plus a margin for decimals of nine digits.
double rounding(double t) {
    if (!(t > 0)) return 0x1p-149;
    return 0.7 * std::ldexp(1.0, std::max(std::ilogb(t), -126) - 23);
}

// Whether t is a binary32 number, or a binary32 number written with nine digits.
bool from_binary32(double t) {
    const auto narrow = static_cast<float>(t);
    return static_cast<double>(narrow) == t || std::strtod(fmt::format("{:.9g}", narrow).c_str(), nullptr) == t;
}

// Returns the simplest number between low and high.
double roundest(double low, double high, double duration) {
    for (const double whole : {duration, 1.0}) {
        const double count = std::round(whole / (0.5 * (low + high))), dt = whole / count;
        if (count >= 1 && dt >= low && dt <= high) return dt;
    }
    for (int digits = 1; digits <= 15; ++digits) {
        const double dt = std::strtod(fmt::format("{:.{}g}", 0.5 * (low + high), digits).c_str(), nullptr);
        if (dt >= low && dt <= high) return dt;
    }
    return 0.5 * (low + high);
}

}  // namespace

std::optional<double> restore_clock(TrajectoryFile& file, double duration) {
    std::vector<TrajectoryRow>& rows = file.rows;
    const std::size_t at_once = file.bodies_at_once(), moments = rows.size() / at_once;
    if (moments < 3) return {};
    const double spacing = (rows.back().t - rows.front().t) / static_cast<double>(moments - 1);
    // spacings below the normal numbers of binary32 do not come from a binary32 clock
    if (!(spacing >= 0x1p-126)) return {};
    const double first = std::round(rows.front().t / spacing);
    if (!(first < 1e15)) return {};
    // each time restricts dt to an interval; the narrow one is for a binary64 clock, also one that accumulates steps
    double low = 0, high = HUGE_VAL, narrow_low = 0, narrow_high = HUGE_VAL;
    for (std::size_t k = 0; k < moments; ++k) {
        const double count = first + static_cast<double>(k), t = rows[k * at_once].t;
        if (count == 0) {
            if (t != 0) return {};
            continue;
        }
        low = std::max(low, (t - rounding(t)) / count);
        high = std::min(high, (t + rounding(t)) / count);
        if (low > high) return {};
        narrow_low = std::max(narrow_low, t * (1 - 0x1p-36) / count);
        narrow_high = std::min(narrow_high, t * (1 + 0x1p-36) / count);
    }
    if (narrow_low <= narrow_high &&
        !std::ranges::all_of(rows, [](const TrajectoryRow& r) { return from_binary32(r.t); }))
        return {};
    const double dt = roundest(low, high, duration);
    // dt reproduces the times as they are: nothing was rounded
    if (dt >= narrow_low && dt <= narrow_high) return {};
    // on a grid of N steps over the duration, use the same times as `solve` and `truth`
    const double steps = std::round(duration / dt);
    const bool divides = steps >= 1 && steps < 1e15 && duration / steps == dt;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const std::size_t moment = k / at_once;
        const double count = first + static_cast<double>(moment);
        rows[k].t = divides ? (count == steps ? duration : duration * count / steps) : count * dt;
    }
    return dt;
}

}  // namespace polhode
