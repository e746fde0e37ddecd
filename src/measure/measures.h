// What is measured of a trajectory: each measure is one row of data, and one function of a sample beside the truth.
//
// Tables of results, series over time, the list of metrics and the reports on files take their columns from here, so
// that a new measure is one entry in measures.cpp.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "body/elementary.h"
#include "motion/exact_body.h"
#include "motion/mechanism_motion.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// The truth at one time. S is double, which drops the low parts of the truth, or Wide.
template <class S>
struct TrueState {
    Quaternion<S> q;                ///< body to world, of unit length
    Vector3<S> angular_velocity_B;  ///< rad/s
    Vector3<S> position_W;          ///< of the centre of mass, m
    Vector3<S> velocity_W;          ///< of the centre of mass, m/s
    Vector3<S> angular_momentum_W;  ///< about the pivot, or else about the centre of mass, kg m^2/s
    S kinetic = S(0);               ///< energy, J
    S energy = S(0);                ///< kinetic and potential, J
};

/// What is below this share of the parts that it is the sum of, or of a radian, is rounding in binary64, and counts as
/// 0.
inline constexpr double vanishing = 1e-15;

/// A sample beside the truth at its time, with the energy and the angular momentum that follow from the sample's own
/// numbers.
template <class S>
struct ComparedSample {
    Quaternion<S> q;                             ///< body to world as the method left it, of any length but zero
    Vector3<S> angular_velocity_B;               ///< rad/s
    Vector3<S> position_W;                       ///< of the centre of mass, m
    Vector3<S> velocity_W;                       ///< of the centre of mass, m/s
    std::optional<double> orthogonality_defect;  ///< of a matrix method: Frobenius norm of A^T A - 1
    Vector3<S> angular_momentum_W;               ///< about the pivot, or else about the centre of mass, kg m^2/s
    S energy = S(0);                             ///< kinetic and potential, J
    TrueState<S> truth;                          ///< at the sample's time
};

/// Several bodies at one time, beside the truth at that time: what they have together.
template <class S>
struct ComparedSystem {
    SystemInvariants<S> own;    ///< as it follows from the bodies' own numbers
    SystemInvariants<S> truth;  ///< as it follows from the truth's
    JointViolations<S> joints;  ///< of the bodies' own numbers
    S reaction_error = S(0);    ///< of all joints, relative to the run's largest reaction
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
    /// Of one sample, before it is divided by the scale; of several bodies the largest counts. Null of what a body
    /// alone does not have.
    MeasureFormula<ComparedSample> error = {};
    /// What the error is relative to: the largest of this over the run (and the bodies). Absolute where there is none.
    MeasureFormula<TrueState> scale = {};
    /// Of several bodies, what stands in the place of `error`: of all of them together.
    MeasureFormula<ComparedSystem> system_error = {};
    /// And in the place of `scale`.
    MeasureFormula<SystemInvariants> system_scale = {};
    bool tabled_of_systems = false;      ///< has columns in tables of several bodies alone
    std::string_view suffix = "_error";  ///< of the name in those columns

    /// Whether one body has it.
    bool of_one_body() const { return static_cast<bool>(error); }
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

/// The truth at one time in the scalar S, without the kinetic energy.
template <class S>
TrueState<S> true_motion(const ReferenceSample& truth) {
    const auto value = [](const Pair& pair) { return S(pair.high) + S(pair.low); };
    const auto vector = [&](const Vector3<Pair>& v) { return Vector3<S>{value(v[0]), value(v[1]), value(v[2])}; };
    return {{value(truth.q.w), value(truth.q.x), value(truth.q.y), value(truth.q.z)},
            vector(truth.angular_velocity_B),
            vector(truth.position_W),
            vector(truth.velocity_W),
            vector(truth.angular_momentum_W),
            S(0),
            value(truth.energy)};
}

/// The truth at one time in the scalar S, with the kinetic energy of the body.
template <class S>
TrueState<S> true_state(const ExactBody<S>& body, const ReferenceSample& truth) {
    TrueState<S> state = true_motion<S>(truth);
    state.kinetic = dot(state.angular_velocity_B, body.inertia_B * state.angular_velocity_B) / S(2);
    if (!body.pivoted) state.kinetic += body.mass * dot(state.velocity_W, state.velocity_W) / S(2);
    return state;
}

/// Sets the energy and the angular momentum of a sample whose other numbers are set. `unit` is its q, normalised; loads
/// act as the scene has them at time t (s).
template <class S>
void set_invariants(ComparedSample<S>& sample, const Scene& scene, const ExactBody<S>& body, double t,
                    const Quaternion<S>& unit) {
    const Invariants<S> own =
        invariants(scene, body, t, unit, sample.angular_velocity_B, sample.position_W, sample.velocity_W);
    sample.angular_momentum_W = own.angular_momentum_W, sample.energy = own.energy;
}

/// Rotation angle (rad) between q, of any length, and the truth, without regard to sign.
double attitude_error(const Quaternion<double>& q, const Quaternion<Pair>& reference);

}  // namespace polhode
