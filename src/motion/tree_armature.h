// The pass from the leaves to the root of Tree (motion/tree.h) for joints with armature: an inertia d that is added to
// a joint's own diagonal entry of the mass matrix, as the rotor of a fast motor adds it. With D = J + d (in the free
// directions of the joint), what remains for the parent is J - J D^-1 J, B - J D^-1 B and M - B^T D^-1 B. Unlike
// without armature, the joint transmits a part of the inertia along its free directions. A locked joint, or one whose
// acceleration is given, transmits all of it, as for D^-1 = 0 (hybrid dynamics, Featherstone 2008, ch. 9).
#pragma once

#include "motion/tree.h"

namespace polhode {

template <class P>
template <class S>
void Tree<P>::articulate_with_armature(TreeWork<S>& at) const {
    for (std::size_t i = links_.links.size(); i-- > 0;) {
        const Link<P>& link = links_.links[i];
        LinkWork<S>& w = at.links[i];
        const ArticulatedInertia<S>& I = w.inertia;
        if (link.kind == LinkJoint::free) {
            w.inverse_mass = inverse(I.M);
            w.inverse = inverse(I.J - congruence(I.B, w.inverse_mass));
            continue;
        }
        const S d(link.armature);
        Symmetric3<S> J, M;
        Matrix3<S> B;
        Vector3<S> n = I.n, f = I.f;
        if (link.kind == LinkJoint::spherical) {
            w.inverse = inverse(Symmetric3<S>{I.J.xx + d, I.J.yy + d, I.J.zz + d, I.J.xy, I.J.xz, I.J.yz});
            w.force = w.force - I.n;
            if (link.parent < 0) continue;
            const Matrix3<S> full = full_matrix(I.J), share = full * full_matrix(w.inverse);
            J = I.J - congruence(full, w.inverse);
            M = I.M - congruence(transposed(I.B), w.inverse);
            const Matrix3<S> yielded = share * I.B;
            for (std::size_t r = 0; r < 3; ++r) B[r] = I.B[r] - yielded[r];
            n = n + share * w.force;
            f = f + transposed_times(I.B, w.inverse * w.force);
        } else {
            const bool turns = link.kind == LinkJoint::revolute;
            Vector3<S>&U_n = w.U.turning, &U_f = w.U.linear;
            if (turns)
                U_n = {I.J.xz, I.J.yz, I.J.zz}, U_f = I.B[2];
            else
                U_n = {I.B[0][2], I.B[1][2], I.B[2][2]}, U_f = {I.M.xz, I.M.yz, I.M.zz};
            w.force[0] = w.force[0] - (turns ? I.n[2] : I.f[2]);
            const int lock = lock_of(i);
            const int drive = lock < 0 ? -1 : locks_[static_cast<std::size_t>(lock)].drive;
            if (drive >= 0) {
                S& along = turns ? w.bias.turning[2] : w.bias.linear[2];
                along = along + at.y[drive];
            }
            if (lock >= 0) {
                J = I.J, B = I.B, M = I.M;
                if (link.parent < 0) continue;
            } else {
                const S per = S(P(1)) / ((turns ? I.J.zz : I.M.zz) + d);
                w.inverse.xx = per;
                if (link.parent < 0) continue;
                const Vector3<S> N = per * U_n, F = per * U_f;
                J = I.J - outer(N, U_n), M = I.M - outer(F, U_f);
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = 0; c < 3; ++c) B[r][c] = I.B[r][c] - N[r] * U_f[c];
                n = n + w.force[0] * N;
                f = f + w.force[0] * F;
            }
        }
        n = n + J * w.bias.turning + B * w.bias.linear;
        f = f + transposed_times(B, w.bias.turning) + M * w.bias.linear;
        add_child_inertia(w, J, B, M, n, f, at.links[static_cast<std::size_t>(link.parent)].inertia);
    }
}

}  // namespace polhode
