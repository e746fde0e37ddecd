// A system of the user's own: any first-order ODE whose state is of a size that only the running program knows, made
// from a model that the user writes. For example two masses on a spring along x, y = (x1, x2, v1, v2):
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

/// The size of a state that the compiler does not know.
inline constexpr int run_time = -1;

/// What a model of one's own has:
///
///  * `int dimension() const`: the number n of components of the state y, at least one.
///  * `void initial(double* y) const`: writes y at t = 0.
///  * `template <class S> void derivative(const S* y, S* dy) const`: writes dy/dt. The scalar S is double for a step,
///    Dual where a Jacobian is needed and Traced where Taylor coefficients are: the rates are made of components and of
///    doubles by +, -, *, /, `square_root(x)` and `sine_cosine(x, sine, cosine)` (body/elementary.h), without branches
///    on their values. Time does not enter: where it is needed, it is a component with the rate S(1).
///  * `std::vector<double> scales() const`: n positive numbers, the sizes that the components reach, in their units. A
///    method's tolerance R means R times these.
///  * `std::vector<Sample> motion(const double* y) const`: the motion of each body at the state y, always as many, at
///    least one. Their times are filled in by the caller.
///
/// Where loads change or impulses act at given times it has besides:
///
///  * `std::vector<double> events() const`: those times, s.
///  * `void enter(double t, double* y)`: called at t = 0 and at each event: changes y, and the model to what holds from
///    then on.
///
/// Where y must keep conditions that rounding and steps leave by a little:
///
///  * `bool projects() const`, whether there are any, and `void project(double* y) const`, which moves y back onto
///  them:
///    called after each step of a method that goes from step to step.
///
/// Where the bodies' kinetic energy (J) is known, so that a run can be told to have diverged:
///
///  * `double kinetic_energy(const Bodies& bodies) const` and `double energy_bound() const`.
template <class M>
concept OwnModel = std::copyable<M> &&
    requires(const M model, double* y, const Dual<own_directions>* x, Dual<own_directions>* rate) {
    { model.dimension() } -> std::convertible_to<int>;
    model.initial(y);
    model.derivative(y, y);
    model.derivative(x, rate);
    { model.scales() } -> std::convertible_to<std::vector<double>>;
    { model.motion(y) } -> std::convertible_to<std::vector<Sample>>;
};

/// @cond internal
/// An OwnModel behind one type, each scalar by a virtual function of its own. It does not change.
class ErasedModel {
  public:
    virtual ~ErasedModel() = default;
    virtual int dimension() const = 0;
    virtual void initial(double* y) const = 0;
    virtual void derivative(const double* y, double* dy) const = 0;
    virtual void derivative(const Dual<own_directions>* y, Dual<own_directions>* dy) const = 0;
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
    /// The model that holds from t on; y as it is then. nullptr where there is no other.
    virtual std::shared_ptr<const ErasedModel> entered(double t, double* y) const = 0;
};

template <OwnModel M>
class Erased : public ErasedModel {
  public:
    explicit Erased(M model) : model_(std::move(model)) {}

    int dimension() const override { return model_.dimension(); }
    void initial(double* y) const override { model_.initial(y); }
    void derivative(const double* y, double* dy) const override { model_.derivative(y, dy); }
    void derivative(const Dual<own_directions>* y, Dual<own_directions>* dy) const override {
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
    std::shared_ptr<const ErasedModel> entered(double t, double* y) const override {
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

/// The problem of an own system over `duration` (s), as pose() makes it.
Problem pose_own(std::shared_ptr<const ErasedModel> model, double duration);

/// Poses a system of one's own for a run from t = 0 to `duration` (s). It is solved like a scene's problem by every
/// method whose descriptor says `own_systems`; the others answer `unsupported`. The trajectory has one sample for each
/// body at each time. Throws InputError where the duration or what the model says of itself makes no sense.
template <OwnModel M>
Problem pose(M model, double duration) {
    return pose_own(std::make_shared<const Erased<M>>(std::move(model)), duration);
}

/// @cond internal
/// The System of such a problem.
class OwnSystem {
  public:
    using Scalar = double;
    static constexpr int dimension = run_time;
    static constexpr bool about_axis = false, has_translation = false;

    explicit OwnSystem(const Problem& problem)
        : model_(problem.model()), size_(model_->dimension()), reactions_(problem.reactions) {}

    int size() const { return size_; }
    void initial(double* y) const { model_->initial(y); }
    bool enter(const Segment& segment, double* y) {
        std::shared_ptr<const ErasedModel> next = model_->entered(segment.begin, y);
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
    /// Whether there are conditions that a step leaves by a little, and the way back onto them.
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

/// Moves a state after a step back onto what the system keeps; whether there was anything to do.
template <class SystemType, class Scalar>
bool project_step([[maybe_unused]] const SystemType& system, [[maybe_unused]] Scalar* y) {
    if constexpr (requires { system.project(y); }) {
        if (!system.projects()) return false;
        system.project(y);
        return true;
    }
    return false;
}

inline void jacobian(const OwnSystem& system, double t, const double* y, double* J) {
    jacobian_by_columns<own_directions>(system, t, y, J);
}
/// @endcond

}  // namespace polhode
