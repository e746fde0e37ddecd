// Forces of joints within bounds: the complementarity problem of dry friction and limits.
//
//   a = a_0 + A f,   low <= f <= high,   and for each joint  a = 0 if low < f < high,  a >= 0 if f = low,
//                                                            a <= 0 if f = high.
//
// Forces within fixed bounds make this a convex problem: for a positive definite A the solution is unique (Cottle, Pang
// & Stone 1992, The Linear Complementarity Problem, theorem 3.1.6). Projected Gauss-Seidel iterations in binary64
// predict which joints are held; the scalar P then verifies the prediction. If it fails, all cases are tried.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "body/elementary.h"
#include "integrators/contact/small_system.h"

namespace polhode::contact {

/// The bounds of a joint's force. An infinite bound has no value.
template <class P>
struct Box {
    P low{0}, high{0};
    bool has_low = true, has_high = true;
};

/// Where a force is within its bounds.
enum class BoxSide { low, within, high };

template <class P>
struct BoxSolution {
    std::vector<BoxSide> sides;
    std::vector<P> forces;
};

template <class P>
class BoxForces {
  public:
    /// `matrix`: n by n, row by row, symmetric positive definite. Accelerations up to `least` are rounding errors.
    BoxForces(std::vector<P> matrix, std::vector<P> accelerations, std::vector<Box<P>> boxes, const P& least = P(0))
        : A_(std::move(matrix)), a_(std::move(accelerations)), boxes_(std::move(boxes)), n_(a_.size()) {
        P largest(0);
        for (std::size_t i = 0; i < n_; ++i) {
            largest = std::max(largest, P(Elementary<P>::magnitude(a_[i])));
            for (const P& bound : {boxes_[i].low, boxes_[i].high})
                largest = std::max(largest, P(Elementary<P>::magnitude(P(bound * A_[i * n_ + i]))));
        }
        small_ = std::max(P(P(1e6) * Elementary<P>::epsilon() * largest), least);
    }

    /// Nothing if no case passes the verification.
    std::optional<BoxSolution<P>> solve() const {
        std::vector<BoxSide> sides = predict();
        if (auto found = verify(sides)) return found;
        constexpr std::size_t most_joints = 8;
        if (n_ > most_joints) return std::nullopt;
        std::size_t cases = 1;
        for (std::size_t i = 0; i < n_; ++i) cases *= 3;
        for (std::size_t one = 0; one < cases; ++one) {
            std::size_t rest = one;
            for (BoxSide& side : sides) side = static_cast<BoxSide>(rest % 3), rest /= 3;
            if (auto found = verify(sides)) return found;
        }
        return std::nullopt;
    }

  private:
    std::vector<P> A_, a_;
    std::vector<Box<P>> boxes_;
    std::size_t n_;
    P small_{0};

    std::vector<BoxSide> predict() const {
        std::vector<double> f(n_, 0.0);
        for (int sweep = 0; sweep < 2000; ++sweep) {
            double change = 0;
            for (std::size_t i = 0; i < n_; ++i) {
                double a = static_cast<double>(a_[i]);
                for (std::size_t j = 0; j < n_; ++j) a += static_cast<double>(A_[i * n_ + j]) * f[j];
                double next = f[i] - a / static_cast<double>(A_[i * n_ + i]);
                if (boxes_[i].has_low) next = std::max(next, static_cast<double>(boxes_[i].low));
                if (boxes_[i].has_high) next = std::min(next, static_cast<double>(boxes_[i].high));
                change = std::max(change, std::abs(next - f[i]));
                f[i] = next;
            }
            if (!(change > 0)) break;
        }
        std::vector<BoxSide> sides(n_, BoxSide::within);
        for (std::size_t i = 0; i < n_; ++i) {
            // a force at its bound holds a joint that does not accelerate
            double a = static_cast<double>(a_[i]);
            for (std::size_t j = 0; j < n_; ++j) a += static_cast<double>(A_[i * n_ + j]) * f[j];
            const double small = static_cast<double>(small_);
            if (boxes_[i].has_low && f[i] <= static_cast<double>(boxes_[i].low) && a > small) sides[i] = BoxSide::low;
            if (boxes_[i].has_high && f[i] >= static_cast<double>(boxes_[i].high) && a < -small)
                sides[i] = BoxSide::high;
        }
        return sides;
    }

    // Solves for the forces within their bounds, and checks all conditions.
    std::optional<BoxSolution<P>> verify(const std::vector<BoxSide>& sides) const {
        BoxSolution<P> result{sides, std::vector<P>(n_, P(0))};
        std::vector<std::size_t> held;
        for (std::size_t i = 0; i < n_; ++i) {
            const Box<P>& box = boxes_[i];
            if (sides[i] == BoxSide::within) {
                held.push_back(i);
                continue;
            }
            if (!(sides[i] == BoxSide::low ? box.has_low : box.has_high)) return std::nullopt;
            result.forces[i] = sides[i] == BoxSide::low ? box.low : box.high;
        }
        std::vector<P> B, right;
        for (const std::size_t i : held) {
            P sum = -a_[i];
            for (std::size_t j = 0; j < n_; ++j) sum = sum - A_[i * n_ + j] * result.forces[j];
            right.push_back(sum);
            for (const std::size_t j : held) B.push_back(A_[i * n_ + j]);
        }
        solve_definite(B, right);
        for (std::size_t k = 0; k < held.size(); ++k) {
            const Box<P>& box = boxes_[held[k]];
            // beyond a bound by rounding
            const P excess = small_ / A_[held[k] * n_ + held[k]];
            if (box.has_low && !(right[k] >= box.low - excess)) return std::nullopt;
            if (box.has_high && !(right[k] <= box.high + excess)) return std::nullopt;
            result.forces[held[k]] = right[k];
        }
        for (std::size_t i = 0; i < n_; ++i) {
            if (sides[i] == BoxSide::within) continue;
            P a = a_[i];
            for (std::size_t j = 0; j < n_; ++j) a = a + A_[i * n_ + j] * result.forces[j];
            if (sides[i] == BoxSide::low ? !(a >= -small_) : !(a <= small_)) return std::nullopt;
        }
        return result;
    }
};

}  // namespace polhode::contact
