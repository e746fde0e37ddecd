// The reference as polynomials in time, for files whose samples would take minutes in multiprecision.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "motion/exact_body.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// A scene's motion at any time, in binary64. It stores the multiprecision polynomials of the reference's own steps
/// (Taylor polynomials, or collocation polynomials for stiff motion) with coefficients rounded once. The increment
/// since the start of the step is summed separately from the state there. No piece extends beyond an event. Like
/// reference(), it is computed by two formulations, which are compared at 257 times.
class DenseTruth {
  public:
    bool available = false;
    std::string message;  ///< why it is unavailable, or how it was computed
    double bound = 0;     ///< as Reference::bound: difference of the two formulations plus rounding to binary64

    /// The motion at t in [0, end], s; at the time of an event, after it. Low parts are zero. Thread-safe.
    ReferenceSample at(double t) const;

    std::size_t pieces() const { return pieces_.size(); }

  private:
    friend DenseTruth dense_reference(const Scene&, double);
    class Builder;

    struct Piece {
        Pair begin;             // s
        double per_length = 0;  // 1/s
        int degree = 0;
        // coefficients: degree + 1 rows of `width` from order 0 up, then the low parts of order 0
        std::size_t offset = 0;
    };
    Scene scene_;
    ExactBody<double> body_;
    int width_ = 14;  // 13 or 7 state variables, padded to an even number
    std::vector<Piece> pieces_;
    std::vector<double> coefficients_;

    template <int width>
    void evaluate(const Piece& piece, double t, double* y) const;
};

/// Computes the polynomials from t = 0 to `end` (s, > 0; may exceed the scene's duration). Unavailable for several
/// bodies, planes and user-defined torques, and if the motion is so sensitive or long that 17 digits do not agree; then
/// reference() may still be available. Throws InputError if the scene is invalid.
DenseTruth dense_reference(const Scene& scene, double end);

}  // namespace polhode
