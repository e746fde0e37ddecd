// The implementation of IdaSolver.
//
// maximal::ConstrainedEquations provides the residual F(z) - z' of index 1 or of the stabilised index 2 formulation.
// The Jacobian comes from dual numbers, one colour of unknowns at a time, and is sparse. Starts use consistent
// multipliers, which are computed from the accelerations.
#include "integrators/sundials/ida_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "motion/dual.h"
#include "motion/finite.h"

namespace polhode {
namespace {

// Tolerance of the multipliers relative to their size. The differential variables determine them, they are excluded
// from the error test, and they need not converge further.
constexpr double multiplier_tolerance = 1e-3;

}  // namespace

IdaSolver::IdaSolver(const maximal::System<double>& system, const maximal::ConstrainedEquations<double>& equations,
                     const Scales& scales, double tolerance, std::function<void(double)> set_time)
    : equations_(&equations),
      set_time_(std::move(set_time)),
      n_(equations.unknowns()),
      // smaller tolerances are rejected elsewhere; below this value the weights (reciprocals) would overflow
      tolerance_(std::max(tolerance, 1e-100)),
      state_(make_owner(N_VNew_Serial(n_, context_))),
      state_rate_(make_owner(N_VNew_Serial(n_, context_))),
      absolute_(make_owner(N_VNew_Serial(n_, context_))),
      variable_ids_(make_owner(N_VNew_Serial(n_, context_))),
      interpolated_(make_owner(N_VNew_Serial(n_, context_))),
      matrix_(make_owner(SparseMatrix::make(n_, context_))),
      linear_(make_owner(SparseSolver::make(context_))),
      memory_(IDACreate(context_)) {
    if (!memory_) throw std::bad_alloc();
    void* memory = memory_.get();
    N_VConst(0, state_.get()), N_VConst(0, state_rate_.get());
    N_VConst(1, variable_ids_.get());
    double* ids = N_VGetArrayPointer(variable_ids_.get());
    std::fill(ids + equations.differential(), ids + n_, 0.0);
    set_tolerances(system, scales);
    check_flag(IDASetErrHandlerFn(memory, store_message, this));
    check_flag(IDAInit(memory, residual, 0, state_.get(), state_rate_.get()));
    check_flag(IDASVtolerances(memory, tolerance_, absolute_.get()));
    check_flag(IDASetUserData(memory, this));
    check_flag(IDASetId(memory, variable_ids_.get()));
    check_flag(IDASetSuppressAlg(memory, SUNTRUE));
    check_flag(IDASetLinearSolver(memory, linear_.get(), matrix_.get()));
    check_flag(IDASetJacFn(memory, fill_jacobian));
}

void IdaSolver::set_tolerances(const maximal::System<double>& system, const Scales& scales) {
    double* absolute = N_VGetArrayPointer(absolute_.get());
    const maximal::Mechanism<double>& mechanism = system.mechanism();
    double mass = 0, speed = scales.velocity;
    for (int b = 0; b < mechanism.world(); ++b) {
        const int first = system.place(b);
        if (first < 0) continue;
        const maximal::MaximalBody<double>& body = mechanism.bodies[b];
        // centres that do not move have no scale
        const double reach = body.reach(), velocity = std::max(scales.velocity, scales.angular_velocity * reach);
        mass += body.mass, speed = std::max(speed, velocity);
        std::fill_n(absolute + first, 4, tolerance_);
        std::fill_n(absolute + first + 4, 3, tolerance_ * std::max(scales.position, reach));
        std::fill_n(absolute + first + 7, 3, tolerance_ * body.least_moment() * scales.angular_velocity);
        std::fill_n(absolute + first + 10, 3, tolerance_ * body.mass * velocity);
    }
    std::fill(absolute + system.angles(), absolute + equations_->differential(), tolerance_);
    for (const maximal::Link<double>& link : mechanism.links)
        if (link.angles >= 0 && link.kind == maximal::Kind::prismatic && scales.position > 0)
            absolute[system.angles() + link.angles] = tolerance_ * scales.position;
    // lambda: forces; mu: momenta; nu: rates
    double acceleration = speed * scales.angular_velocity;
    for (const Load& load : mechanism.scene().loads)
        if (const auto* gravity = std::get_if<Gravity>(&load)) acceleration += length(gravity->acceleration_W);
    std::fill(absolute + equations_->lambda(), absolute + equations_->mu(), multiplier_tolerance * mass * acceleration);
    std::fill(absolute + equations_->mu(), absolute + equations_->nu(), multiplier_tolerance * mass * speed);
    std::fill(absolute + equations_->nu(), absolute + n_, multiplier_tolerance * scales.angular_velocity);
}

void IdaSolver::reset() {
    N_VConst(0, state_.get()), N_VConst(0, state_rate_.get());
    evaluations_ = 0, counts_ = {};
    running_ = false;
    not_finite_at_.reset();
}

void IdaSolver::set_state(double t) {
    collect_counts();
    t_ = t;
    if (set_time_) set_time_(t);
    equations_->make_consistent(unknowns(), N_VGetArrayPointer(state_rate_.get()));
    ++evaluations_;
}

int IdaSolver::start() {
    running_ = true;
    return IDAReInit(memory_.get(), t_, state_.get(), state_rate_.get());
}

// Backward Euler's error h^2 |y''| / 2 is about R times the scale s of y for h = sqrt(R) s / |y'|.
int IdaSolver::start_from_event() {
    constexpr double newton_tolerance = 1e-3, safety = 0.1;
    if (const int flag = start(); flag != IDA_SUCCESS) return flag;
    if (const int flag = IDASetNonlinConvCoef(memory_.get(), newton_tolerance); flag != IDA_SUCCESS) return flag;
    const double* absolute = N_VGetArrayPointer(absolute_.get());
    const int n = equations_->differential();
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double weighted = rates()[i] / (tolerance_ * std::abs(unknowns()[i]) + absolute[i]);
        sum += weighted * weighted;
    }
    const double norm = std::sqrt(sum / n);
    return norm > 0 && std::isfinite(norm) ? IDASetInitStep(memory_.get(), safety / (std::sqrt(tolerance_) * norm))
                                           : IDA_SUCCESS;
}

