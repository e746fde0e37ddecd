// User-defined systems: any first-order ODE whose size is known only at run time, defined by a model class. Example:
// two masses connected by a spring along x, y = (x1, x2, v1, v2):
//
//     struct TwoMasses {
//         double k, m1, m2, rest;
//         int dimension() const { return 4; }
//         void initial(double* y) const { y[0] = 0, y[1] = 2 * rest, y[2] = 0, y[3] = 0; }
//         template <class S>
//         void derivative(const S* y, S* dy) const {
//             const S pull = k * (y[1] - y[0] - rest);
//             dy[0] = y[2], dy[1] = y[3], dy[2] = (1 / m1) * pull, dy[3] = (-1 / m2) * pull;
//         }
//         std::vector<double> scales() const { return {rest, rest, 1, 1}; }
//         std::vector<Sample> motion(const double* y) const;  // one for each mass
//     };
//     const Trajectory trajectory = solve(pose(TwoMasses{1, 2, 3, 0.5}, 10.0), *find_method("cvode_adams"));
//
// UserModel is the concept that a model must satisfy, pose() makes a Problem of it, and ErasedSystem is the System that
// methods integrate.
#pragma once

#include <algorithm>
#include <concepts>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "motion/dual.h"
#include "motion/problem.h"
#include "motion/traced.h"

namespace polhode {

/// The `dimension` of a system whose size is known only at run time.
inline constexpr int run_time = -1;

/// The members of a user-defined model:
///
///  * `int dimension() const`: the number n of components of the state y, at least one.
///  * `void initial(double* y) const`: writes y at t = 0.
///  * `template <class S> void derivative(const S* y, S* dy) const`: writes dy/dt. The scalar S is double for steps,
///    Dual for Jacobians and Traced for Taylor coefficients. Compute the rates from components and doubles by +, -, *,
///    /, `square_root(x)` and `sine_cosine(x, sine, cosine)` (body/elementary.h), without branches on their values.
///    The system is autonomous: if it needs the time, make the time a component with the rate S(1).
///  * `std::vector<double> scales() const`: n positive numbers, the typical sizes of the components in their units. A
///    tolerance R of a method means R times these.
///  * `std::vector<Sample> motion(const double* y) const`: the motion of each body at the state y, always the same
///    number, at least one. The caller sets their times.
///
/// Optional, for loads that change or impulses that act at given times:
///
///  * `std::vector<double> events() const`: those times, s.
///  * `void enter(double t, double* y)`: called at t = 0 and at each event. Changes y, and the model for the time from
///    t on.
///
/// Optional, for constraints on y that rounding and steps violate slightly:
///
///  * `bool projects() const`: whether there are constraints.
///  * `void project(double* y) const`: moves y back onto them. Methods that support it call it after each
///    accepted step.
///
/// Optional, for detecting divergence by the kinetic energy of the bodies (J):
///
///  * `double kinetic_energy(const Bodies& bodies) const` and `double energy_bound() const`.
template <class M>
concept UserModel = std::copyable<M> &&
    requires(const M model, double* y, const Dual<jacobian_directions>* x, Dual<jacobian_directions>* rate) {
    { model.dimension() } -> std::convertible_to<int>;
    model.initial(y);
    model.derivative(y, y);
    model.derivative(x, rate);
    { model.scales() } -> std::convertible_to<std::vector<double>>;
    { model.motion(y) } -> std::convertible_to<std::vector<Sample>>;
};

/// @cond internal
/// Type erasure of an UserModel, with one virtual function per scalar. Immutable.
class ErasedModel {
  public:
    virtual ~ErasedModel() = default;
    virtual int dimension() const = 0;
    virtual void initial(double* y) const = 0;
    virtual void derivative(const double* y, double* dy) const = 0;
    virtual void derivative(const Dual<jacobian_directions>* y, Dual<jacobian_directions>* dy) const = 0;
    virtual void derivative(const Traced<double>* y, Traced<double>* dy) const = 0;
    virtual void derivative(const Traced<long double>* y, Traced<long double>* dy) const = 0;
    virtual std::vector<double> scales() const = 0;
    virtual std::vector<Sample> motion(const double* y) const = 0;
    virtual std::vector<Reaction<double>> reactions(const double* y) const = 0;
    virtual std::vector<double> events() const = 0;
    virtual bool projects() const = 0;
    virtual void project(double* y) const = 0;
    virtual double kinetic_energy(const Bodies& bodies) const = 0;
    virtual double energy_bound() const = 0;
    /// The model for the time from t on; y is updated. nullptr if the model does not change.
    virtual std::shared_ptr<const ErasedModel> enter_event(double t, double* y) const = 0;
};

template <UserModel M>
class Erased : public ErasedModel {
  public:
    explicit Erased(M model) : model_(std::move(model)) {}

