// A trajectory file judged against the truth.
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

/// One error over a file's samples.
struct ErrorSummary {
    double max = 0;       ///< the largest
    double max_time = 0;  ///< s, where that is; the first of equals
    double final = 0;     ///< at the file's last sample
};

/// The largest errors of the samples up to a time, from the one of the span before on.
struct ErrorSpan {
    double until = 0;          ///< s, the last sample's
    PerMeasure<double> error;  ///< as the measures have them; 0 where the judgement has none
};

/// The errors of a file's samples, as measures() have them; those that its columns do not tell are empty.
struct Judgement : PerMeasure<std::optional<ErrorSummary>> {
    std::vector<ErrorSpan> over_time;  ///< at most ten, of about the same length in time
    /// How large the motion is, by the truth: the largest value over the samples of what each measure is relative to
    /// (SI), of the distance from the start (m) and of the speed (m/s). 0 for all other measures.
    PerMeasure<double> size;
    /// Of several bodies: the one whose attitude error is the largest, and the joints with the largest gap and turn;
    /// else empty.
    std::string worst_body, worst_gap, worst_turn;
};

/// Whether the rotation of a body that flies does not hang on where it is: no plane, no point of attack in the world.
bool rotates_alone(const Scene& scene);

/// As many spans of time at most are told apart.
inline constexpr std::size_t most_spans = 10;
/// The span of a sample at t of a file that goes from `begin` to `end` (s): a span ends with the sample at its end.
std::size_t span_of(double t, double begin, double end);

/// What the errors are formed in: 128 bits show what a binary64 file is wrong by to its last digit; binary64 takes a
/// hundredth of the time and resolves about 1e-15.
enum class JudgedIn { binary128, binary64 };

/// Judges sample by sample; `truth` has the file's times, else std::invalid_argument. Omega and momentum need w. Energy
/// needs w, and p and v where the scene has no pivot; without one of these the energy of rotation is compared where the
/// rotation does not hang on them. Momenta and energy of several bodies need w, p and v of all, joints need all bodies.
Judgement judge(const Scene& scene, const TrajectoryFile& file, const Reference& truth,
                JudgedIn arithmetic = JudgedIn::binary128);

/// Where each body of a file of several stands in the scene.
std::vector<std::size_t> bodies_of_file(const Scene& scene, const TrajectoryFile& file);
/// The names of the scene's bodies that a file of several bodies does not have.
std::vector<std::string> missing_bodies(const Scene& scene, const TrajectoryFile& file);

/// A file of several bodies as a method would have given it; its truth stands in for what it does not tell, and for
/// bodies that it does not have.
Trajectory completed_by(const Reference& truth, const Scene& scene, const TrajectoryFile& file);

/// The same as judge() piece by piece, for files whose truth does not fit in memory or is made by several threads.
class Judge {
  public:
    /// Keeps references: both outlive it.
    Judge(const Scene& scene, const TrajectoryFile& file, JudgedIn arithmetic);
    ~Judge();
    Judge(Judge&&) noexcept;

    /// Judges the rows of the times first, first + 1, .. by these samples, which are of all bodies at each time; each
    /// row once, in order within one Judge. Throws std::invalid_argument where a time is not the row's.
    void add(std::size_t first, std::span<const ReferenceSample> truth);
    /// Keeps the error of each row in this measure as well; before any is judged.
    void keep(std::size_t measure);
    /// Takes over what another has judged, of later rows of a scene of one body.
    void append(const Judge& later);
    Judgement result() const;
    /// The errors kept, row by row, as the measure has them.
    std::vector<double> kept() const;

    struct State;
    struct Tally;

  private:
    std::unique_ptr<State> state_;
};

}  // namespace polhode
