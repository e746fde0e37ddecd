// Contacts of one body with planes, as constraints on its velocity.
//
// ContactDetector finds the contact points of the body's hull within a margin. ContactConstraint holds one of them in
// its own axes n, t1, t2 (the plane's normal and two tangents) at a fixed configuration:
//   u = J (v, w)          velocity of the body's point, u_i = axis_i . v + (r x axis_i) . w
//   v += p_i axis_i / m,  w += p_i I_W^-1 (r x axis_i)          effect of an impulse p
//   K = J M^-1 J^T        change of u by a unit impulse
// A piece of the hull touches a plane at its lowest point. A disc (face of a cylinder, cone or frustum) has four points
// on its rim, so that it can rest on its face.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "motion/contact.h"

namespace polhode::contact_stepping {

/// The velocity of a body: of its centre of mass (m/s), and angular (rad/s), world axes.
template <class S>
struct Twist {
    Vector3<S> v, w;
};

/// The axes of a contact with the unit normal n: n, and two tangents. t1 lies in the plane of n and the x axis, or of n
/// and the y axis where n is near the x axis. On a ramp that descends along x, t1 is the direction of descent.
template <class S>
std::array<Vector3<S>, 3> contact_axes(const Vector3<S>& n) {
    const bool along_x = n[0] * n[0] > S(0.81);
    const Vector3<S> e(S(along_x ? 0 : 1), S(along_x ? 1 : 0), S(0));
    const Vector3<S> t = e - dot(n, e) * n;
    const Vector3<S> first = (S(1) / length(t)) * t;
    return {n, first, cross(n, first)};
}

/// A contact at a fixed configuration. Vectors of impulses and velocities are in the contact's axes n, t1, t2.
template <class S>
struct ContactConstraint {
    std::size_t feature = 0;             ///< identifies the pair of plane and point of the hull across steps
    Vector3<S> arm_W;                    ///< r, from the centre of mass to the contact, m
    std::array<Vector3<S>, 3> axis_W;    ///< n, t1, t2
    std::array<Vector3<S>, 3> moment_W;  ///< r x axis, m
    std::array<Vector3<S>, 3> turn_W;    ///< I_W^-1 (r x axis)
    Matrix3<S> K;                        ///< 1/kg
    S inverse_mass = S(0);               ///< 1/kg
    S gap = S(0);                        ///< m, negative for penetration
    S restitution = S(0), friction = S(0);
    S approach = S(0);   ///< normal velocity at the start of the step, m/s, negative if approaching
    S target = S(0);     ///< lower bound of the normal velocity after the step, m/s
    Vector3<S> impulse;  ///< accumulated in this step, N s

    /// Computes the rows and K from the arm, the axes and the inverse mass.
    void set_rows(const Matrix3<S>& inverse_inertia_W) {
        for (std::size_t i = 0; i < 3; ++i) {
            moment_W[i] = cross(arm_W, axis_W[i]);
            turn_W[i] = inverse_inertia_W * moment_W[i];
        }
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) K[i][k] = dot(moment_W[i], turn_W[k]) + (i == k ? inverse_mass : S(0));
    }
    Vector3<S> velocity(const Twist<S>& u) const { return {velocity(0, u), velocity(1, u), velocity(2, u)}; }
    S velocity(std::size_t i, const Twist<S>& u) const { return dot(axis_W[i], u.v) + dot(moment_W[i], u.w); }
    /// Applies the impulse p along one axis.
    void apply(std::size_t i, const S& p, Twist<S>& u) const {
        u.v = u.v + (p * inverse_mass) * axis_W[i];
        u.w = u.w + p * turn_W[i];
    }
    void apply(const Vector3<S>& p, Twist<S>& u) const {
        for (std::size_t i = 0; i < 3; ++i) apply(i, p[i], u);
    }
    /// Replaces the accumulated impulse along one axis.
    void set_impulse(std::size_t i, const S& p, Twist<S>& u) {
        apply(i, p - impulse[i], u);
        impulse[i] = p;
    }
};

