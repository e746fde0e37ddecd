// Torque-free rotation of a rigid body, in closed form and in ball arithmetic.
#pragma once

#include <optional>
#include <utility>
#include <variant>

#include "body/algebra.h"
#include "integrators/truth/balls/ball.h"

namespace polhode::truth {

/// The motion after time t: w_B, and the rotation from the body axes at t to those at the start, continuous in t.
struct FreeMotion {
    Vector3<Ball> angular_velocity_B;
    Quaternion<Ball> q;
};

/// I w is parallel to w: w is constant.
struct PermanentRotation {
    Vector3<Ball> w_B;
    FreeMotion after(const Ball& t) const;
};

/// Two equal moments: w rotates about the third axis and the body about L (Landau & Lifshitz, Mechanics, 33).
struct SymmetricRotation {
    int axis;
    Vector3<Ball> w_B, L_over_equal_moment;  ///< at the start
    Ball rate;                               ///< of w_B about the axis, rad/s
    FreeMotion after(const Ball& t) const;
};

/// Three different moments: Jacobi's functions (van Zon & Schofield 2007, J. Comput. Phys. 225, 145). The axes are
/// numbered so that axis 2 has the middle moment and the polhode encircles axis 3; right-handed.
///
///   w = (a1 cn u, a2 sn u, a3 dn u),  u = rate t + u0,  a1 > 0
///   R = Rz(phi) Rx(theta) Rz(chi),  L_B = L (sin theta sin chi, sin theta cos chi, cos theta)
///   phi = L t / I3 - D3 / (I3 L rate) (G(u) - G(u0)),  G(u) = int_0^u du / (1 - alpha^2 dn^2),  alpha = I3 |a3| / L
///
/// u = N K + v with |v| at most about K/2, where every function of v has one branch. N counts quarter periods, which
/// makes phi, chi and hence q continuous.
class AsymmetricRotation {
  public:
    /// `axes`: columns are principal axes in body axes. Empty if the balls do not determine the order of the moments or
    /// the side of the separatrix.
    static std::optional<AsymmetricRotation> from(const Vector3<Ball>& moments, const Matrix3<Ball>& axes,
                                                  const Vector3<Ball>& w_B);
    FreeMotion after(const Ball& t) const;

  private:
    struct State {
        Vector3<Ball> w;
        Quaternion<Ball> tilt;  ///< Rx(theta) Rz(chi)
        Ball integral;          ///< G
    };
    Vector3<Ball> moments_, amplitudes_;
    int sense_ = 1;  // sign of a2
    Matrix3<Ball> axes_;
    Quaternion<Ball> q_axes_;        // from the numbered axes to the body axes
    Ball L_, D3_, rate_, u0_;        // D3 = L^2 - 2 E I3
    Ball m_, k1_, K_, tau_;          // k^2, k', K, K'/K
    Ball alpha2_, beta1_, beta2_;    // alpha^2, 1 - alpha^2, 1 - alpha^2 k'^2
    Ball theta2_, theta3_, theta4_;  // theta functions at 0
    Ball whole_;                     // G(K)
    State start_;

    State state(const Ball& t) const;
};

struct PrincipalAxes {
    Vector3<Ball> moments;
    Matrix3<Ball> axes;  ///< columns, right-handed
};
/// The principal axes of a symmetric tensor. Empty if balls of the working precision do not separate the moments.
std::optional<PrincipalAxes> principal_axes(const Matrix3<Ball>& tensor);

/// The torque-free motion that starts with w_B. Empty if the balls do not determine which closed form applies.
using FreeRotation = std::variant<PermanentRotation, SymmetricRotation, AsymmetricRotation>;
std::optional<FreeRotation> free_rotation(const Matrix3<Ball>& inertia_B, const Vector3<Ball>& w_B);

}  // namespace polhode::truth
