// Soft constraints with substeps: E. Catto 2011, Soft Constraints, Game Developers Conference; 2024, Solver2D; and
// Box2D v3.1 (src/solver.c, src/world.c, src/types.c), from which the constants are taken.
#include <algorithm>
#include <numbers>
#include <span>

#include "integrators/multibody/binary32_variants.h"
#include "integrators/multibody/joint_rows.h"
#include "integrators/multibody/maximal_state.h"
#include "integrators/multibody/velocity_rows.h"

namespace polhode {
namespace {

/// h = step / substeps; in each substep, with w_n = 2 pi f, f = min(60 Hz, 1/(8 h)), zeta = 2:
///   v += h F / m,  w += h I^-1 tau;  apply the impulses of the previous substep
///   solve: each block of a joint once,  d = -s K^-1 (J v + b C) - (1 - s) lambda,
///     a_1 = 2 zeta + h w_n,  b = w_n / a_1,  s = h w_n a_1 / (1 + h w_n a_1)
///   x += h v,  q = exp(h w) q
///   relax: each block once,  d = -K^-1 J v
/// Limits and friction of joints are solved before the blocks, a limit that is passed with the same softness.
/// A block constrains a point (or a distance, or a rail) or axes; K = J M^-1 J^T of the block.
template <class S, int substeps>
class SoftStep : public multibody::MaximalState<S> {
    using Base = multibody::MaximalState<S>;
    using Base::bodies_, Base::steps_;
    using Softness = multibody::Softness<S>;

  public:
    explicit SoftStep(const Problem& problem) : Base(problem) {
        impulses_.resize(this->pairs().size());
        joint_rows_ = multibody::joint_rows(problem.scene, this->pairs());
    }
    void restart() {
        Base::restart();
        for (auto& impulse : impulses_) impulse = {};
        for (auto& row : joint_rows_) row.forget();
    }
    void step(double, double step) {
        const S h = S(step) / substeps;
        constexpr S damping_ratio = 2, hertz = 60;
        const S w_n = 2 * std::numbers::pi_v<S> * std::min(hertz, S(0.125) / h);
        const S a1 = 2 * damping_ratio + h * w_n, a2 = h * w_n * a1;
        const Softness soft{w_n / a1, a2 / (1 + a2), 1 / (1 + a2)}, rigid{};
        for (int i = 0; i < substeps; ++i) {
            for_each_joint_row([&](auto& row, const auto& at, S x) { row.start_step(at, x, h, soft.bias_rate); });
            this->template accelerate<GyroscopicTerm::one_newton_step>(h);
            update_rows();
            for (std::size_t k = 0; k < rows_.size(); ++k) {
                const auto& pair = this->pairs()[k];
                const auto& rows = rows_[k].rows;
                for (std::size_t r = 0; r < rows.count; ++r)
                    rows.row[r].apply_impulse(impulses_[k][r], bodies_[pair.from], bodies_[pair.to]);
            }
            for (auto& row : joint_rows_) {
                const auto& pair = this->pairs()[row.pair];
                row.warm_start(S(1), bodies_[pair.from], bodies_[pair.to]);
            }
            solve_joints(soft);
            for (auto& body : bodies_) this->move(body, h, body.v, body.w);
            update_rows();
            for_each_joint_row([&](auto& row, const auto& at, S x) { row.update(at, x, h, S(0)); });
            solve_joints(rigid);
            ++steps_;
        }
    }

  private:
    std::vector<std::array<S, 6>> impulses_;
    std::vector<multibody::BlockedPair<S>> rows_;
    std::vector<multibody::JointRow<S>> joint_rows_;

    template <class Action>
    void for_each_joint_row(Action&& action) {
        for (auto& row : joint_rows_) {
            const auto at = this->view(this->pairs()[row.pair]);
            multibody::update_coordinates(at, this->coordinates_[row.pair]);
            action(row, at, this->coordinates_[row.pair][0]);
        }
    }
    void update_rows() {
        rows_.clear();
        for (const auto& pair : this->pairs()) rows_.emplace_back(this->view(pair));
    }
    void solve_joints(const Softness& softness) {
        for (auto& row : joint_rows_) {
            const auto& pair = this->pairs()[row.pair];
            row.solve(bodies_[pair.from], bodies_[pair.to], softness);
        }
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const auto& pair = this->pairs()[k];
            rows_[k].solve(softness, impulses_[k], bodies_[pair.from], bodies_[pair.to]);
        }
    }
};

template <class S, int substeps>
Trajectory solve_soft_step(const Problem& problem, const Settings& settings) {
    return march<SoftStep<S, substeps>>(problem, settings);
}

constexpr Method soft_step_variants[] = {
    {.name = "soft_step_4",
     .documentation =
         "Soft constraints with 4 substeps, as in the joint solver of Box2D v3.1. In each substep every joint is "
         "solved once as a spring of 60 Hz (at most 1/8 per substep) and damping ratio 2, then positions move, and "
         "every joint is solved once more without the spring (relaxing), which removes the energy of the spring. The "
         "impulses of the previous substep are the first guess. Points and axes are solved as blocks. In space each "
         "body has its gyroscopic term, in one Newton step. Springs, dampers and motors of joints are forces at the "
         "start of the substep. Friction of a joint is a motor at speed zero, a limit stops the joint at the end of "
         "the "
         "substep in which it arrives and is soft once it is passed; restitution is not supported. While positions "
         "move, only the spring holds the "
         "joints: they open by a / w_n^2 for any "
         "step, where a is the acceleration to be held and w_n = 2 pi 60 Hz. They open less only over times below 1 / "
         "(h w_n^2), where the order is 1.",
     .solve = solve_soft_step<double, 4>},
    {.name = "soft_step_16",
     .documentation = "`soft_step_4` with 16 substeps per step.",
     .solve = solve_soft_step<double, 16>},
};

constexpr auto soft_step_binary64_family =
    apply_defaults({.source = "E. Catto 2011, Soft Constraints, Game Developers Conference; Box2D v3.1, "
                              "b2MakeSoft and the stages of b2Solve, jointHertz 60, jointDampingRatio 2",
                    .conserves = "|q|; linear momentum of a mechanism that is not connected to the world",
                    .control = Control::fixed_step,
                    .general_systems = true,
                    .order = 1,
                    .family = Family::engine_update,
                    .refusal = multibody::soft_limit_refusal},
                   soft_step_variants);

constexpr auto soft_step_family =
    multibody::with_binary32_variants<soft_step_binary64_family, solve_soft_step<float, 4>,
                                      solve_soft_step<float, 16>>();

}  // namespace

extern const std::span<const Method> soft_step_methods{soft_step_family};

}  // namespace polhode
