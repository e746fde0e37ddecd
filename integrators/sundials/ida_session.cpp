// IDA for mechanisms: the implementation of IdaSession.
//
// maximal::ConstrainedEquations provides the residual F(z) - z' of index 1 or of the stabilised index 2 formulation.
// The Jacobian comes from dual numbers, one colour of unknowns at a time, and is sparse. Events restart IDA with
// consistent multipliers, which are computed from the accelerations.
#include "integrators/sundials/ida_session.h"

namespace polhode {
namespace {

// Tolerance of the multipliers relative to their size. The differential variables determine them, they are excluded
// from the error test, and they need not converge further.
constexpr double multiplier_tolerance = 1e-3;

// initial joint coordinates, including those of dependent joints
std::vector<std::array<double, 2>> initial_coordinates(const Problem& problem) {
    const Tree<double>& tree = mechanism_of(problem).tree();
    std::vector<double> y(static_cast<std::size_t>(tree.dimension()));
    tree.initial(y.data());
    return tree.joint_coordinates(y.data());
}

}  // namespace

IdaSession::IdaSession(const Problem& problem, maximal::Index index, double tolerance)
    : problem_(&problem),
      start_(mechanism_initial_motions(problem.scene)),
      system_(problem.scene, start_, initial_coordinates(problem), maximal::LoopRows::independent, {},
              maximal::joints_to_count(problem.scene, index)),
      equations_(system_, index),
      n_(equations_.unknowns()),
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
    std::fill(ids + equations_.differential(), ids + n_, 0.0);
    system_.initial(y());
    set_tolerances();
    check_flag(IDASetErrHandlerFn(memory, store_message, this));
    check_flag(IDAInit(memory, residual, 0, state_.get(), state_rate_.get()));
    check_flag(IDASVtolerances(memory, tolerance_, absolute_.get()));
    check_flag(IDASetUserData(memory, this));
    check_flag(IDASetId(memory, variable_ids_.get()));
    check_flag(IDASetSuppressAlg(memory, SUNTRUE));
    check_flag(IDASetLinearSolver(memory, linear_.get(), matrix_.get()));
    check_flag(IDASetJacFn(memory, fill_jacobian));
}

void IdaSession::set_tolerances() {
    double* absolute = N_VGetArrayPointer(absolute_.get());
    const Scales& scales = problem_->scales;
    const maximal::Mechanism<double>& mechanism = system_.mechanism();
    double mass = 0, speed = scales.velocity;
    for (int b = 0; b < mechanism.world(); ++b) {
        const int first = system_.place(b);
        if (first < 0) continue;
        const maximal::MaximalBody<double>& body = mechanism.bodies[b];
        // centres that do not move have no scale of their own
        const double reach = body.reach(), velocity = std::max(scales.velocity, scales.angular_velocity * reach);
        mass += body.mass, speed = std::max(speed, velocity);
        std::fill_n(absolute + first, 4, tolerance_);
        std::fill_n(absolute + first + 4, 3, tolerance_ * std::max(scales.position, reach));
        std::fill_n(absolute + first + 7, 3, tolerance_ * body.least_moment() * scales.angular_velocity);
        std::fill_n(absolute + first + 10, 3, tolerance_ * body.mass * velocity);
    }
    std::fill(absolute + system_.angles(), absolute + equations_.differential(), tolerance_);
    for (const maximal::Link<double>& link : mechanism.links)
        if (link.angles >= 0 && link.kind == maximal::Kind::prismatic && scales.position > 0)
            absolute[system_.angles() + link.angles] = tolerance_ * scales.position;
    // lambda: forces; mu: momenta; nu: rates
    double acceleration = speed * scales.angular_velocity;
    for (const Load& load : problem_->scene.loads)
        if (const auto* gravity = std::get_if<Gravity>(&load)) acceleration += length(gravity->acceleration_W);
    std::fill(absolute + equations_.lambda(), absolute + equations_.mu(), multiplier_tolerance * mass * acceleration);
    std::fill(absolute + equations_.mu(), absolute + equations_.nu(), multiplier_tolerance * mass * speed);
    std::fill(absolute + equations_.nu(), absolute + n_, multiplier_tolerance * scales.angular_velocity);
}

