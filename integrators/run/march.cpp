#include "integrators/run/march.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polhode {

long steps_per_sample(double interval, double step) {
    const double ratio = interval / step, whole = std::round(ratio);
    if (!(ratio < 9e18)) return std::numeric_limits<long>::max();
    // a ratio that differs from a whole number only by rounding is that number
    const double steps = std::abs(ratio - whole) <= 1e-9 * ratio ? whole : std::ceil(ratio);
    return steps < 1 ? 1 : static_cast<long>(steps);
}

SampleIntervals::SampleIntervals(const Problem& problem, const Settings& settings)
    : duration_(problem.scene.duration), step_(*settings.step), times_(settings.times), count_(settings.samples) {
    constexpr long most = std::numeric_limits<long>::max();
    if (times_.empty()) {
        const double between = duration_ / static_cast<double>(count_);
        per_sample_ = steps_per_sample(between, step_);
        longest_step_ = between / static_cast<double>(per_sample_);
        steps_ = per_sample_ > most / count_ ? most : per_sample_ * count_;
        return;
    }
    // a sample at t = 0 ends no interval; the run continues to its end after the last sample
    count_ = static_cast<long>(times_.size()) - (times_.front() == 0 ? 1 : 0) + (times_.back() < duration_ ? 1 : 0);
    for (long k = 0; k < count_; ++k) {
        const Interval at = (*this)[k];
        longest_step_ = std::max(longest_step_, at.h);
        steps_ = at.steps > most - steps_ ? most : steps_ + at.steps;
    }
}

SampleIntervals::Interval SampleIntervals::operator[](long k) const {
    if (times_.empty()) {
        const double begin = sample_time(duration_, k, count_), end = sample_time(duration_, k + 1, count_);
        return {begin, end, (end - begin) / static_cast<double>(per_sample_), per_sample_, true};
    }
    const std::size_t next = static_cast<std::size_t>(k) + (times_.front() == 0 ? 1 : 0);
    const bool sampled = next < times_.size();
    const double begin = next == 0 ? 0 : times_[next - 1], end = sampled ? times_[next] : duration_;
    const long steps = steps_per_sample(end - begin, step_);
    return {begin, end, (end - begin) / static_cast<double>(steps), steps, sampled};
}

}  // namespace polhode
