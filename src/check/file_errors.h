// Errors of a trajectory file against the truth.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "measure/measures.h"
#include "motion/trajectory_csv.h"
#include "scene/scene.h"

namespace polhode {

/// One error over the samples of a file.
struct ErrorSummary {
    double max = 0;       ///< largest error
    double max_time = 0;  ///< time of the first largest error, s
    double final = 0;     ///< error at the last sample
};

/// The largest errors over the samples of one time span.
struct ErrorSpan {
    double until = 0;          ///< time of the last sample of the span, s
    PerMeasure<double> error;  ///< in the units of measures(); 0 if the error is not available
};

/// The errors of a file in the units of measures(). Errors for which the file lacks columns are empty.
struct FileErrors : PerMeasure<std::optional<ErrorSummary>> {
    std::vector<ErrorSpan> over_time;  ///< at most ten spans of about equal duration
    /// Size of the true motion: the largest value over the samples of the scale of each relative measure (SI), of the
    /// distance from the start (m) and of the speed (m/s). 0 for other measures.
    PerMeasure<double> size;
    /// Several bodies: the body with the largest attitude error, the joints with the largest gap and misalignment.
    std::string worst_body, worst_gap, worst_turn;
};

/// Whether the rotation is independent of the position: no planes, and no loads at points fixed in the world.
bool rotation_is_independent(const Scene& scene);

/// The number of time spans in a report.
inline constexpr std::size_t most_spans = 10;
/// Returns the span of a sample at t in a file from `begin` to `end` (s). A sample at the end of a span belongs to it.
std::size_t span_of(double t, double begin, double end);

/// Arithmetic in which errors are computed. binary128 resolves the last digit of a binary64 file. binary64 resolves
/// about 1e-15 and is about 100 times faster.
enum class ErrorArithmetic { binary128, binary64 };

/// Computes the errors of all samples. Throws std::invalid_argument if `truth` is not at the file's times. Omega and
/// momentum need w. Energy needs w, and without a pivot also p and v. If p or v is missing, the rotational energy is
/// compared, provided that rotation_is_independent(). Momenta and energy of several bodies need w, p and v of all
/// bodies. Joint errors need all bodies.
FileErrors compute_file_errors(const Scene& scene, const TrajectoryFile& file, const Reference& truth,
                               ErrorArithmetic arithmetic = ErrorArithmetic::binary128);

/// Indices in the scene of the bodies of a file.
std::vector<std::size_t> bodies_of_file(const Scene& scene, const TrajectoryFile& file);
/// Names of the scene's bodies that are missing in a file. No body is missing in a file of one body.
std::vector<std::string> missing_bodies(const Scene& scene, const TrajectoryFile& file);

/// Converts a file of several bodies to a trajectory. Missing blocks and bodies are filled in from the truth.
Trajectory complete_from_truth(const Reference& truth, const Scene& scene, const TrajectoryFile& file);

/// Computes the errors piece by piece, for a truth that does not fit in memory or is computed by several threads.
class FileErrorAccumulator {
  public:
    /// Keeps references to `scene` and `file`.
    FileErrorAccumulator(const Scene& scene, const TrajectoryFile& file, ErrorArithmetic arithmetic);
    ~FileErrorAccumulator();
    FileErrorAccumulator(FileErrorAccumulator&&) noexcept;

    /// Compares the rows at times first, first + 1, .. with these samples of all bodies. Rows must be added in order.
    /// Throws std::invalid_argument if a sample's time differs from its row's.
    void add(std::size_t first, std::span<const ReferenceSample> truth);
    /// Also keeps the error of each row in this measure. Must be called before add().
    void keep_row_errors(std::size_t measure);
    /// Appends the result of later rows. For scenes of one body.
    void append(const FileErrorAccumulator& later);
    FileErrors result() const;
    /// The kept errors, one per row, in the unit of the measure.
    std::vector<double> row_errors() const;

    struct State;
    struct Tally;

  private:
    std::unique_ptr<State> state_;
};

}  // namespace polhode
