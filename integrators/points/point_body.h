// A body made of points: equal point masses with exactly the mass, the centre of mass and the inertia tensor of a
// scene's body, and the distances between them that hold it together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/problem.h"

namespace polhode {

/// Two points at a distance (m) that is to stay.
struct PointLink {
    int i = 0, j = 0;
    double length = 0;
};

/// How the points lie. With a_k^2 = (I_i + I_j - I_k) / (2m), the mean square of coordinate k over the body, in its
/// principal axes about the centre of mass:
///   simplex   four points at (a1, a2, a3), (a1, -a2, -a3), (-a1, a2, -a3), (-a1, -a2, a3) and their 6 distances: as
///   many
///             as a free body of 4 points has to lose, 12 - 6
///   box       n^3 points in a box of equal spacings; n = 2: its corners (+-a1, +-a2, +-a3), linked all with all (28
///             distances); n > 2: each with the neighbours of its cells, along edges and diagonals
/// A flat body (the least a_k below 10^-6 of the largest) has no such box: points of a plane do not resist bending to
/// first order. Either is then three points sqrt(2) (a1 cos, a2 sin)(120 deg n) and their 3 distances.
struct Arrangement {
    enum class Kind { simplex, box } kind = Kind::box;
    int n = 2;  ///< points along an edge of the box
};

struct PointBody {
    double point_mass = 0;                ///< kg, of each
    std::vector<Vector3<double>> rest_B;  ///< from the centre of mass, body axes, m
    std::vector<PointLink> links;
    bool pivoted = false;
    /// c_i with sum c_i r_i = the material point held at W's origin, and sum c_i = 1 (empty without a pivot).
    std::vector<double> pivot_weights;
    double extent = 0;    ///< m, root of the mean square distance from the centre of mass
    std::string refusal;  ///< why the body cannot be made of points, or empty

    int count() const { return static_cast<int>(rest_B.size()); }
};

PointBody point_body(const Problem& problem, Arrangement arrangement);

/// Mass, centre of mass and tensor about it of equal masses at these places (m).
struct PointCloud {
    Vector3<double> center;
    Matrix3<double> inertia;  ///< about `center`
};
PointCloud cloud_of(double point_mass, const double* r, int count);

/// The rotation q that makes sum |r_i - c - R(q) x_i|^2 least (W. Kabsch 1976, by B. K. P. Horn's quaternion 1987, J.
/// Opt. Soc. Am. A 4, 629-642; one Newton step then takes what the eigenvalue problem's rounding left). Of q and -q the
/// one with w >= 0.
Quaternion<double> best_rotation(const std::vector<Vector3<double>>& rest_B, const double* r,
                                 const Vector3<double>& center);

/// Largest | |d| - l | / l over the links.
double largest_stretch(const PointBody& body, const double* r);

}  // namespace polhode
