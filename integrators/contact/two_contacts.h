// A ball that touches two planes which are not parallel, and moves along the line of their intersection.
//
// Let d be the direction of the line, t_i = n_i x d, c = n_1 . n_2, S = |n_1 x n_2|. The force N_i n_i + A_i d + T_i
// t_i of plane i acts at -r n_i, and
//   m V' = m a . d + A_1 + A_2,   I w' = tau + r sum (T_i d - A_i t_i),   u_i = (V - r w . t_i) d + r (w . d) t_i
//   N_1 + c N_2 + S T_2 = -m a . n_1,   c N_1 + N_2 - S T_1 = -m a . n_2.
// Here w . d = 0 and tau . d = 0: the slips are along d, T_i = 0, and the loads alone determine N_i. The motion along
// the line is then a complementarity problem with a symmetric positive definite matrix, u_i' = k A_i + k' A_j - b_i
// with k = 1/m + r^2/I, k' = 1/m + c r^2/I, which has exactly one solution.
//
// Opposite forces T_1 = -T_2 press the ball between the planes while it rolls at both. Rigid laws do not determine
// them. If rolling needs more friction than T_i = 0 allows and they could provide it, the motion is not determined.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "integrators/contact/contact_state.h"

namespace polhode::contact {

/// The lasting contacts of a ball with two planes.
template <class P>
struct TwoContacts {
    std::array<Pair, 2> pairs;
    std::array<int, 2> slip{};  ///< sign of u_i . d; 0 while it rolls. 1 at a plane without friction
    Vector3<P> line_W;          ///< d, unit
};

/// Number of functions that a formulation observes: N (2), for each contact (mu N)^2 - A^2 while it rolls or |u| while
/// it slides, and the forces (3 and 3).
inline constexpr int two_contacts_functions = 10;

/// A ball between two planes, in world axes.
template <class P>
struct BallBetweenPlanes {
    P mass{1}, moment{1}, radius{1};
    std::array<Vector3<P>, 2> normal_W;
    std::array<P, 2> friction{};
    Vector3<P> acceleration_W, torque_W;  ///< by loads, of the centre, m/s^2 and N m
    Vector3<P> line_W;                    ///< d
    P rounding{0};                        ///< relative error of forces

    P cosine() const { return dot(normal_W[0], normal_W[1]); }
    /// N of both planes without T.
    std::array<P, 2> normal_forces() const {
        const P c = cosine(), scale = -mass / (P(1) - c * c);
        const P first = dot(acceleration_W, normal_W[0]), second = dot(acceleration_W, normal_W[1]);
        return {scale * (first - c * second), scale * (second - c * first)};
    }
};

/// Which contacts roll and which slide.
struct TwoContactChoice {
    std::array<int, 2> slip{};
    bool found = false;
    bool is_pressed = false;  ///< forces that the laws do not determine decide whether the ball rolls
};

/// Selects rolling or sliding of each contact without slip; a contact with slip[i] != 0 slides.
template <class P>
class TwoContactModes {
  public:
    TwoContactModes(const BallBetweenPlanes<P>& ball, const std::array<int, 2>& slip)
        : ball_(ball), slip_(slip), normal_(ball.normal_forces()) {
        const P per_moment = ball.radius / ball.moment;
        k_ = P(1) / ball.mass + ball.radius * per_moment;
        coupling_ = P(1) / ball.mass + ball.cosine() * ball.radius * per_moment;
        for (std::size_t i = 0; i < 2; ++i)
            b_[i] = per_moment * dot(ball.torque_W, cross(ball.normal_W[i], ball.line_W)) -
                    dot(ball.acceleration_W, ball.line_W);
    }

    TwoContactChoice choose() const {
        TwoContactChoice choice;
        const std::array<int, 3> all{0, 1, -1};
        for (int first : all)
            for (int second : all)
                if (!choice.found && is_consistent({first, second})) choice.slip = {first, second}, choice.found = true;
        choice.is_pressed = choice.found && may_roll_by_pressure(choice.slip);
        return choice;
    }
    /// A_1 and A_2.
    std::array<P, 2> friction(const std::array<int, 2>& slip) const {
        std::array<P, 2> A{};
        for (std::size_t i = 0; i < 2; ++i)
            if (slip[i] != 0) A[i] = P(-slip[i]) * (ball_.friction[i] * normal_[i]);
        if (slip[0] == 0 && slip[1] == 0) {
            const P determinant = k_ * k_ - coupling_ * coupling_;
            return {(k_ * b_[0] - coupling_ * b_[1]) / determinant, (k_ * b_[1] - coupling_ * b_[0]) / determinant};
        }
        for (std::size_t i = 0; i < 2; ++i)
            if (slip[i] == 0) A[i] = (b_[i] - coupling_ * A[1 - i]) / k_;
        return A;
    }

  private:
    const BallBetweenPlanes<P>& ball_;
    std::array<int, 2> slip_;
    std::array<P, 2> normal_, b_{};
    P k_{1}, coupling_{0};

    bool is_consistent(const std::array<int, 2>& slip) const {
        const std::array<P, 2> A = friction(slip);
        for (std::size_t i = 0; i < 2; ++i) {
            const bool rubs = ball_.friction[i] > P(0);
            if (slip_[i] != 0 || !rubs) {
                if (slip[i] != (rubs ? slip_[i] : 1)) return false;
                continue;
            }
            const P limit = ball_.friction[i] * normal_[i] * (P(1) + ball_.rounding);
            if (slip[i] == 0 && Elementary<P>::magnitude(A[i]) > limit) return false;
            const P slip_rate = k_ * A[i] + coupling_ * A[1 - i] - b_[i];
            if (slip[i] != 0 && !(P(slip[i]) * slip_rate > P(0))) return false;
        }
        return true;
    }
    // whether rolling at both contacts is possible with T_1 = -T_2 but not with T_i = 0
    bool may_roll_by_pressure(const std::array<int, 2>& slip) const {
        if (slip_[0] != 0 || slip_[1] != 0 || (slip[0] == 0 && slip[1] == 0)) return false;
        if (!(ball_.friction[0] > P(0)) || !(ball_.friction[1] > P(0))) return false;
        const std::array<P, 2> A = friction({0, 0});
        const double c = static_cast<double>(ball_.cosine()), gain = std::sqrt(1 - c * c) / (1 + c);
        // concave in T: N_i = N_i(0) + gain T
        const auto margin = [&](double T) {
            double least = 0;
            for (std::size_t i = 0; i < 2; ++i) {
                const double mu = static_cast<double>(ball_.friction[i]), N = static_cast<double>(normal_[i]);
                const double now = mu * (N + gain * T) - std::hypot(static_cast<double>(A[i]), T);
                least = i == 0 ? now : std::min(least, now);
            }
            return least;
        };
        const double size = std::hypot(static_cast<double>(A[0]), static_cast<double>(A[1])) +
                            static_cast<double>(normal_[0] + normal_[1]);
        double low = -1e6 * size, high = 1e6 * size;
        for (int i = 0; i < 200; ++i) {
            const double a = low + (high - low) / 3, b = high - (high - low) / 3;
            (margin(a) < margin(b) ? low : high) = margin(a) < margin(b) ? a : b;
        }
        return margin((low + high) / 2) > 0;
    }
};

}  // namespace polhode::contact
