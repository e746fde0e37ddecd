// A user-defined method: a scheme for first-order equations, and its descriptor.
#pragma once

#include <polhode/polhode.h>

/// Heun's second-order method for dy/dt = f(t, y), for the library's fixed-step driver. It has all members that a
/// scheme needs.
template <class SystemType>
struct Heun {
    static constexpr int evaluations = 2;  ///< right-hand sides per step

    void step(const SystemType& system, double t, double* y, double h) {
        double k1[SystemType::dimension], k2[SystemType::dimension], middle[SystemType::dimension];
        system.derivative(t, y, k1);
        for (int i = 0; i < SystemType::dimension; ++i) middle[i] = y[i] + h * k1[i];
        system.derivative(t + h, middle, k2);
        for (int i = 0; i < SystemType::dimension; ++i) y[i] += h / 2 * (k1[i] + k2[i]);
    }
};

inline const polhode::Method heun{.name = "heun",
                                  .documentation = "Heun's second-order method.",
                                  .source = "K. Heun, Z. Math. Phys. 45 (1900) 23",
                                  .conserves = "nothing",
                                  .control = polhode::Control::fixed_step,
                                  .order = 2,
                                  .solve = polhode::march_system<Heun>};
