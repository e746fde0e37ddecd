// Second formulation of touching spheres, written independently of contact/cluster_form.h: momenta in world axes with
// one multiplier for each contact that slides and three for each contact that sticks.
//
//   dP_i/dt = f_i + sum of +-F_k,   dL_i/dt = tau_i + sum of r_ik x (+-F_k)
//   F_k = lambda_k (n_k - mu u_k / |u_k|)  or, without slip, F_k = any vector
//
// With D = p_1 - p_2 and its length R in contact, the constraint of a pair is D . D = R^2, so D . D'' + D' . D' = 0;
// that of a plane is n . p'' = 0. Where a contact sticks, the velocity u of its points is constant, and u' = 0 replaces
// this. All multipliers follow from one system of equations with the matrix J M^-1 G of all contacts.
//
// State of each sphere: that of momentum_form.h (L, q, p, P); then the clock and the integrals of the observed
// functions (contact/sphere_cluster.h).
#pragma once

#include <vector>

#include "integrators/contact/small_system.h"
#include "integrators/contact/sphere_cluster.h"
#include "integrators/truth/momentum_form.h"

namespace polhode::truth {

template <class P>
class ClusterMultiplierForm {
  public:
    ClusterMultiplierForm(const std::vector<const Scene*>& scenes, const std::vector<P>& radii) {
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            loads_.emplace_back(*scenes[i]);
            const MassProperties<P> body = mass_properties<P>(scenes[i]->body);
            spheres_.push_back({body.mass, body.inertia[0][0], radii[i]});
        }
    }

    std::size_t size() const { return spheres_.size(); }
    void enter(double begin, bool with_impulses, std::vector<Motion<P>>& motions) {
        for (std::size_t i = 0; i < size(); ++i) {
            std::vector<P> y(13, P(0));
            momenta(i, motions[i], y.data());
            loads_[i].enter(begin, y.data());
            if (with_impulses) motions[i] = loads_[i].motion(y.data());
        }
    }
    void set_mode(const contact::ClusterMode<P>& mode) { mode_ = mode; }
    int clock() const { return 13 * static_cast<int>(size()); }
    int function(std::size_t k) const { return clock() + 1 + contact::cluster_functions * static_cast<int>(k); }
    int gap(std::size_t k) const { return function(mode_.closed.size()) + static_cast<int>(k); }
    int dimension() const { return gap(mode_.open.size()); }
    std::vector<contact::Block> blocks(const contact::Sizes& sizes) const {
        std::vector<contact::Block> all;
        for (std::size_t i = 0; i < size(); ++i) {
            const int at = 13 * static_cast<int>(i);
            const double mass = static_cast<double>(spheres_[i].mass), moment = static_cast<double>(spheres_[i].moment);
            all.push_back({at, 3, moment * sizes.angular_velocity});
            all.push_back({at + 3, 4, 1});
            all.push_back({at + 7, 3, sizes.position});
            all.push_back({at + 10, 3, mass * sizes.velocity});
        }
        return all;
    }
    void start(const std::vector<Motion<P>>& motions, const P& t, P* y) const {
        std::fill_n(y, dimension(), P(0));
        for (std::size_t i = 0; i < size(); ++i) momenta(i, motions[i], y + 13 * i);
        y[clock()] = t;
    }
    std::vector<Motion<P>> motions(const P* y) const {
        std::vector<Motion<P>> all;
        for (std::size_t i = 0; i < size(); ++i) all.push_back(loads_[i].motion(y + 13 * i));
        return all;
    }
    contact::SphereRates<P> free_rates(std::size_t i, const Motion<P>& m) const {
        std::vector<P> y(13, P(0)), dy(13, P(0));
        momenta(i, m, y.data());
        loads_[i].derivative(y.data(), dy.data());
        return {(P(1) / spheres_[i].mass) * vector_at(dy.data(), 10),
                (P(1) / spheres_[i].moment) * vector_at(dy.data(), 0)};
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        for (std::size_t i = 0; i < size(); ++i) loads_[i].derivative(y + 13 * i, dy + 13 * i);
        std::vector<Kinematics<S>> all;
        for (const contact::ClusterContact<P>& c : mode_.closed) all.push_back(kinematics(c, y));
        const std::vector<Multiplier<S>> multipliers = multipliers_of(all);
        for (std::size_t k = 0; k < all.size(); ++k) all[k].acceleration = contact_acceleration(k, all[k], dy);
        const std::vector<S> lambda = solve(multipliers, all);
        for (std::size_t r = 0; r < multipliers.size(); ++r) {
            Vector3<S>& force = all[multipliers[r].contact].force;
            force = force + lambda[r] * multipliers[r].force;
        }
        for (std::size_t k = 0; k < all.size(); ++k) add_force(k, all[k], dy);
        S pace(1);
        if (mode_.is_stretched())
            for (std::size_t k = 0; k < all.size(); ++k)
                if (mode_.closed[k].grip == contact::Grip::sliding) pace = pace * all[k].speed;
        for (std::size_t k = 0; k < all.size(); ++k) observe(k, all[k], dy);
        for (std::size_t k = 0; k < mode_.open.size(); ++k) dy[gap(k)] = distance(mode_.open[k], y);
        if (mode_.is_stretched())
            for (int i = 0; i < clock(); ++i) dy[i] = pace * dy[i];
        dy[clock()] = pace;
    }

