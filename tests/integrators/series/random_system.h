// Random autonomous systems with all operations of a tape, for any scalar type, smooth near the start.
#pragma once

#include <rapidcheck.h>

#include <vector>

#include "body/elementary.h"

namespace polhode::testing {

/// A list of operations, each on two of the variables and earlier results; the rates are the last results.
struct RandomSystem {
    struct Step {
        int operation;
        std::size_t a, b;  ///< distance back to the operands
        double c;          ///< in [0.25, 1]
    };
    std::size_t variables = 0;
    std::vector<Step> steps;
    std::vector<double> start;  ///< in [-1, 1]

    /// Results stay of order 1: divisors are at least 1, and a sine bounds growing values.
    template <class S>
    void derivative(const S* y, S* dy) const {
        std::vector<S> v(y, y + variables);
        for (const Step& step : steps) {
            const S a = v[v.size() - 1 - step.a % v.size()], b = v[v.size() - 1 - step.b % v.size()], c(step.c);
            S s(0), cosine(0);
            switch (step.operation) {
                case 0:
                    v.push_back(c * a * b);
                    break;
                case 1:
                    v.push_back(a - c * b);
                    break;
                case 2:
                    v.push_back(a / (S(1) + c * b * b));
                    break;
                case 3:
                    v.push_back(S(1) / square_root(S(1) + c * a * a));
                    break;
                case 4:
                    sine_cosine(c * a, s, cosine);
                    v.push_back(s);
                    v.push_back(cosine);
                    break;
                default:
                    sine_cosine(a - b + c, s, cosine);
                    v.push_back(s * b + c * cosine);
            }
            if (v.size() % 7 == 0) {
                sine_cosine(v.back(), s, cosine);
                v.push_back(s);
            }
        }
        for (std::size_t i = 0; i < variables; ++i) {
            const S& last = v[v.size() - 1 - i];
            dy[i] = i % 2 == 0 ? last : S(0.5) * last - v[v.size() / 2];
        }
    }
};

/// A system with up to `most` operations.
inline RandomSystem random_system(int most) {
    RandomSystem system;
    system.variables = *rc::gen::inRange<std::size_t>(1, 5);
    const int count = *rc::gen::inRange(1, most);
    for (int i = 0; i < count; ++i)
        system.steps.push_back({*rc::gen::inRange(0, 6), *rc::gen::inRange<std::size_t>(0, 12),
                                *rc::gen::inRange<std::size_t>(0, 12),
                                0.25 + 0.75 * *rc::gen::inRange(0, 1025) / 1024});
    for (std::size_t i = 0; i < system.variables; ++i) system.start.push_back(*rc::gen::inRange(-64, 65) / 64.0);
    return system;
}

}  // namespace polhode::testing
