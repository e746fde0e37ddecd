// The truth as polynomials in time: for files of so many samples that multiprecision would take minutes over them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "motion/exact_body.h"
#include "motion/trajectory.h"
#include "scene/scene.h"

namespace polhode {

/// A scene's motion at any time, in binary64: the multiprecision polynomials of the truth's own steps (Taylor's,
/// collocation's where the motion is stiff), their coefficients rounded once, what they add to the state at the step's
/// begin summed apart from it. No piece goes beyond an event. Made twice in two formulations like reference(), which
/// compare at 257 times.
class DenseTruth {
  public:
    bool available = false;
    std::string message;  ///< why it is not, or how it was made
    double bound = 0;     ///< as Reference::bound: what the two formulations differ by, and rounding to binary64

    /// The motion at t (s), 0 <= t <= the end that was asked for; at the time of an event: after it. Low parts are
    /// zero. Safe to call from several threads.
    ReferenceSample at(double t) const;

    std::size_t pieces() const { return pieces_.size(); }

  private:
    friend DenseTruth dense_reference(const Scene&, double);

    struct Piece {
        Pair begin;             // s
        double per_length = 0;  // 1/s
        int degree = 0;
        std::size_t offset = 0;  // of its coefficients: degree + 1 rows of `width`, the lowest order first, then the
                                 // low parts of the lowest
    };
    Scene scene_;
    ExactBody<double> body_;
    int width_ = 14;  // 13 state variables or 7, and room for pairs
    std::vector<Piece> pieces_;
    std::vector<double> coefficients_;

    template <int width>
    void evaluate(const Piece& piece, double t, double* y) const;
};

/// From t = 0 to `end` (s, > 0, also beyond the scene's duration). Not available where the motion is so
/// sensitive or long that 17 digits cannot be had in a few seconds (reference() then still may be), or with a user's
/// own torque. Throws InputError on an invalid scene.
DenseTruth dense_reference(const Scene& scene, double end);

}  // namespace polhode
