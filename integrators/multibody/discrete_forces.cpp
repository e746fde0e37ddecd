#include "integrators/multibody/discrete_forces.h"

#include <cmath>

namespace polhode::multibody {

// outward sweep: velocities and accelerations, and for each link alone its momentum and the wrench that accelerates it
void JointSweeps::sweep_outward(const Tree<double>& tree, const TreeWork<double>& at, const double* y,
                                const double* a) {
    const Links<double>& all = tree.links();
    const std::size_t n = all.links.size();
    speed_.resize(n), momentum_.resize(n), acceleration_.resize(n), wrench_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Link<double>& link = all.links[i];
        const LinkWork<double>& w = at.links[i];
        Vector3<double>&u = speed_[i], &alpha = acceleration_[i].turning, &linear = acceleration_[i].linear;
        u = alpha = linear = {};
        if (link.parent >= 0) {
            const std::size_t p = static_cast<std::size_t>(link.parent);
            u = transposed_times(w.R, Vector3<double>(speed_[p] + cross(at.links[p].w, w.r)));
            const Pair6<double>& parent = acceleration_[p];
            alpha = transposed_times(w.R, parent.turning);
            linear = transposed_times(w.R, Vector3<double>(parent.linear + cross(parent.turning, w.r)));
        }
        alpha = alpha + w.bias.turning, linear = linear + w.bias.linear;
        const double *const rate = y + link.rate, *const change = a + (link.rate - all.coordinates);
        if (link.kind == LinkJoint::revolute) {
            alpha[2] += change[0];
        } else if (link.kind == LinkJoint::prismatic) {
            u[2] += rate[0], linear[2] += change[0];
        } else {
            alpha = alpha + Vector3<double>(change[0], change[1], change[2]);
            if (link.kind == LinkJoint::free) {
                u = transposed_times(w.R, Vector3<double>(rate[3], rate[4], rate[5]));
                linear = transposed_times(w.R, Vector3<double>(change[3], change[4], change[5]));
            }
        }
        const ArticulatedInertia<double>& I = w.inertia;
        momentum_[i] = {I.J * w.w + I.B * u, transposed_times(I.B, w.w) + I.M * u};
        wrench_[i] = {I.J * alpha + I.B * linear + I.n, transposed_times(I.B, alpha) + I.M * linear + I.f};
    }
}

void JointSweeps::compute(const Tree<double>& tree, const TreeWork<double>& at, const double* y, const double* a,
                          DiscreteForces& out) {
    sweep_outward(tree, at, y, a);
    const Links<double>& all = tree.links();
    const std::size_t rates = static_cast<std::size_t>(all.rates);
    out.momentum.resize(rates), out.force.resize(rates);
    for (std::size_t i = all.links.size(); i-- > 0;) {
        const Link<double>& link = all.links[i];
        const LinkWork<double>& w = at.links[i];
        const std::size_t k = static_cast<std::size_t>(link.rate - all.coordinates);
        const double* const rate = y + link.rate;
        const Pair6<double>&momentum = momentum_[i], &load = wrench_[i];
        // dT/dx = momentum . [V, S], where V is the twist of the parent and S the joint's directions
        if (link.kind == LinkJoint::revolute) {
            out.momentum[k] = momentum.turning[2];
            out.force[k] = (cross(momentum.turning, w.w) + cross(momentum.linear, speed_[i]) + load.turning)[2];
        } else if (link.kind == LinkJoint::prismatic) {
            out.momentum[k] = momentum.linear[2];
            out.force[k] = (cross(momentum.linear, w.w) + load.linear)[2];
        } else {
            const Vector3<double> parent_velocity = w.w - Vector3<double>(rate[0], rate[1], rate[2]);
            const Vector3<double> force =
                cross(momentum.turning, parent_velocity) + cross(momentum.linear, speed_[i]) + load.turning;
            for (std::size_t c = 0; c < 3; ++c) out.momentum[k + c] = momentum.turning[c], out.force[k + c] = force[c];
            if (link.kind == LinkJoint::free) {
                const Vector3<double> p_W = w.R * momentum.linear, f_W = w.R * load.linear;
                for (std::size_t c = 0; c < 3; ++c) out.momentum[k + 3 + c] = p_W[c], out.force[k + 3 + c] = f_W[c];
            }
        }
        if (link.parent < 0) continue;
        const auto add_to_parent = [&](const Pair6<double>& child, Pair6<double>& parent) {
            const Vector3<double> f = w.R * child.linear;
            parent.linear = parent.linear + f;
            parent.turning = parent.turning + (w.R * child.turning + cross(w.r, f));
        };
        const std::size_t p = static_cast<std::size_t>(link.parent);
        add_to_parent(momentum, momentum_[p]), add_to_parent(load, wrench_[p]);
    }
}

RotationMaps::RotationMaps(const Vector3<double>& xi) : xi_(xi) {
    const double square = dot(xi, xi), theta = std::sqrt(square);
    if (theta < 1e-2) {
        quadratic_ = 1.0 / 12 + square / 720, tangent_ = 0.25 + square / 192;
    } else {
        quadratic_ = (1 - theta / 2 / std::tan(theta / 2)) / square, tangent_ = std::tan(theta / 4) / theta;
    }
}

Vector3<double> RotationMaps::start_momentum(const Vector3<double>& momentum, const Vector3<double>& half_force) const {
    const Vector3<double> once = cross(xi_, momentum);
    return momentum + 0.5 * once + quadratic_ * cross(xi_, once) - half_force - tangent_ * cross(xi_, half_force);
}

Vector3<double> RotationMaps::end_momentum(const Vector3<double>& momentum, const Vector3<double>& half_force) const {
    const Vector3<double> once = cross(xi_, momentum);
    return momentum - 0.5 * once + quadratic_ * cross(xi_, once) + half_force - tangent_ * cross(xi_, half_force);
}

}  // namespace polhode::multibody