    int dimension() const override { return model_.dimension(); }
    void initial(double* y) const override { model_.initial(y); }
    void derivative(const double* y, double* dy) const override { model_.derivative(y, dy); }
    void derivative(const Dual<jacobian_directions>* y, Dual<jacobian_directions>* dy) const override {
        model_.derivative(y, dy);
    }
    void derivative(const Traced<double>* y, Traced<double>* dy) const override { model_.derivative(y, dy); }
    void derivative(const Traced<long double>* y, Traced<long double>* dy) const override { model_.derivative(y, dy); }
    std::vector<double> scales() const override { return model_.scales(); }
    std::vector<Sample> motion(const double* y) const override { return model_.motion(y); }
    std::vector<Reaction<double>> reactions([[maybe_unused]] const double* y) const override {
        if constexpr (requires { model_.reactions(y); }) return model_.reactions(y);
        return {};
    }
    std::vector<double> events() const override {
        if constexpr (requires { model_.events(); })
            return model_.events();
        else
            return {};
    }
    bool projects() const override {
        if constexpr (requires { model_.projects(); }) return model_.projects();
        return false;
    }
    void project([[maybe_unused]] double* y) const override {
        if constexpr (requires { model_.project(y); }) model_.project(y);
    }
    double kinetic_energy([[maybe_unused]] const Bodies& bodies) const override {
        if constexpr (requires { model_.kinetic_energy(bodies); }) return model_.kinetic_energy(bodies);
        return 0;
    }
    double energy_bound() const override {
        if constexpr (requires { model_.energy_bound(); }) return model_.energy_bound();
        return std::numeric_limits<double>::infinity();
    }
    std::shared_ptr<const ErasedModel> enter_event(double t, double* y) const override {
        if constexpr (requires(M m) { m.enter(t, y); }) {
            M next = model_;
            next.enter(t, y);
            return std::make_shared<const Erased>(std::move(next));
        } else {
            (void)t, (void)y;
            return nullptr;
        }
    }

    const M& model() const { return model_; }

  private:
    M model_;
};
/// @endcond

/// The problem of a user-defined system over `duration` (s). Called by pose().
Problem pose_model(std::shared_ptr<const ErasedModel> model, double duration);

/// Poses a user-defined system for a run from t = 0 to `duration` (s). Every method with `general_systems` in its
/// descriptor can solve it; the others return `unsupported`. The trajectory has one sample per body at each time.
/// Throws InputError if the duration or the model's own data are invalid.
template <UserModel M>
Problem pose(M model, double duration) {
    return pose_model(std::make_shared<const Erased<M>>(std::move(model)), duration);
}

/// @cond internal
/// The System of a problem with a user-defined system.
class ErasedSystem {
  public:
    using Scalar = double;
    static constexpr int dimension = run_time;
    static constexpr bool about_axis = false, has_translation = false;

    explicit ErasedSystem(const Problem& problem)
        : model_(problem.model()), size_(model_->dimension()), reactions_(problem.reactions) {}

    int size() const { return size_; }
    void initial(double* y) const { model_->initial(y); }
    bool enter(const Segment& segment, double* y) {
        std::shared_ptr<const ErasedModel> next = model_->enter_event(segment.begin, y);
        if (!next) return false;
        model_ = std::move(next);
        return true;
    }
    template <class S>
    void derivative(double, const S* y, S* dy) const {
        model_->derivative(y, dy);
    }
    Moment motion(double t, const double* y) const {
        Moment moment{model_->motion(y), {}};
        for (Sample& body : moment.samples) body.t = t;
        if (reactions_) moment.reactions = model_->reactions(y);
        return moment;
    }
    /// Whether there are constraints that steps violate slightly; project() moves y back onto them.
    bool projects() const { return model_->projects(); }
    void project(double* y) const { model_->project(y); }
    void scales(double* scales) const {
        const std::vector<double> s = model_->scales();
        std::copy(s.begin(), s.end(), scales);
    }

  private:
    std::shared_ptr<const ErasedModel> model_;
    int size_;
    bool reactions_;
};

/// Projects the state after a step onto the system's constraints. Returns whether the system has any.
template <class SystemType, class Scalar>
bool project_step([[maybe_unused]] const SystemType& system, [[maybe_unused]] Scalar* y) {
    if constexpr (requires { system.project(y); }) {
        if (!system.projects()) return false;
        system.project(y);
        return true;
    }
    return false;
}

inline void jacobian(const ErasedSystem& system, double t, const double* y, double* J) {
    jacobian_by_columns<jacobian_directions>(system, t, y, J);
}
/// @endcond

}  // namespace polhode
