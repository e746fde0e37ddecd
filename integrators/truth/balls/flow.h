// The motion between two events, enclosed: what every way to enclose it is given and gives back.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/euler_form.h"

namespace polhode::truth {

/// A piece between two events; times are exactly these doubles.
struct Piece {
    Recording<Ball> equations;
    double begin, end;
    std::vector<double> sample_times;       ///< increasing, in [begin, end]
    const EulerForm<Ball>* body = nullptr;  ///< of the motion of one body

    Piece(Recording<Ball> of_motion, double from, double until, std::vector<double> samples)
        : equations(std::move(of_motion)), begin(from), end(until), sample_times(std::move(samples)) {}
    /// The form has entered the piece, and outlives it.
    Piece(const EulerForm<Ball>& form, double from, double until, std::vector<double> samples)
        : Piece(record<Ball>(form, form.dimension()), from, until, std::move(samples)) {
        body = &form;
    }

    int dimension() const { return static_cast<int>(equations.rates.size()); }
};

/// States as balls; every state of the true motion lies in its balls.
struct Enclosure {
    std::string fault;      ///< why there is none; empty where there is one
    bool hopeless = false;  ///< the fault stays at any precision
    bool coarse = false;    ///< rounding is the fault: what is in want is spare bits
    long steps = 0;
    std::vector<std::vector<Ball>> samples;
    std::vector<Ball> end;
};

/// How the errors of the steps so far are carried on.
enum class Carry {
    norm,            ///< one length, which grows by the logarithmic norm: cheap, and loses some of a bit in each step
    parallelepiped,  ///< a set that turns and shears with the motion: loses what the motion itself loses
};

/// By Taylor series about exact points with a proven defect.
Enclosure enclose_by_taylor(const Piece& piece, const PiecePlan& plan, const std::vector<Ball>& start,
                            Carry carry = Carry::norm);

/// No torque, and no force that turns with the body.
inline bool has_closed_form(const Forcing<Ball>& forcing) { return !forcing.any_torque() && !forcing.has_body_force; }

/// By closed forms, at a cost that no length of time changes: rotation without torque (Jacobi's functions by theta
/// functions and Carlson's R_J; trigonometric where two moments are equal or the axis is permanent), and in flight a
/// constant acceleration with linear drag. For pieces of one body that has_closed_form() holds of; a fault where balls
/// of the working precision cannot tell which side of the separatrix the motion is on, or which moment is the middle
/// one.
Enclosure enclose_by_closed_form(const Piece& piece, const std::vector<Ball>& start);

/// Where one body is strongly damped: collocation polynomials, whose steps the decay does not shorten, taken as given
/// and their defect enclosed; errors carried as by enclose_by_taylor. They carry at most most_collocation_bits.
Enclosure enclose_by_collocation(const Scene& scene, const Piece& piece, const PiecePlan& plan,
                                 const std::vector<Ball>& start);
constexpr double most_collocation_bits = 300;

}  // namespace polhode::truth