void IdaSession::restart() {
    N_VConst(0, state_.get()), N_VConst(0, state_rate_.get());
    system_.initial(y());
    evaluations_ = 0, counts_ = {};
    running_ = false;
    not_finite_at_.reset();
}

int IdaSession::enter(const Segment& segment) {
    collect_counts();
    t_ = segment.begin, end_ = segment.end;
    system_.enter(segment.begin, y());
    make_consistent();
    if (!(end_ > t_)) return IDA_SUCCESS;
    running_ = true;
    if (const int flag = IDAReInit(memory_.get(), t_, state_.get(), state_rate_.get()); flag != IDA_SUCCESS)
        return flag;
    return IDASetStopTime(memory_.get(), end_);
}

int IdaSession::step() {
    double reached = t_;
    const int flag = IDASolve(memory_.get(), end_, &reached, state_.get(), state_rate_.get(), IDA_ONE_STEP);
    if (flag == IDA_ILL_INPUT && end_ - t_ < 1e-13 * std::abs(end_)) {
        // a segment as short as a rounding error, on which no solver can start: an explicit Euler step is exact there
        const double* rate = N_VGetArrayPointer(state_rate_.get());
        for (int i = 0; i < equations_.differential(); ++i) y()[i] += (end_ - t_) * rate[i];
        t_ = end_;
        message_.clear();
        ++counts_.steps;
        return IDA_TSTOP_RETURN;
    }
    t_ = flag == IDA_TSTOP_RETURN ? end_ : reached;
    return flag;
}

SolverFailure IdaSession::failure(int flag) {
    const std::unique_ptr<char, decltype(&std::free)> name(IDAGetReturnFlagName(flag), &std::free);
    const std::string reason = message_.empty() ? fmt::format("IDA returned {}", name.get()) : "IDA: " + message_;
    if (not_finite_at_)
        return {Status::diverged, fmt::format("the right-hand side is not finite at {}; {}{}",
                                              format_time(*not_finite_at_), reason, last_state(sample()))};
    const bool out_of_reach = flag == IDA_TOO_MUCH_ACC || flag == IDA_ERR_FAIL || flag == IDA_CONV_FAIL;
    return {out_of_reach ? Status::tolerance_not_met : Status::failed, reason};
}

Moment IdaSession::moment_at(double t, const double* z) const {
    Moment moment{samples_of_bodies(t, system_.motions(z)), {}};
    if (problem_->reactions) moment.reactions = system_.reactions(z, z + equations_.lambda());
    return moment;
}

// lambda from the accelerations; mu and nu vanish, and so do the rates of all three as far as IDA requires them
void IdaSession::make_consistent() {
    equations_.make_consistent(y(), N_VGetArrayPointer(state_rate_.get()));
    ++evaluations_;
}

void IdaSession::collect_counts() {
    if (!running_) return;
    running_ = false;
    counts_.add(memory_.get());
}

// 0, or -1 permanently once a number is not finite: see SundialsSession::right_hand_side()
int IdaSession::check_finite(double t, const double* numbers, std::size_t count) {
    if (all_finite({numbers, count})) return 0;
    not_finite_at_ = t;
    return -1;
}

int IdaSession::residual(double t, N_Vector state, N_Vector rate, N_Vector result, void* session) {
    IdaSession* self = static_cast<IdaSession*>(session);
    if (self->not_finite_at_) return -1;
    const double* dz = N_VGetArrayPointer(rate);
    double* F = N_VGetArrayPointer(result);
    ++self->evaluations_;
    self->equations_.evaluate(N_VGetArrayPointer(state), F);
    for (int i = 0; i < self->equations_.differential(); ++i) F[i] -= dz[i];
    return self->check_finite(t, F, static_cast<std::size_t>(self->n_));
}

// dF/dz + c dF/dz', for the unknowns of one colour at a time
int IdaSession::fill_jacobian(double t, double c, N_Vector state, N_Vector, N_Vector, SUNMatrix J, void* session,
                              N_Vector, N_Vector, N_Vector) {
    IdaSession* self = static_cast<IdaSession*>(session);
    using Equations = maximal::ConstrainedEquations<double>;
    using Number = Dual<Equations::most_in_group>;
    const Equations& equations = self->equations_;
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
void IdaSession::store_message(int code, const char*, const char*, char* text, void* session) {
    if (code <= 0) static_cast<IdaSession*>(session)->message_ = text;
}

}  // namespace polhode
