// The rows of a trajectory file beside the scene's own motion: what hypotheses about the file are tried on.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "check/diagnosis.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

inline double length(const Vector3<double>& v) { return std::sqrt(dot(v, v)); }

/// w of a sample in world axes, rad/s.
inline Vector3<double> world_rate(const Sample& sample) {
    return (1 / squared_norm(sample.q)) * rotate(sample.q, sample.angular_velocity_B);
}

template <class Error>
double root_mean_square(std::size_t count, Error&& error) {
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double e = error(k);
        sum += e * e;
    }
    return std::sqrt(sum / static_cast<double>(count));
}

/// Rows of a file from the first on, twice as many each time, until the error is plain to see: beyond that it
/// saturates, and a broken engine's own rounding and steps hide what broke it. Not before the body has turned by two
/// radians.
class ComparedRows {
  public:
    /// Keeps references: all outlive it.
    ComparedRows(const Scene& scene, const TrajectoryFile& file, const AlteredMotion& motion);

    const Scene& scene() const { return *scene_; }
    const TrajectoryFile& file() const { return *file_; }
    /// Below three there is nothing to compare.
    std::size_t size() const { return times_.size(); }
    const TrajectoryRow& row(std::size_t k) const { return file_->rows[index_[k]]; }
    /// The index in the file of the last row compared.
    std::size_t last_index() const { return index_.back(); }
    const std::vector<double>& times() const { return times_; }  ///< s, of the rows
    const std::vector<Sample>& own() const { return own_; }      ///< the scene's motion at them
    double turned() const { return turned_; }                    ///< rad, by the scene's motion
    /// rad: root mean square between the file and the scene's motion.
    double error() const { return error_; }
    /// rad/s, the largest of the scene's motion.
    double largest_own_rate() const;

    std::vector<Sample> motion(const Scene& scene, const Alteration& alteration,
                               const std::vector<double>& times) const {
        return (*motion_)(scene, alteration, times);
    }
    /// rad: root mean square between the file and these samples, or 10 where they are too few.
    double attitude_error(const std::vector<Sample>& samples) const;
    double attitude_error(const Scene& scene, const Alteration& alteration) const;
    /// attitude_error() of the scene without the gyroscopic term.
    double error_without_gyroscopic_term() const;

    /// How far the file's w is from rate_W(k) at row k (root mean square), relative to the largest of them. Nothing
    /// where the file has no w, or nothing turns.
    template <class Rate>
    std::optional<double> rates_left(const Rate& rate_W) const {
        if (!file_->has_angular_velocity) return {};
        double scale = 0;
        const double error = root_mean_square(size(), [&](std::size_t k) {
            const Vector3<double> w = rate_W(k);
            scale = std::max(scale, length(w));
            return length(row(k).angular_velocity_W - w);
        });
        if (scale == 0) return {};
        return error / scale;
    }
    std::optional<double> rates_left(const Scene& scene, const Alteration& alteration) const;

  private:
    void choose();

    const Scene* scene_;
    const TrajectoryFile* file_;
    const AlteredMotion* motion_;
    std::vector<std::size_t> index_;
    std::vector<double> times_;
    std::vector<Sample> own_;
    double error_ = 0, turned_ = 0;
    mutable std::optional<double> without_gyroscopic_term_;
};

}  // namespace polhode
