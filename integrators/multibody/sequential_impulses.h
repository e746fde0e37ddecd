// Sequential impulses: E. Catto 2005, Iterative Dynamics with Temporal Coherence, Game Developers Conference.
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "integrators/multibody/joint_rows.h"
#include "integrators/multibody/maximal_state.h"
#include "integrators/multibody/velocity_rows.h"

namespace polhode::multibody {

/// Options of the impulse solver.
struct ImpulseOptions {
    int iterations = 10;
    bool warm_start = true;       ///< starts from the previous step's impulses, scaled by the ratio of the steps
    bool split = false;           ///< corrects positions by separate velocities that are discarded after the step
    bool gyroscopic_term = true;  ///< w x I w by one Newton step; otherwise omitted
    bool blocks = false;          ///< solves a joint's axes together, then its points together; otherwise row by row
};

/// Semi-implicit Euler in maximal coordinates. Gauss-Seidel iteration over the rows computes the constraint impulses:
///   v += h F / m,  w += h I^-1 tau,
///   repeatedly for each row:  d = -(J v + (beta/h) C) / (J M^-1 J^T),  (v, w) += M^-1 J^T d,  lambda += d
///   x += h v,  q = exp(h w) q
/// with J and C at the start of the step, beta = 0.2. Limits and friction of joints are rows with bounded impulses
/// (joint_rows.h), solved before the others in each iteration.
template <class S, ImpulseOptions options>
class SequentialImpulses : public MaximalState<S> {
    using Base = MaximalState<S>;
    using Base::bodies_, Base::steps_;

  public:
    explicit SequentialImpulses(const Problem& problem) : Base(problem) {
        impulses_.resize(this->pairs().size());
        joint_rows_ = joint_rows(problem.scene, this->pairs());
    }
    void restart() {
        Base::restart();
        for (auto& impulse : impulses_) impulse = {};
        for (JointRow<S>& row : joint_rows_) row.forget();
        previous_step_ = 0;
    }
    void step(double, double step) {
        const S h = S(step), beta = S(0.2), correction_rate = beta / h;
        constexpr GyroscopicTerm term =
            options.gyroscopic_term ? GyroscopicTerm::one_newton_step : GyroscopicTerm::none;
        for (JointRow<S>& row : joint_rows_) {
            const PairView<S> at = this->view(this->pairs()[row.pair]);
            update_coordinates(at, this->coordinates_[row.pair]);
            row.start_step(at, this->coordinates_[row.pair][0], h, options.split ? S(0) : correction_rate);
        }
        this->template accelerate<term>(h);
        rows_.clear();
        for (const JointPair<S>& pair : this->pairs()) rows_.emplace_back(this->view(pair));
        if constexpr (!options.blocks) update_masses();
        const S ratio = previous_step_ > 0 ? h / previous_step_ : S(0);
        previous_step_ = h;
        for_each_row([&](std::size_t k, std::size_t i, const VelocityRow<S>& row, MovingBody<S>& a, MovingBody<S>& b) {
            S& impulse = impulses_[k][i];
            impulse = options.warm_start ? ratio * impulse : S(0);
            if (options.warm_start) row.apply_impulse(impulse, a, b);
        });
        const auto solve_joint_rows = [&] {
            for (JointRow<S>& row : joint_rows_) {
                const JointPair<S>& pair = this->pairs()[row.pair];
                row.solve(bodies_[pair.from], bodies_[pair.to]);
            }
        };
        for (JointRow<S>& row : joint_rows_) {
            const JointPair<S>& pair = this->pairs()[row.pair];
            row.warm_start(options.warm_start ? ratio : S(0), bodies_[pair.from], bodies_[pair.to]);
        }
        if constexpr (options.blocks) {
            const Softness<S> rigid{correction_rate, S(1), S(0)};
            for (int iteration = 0; iteration < options.iterations; ++iteration) {
                solve_joint_rows();
                for (std::size_t k = 0; k < rows_.size(); ++k) {
                    const JointPair<S>& pair = this->pairs()[k];
                    rows_[k].solve(rigid, impulses_[k], bodies_[pair.from], bodies_[pair.to]);
                }
            }
        }
        for (int iteration = 0; !options.blocks && iteration < options.iterations; ++iteration) {
            solve_joint_rows();
            for_each_row(
                [&](std::size_t k, std::size_t i, const VelocityRow<S>& row, MovingBody<S>& a, MovingBody<S>& b) {
                    const S bias = options.split ? S(0) : correction_rate * row.error;
                    const S change = -masses_[k][i] * (row.velocity(a, b) + bias);
                    impulses_[k][i] += change;
                    row.apply_impulse(change, a, b);
                });
        }
        if constexpr (options.split) {
            correct_positions(h, correction_rate);
        } else {
            for (MovingBody<S>& body : bodies_) this->move(body, h, body.v, body.w);
        }
        ++steps_;
    }

  private:
    using Rows = std::conditional_t<options.blocks, BlockedPair<S>, PairRows<S>>;
    std::vector<Rows> rows_;
    std::vector<std::array<S, 6>> masses_, impulses_;
    std::vector<JointRow<S>> joint_rows_;
    S previous_step_ = S(0);

    static const PairRows<S>& plain_rows(const PairRows<S>& rows) { return rows; }
    static const PairRows<S>& plain_rows(const BlockedPair<S>& pair) { return pair.rows; }
    template <class Action>
    void for_each_row(Action&& action) {
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const JointPair<S>& pair = this->pairs()[k];
            MovingBody<S>&a = bodies_[pair.from], &b = bodies_[pair.to];
            const PairRows<S>& rows = plain_rows(rows_[k]);
            for (std::size_t i = 0; i < rows.count; ++i) action(k, i, rows.row[i], a, b);
        }
    }
    void update_masses() {
        masses_.resize(rows_.size());
        for_each_row([&](std::size_t k, std::size_t i, const VelocityRow<S>& row, MovingBody<S>& a, MovingBody<S>& b) {
            masses_[k][i] = 1 / coupling(row, row, a, b);
        });
    }
    // the same iteration for the correction velocities, which start at zero
    void correct_positions(S h, S correction_rate) {
        const std::vector<MovingBody<S>> real = bodies_;
        for (MovingBody<S>& body : bodies_) body.v = body.w = {};
        for (JointRow<S>& row : joint_rows_) row.start_correction(correction_rate);
        for (int iteration = 0; iteration < options.iterations; ++iteration) {
            for (JointRow<S>& row : joint_rows_) {
                const JointPair<S>& pair = this->pairs()[row.pair];
                row.correct(bodies_[pair.from], bodies_[pair.to]);
            }
            for_each_row(
                [&](std::size_t k, std::size_t i, const VelocityRow<S>& row, MovingBody<S>& a, MovingBody<S>& b) {
                    row.apply_impulse(-masses_[k][i] * (row.velocity(a, b) + correction_rate * row.error), a, b);
                });
        }
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            MovingBody<S>& body = bodies_[b];
            this->move(body, h, real[b].v + body.v, real[b].w + body.w);
            body.v = real[b].v, body.w = real[b].w;
        }
    }
};

}  // namespace polhode::multibody
