// A body made of points: equal point masses with exactly the mass, centre of mass and inertia tensor of a scene's
// body, and the distances that hold them together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/problem.h"

namespace polhode {

/// Two points at a constant distance `length` (m).
struct PointLink {
    int i = 0, j = 0;
    double length = 0;
};

/// Arrangement of the points. Let a_k^2 = (I_i + I_j - I_k) / (2m) be the mean square of coordinate k over the body,
/// in principal axes about the centre of mass.
///   simplex   four points at (a1, a2, a3), (a1, -a2, -a3), (-a1, a2, -a3), (-a1, -a2, a3) and their 6 distances, as
///             many as a free rigid body of 4 points has constraints (12 - 6)
///   box       n^3 points in a box with equal spacings. n = 2: corners (+-a1, +-a2, +-a3), all linked with each
///             other (28 distances). n > 2: linked with the neighbours in their cells, along edges and diagonals
/// A flat body (smallest a_k below 10^-6 of the largest) has no such box: points in a plane do not resist bending to
/// first order. It becomes three points sqrt(2) (a1 cos, a2 sin)(120 deg n) with their 3 distances.
struct Arrangement {
    enum class Kind { simplex, box } kind = Kind::box;
    int n = 2;  ///< points along an edge of the box
};

/// A body made of points. All points have the same mass.
struct PointBody {
    double point_mass = 0;                ///< kg, of each
    std::vector<Vector3<double>> rest_B;  ///< from the centre of mass, body axes, m
    std::vector<PointLink> links;
    bool pivoted = false;
    /// c_i with sum c_i r_i = the material point held at W's origin, and sum c_i = 1 (empty without a pivot).
    std::vector<double> pivot_weights;
    double extent = 0;    ///< m, root mean square distance from the centre of mass
    std::string refusal;  ///< why the body cannot be made of points, or empty if it can

    int count() const { return static_cast<int>(rest_B.size()); }
};

/// Builds the points and links for the body of `problem`; sets `refusal` if that is not possible.
PointBody point_body(const Problem& problem, Arrangement arrangement);

/// Value of Method::refuses: `refusal` of the body, which does not depend on the arrangement.
std::string point_body_refusal(const Problem& problem);

/// Centre of mass of equal masses at the points r (m), and their tensor about it.
struct PointCloud {
    Vector3<double> center;
    Matrix3<double> inertia;  ///< about `center`
};
PointCloud compute_cloud(double point_mass, const double* r, int count);

/// The rotation q that minimises sum |r_i - c - R(q) x_i|^2, with w >= 0 (W. Kabsch 1976, by B. K. P. Horn's
/// quaternion method 1987, J. Opt. Soc. Am. A 4, 629-642). One Newton step then removes the rounding error of the
/// eigenvalue problem.
Quaternion<double> best_rotation(const std::vector<Vector3<double>>& rest_B, const double* r,
                                 const Vector3<double>& center);

/// Largest | |d| - l | / l over the links.
double largest_stretch(const PointBody& body, const double* r);

}  // namespace polhode
