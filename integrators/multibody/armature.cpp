#include "integrators/multibody/armature.h"

#include "motion/links.h"

namespace polhode::multibody {
namespace {

using Wrench = Pair6<double>;

}  // namespace

void ArmatureSolver::copy_links(const Tree<double>& tree, const TreeWork<double>& at) {
    const std::size_t n = tree.links().links.size();
    links_.assign(at.links.begin(), at.links.begin() + static_cast<std::ptrdiff_t>(n));
    for (LinkWork<double>& link : links_) link.inertia.n = link.inertia.f = {};
}

void ArmatureSolver::factorize(const Tree<double>& tree, const std::vector<double>& armature) {
    const Links<double>& all = tree.links();
    for (std::size_t i = links_.size(); i-- > 0;) {
        const Link<double>& link = all.links[i];
        LinkWork<double>& w = links_[i];
        const ArticulatedInertia<double>& I = w.inertia;
        const double* const d = armature.data() + (link.rate - all.coordinates);
        if (link.kind == LinkJoint::free) {
            w.inverse_mass = inverse(I.M);
            w.inverse = inverse(I.J - polhode::congruence(I.B, w.inverse_mass));
            continue;
        }
        Symmetric3<double> J, M;
        Matrix3<double> B;
        if (link.kind == LinkJoint::spherical) {
            // D = J + diag(d); remaining inertia: J - J D^-1 J, B - J D^-1 B, M - B^T D^-1 B
            w.inverse =
                inverse(Symmetric3<double>{I.J.xx + d[0], I.J.yy + d[1], I.J.zz + d[2], I.J.xy, I.J.xz, I.J.yz});
            if (link.parent < 0) continue;
            const Matrix3<double> full = full_matrix(I.J);
            J = I.J - polhode::congruence(full, w.inverse);
            M = I.M - polhode::congruence(transposed(I.B), w.inverse);
            const Matrix3<double> reduction = full * full_matrix(w.inverse) * I.B;
            for (int r = 0; r < 3; ++r) B[r] = I.B[r] - reduction[r];
        } else {
            const bool is_revolute = link.kind == LinkJoint::revolute;
            Vector3<double>&U_n = w.U.turning, &U_f = w.U.linear;
            if (is_revolute)
                U_n = {I.J.xz, I.J.yz, I.J.zz}, U_f = I.B[2];
            else
                U_n = {I.B[0][2], I.B[1][2], I.B[2][2]}, U_f = {I.M.xz, I.M.yz, I.M.zz};
            const double inverse_D = 1 / ((is_revolute ? I.J.zz : I.M.zz) + d[0]);
            w.inverse.xx = inverse_D;
            if (link.parent < 0) continue;
            const Vector3<double> N = inverse_D * U_n, F = inverse_D * U_f;
            J = I.J - outer(N, U_n), M = I.M - outer(F, U_f);
            for (int r = 0; r < 3; ++r) B[r] = I.B[r] - N[r] * U_f;
        }
        add_child_inertia(w, J, B, M, Vector3<double>(), Vector3<double>(),
                          links_[static_cast<std::size_t>(link.parent)].inertia);
    }
}

void ArmatureSolver::solve(const Tree<double>& tree, const std::vector<double>& torque, std::vector<double>& x) {
    const Links<double>& all = tree.links();
    x.resize(static_cast<std::size_t>(all.rates));
    sweep_inward(all, torque);
    sweep_outward(all, torque, x);
}

// w.bias: force that the child links require from a link;  w.force: u = tau - S^T p
void ArmatureSolver::sweep_inward(const Links<double>& all, const std::vector<double>& torque) {
    for (LinkWork<double>& w : links_) w.bias = {};
    for (std::size_t i = links_.size(); i-- > 0;) {
        const Link<double>& link = all.links[i];
        LinkWork<double>& w = links_[i];
        const double* const tau = torque.data() + (link.rate - all.coordinates);
        if (link.kind == LinkJoint::free) continue;
        Wrench p = w.bias;
        if (link.kind == LinkJoint::spherical) {
            w.force = Vector3<double>(tau[0], tau[1], tau[2]) - p.turning;
            const Vector3<double> step = w.inverse * w.force;
            p.turning = p.turning + full_matrix(w.inertia.J) * step;
            p.linear = p.linear + transposed_times(w.inertia.B, step);
        } else {
            w.force[0] = tau[0] - (link.kind == LinkJoint::revolute ? p.turning[2] : p.linear[2]);
            const double step = w.inverse.xx * w.force[0];
            p.turning = p.turning + step * w.U.turning;
            p.linear = p.linear + step * w.U.linear;
        }
        if (link.parent < 0) continue;
        Wrench& parent = links_[static_cast<std::size_t>(link.parent)].bias;
        const Vector3<double> f = w.R * p.linear;
        parent.linear = parent.linear + f;
        parent.turning = parent.turning + (w.R * p.turning + cross(w.r, f));
    }
}

// accelerations of the links, and the rates' part of them: x
void ArmatureSolver::sweep_outward(const Links<double>& all, const std::vector<double>& torque,
                                   std::vector<double>& x) {
    for (std::size_t i = 0; i < links_.size(); ++i) {
        const Link<double>& link = all.links[i];
        LinkWork<double>& w = links_[i];
        Vector3<double>&alpha = w.acceleration.turning, &a = w.acceleration.linear;
        const double* const tau = torque.data() + (link.rate - all.coordinates);
        double* const out = x.data() + (link.rate - all.coordinates);
        if (link.kind == LinkJoint::free) {
            const Vector3<double> n = Vector3<double>(tau[0], tau[1], tau[2]) - w.bias.turning;
            const Vector3<double> f = transposed_times(w.R, Vector3<double>(tau[3], tau[4], tau[5])) - w.bias.linear;
            alpha = w.inverse * Vector3<double>(n - w.inertia.B * (w.inverse_mass * f));
            a = w.inverse_mass * Vector3<double>(f - transposed_times(w.inertia.B, alpha));
            const Vector3<double> a_W = w.R * a;
            for (std::size_t k = 0; k < 3; ++k) out[k] = alpha[k], out[k + 3] = a_W[k];
            continue;
        }
        alpha = a = {};
        if (link.parent >= 0) {
            const Wrench& parent = links_[static_cast<std::size_t>(link.parent)].acceleration;
            alpha = transposed_times(w.R, parent.turning);
            a = transposed_times(w.R, Vector3<double>(parent.linear + cross(parent.turning, w.r)));
        }
        if (link.kind == LinkJoint::spherical) {
            const Vector3<double> step =
                w.inverse * Vector3<double>(w.force - full_matrix(w.inertia.J) * alpha - w.inertia.B * a);
            for (std::size_t k = 0; k < 3; ++k) out[k] = step[k];
            alpha = alpha + step;
        } else {
            out[0] = w.inverse.xx * (w.force[0] - dot(w.U.turning, alpha) - dot(w.U.linear, a));
            (link.kind == LinkJoint::revolute ? alpha[2] : a[2]) += out[0];
        }
    }
}

}  // namespace polhode::multibody