int IdaSolver::step() {
    double reached = t_;
    const int flag = IDASolve(memory_.get(), end_, &reached, state_.get(), state_rate_.get(), IDA_ONE_STEP);
    was_euler_step_ = flag == IDA_ILL_INPUT && end_ - t_ < 1e-13 * std::abs(end_);
    if (was_euler_step_) {
        // an interval as short as a rounding error, on which no solver can start: an explicit Euler step is exact there
        for (int i = 0; i < equations_->differential(); ++i) unknowns()[i] += (end_ - t_) * rates()[i];
        t_ = end_;
        message_.clear();
        ++counts_.steps;
        return IDA_TSTOP_RETURN;
    }
    t_ = flag == IDA_TSTOP_RETURN ? end_ : reached;
    return flag;
}

const double* IdaSolver::inside(double t) {
    if (was_euler_step_) return unknowns();
    IDAGetDky(memory_.get(), t, 0, interpolated_.get());
    return N_VGetArrayPointer(interpolated_.get());
}

int IdaSolver::last_order() const {
    int order = 1;
    IDAGetLastOrder(memory_.get(), &order);
    return std::max(order, 1);
}

std::string IdaSolver::reason(int flag) const {
    const std::unique_ptr<char, decltype(&std::free)> name(IDAGetReturnFlagName(flag), &std::free);
    return message_.empty() ? fmt::format("IDA returned {}", name.get()) : "IDA: " + message_;
}

void IdaSolver::collect_counts() {
    if (!running_) return;
    running_ = false;
    counts_.add(memory_.get());
}

// 0, or -1 permanently once a number is not finite: see SundialsSession::right_hand_side()
int IdaSolver::check_finite(double t, const double* numbers, std::size_t count) {
    if (all_finite({numbers, count})) return 0;
    not_finite_at_ = t;
    return -1;
}

int IdaSolver::residual(double t, N_Vector state, N_Vector rate, N_Vector result, void* solver) {
    IdaSolver* self = static_cast<IdaSolver*>(solver);
    if (self->not_finite_at_) return -1;
    const double* dz = N_VGetArrayPointer(rate);
    double* F = N_VGetArrayPointer(result);
    ++self->evaluations_;
    if (self->set_time_) self->set_time_(t);
    self->equations_->evaluate(N_VGetArrayPointer(state), F);
    for (int i = 0; i < self->equations_->differential(); ++i) F[i] -= dz[i];
    return self->check_finite(t, F, static_cast<std::size_t>(self->n_));
}

// dF/dz + c dF/dz', for the unknowns of one colour at a time
int IdaSolver::fill_jacobian(double t, double c, N_Vector state, N_Vector, N_Vector, SUNMatrix J, void* solver,
                             N_Vector, N_Vector, N_Vector) {
    IdaSolver* self = static_cast<IdaSolver*>(solver);
    using Equations = maximal::ConstrainedEquations<double>;
    using Number = Dual<Equations::most_in_group>;
    const Equations& equations = *self->equations_;
    if (self->set_time_) self->set_time_(t);
    const double* z = N_VGetArrayPointer(state);
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> values;
    std::vector<Number> at(z, z + self->n_), result(self->n_);
    for (int color = 0; color < equations.colors(); ++color) {
        const auto seed = [&](double slope) {
            for (const maximal::Group& group : equations.groups())
                for (std::size_t i = 0; group.color == color && i < group.unknowns.size(); ++i)
                    at[group.unknowns[i]].slope[i] = slope;
        };
        seed(1);
        equations.evaluate(at.data(), result.data());
        seed(0);
        for (const maximal::Group& group : equations.groups()) {
            if (group.color != color) continue;
            for (std::size_t i = 0; i < group.unknowns.size(); ++i)
                for (const int other : group.coupled_groups)
                    for (const int row : equations.groups()[other].unknowns) {
                        values.push_back(result[row].slope[i]);
                        entries.emplace_back(row, group.unknowns[i], values.back());
                    }
        }
    }
    for (int i = 0; i < equations.differential(); ++i) entries.emplace_back(i, i, -c);
    SparseMatrix::entries(J).setFromTriplets(entries.begin(), entries.end());
    return self->check_finite(t, values.data(), values.size());
}

// positive codes are warnings
void IdaSolver::store_message(int code, const char*, const char*, char* text, void* solver) {
    if (code <= 0) static_cast<IdaSolver*>(solver)->message_ = text;
}

}  // namespace polhode