/// Finds the contacts of a body with planes.
template <class S>
class ContactDetector {
  public:
    /// Rounds planes and hull of `geometry`, which must be in body axes, to S.
    explicit ContactDetector(const ContactGeometry<double>& geometry) : reach_(static_cast<S>(geometry.reach)) {
        if (!geometry.any()) return;
        for (const ContactPlane<double>& plane : geometry.planes)
            planes_.push_back({{cast<S>(plane.normal_W), S(plane.offset), S(plane.restitution), S(plane.friction)},
                               contact_axes(cast<S>(plane.normal_W))});
        for (const SupportPiece<double>& piece : geometry.pieces)
            pieces_.push_back({cast<S>(piece.center), piece.extended, cast<S>(piece.semi_axes), S(piece.radius)});
    }

    bool any() const { return !planes_.empty(); }
    std::size_t plane_count() const { return planes_.size(); }
    /// The plane of a contact.
    std::size_t plane_of(std::size_t feature) const { return feature / (points_per_piece * pieces_.size()); }
    /// Bound of the distance of the hull's points from the centre of mass, m.
    const S& reach() const { return reach_; }
    /// A gap below this value counts as closed, m.
    S rounding(const Vector3<S>& x) const { return S(16) * Elementary<S>::epsilon() * (reach_ + length(x)); }

    /// Calls found(feature, plane, axes, arm_W, gap) for each contact with a gap of at most `margin`, in a fixed order.
    template <class Found>
    void find(const Quaternion<S>& q, const Vector3<S>& x, const S& margin, const Found& found) const {
        for (std::size_t i = 0; i < planes_.size(); ++i) {
            const AxedPlane& plane = planes_[i];
            const Vector3<S> n = rotate_back(q, plane.normal_W);
            const S height = dot(plane.normal_W, x) - plane.offset;
            for (std::size_t k = 0; k < pieces_.size(); ++k) {
                const SupportPiece<S>& piece = pieces_[k];
                if (height + piece.lowest(n) > margin) continue;
                const std::size_t feature = points_per_piece * (i * pieces_.size() + k);
                const auto add = [&](std::size_t point, const Vector3<S>& p) {
                    const S gap = height + dot(n, p);
                    if (!(gap > margin)) found(feature + point, plane, plane.axes, rotate(q, p), gap);
                };
                if (is_disc(piece))
                    add_rim(piece, n, add);
                else
                    add(0, piece.lowest_point(n));
            }
        }
    }

  private:
    static constexpr std::size_t points_per_piece = 4;

    struct AxedPlane : ContactPlane<S> {
        std::array<Vector3<S>, 3> axes;
    };

    // a piece with two semi-axes, in the first two columns of A
    static bool is_disc(const SupportPiece<S>& piece) {
        if (!piece.extended) return false;
        for (std::size_t i = 0; i < 3; ++i)
            if (piece.semi_axes[i][2] != S(0)) return false;
        return true;
    }
    // c - A u - r n for the unit vector u along A^T n, where the height is lowest, and three more at right angles
    template <class Add>
    static void add_rim(const SupportPiece<S>& piece, const Vector3<S>& n, const Add& add) {
        const Vector3<S> a = transposed(piece.semi_axes) * n;
        const S size = length(a);
        Vector3<S> u(S(1), S(0), S(0));
        if (size > S(16) * Elementary<S>::epsilon() * piece.reach()) u = (S(1) / size) * a;
        const Vector3<S> down = piece.semi_axes * u, across = piece.semi_axes * Vector3<S>(-u[1], u[0], S(0));
        const Vector3<S> middle = piece.center - piece.radius * n;
        add(0, middle - down);
        add(1, middle + down);
        add(2, middle - across);
        add(3, middle + across);
    }

    std::vector<AxedPlane> planes_;
    std::vector<SupportPiece<S>> pieces_;  // from the centre of mass, body axes
    S reach_;
};

}  // namespace polhode::contact_stepping