  private:
    /// A contact of two sides: the first sphere, and the second one or the plane.
    template <class S>
    struct Kinematics {
        Vector3<S> normal, normal_rate, slip;
        Vector3<S> direction;     // unit vector along u
        S speed{0};               // |u|
        S centripetal{0};         // D' . D' / R
        Vector3<S> moving;        // u' by the motion of the normal
        Vector3<S> acceleration;  // u' by loads, without `moving`
        Vector3<S> force;         // on the first sphere
        contact::SlipHeading<S> heading;
    };
    /// One unknown: its force on the first sphere, and the component of u' that it determines.
    template <class S>
    struct Multiplier {
        std::size_t contact;
        Vector3<S> force, row;
    };

    std::vector<MomentumForm<P>> loads_;
    std::vector<contact::SphereBody<P>> spheres_;
    contact::ClusterMode<P> mode_;

    void momenta(std::size_t i, const Motion<P>& m, P* y) const {
        put(y, 0, spheres_[i].moment * rotate(m.q, m.angular_velocity_B)), put(y, 3, m.q);
        put(y, 7, m.position_W), put(y, 10, spheres_[i].mass * m.velocity_W);
    }
    template <class S>
    Vector3<S> velocity(std::size_t i, const S* y) const {
        return (P(1) / spheres_[i].mass) * vector_at(y + 13 * i, 10);
    }
    template <class S>
    Vector3<S> angular_velocity(std::size_t i, const S* y) const {
        return (P(1) / spheres_[i].moment) * vector_at(y + 13 * i, 0);
    }
    // the sides of a contact: its spheres with the signs of the force, and their arms
    template <class S, class Visit>
    void visit_sides(const contact::ClusterContact<P>& c, const Vector3<S>& normal, const Visit& visit) const {
        visit(c.first, P(1), Vector3<S>((P(-1) * spheres_[c.first].radius) * normal));
        if (c.second) visit(*c.second, P(-1), Vector3<S>(spheres_[*c.second].radius * normal));
    }
    template <class S>
    Kinematics<S> kinematics(const contact::ClusterContact<P>& c, const S* y) const {
        Kinematics<S> k;
        if (c.second) {
            const P& R = c.offset;
            const Vector3<S> V = velocity(c.first, y) - velocity(*c.second, y);
            k.normal = (P(1) / R) * (vector_at(y + 13 * c.first, 7) - vector_at(y + 13 * *c.second, 7));
            k.normal_rate = (P(1) / R) * V;
            k.centripetal = (P(1) / R) * dot(V, V);
        } else {
            k.normal = cast<S>(c.normal_W);
        }
        visit_sides(c, k.normal, [&](std::size_t i, const P& sign, const Vector3<S>& arm) {
            const Vector3<S> w = angular_velocity(i, y);
            k.slip = k.slip + sign * (velocity(i, y) + cross(w, arm));
            k.moving = k.moving + spheres_[i].radius * cross(k.normal_rate, w);
        });
        if (c.grip == contact::Grip::sliding) {
            k.speed = square_root(dot(k.slip, k.slip));
            k.direction = (P(1) / k.speed) * k.slip;
        } else if (c.grip == contact::Grip::starting) {
            k.heading = contact::slip_heading(c.path, y[clock()], k.normal, k.normal_rate);
            k.direction = k.heading.direction;
        }
        return k;
    }
    template <class S>
    std::vector<Multiplier<S>> multipliers_of(const std::vector<Kinematics<S>>& all) const {
        std::vector<Multiplier<S>> result;
        for (std::size_t k = 0; k < all.size(); ++k) {
            const contact::ClusterContact<P>& c = mode_.closed[k];
            if (c.grip != contact::Grip::sticking) {
                Vector3<S> force = all[k].normal;
                if (c.grip != contact::Grip::smooth) force = force - c.friction * all[k].direction;
                result.push_back({k, force, all[k].normal});
                continue;
            }
            for (std::size_t i = 0; i < 3; ++i) {
                Vector3<S> unit;
                unit[i] = S(1);
                result.push_back({k, unit, unit});
            }
        }
        return result;
    }
    // u' by the rates of the momenta, without that of the normal
    template <class S>
    Vector3<S> contact_acceleration(std::size_t k, const Kinematics<S>& at, const S* dy) const {
        Vector3<S> sum;
        visit_sides(mode_.closed[k], at.normal, [&](std::size_t i, const P& sign, const Vector3<S>& arm) {
            const Vector3<S> a = (P(1) / spheres_[i].mass) * vector_at(dy + 13 * i, 10),
                             alpha = (P(1) / spheres_[i].moment) * vector_at(dy + 13 * i, 0);
            sum = sum + sign * (a + cross(alpha, arm));
        });
        return sum;
    }
    template <class S>
    void add_force(std::size_t k, const Kinematics<S>& at, S* dy) const {
        visit_sides(mode_.closed[k], at.normal, [&](std::size_t i, const P& sign, const Vector3<S>& arm) {
            const Vector3<S> f = sign * at.force;
            put(dy, 13 * static_cast<int>(i), vector_at(dy + 13 * i, 0) + cross(arm, f));
            put(dy, 13 * static_cast<int>(i) + 10, vector_at(dy + 13 * i, 10) + f);
        });
    }
    // the change of u' at one contact by a force at another one
    template <class S>
    Vector3<S> response(std::size_t k, std::size_t by, const std::vector<Kinematics<S>>& all,
                        const Vector3<S>& force) const {
        Vector3<S> sum;
        visit_sides(mode_.closed[k], all[k].normal, [&](std::size_t i, const P& sign, const Vector3<S>& arm) {
            visit_sides(mode_.closed[by], all[by].normal,
                        [&](std::size_t j, const P& other_sign, const Vector3<S>& other_arm) {
                            if (i != j) return;
                            const Vector3<S> f = (sign * other_sign) * force;
                            sum = sum + (P(1) / spheres_[i].mass) * f +
                                  (P(1) / spheres_[i].moment) * cross(cross(other_arm, f), arm);
                        });
        });
        return sum;
    }
    template <class S>
    std::vector<S> solve(const std::vector<Multiplier<S>>& multipliers, const std::vector<Kinematics<S>>& all) const {
        const std::size_t m = multipliers.size();
        std::vector<S> matrix(m * m, S(0)), right(m, S(0));
        for (std::size_t r = 0; r < m; ++r) {
            const Multiplier<S>& row = multipliers[r];
            const Kinematics<S>& at = all[row.contact];
            const S given = dot(row.row, at.acceleration);
            const bool sticks = mode_.closed[row.contact].grip == contact::Grip::sticking;
            right[r] = P(-1) * (given + (sticks ? dot(row.row, at.moving) : at.centripetal));
            for (std::size_t c = 0; c < m; ++c)
                matrix[r * m + c] =
                    dot(row.row, response(row.contact, multipliers[c].contact, all, multipliers[c].force));
        }
        contact::solve_definite(matrix, right);
        return right;
    }
    template <class S>
    void observe(std::size_t k, const Kinematics<S>& at, S* dy) const {
        const contact::ClusterContact<P>& c = mode_.closed[k];
        const S N = dot(at.normal, at.force);
        const int to = function(k);
        dy[to] = N, dy[to + 1] = S(0), dy[to + 2] = S(0);
        // (mu N)^2 - T^2 = (1 + mu^2) N^2 - F^2
        if (c.grip == contact::Grip::sticking)
            dy[to + 1] = (P(1) + c.friction * c.friction) * (N * N) - dot(at.force, at.force);
        if (c.grip == contact::Grip::sliding) dy[to + 1] = dot(at.slip, at.slip);
        if (c.grip == contact::Grip::starting) {
            const Vector3<S> a = contact_acceleration(k, at, dy) + at.moving;
            dy[to + 1] = dot(a, at.heading.across) - dot(at.slip, at.direction) * at.heading.frame_rate;
            dy[to + 2] = dot(a, at.heading.direction);
        }
        put(dy, to + 3, at.force);
    }
    template <class S>
    S distance(const contact::ClusterContact<P>& c, const S* y) const {
        const Vector3<S> p = vector_at(y + 13 * c.first, 7);
        if (!c.second) return dot(c.normal_W, p) - c.offset - spheres_[c.first].radius;
        const Vector3<S> D = p - vector_at(y + 13 * *c.second, 7);
        return square_root(dot(D, D)) - c.offset;
    }
};

}  // namespace polhode::truth
