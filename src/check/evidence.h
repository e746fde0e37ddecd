// What a trajectory file says for and against a cause, without the truth: row by row, each from the one before.
//
// A row is taken as the state of the engine that the cause describes, and the next row is predicted from it. So an
// error of long ago, chaos and a wrong start spoil nothing, and a single step shows what is wrong with it. The file's
// start is compared with the scene's apart from that. Where a file has no angular velocity the engine is run from the
// scene's start instead, and the attitudes are compared.
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

/// The questions that are asked of a file. Each is answered by how far the file is from what is predicted, relative to
/// what moves: the mean over the rows of the decimal logarithm.
enum class Question {
    start_attitude,
    start_rate,
    start_position,
    start_velocity,
    first_step,  ///< from row 0 to row 1: all blocks
    attitude,
    rate,
    position,
    velocity,
    events,  ///< steps in which a load begins or ends, or an impulse acts: all blocks
};
inline constexpr std::size_t question_count = 10;

/// The answers under one cause and one rule.
struct Residual {
    std::array<std::optional<double>, question_count> decades;  ///< 0: nothing is as predicted; empty: was not asked
    double total = 0;                                           ///< their sum
    double least = 0;                                           ///< what the sum would be if all were as predicted
    double worst = 0;  ///< by how much the question answered worst is above the least that it could be

    std::optional<double>& operator[](Question q) { return decades[static_cast<std::size_t>(q)]; }
    const std::optional<double>& operator[](Question q) const { return decades[static_cast<std::size_t>(q)]; }
};

/// A trajectory file, seen in a few dozen steps of it.
class FileEvidence {
  public:
    /// Keeps references: both outlive it.
    FileEvidence(const Scene& scene, const TrajectoryFile& file);

    /// Fewer than three rows that can be compared: nothing can be said.
    bool enough() const { return windows_.size() >= 2; }
    /// A sound cause: this file as it is named, this scene, no fault.
    const Cause& sound() const { return sound_; }
    const FileFacts& facts() const { return facts_; }
    bool has_angular_velocity() const { return file_->has_angular_velocity; }
    /// From which row on nothing moves any more, where the scene's body does: its time (s).
    std::optional<double> still_from() const { return still_from_; }
    /// The relative rounding of the file's numbers.
    double noise() const { return noise_; }

    /// How far the file is from the accurate motion of the scene over its first rows: the largest of the attitude (rad)
    /// and the other blocks' relative errors.
    double plain_error() const { return plain_error_; }

    /// `steps`: of the rule, from one row to the next.
    Residual residual(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps) const;
    /// How far attitude and w are from what is predicted in each of the steps that are looked at, in decades; steps
    /// with an event are left out, and a file without w has none.
    std::vector<double> by_step(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps) const;

  private:
    const Scene* scene_;
    const TrajectoryFile* file_;
    Cause sound_;
    FileFacts facts_;
    std::vector<std::size_t> windows_;  ///< rows from which the next is predicted, and those with an event
    std::size_t last_ = 0;              ///< the last row before anything that no cause describes: an impact, the end
    std::optional<double> still_from_;
    double noise_ = 1e-15;
    double plain_error_ = 0;

    void find_noise();
    void choose_windows();
    void compare_plainly();
    ModelState state(const Cause& cause, std::size_t row) const;
    double position_noise(const Cause& cause, const ModelState& s) const;
    void use_center(const Cause& cause, const Vector3<double>& angular_velocity_B, ModelState& s) const;
    bool same(std::size_t a, std::size_t b) const;
    void ask_start(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps, Residual& r) const;
    void ask_steps(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps, Residual& r,
                   std::vector<double>* by_step = nullptr) const;
    void ask_run(const Cause& cause, const EngineModel& model, const UpdateRule& rule, int steps, Residual& r) const;
};

}  // namespace polhode
