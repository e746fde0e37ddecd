// What is measured of a trajectory: each measure is one row of data, and one function of a sample beside the truth.
//
// Tables of results, series over time, the list of metrics and the reports on files take their columns from here, so
// that a new measure is one entry in measures.cpp.
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

/// What is below this share of the parts that it is the sum of, or of a radian, is rounding in binary64, and counts as
/// 0.
inline constexpr double vanishing = 1e-15;

/// Whether an error is larger than the largest so far; NaN is the largest of all, and the first of several stays.
template <class S>
bool is_larger(const S& error, const S& largest) {
    return !std::isnan(double(largest)) && !(error <= largest);
}

/// One body beside the truth at one time. S is double or Wide.
template <class S>
struct ComparedBody {
    BodyMotion<S> own;                           ///< q as the method left it, of any length but zero
    BodyMotion<S> truth;                         ///< q of unit length
    std::optional<double> orthogonality_defect;  ///< of a matrix method: Frobenius norm of A^T A - 1
};

/// The bodies of a scene, one or several, beside the truth at one time.
template <class S>
struct ComparedMotion {
    std::vector<ComparedBody<S>> bodies;  ///< in the scene's order
    SystemInvariants<S> own;              ///< what all have together, from their own numbers
    SystemInvariants<S> truth;            ///< the same from the truth's
    JointViolations<S> joints;            ///< of the bodies' own numbers
    S reaction_error = S(0);              ///< of all joints, relative to the run's largest reaction
};

/// One formula, compiled for binary64 and for 128 bits.
template <template <class> class Argument>
struct MeasureFormula {
    double (*binary64)(const Argument<double>&) = nullptr;  ///< null: there is no formula
    Wide (*binary128)(const Argument<Wide>&) = nullptr;     ///< null: there is no formula

    /// No formula.
    MeasureFormula() = default;
    /// A function object, or a generic lambda, that captures nothing.
    template <class F>
    MeasureFormula(F formula) : binary64(formula), binary128(formula) {}

    /// The value in binary64.
    double operator()(const Argument<double>& argument) const { return binary64(argument); }
    /// The value in 128 bits.
    Wide operator()(const Argument<Wide>& argument) const { return binary128(argument); }
    /// Whether there is a formula.
    explicit operator bool() const { return binary64 != nullptr; }
};

/// What has to be known of a motion for a measure of it. Several are joined by |.
enum Known : unsigned {
    known_truth = 1,             ///< the truth
    known_angular_velocity = 2,  ///< its angular velocity
    known_position = 4,          ///< its position
    known_velocity = 8,          ///< its velocity
    known_center = 16,           ///< position and velocity of the centre of mass, if only by the attitude about a pivot
    known_reactions = 32,        ///< the reactions of its joints
    known_free_system = 64,      ///< that no joint ties the bodies to the world
};

/// One measure of how wrong a trajectory is.
struct Measure {
    std::string_view name;       ///< "attitude": columns are attitude_error, attitude_error_max, ..
    std::string_view title;      ///< for people
    std::string_view unit;       ///< "rad", "m", "relative"; empty where the title says it
    std::string_view meaning;    ///< one line
    unsigned needs = 0;          ///< Known, joined
    bool tabled = false;         ///< has columns in the tables of results and series; without, only `check` tells it
    bool tabled_at_end = false;  ///< and one of its value at the end of the run
    bool over_time = false;      ///< `check` tells its growth
    /// Of a body, before it is divided by the scale; the largest of several counts. Null of what bodies have together.
    MeasureFormula<ComparedBody> error = {};
    /// What that is relative to: the largest of this over the run and the bodies. Absolute where there is none.
    MeasureFormula<BodyMotion> scale = {};
    /// Of all bodies together, where there is no `error`.
    MeasureFormula<ComparedMotion> whole_error = {};
    /// What that is relative to: the largest of this over the run.
    MeasureFormula<SystemInvariants> whole_scale = {};
    bool of_one_body = true;             ///< whether one body alone has it
    bool tabled_of_systems = false;      ///< has columns in tables of several bodies alone
    std::string_view suffix = "_error";  ///< of the name in those columns

    /// Whether it is relative to a scale.
    bool is_relative() const { return scale || whole_scale; }
};

/// All measures, in the order of reports.
std::span<const Measure> measures();
/// The index of a measure by its name. Throws std::invalid_argument where there is none.
std::size_t measure_index(std::string_view name);

/// A value for each measure, by its name or its index in measures().
template <class T>
class PerMeasure {
  public:
    /// The value of a measure by its index.
    T& operator[](std::size_t measure) { return values_[measure]; }
    /// The value of a measure by its index.
    const T& operator[](std::size_t measure) const { return values_[measure]; }
    /// The value of a measure by its name. Throws std::invalid_argument where there is none.
    T& operator[](std::string_view measure) { return values_[measure_index(measure)]; }
    /// The value of a measure by its name. Throws std::invalid_argument where there is none.
    const T& operator[](std::string_view measure) const { return values_[measure_index(measure)]; }
    /// How many measures there are.
    std::size_t size() const { return values_.size(); }

  private:
    std::vector<T> values_ = std::vector<T>(measures().size());
};

/// The truth at one time in the scalar S.
template <class S>
BodyMotion<S> true_motion(const ReferenceSample& truth) {
    const auto value = [](const Pair& pair) { return S(pair.high) + S(pair.low); };
    const auto vector = [&](const Vector3<Pair>& v) { return Vector3<S>{value(v[0]), value(v[1]), value(v[2])}; };
    return {{value(truth.q.w), value(truth.q.x), value(truth.q.y), value(truth.q.z)},
            vector(truth.angular_velocity_B),
            vector(truth.position_W),
            vector(truth.velocity_W)};
}

/// Rotation angle (rad) between q, of any length, and the truth, without regard to sign.
double attitude_error(const Quaternion<double>& q, const Quaternion<Pair>& reference);

}  // namespace polhode
