#include "integrators/lanes/rotation_lanes.h"

#include "integrators/lanes/quadratic_polynomial.h"

namespace polhode {
namespace {

constexpr int rates = 3, attitude = 3;  // w = x_0..x_2, q = x_3..x_6
using Polynomial = QuadraticPolynomial<7>;

/// Index pairs of the monomials, in the order of RotationCoefficients::monomial.
constexpr int pairs[10][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}, {0, 0}, {1, 1}, {2, 2}, {3, 3}};

/// Returns whether the torque has the form (0, 0, m) x (2(xz - wy), 2(yz + wx), ..) and no other terms.
bool axial_field(const Vector3<Polynomial>& tau) {
    const double twice = tau[1].quadratic[4][6];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 7; ++j) {
            if (tau[i].constant != 0 || tau[i].linear[j] != 0) return false;
            for (int k = j; k < 7; ++k) {
                double expected = 0;
                if (i == 0 && ((j == 5 && k == 6) || (j == 3 && k == 4))) expected = -twice;
                if (i == 1 && j == 4 && k == 6) expected = twice;
                if (i == 1 && j == 3 && k == 5) expected = -twice;
                if (tau[i].quadratic[j][k] != expected) return false;
            }
        }
    return true;
}

/// Returns the torque as a polynomial in (w, q), or nullopt if it is not of degree two or not of the supported form.
std::optional<Vector3<Polynomial>> polynomial_torque(const Forcing<double>& forcing) {
    if (!forcing.user_torques.empty() || (!forcing.world_points.empty() && !forcing.pivoted)) return std::nullopt;
    const auto x = [](int i) { return Polynomial::variable(i); };
    const Vector3<Polynomial> w(x(0), x(1), x(2)), nowhere;
    const Vector3<Polynomial> tau =
        torque(forcing, 0, w, Quaternion<Polynomial>{x(3), x(4), x(5), x(6)}, nowhere, nowhere);
    for (int i = 0; i < 3; ++i) {
        if (!tau[i].exact) return std::nullopt;
        for (int j = 0; j < 7; ++j)
            if (j >= attitude && tau[i].linear[j] != 0) return std::nullopt;
        for (int j = 0; j < rates; ++j)
            for (int k = j; k < 7; ++k)
                if (tau[i].quadratic[j][k] != 0) return std::nullopt;
    }
    return tau;
}

}  // namespace

std::optional<RotationCoefficients> rotation_coefficients(const PrincipalInertia<double>& inertia,
                                                          const Forcing<double>* forcing) {
    RotationCoefficients c;
    // Signs of the products in attitude_rate().
    constexpr double half[3][4] = {{-0.5, 0.5, 0.5, 0.5}, {-0.5, 0.5, 0.5, 0.5}, {-0.5, -0.5, -0.5, -0.5}};
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 4; ++k) c.product[i][attitude + k] = half[i][k];
    for (int i = 0; i < 3; ++i) c.product[0][i] = inertia.isotropic ? 0 : inertia.gyroscopic[i];
    for (int i = 0; i < 8; ++i) c.response[i] = i < rates ? inertia.inverse_moments[i] : 1;
    if (forcing == nullptr || !forcing->any_torque()) return c;
    const std::optional<Vector3<Polynomial>> tau = polynomial_torque(*forcing);
    if (!tau) return std::nullopt;
    if (axial_field(*tau)) {
        c.terms = RotationTerms::axial_field;
        const double twice = (*tau)[1].quadratic[4][6];
        c.product[1][0] = -twice, c.product[1][1] = twice;
        c.product[2][0] = -twice, c.product[2][1] = -twice;
        return c;
    }
    c.terms = RotationTerms::quadratic;
    for (int i = 0; i < rates; ++i) {
        c.constant[i] = (*tau)[i].constant;
        for (int j = 0; j < rates; ++j) c.damping[j][i] = (*tau)[i].linear[j];
        for (int k = 0; k < 10; ++k)
            c.monomial[k][i] = (*tau)[i].quadratic[attitude + pairs[k][0]][attitude + pairs[k][1]];
    }
    return c;
}

}  // namespace polhode
