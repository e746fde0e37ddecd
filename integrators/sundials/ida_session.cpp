// The implementation of IdaSession. Events restart IDA with consistent multipliers.
#include "integrators/sundials/ida_session.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <string>

namespace polhode {
namespace {

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
      solver_(system_, equations_, problem.scales, tolerance) {
    system_.initial(solver_.unknowns());
}

void IdaSession::restart() {
    solver_.reset();
    system_.initial(solver_.unknowns());
}

int IdaSession::enter(const Segment& segment) {
    solver_.counts();
    system_.enter(segment.begin, solver_.unknowns());
    solver_.set_state(segment.begin);
    if (!(segment.end > segment.begin)) return IDA_SUCCESS;
    if (const int flag = solver_.start(); flag != IDA_SUCCESS) return flag;
    return solver_.set_stop(segment.end);
}

SolverFailure IdaSession::failure(int flag) {
    const std::string reason = solver_.reason(flag);
    if (solver_.not_finite_at())
        return {Status::diverged, fmt::format("the right-hand side is not finite at {}; {}{}",
                                              format_time(*solver_.not_finite_at()), reason, last_state(sample()))};
    const bool out_of_reach = flag == IDA_TOO_MUCH_ACC || flag == IDA_ERR_FAIL || flag == IDA_CONV_FAIL;
    return {out_of_reach ? Status::tolerance_not_met : Status::failed, reason};
}

Moment IdaSession::moment_at(double t, const double* z) const {
    Moment moment{samples_of_bodies(t, system_.motions(z)), {}};
    if (problem_->reactions) moment.reactions = system_.reactions(z, z + equations_.lambda());
    return moment;
}

}  // namespace polhode
