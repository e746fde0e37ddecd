// Enclosures of the motion between two events: input and output shared by all enclosure methods.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/euler_form.h"

namespace polhode::truth {

/// A piece of the motion between two events. Times are exactly these doubles, s.
struct Piece {
    Recording<Ball> equations;
    double begin, end;
    std::vector<double> sample_times;       ///< increasing, in [begin, end]
    const EulerForm<Ball>* body = nullptr;  ///< set for the motion of one body only

    Piece(Recording<Ball> of_motion, double from, double until, std::vector<double> samples)
        : equations(std::move(of_motion)), begin(from), end(until), sample_times(std::move(samples)) {}
    /// The form must have entered the piece and must outlive this object.
    Piece(const EulerForm<Ball>& form, double from, double until, std::vector<double> samples)
        : Piece(record<Ball>(form, form.dimension()), from, until, std::move(samples)) {
        body = &form;
    }

    int dimension() const { return static_cast<int>(equations.rates.size()); }
};

/// States as balls that contain the exact motion.
struct Enclosure {
    std::string fault;      ///< why there is no enclosure; empty if there is one
    bool hopeless = false;  ///< the failure cannot be fixed by more precision
    bool coarse = false;    ///< rounding errors dominate: more spare bits are needed
    long steps = 0;
    std::vector<std::vector<Ball>> samples;
    std::vector<Ball> end;
};

/// How the errors of previous steps are propagated.
enum class Carry {
    norm,            ///< one length that grows by the logarithmic norm: fast, loses a fraction of a bit per step
    parallelepiped,  ///< a set that rotates and shears with the motion: loses only what the motion itself loses
};

/// Encloses a piece by Taylor series about exact points, with a proven defect.
Enclosure enclose_by_taylor(const Piece& piece, const PiecePlan& plan, const std::vector<Ball>& start,
                            Carry carry = Carry::norm);

/// True if no torque acts and no force is fixed in the body.
inline bool has_closed_form(const Forcing<Ball>& forcing) { return !forcing.any_torque() && !forcing.has_body_force; }

/// Encloses a piece by closed forms. The cost does not depend on the length of the piece. Rotation without torque uses
/// Jacobi's functions (theta functions and Carlson's R_J), or trigonometric functions if two moments are equal or the
/// axis is permanent. Translation in flight has constant acceleration and linear drag. Requires one body and
/// has_closed_form(). Fails if the balls at this precision do not determine the side of the separatrix or the order of
/// the moments.
Enclosure enclose_by_closed_form(const Piece& piece, const std::vector<Ball>& start);

/// Encloses a strongly damped piece of one body by collocation polynomials, whose step is not limited by the decay. The
/// polynomials are taken as exact and their defect is enclosed. Errors are carried by the logarithmic norm, as in
/// enclose_by_taylor(). Supports at most most_collocation_bits.
Enclosure enclose_by_collocation(const Scene& scene, const Piece& piece, const PiecePlan& plan,
                                 const std::vector<Ball>& start);
constexpr double most_collocation_bits = 300;

}  // namespace polhode::truth
