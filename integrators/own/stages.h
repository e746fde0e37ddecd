// A scalar that holds the values at up to eight stages. A right-hand side evaluated on it is evaluated at all stages
// at once.
#pragma once

#include "integrators/lanes/lanes.h"

namespace polhode {

/// Values at up to eight stages.
struct Stages {
    Lanes8 lane{};

    Stages() = default;
    explicit Stages(double x) : lane{x, x, x, x, x, x, x, x} {}
    explicit Stages(const Lanes8& lanes) : lane(lanes) {}
    // Not trivial, so that it is passed in memory whatever registers the caller's and callee's instruction sets have.
    Stages(const Stages& other) : lane(other.lane) {}
    Stages& operator=(const Stages& other) = default;
    ~Stages() = default;

    friend Stages operator+(const Stages& a, const Stages& b) { return Stages(a.lane + b.lane); }
    friend Stages operator-(const Stages& a, const Stages& b) { return Stages(a.lane - b.lane); }
    friend Stages operator*(const Stages& a, const Stages& b) { return Stages(a.lane * b.lane); }
    friend Stages operator-(const Stages& a) { return Stages(-a.lane); }
    friend Stages operator*(double a, const Stages& b) { return Stages(a * b.lane); }
    friend Stages operator*(const Stages& a, double b) { return Stages(a.lane * b); }
    friend Stages operator+(const Stages& a, double b) { return Stages(a.lane + b); }
    friend Stages operator+(double a, const Stages& b) { return Stages(a + b.lane); }
    friend Stages operator-(const Stages& a, double b) { return Stages(a.lane - b); }
    friend Stages operator-(double a, const Stages& b) { return Stages(a - b.lane); }
};

}  // namespace polhode
