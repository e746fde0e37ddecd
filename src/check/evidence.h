// Evidence of a trajectory file for and against a cause, without the truth.
//
// A row is used as the state of the engine that the cause describes, and the next row is predicted from it. Earlier
// errors, chaos and a wrong start therefore have no influence, and a single step shows its fault. The file's start is
// compared with the scene's start separately. If a file has no angular velocity, the engine runs from the scene's
// start and the attitudes are compared.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "check/engine_model.h"
#include "check/hypothesis.h"
#include "motion/trajectory_csv.h"

namespace polhode {

/// The parts of a file that are predicted. The answer to each question is the mean over the rows of
/// log10(prediction error / change of the predicted quantity), in decades.
enum class Criterion {
    start_attitude,
    start_rate,
    start_position,
    start_velocity,
    first_step,  ///< from row 0 to row 1: all blocks
    attitude,
    rate,
    position,
    velocity,
    events,  ///< steps in which a load starts or ends or an impulse acts: all blocks
};
inline constexpr std::size_t criterion_count = 10;

/// The answers under one cause and one rule.
struct Residual {
    std::array<std::optional<double>, criterion_count> decades;  ///< 0: the prediction fails; empty: not asked
    double total = 0;                                            ///< sum of the decades
    double least = 0;                                            ///< the sum for perfect predictions
    double worst = 0;  ///< largest excess of a question over its value for perfect predictions

    std::optional<double>& operator[](Criterion q) { return decades[static_cast<std::size_t>(q)]; }
    const std::optional<double>& operator[](Criterion q) const { return decades[static_cast<std::size_t>(q)]; }
};

/// A trajectory file, represented by a few dozen of its steps.
class FileEvidence {
  public:
    /// Keeps references to both arguments.
    FileEvidence(const Scene& scene, const TrajectoryFile& file);

    /// False if fewer than three rows can be compared.
    bool has_enough_rows() const { return windows_.size() >= 2; }
    /// The cause without a fault: this scene, and columns as they are named.
    const Cause& sound() const { return sound_; }
    const FileFacts& facts() const { return facts_; }
    bool has_angular_velocity() const { return file_->has_angular_velocity; }
    /// Time from which nothing moves in the file although the scene's body does, s.
    std::optional<double> rest_start() const { return rest_start_; }
    /// Relative rounding error of the file's numbers.
    double noise() const { return noise_; }

    /// Error of the file's first rows against the accurate motion of the scene: the largest of the attitude error
    /// (rad) and the relative errors of the other blocks.
    double plain_error() const { return plain_error_; }

    /// Prediction errors under a cause. `steps`: steps of the rule per row.
    Residual residual(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps) const;
    /// Prediction error of attitude and w in each step, decades. Steps with an event are omitted. Empty for a file
    /// without w.
    std::vector<double> by_step(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps) const;

  private:
    const Scene* scene_;
    const TrajectoryFile* file_;
    Cause sound_;
    FileFacts facts_;
    std::vector<std::size_t> windows_;  ///< rows from which the next row is predicted, including those with an event
    std::size_t last_ = 0;              ///< the last row before an impact or the end, which causes do not describe
    std::optional<double> rest_start_;
    double noise_ = 1e-15;
    double plain_error_ = 0;

    void find_noise();
    void choose_windows();
    void compare_with_scene();
    ModelState state(const Cause& cause, std::size_t row) const;
    double position_noise(const Cause& cause, const ModelState& s) const;
    void convert_origin_velocity(const Cause& cause, const Vector3<double>& angular_velocity_B, ModelState& s) const;
    bool same(std::size_t a, std::size_t b) const;
    void compare_start(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps,
                       Residual& r) const;
    void compare_steps(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps, Residual& r,
                       std::vector<double>* by_step = nullptr) const;
    void compare_run(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps,
                     Residual& r) const;
};

}  // namespace polhode
