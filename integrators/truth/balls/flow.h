// The motion between two events, enclosed: what every way to enclose it is given and gives back.
#pragma once

#include <string>
#include <vector>

#include "integrators/truth/balls/ball.h"
#include "integrators/truth/balls/norm.h"
#include "integrators/truth/euler_form.h"

namespace polhode::truth {

/// A piece between two events. The form has entered it; times are exactly these doubles.
struct Piece {
    const EulerForm<Ball>& form;
    double begin, end;
    std::vector<double> sample_times;  ///< increasing, in [begin, end]
};

/// States as balls; every state of the true motion lies in its balls.
struct Enclosure {
    std::string fault;      ///< why there is none; empty where there is one
    bool hopeless = false;  ///< the fault stays at any precision
    long steps = 0;
    std::vector<std::vector<Ball>> samples;
    std::vector<Ball> end;
};

/// The fault of pieces whose right-hand side is_polynomial() does not hold of: the defects' bounds know sums and
/// products.
inline constexpr const char* not_polynomial = "bounds are known for right-hand sides of sums and products only";

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
/// constant acceleration with linear drag. For pieces that has_closed_form() holds of; a fault where balls of the
/// working precision cannot tell which side of the separatrix the motion is on, or which moment is the middle one.
Enclosure enclose_by_closed_form(const Piece& piece, const std::vector<Ball>& start);

/// Where the motion is strongly damped: collocation polynomials, whose steps the decay does not shorten, taken as given
/// and their defect enclosed; errors carried as by enclose_by_taylor. They carry at most most_collocation_bits.
Enclosure enclose_by_collocation(const Scene& scene, const Piece& piece, const PiecePlan& plan,
                                 const std::vector<Ball>& start);
constexpr double most_collocation_bits = 300;

}  // namespace polhode::truth
