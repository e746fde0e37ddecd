// The contact point of one piece of a hull with a plane, in body axes, over the scalar of the state.
//
// With the plane's normal n in body axes, a piece { c + A u + r b } touches at s = c - A m / |m| - r n, m = A^T n. As
// dn/dt = n x w, the point moves over the body with
//   ds/dt = -r dn/dt - A (m'/|m| - m (m . m') / |m|^3),   m' = A^T dn/dt.
#pragma once

#include "body/support.h"

namespace polhode::contact {

/// The contact point from the centre of mass, its velocity over the body, and the normal, in body axes.
template <class S>
struct ContactPoint {
    Vector3<S> normal_B;  ///< unit, towards the body
    Vector3<S> point_B;   ///< s, m
    Vector3<S> moves_B;   ///< ds/dt, m/s
};

/// n . x of the lowest point of a piece (m), with n in body axes.
template <class S, class P>
S lowest_height(const SupportPiece<P>& piece, const Vector3<S>& n) {
    S height = dot(n, piece.center) - piece.radius;
    if (!piece.extended) return height;
    const Vector3<S> m = transposed(piece.semi_axes) * n;
    return height - square_root(dot(m, m));
}

/// The contact point of `piece` for the normal n and the angular velocity w, both in body axes.
template <class S, class P>
ContactPoint<S> contact_point(const SupportPiece<P>& piece, const Vector3<S>& n, const Vector3<S>& w) {
    ContactPoint<S> contact{n, piece.center - piece.radius * n, {}};
    const Vector3<S> turns = cross(n, w);
    contact.moves_B = S(0) * turns;
    if (!(piece.radius == P(0))) contact.moves_B = P(-1) * (piece.radius * turns);
    if (!piece.extended) return contact;
    const Vector3<S> m = transposed(piece.semi_axes) * n, m_rate = transposed(piece.semi_axes) * turns;
    const S square = dot(m, m), size = square_root(square), inverse_size = S(1) / size;
    contact.point_B = contact.point_B - inverse_size * (piece.semi_axes * m);
    const S share = dot(m, m_rate) / square;
    contact.moves_B = contact.moves_B - inverse_size * (piece.semi_axes * (m_rate - share * m));
    return contact;
}

}  // namespace polhode::contact
