// The measures of a trajectory: each is one row of data and one function of a sample and the reference.
//
// Result tables, time series, the list of metrics and the reports on files take their columns from here, so that a
// new measure is one entry in measures.cpp.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "body/elementary.h"
#include "motion/mechanism_motion.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// Values below this fraction of the terms of their sum (or of a radian) are binary64 rounding and count as 0.
inline constexpr double vanishing = 1e-15;

/// Whether an error exceeds the largest so far. NaN exceeds everything; the first of several NaN is kept.
template <class S>
bool is_larger(const S& error, const S& largest) {
    return !std::isnan(double(largest)) && !(error <= largest);
}

/// One body and its reference at one time. S is double or Wide.
template <class S>
struct ComparedBody {
    BodyMotion<S> computed;                      ///< q as output by the method, of any nonzero length
    BodyMotion<S> truth;                         ///< q of unit length
    std::optional<double> orthogonality_defect;  ///< for a matrix method: Frobenius norm of A^T A - 1
};

/// All bodies of a scene (one or several) and their reference at one time.
template <class S>
struct ComparedMotion {
    std::vector<ComparedBody<S>> bodies;  ///< in the order of the scene
    SystemInvariants<S> computed;         ///< whole system, from the method's numbers
    SystemInvariants<S> truth;            ///< whole system, from the reference
    JointViolations<S> joints;            ///< from the method's numbers
    S reaction_error = S(0);              ///< worst of all joints, relative to the run's largest reaction
};

/// One formula, compiled for binary64 and for 128 bits.
template <template <class> class Argument>
struct MeasureFormula {
    double (*binary64)(const Argument<double>&) = nullptr;  ///< null: no formula
    Wide (*binary128)(const Argument<Wide>&) = nullptr;     ///< null: no formula

    /// No formula.
    MeasureFormula() = default;
    /// From a function object or a generic lambda without captures.
    template <class F>
    MeasureFormula(F formula) : binary64(formula), binary128(formula) {}

    /// The value in binary64.
    double operator()(const Argument<double>& argument) const { return binary64(argument); }
    /// The value in 128 bits.
    Wide operator()(const Argument<Wide>& argument) const { return binary128(argument); }
    /// Whether there is a formula.
    explicit operator bool() const { return binary64 != nullptr; }
};

/// The data that a measure needs. Flags are combined by |.
enum Known : unsigned {
    known_truth = 1,             ///< the reference
    known_angular_velocity = 2,  ///< the angular velocity
    known_position = 4,          ///< the position
    known_velocity = 8,          ///< the velocity
    known_center = 16,           ///< position and velocity of the centre of mass; a pivot and the attitude suffice
    known_reactions = 32,        ///< the joint reactions
    known_free_system = 64,      ///< no joint connects the bodies to the world
};

/// One error measure of a trajectory.
struct Measure {
    std::string_view name;       ///< "attitude": columns are attitude_error, attitude_error_max, ..
    std::string_view title;      ///< for readers
    std::string_view unit;       ///< "rad", "m", "relative"; empty if the title states it
    std::string_view meaning;    ///< one line
    unsigned needs = 0;          ///< combination of Known flags
    bool tabled = false;         ///< has columns in result tables and series; otherwise only `check` reports it
    bool tabled_at_end = false;  ///< also has a column for its value at the end of the run
    bool over_time = false;      ///< `check` reports its growth
    /// Error of one body, before division by the scale; for several bodies, the largest counts. Null for measures of
    /// the whole system.
    MeasureFormula<ComparedBody> error = {};
    /// The scale of `error`: its largest value over the run and the bodies. Null: the error is absolute.
    MeasureFormula<BodyMotion> scale = {};
    /// Error of the whole system, for measures without `error`.
    MeasureFormula<ComparedMotion> whole_error = {};
    /// The scale of `whole_error`: its largest value over the run.
    MeasureFormula<SystemInvariants> whole_scale = {};
    bool of_one_body = true;             ///< defined for scenes of a single body
    bool tabled_of_systems = false;      ///< has columns only in tables of several bodies
    std::string_view suffix = "_error";  ///< suffix of the name in those columns

    /// Whether it is relative to a scale.
    bool is_relative() const { return scale || whole_scale; }
};

/// All measures, in the order of reports.
std::span<const Measure> measures();
/// The index of a measure by its name. Throws std::invalid_argument if it does not exist.
std::size_t measure_index(std::string_view name);

/// One value per measure, accessed by name or by index in measures().
template <class T>
class PerMeasure {
  public:
    /// The value of a measure by its index.
    T& operator[](std::size_t measure) { return values_[measure]; }
    /// The value of a measure by its index.
    const T& operator[](std::size_t measure) const { return values_[measure]; }
    /// The value of a measure by its name. Throws std::invalid_argument if it does not exist.
    T& operator[](std::string_view measure) { return values_[measure_index(measure)]; }
    /// The value of a measure by its name. Throws std::invalid_argument if it does not exist.
    const T& operator[](std::string_view measure) const { return values_[measure_index(measure)]; }
    /// The number of measures.
    std::size_t size() const { return values_.size(); }

  private:
    std::vector<T> values_ = std::vector<T>(measures().size());
};

/// Converts a reference sample to the scalar S.
template <class S>
BodyMotion<S> true_motion(const ReferenceSample& truth) {
    const auto value = [](const Pair& pair) { return S(pair.high) + S(pair.low); };
    const auto vector = [&](const Vector3<Pair>& v) { return Vector3<S>{value(v[0]), value(v[1]), value(v[2])}; };
    return {{value(truth.q.w), value(truth.q.x), value(truth.q.y), value(truth.q.z)},
            vector(truth.angular_velocity_B),
            vector(truth.position_W),
            vector(truth.velocity_W)};
}

/// Rotation angle (rad) between q, of any nonzero length, and the reference; q and -q give the same angle.
double attitude_error(const Quaternion<double>& q, const Quaternion<Pair>& reference);

}  // namespace polhode
