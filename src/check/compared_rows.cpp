#include "check/compared_rows.h"

#include <algorithm>

#include "body/orientation.h"

namespace polhode {

ComparedRows::ComparedRows(const Scene& scene, const TrajectoryFile& file, const AlteredMotion& motion)
    : scene_(&scene), file_(&file), motion_(&motion) {
    choose();
}

void ComparedRows::choose() {
    const std::size_t all = file_->rows.size();
    if (all < 3) return;
    for (std::size_t count = std::min<std::size_t>(16, all);; count = std::min(2 * count, all)) {
        constexpr std::size_t most = 300;
        index_.clear(), times_.clear();
        for (std::size_t i = 0; i < std::min(count, most); ++i) {
            index_.push_back(count <= most ? i : i * (count - 1) / (most - 1));
            times_.push_back(row(i).t);
        }
        own_ = (*motion_)(*scene_, {}, times_);
        const bool complete = own_.size() == times_.size();
        if (!complete) index_.resize(own_.size()), times_.resize(own_.size());
        if (own_.size() < 3) return;
        turned_ = length(own_[0].angular_velocity_B) * times_[0];
        for (std::size_t k = 1; k < own_.size(); ++k)
            turned_ += (times_[k] - times_[k - 1]) *
                       std::max(length(own_[k].angular_velocity_B), length(own_[k - 1].angular_velocity_B));
        error_ = attitude_error(own_);
        if (count == all || !complete || (error_ > 0.3 && turned_ > 2)) return;
    }
}

double ComparedRows::largest_own_rate() const {
    double largest = 0;
    for (const Sample& s : own_) largest = std::max(largest, length(s.angular_velocity_B));
    return largest;
}

double ComparedRows::attitude_error(const std::vector<Sample>& samples) const {
    constexpr double unfit = 10;  // no motion to compare with
    if (samples.size() < times_.size()) return unfit;
    return root_mean_square(times_.size(),
                            [&](std::size_t k) { return rotation_angle_between(samples[k].q, row(k).q); });
}

double ComparedRows::attitude_error(const Scene& scene, const Alteration& alteration) const {
    return attitude_error(motion(scene, alteration, times_));
}

double ComparedRows::error_without_gyroscopic_term() const {
    if (!without_gyroscopic_term_) without_gyroscopic_term_ = attitude_error(*scene_, {.gyroscopic = 0});
    return *without_gyroscopic_term_;
}

std::optional<double> ComparedRows::rates_left(const Scene& scene, const Alteration& alteration) const {
    const std::vector<Sample> samples = motion(scene, alteration, times_);
    if (samples.size() < times_.size()) return {};
    return rates_left([&](std::size_t k) { return world_rate(samples[k]); });
}

}  // namespace polhode
