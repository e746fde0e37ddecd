// Time stepping by linear complementarity: friction in a pyramid with 4 or 8 sides, and in a cone.
//
// Over a step of length h with all forces and axes at its start (M mass matrix, u = (w, v), k forces and gyroscopic
// term; N normals, D the pyramid's unit directions d_j, which come in opposite pairs):
//   M (u1 - u0) = h k + N c + D b,   x1 = x0 + h v1,   q1 = exp(h w1) q0
//   0 <= c,    N^T u1 - target >= 0,            complementary
//   0 <= b_j,  d_j^T u1 + lambda >= 0,          complementary
//   0 <= lambda,  mu c - (sum of b_j) >= 0,     complementary
// Stewart & Trinkle: target = -gap / h, for all contacts that the step can close: no penetration at the end.
// Anitescu & Potra: target = 0 for closed contacts. At an impact this is the phase of compression; then the impulse
// e c is added and the problem solved again with it (Poisson's law).
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <span>

#include "integrators/contact_stepping/contact_state.h"
#include "integrators/contact_stepping/lemke.h"
#include "integrators/run/amplification.h"
#include "integrators/run/binary32.h"

namespace polhode {
namespace {

/// The choices that distinguish the variants.
struct PyramidOptions {
    int sides = 4;             ///< 4, 8, or 0 for the cone
    bool looks_ahead = false;  ///< Stewart & Trinkle: contacts are constraints on the gap at the end of the step
};

template <class S>
class FrictionPyramids : public contact_stepping::ContactState<S> {
    using Base = contact_stepping::ContactState<S>;
    using Constraint = contact_stepping::ContactConstraint<S>;
    using Velocity = contact_stepping::Twist<S>;
    using Base::contacts_, Base::v_, Base::w_;

  public:
    FrictionPyramids(const Problem& problem, const PyramidOptions& options) : Base(problem), options_(options) {
        // exact multiples of 45 degrees
        const S half = S(std::numbers::sqrt2 / 2);
        const std::array<std::array<S, 2>, 8> all{{{S(1), S(0)},
                                                   {half, half},
                                                   {S(0), S(1)},
                                                   {-half, half},
                                                   {S(-1), S(0)},
                                                   {-half, -half},
                                                   {S(0), S(-1)},
                                                   {half, -half}}};
        if (options.sides > 0)
            for (std::size_t i = 0; i < all.size(); i += 8 / static_cast<std::size_t>(options.sides))
                directions_.push_back(all[i]);
    }
    void restart() {
        Base::restart();
        failed_at_ = -1;
    }
    void step(double t, double step) {
        const S h = S(step);
        const Matrix3<S> R = rotation_matrix(this->q_);
        Velocity u = this->template free_velocity<GyroscopicTerm::explicit_euler>(t, h, R);
        find_constraints(h, R, u);
        if (!contacts_.empty() && !(compress(u) && restitute(u))) {
            failed_at_ = t;
            return;
        }
        v_ = u.v, w_ = u.w;
        this->move(h, u);
        this->note_impacts(t, h);
        this->store_impulses();
        this->move_to_pivot();
    }
    bool failed() const { return failed_at_ >= 0; }
    void explain(Trajectory& trajectory) const {
        trajectory.status = Status::failed;
        trajectory.message = fmt::format(
            "the complementarity problem of the step at t = {:.10g} s has no solution within rounding", failed_at_);
    }

  private:
    void find_constraints(const S& h, const Matrix3<S>& R, const Velocity& u) {
        if (!options_.looks_ahead) return this->find_closed_contacts(R);
        if (!this->detector_.any()) return;
        const S reach = this->detector_.reach(), fastest = length(u.v) + reach * length(u.w);
        this->find_contacts(R, this->detector_.rounding(this->x_) + h * fastest);
        for (Constraint& c : contacts_) c.target = -c.gap / h;
    }
    bool compress(Velocity& u) {
        if (options_.sides == 0) {
            this->recall_impulses(S(1));
            this->solve_cones(u);
            return true;
        }
        extra_.assign(contacts_.size(), S(0));
        return solve_pyramids(u);
    }
    /// The phase of restitution at contacts that approached: the normal impulse e c, then what the conditions need.
    bool restitute(Velocity& u) {
        bool any = false;
        extra_.assign(contacts_.size(), S(0));
        for (std::size_t i = 0; i < contacts_.size(); ++i) {
            Constraint& c = contacts_[i];
            if (options_.looks_ahead || !(c.approach < S(0)) || !(c.restitution > S(0))) continue;
            extra_[i] = c.restitution * c.impulse[0];
            any = any || extra_[i] > S(0);
        }
        if (!any) return true;
        if (options_.sides == 0) return restitute_in_cones(u);
        for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].apply(0, extra_[i], u);
        return solve_pyramids(u);
    }
    // with a cone, the normal velocity that the impulse e c reaches is the target
    bool restitute_in_cones(Velocity& u) {
        Velocity with = u;
        for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].apply(0, extra_[i], with);
        for (Constraint& c : contacts_) {
            c.target = std::max(S(0), c.velocity(0, with));
            c.impulse = {};
        }
        this->solve_cones(u);
        return true;
    }

    /// Adds the impulses of the complementarity problem to u. `extra_` are normal impulses that u includes already and
    /// that count for friction.
    bool solve_pyramids(Velocity& u) {
        const std::size_t contacts = contacts_.size(), d = directions_.size(), rows = 2 + d, n = contacts * rows;
        // scaled by K's size and the largest velocity
        S stiffness = S(0), speed = S(0);
        q_lcp_.assign(n, S(0));
        for (std::size_t i = 0; i < contacts; ++i) {
            const Constraint& c = contacts_[i];
            stiffness = std::max({stiffness, c.K[0][0], c.K[1][1], c.K[2][2]});
            const Vector3<S> b = c.velocity(u);
            q_lcp_[i * rows] = b[0] - c.target;
            for (std::size_t j = 0; j < d; ++j)
                q_lcp_[i * rows + 1 + j] = directions_[j][0] * b[1] + directions_[j][1] * b[2];
        }
        for (const S& b : q_lcp_) speed = std::max(speed, std::abs(b));
        if (!(speed > S(0))) return true;
        for (S& b : q_lcp_) b /= speed;
        fill_matrix(stiffness, speed);
        if (!lemke_.solve(n, matrix_, q_lcp_, z_)) return false;
        for (std::size_t i = 0; i < contacts; ++i) {
            Vector3<S> p(z_[i * rows], S(0), S(0));
            for (std::size_t j = 0; j < d; ++j) {
                p[1] += directions_[j][0] * z_[i * rows + 1 + j];
                p[2] += directions_[j][1] * z_[i * rows + 1 + j];
            }
            p = (speed / stiffness) * p;
            contacts_[i].impulse = contacts_[i].impulse + p;
            contacts_[i].apply(p, u);
        }
        return true;
    }
    // per contact: c, b_1 .. b_d, lambda
    void fill_matrix(const S& stiffness, const S& speed) {
        const std::size_t contacts = contacts_.size(), d = directions_.size(), rows = 2 + d, n = contacts * rows;
        matrix_.assign(n * n, S(0));
        const auto at = [&](std::size_t i, std::size_t k) -> S& { return matrix_[i * n + k]; };
        for (std::size_t a = 0; a < contacts; ++a)
            for (std::size_t b = 0; b < contacts; ++b) {
                // K between two contacts
                Matrix3<S> K;
                for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t k = 0; k < 3; ++k)
                        K[i][k] = (contacts_[a].inverse_mass * dot(contacts_[a].axis_W[i], contacts_[b].axis_W[k]) +
                                   dot(contacts_[a].moment_W[i], contacts_[b].turn_W[k])) /
                                  stiffness;
                const auto along = [&](const Vector3<S>& x, std::size_t j) {
                    return j == 0 ? x[0] : directions_[j - 1][0] * x[1] + directions_[j - 1][1] * x[2];
                };
                for (std::size_t j = 0; j <= d; ++j) {
                    Vector3<S> column;
                    for (std::size_t i = 0; i < 3; ++i) column[i] = along(K[i], j);
                    for (std::size_t i = 0; i <= d; ++i) at(a * rows + i, b * rows + j) = along(column, i);
                }
            }
        for (std::size_t a = 0; a < contacts; ++a) {
            const std::size_t last = a * rows + 1 + d;
            at(last, a * rows) = contacts_[a].friction;
            for (std::size_t j = 1; j <= d; ++j) at(a * rows + j, last) = S(1), at(last, a * rows + j) = S(-1);
            q_lcp_[last] = contacts_[a].friction * extra_[a] * stiffness / speed;
        }
    }

    const PyramidOptions options_;
    std::vector<std::array<S, 2>> directions_;
    contact_stepping::LemkeSolver<S> lemke_;
    std::vector<S> matrix_, q_lcp_, z_, extra_;
    double failed_at_ = -1;  // s
};

template <class S, PyramidOptions options>
Trajectory solve_friction_pyramids(const Problem& problem, const Settings& settings) {
    return march<FrictionPyramids<S>>(problem, settings, options);
}

constexpr PyramidOptions potra_4{.sides = 4}, potra_8{.sides = 8}, potra_cone{.sides = 0},
    trinkle_4{.sides = 4, .looks_ahead = true}, trinkle_8{.sides = 8, .looks_ahead = true},
    trinkle_cone{.sides = 0, .looks_ahead = true};

std::string stewart_trinkle_refusal(const Problem& problem) {
    for (const Plane& plane : problem.scene.planes)
        if (plane.restitution > 0) return "the Stewart-Trinkle scheme has no restitution: it supports only e = 0";
    return contact_stepping::contact_refusal(problem);
}

constexpr std::string_view potra_source =
    "M. Anitescu & F. A. Potra 1997, Formulating dynamic multi-rigid-body contact problems with friction as solvable "
    "linear complementarity problems, Nonlinear Dynamics 14, 231";
constexpr std::string_view trinkle_source =
    "D. E. Stewart & J. C. Trinkle 1996, An implicit time-stepping scheme for rigid body dynamics with inelastic "
    "collisions and Coulomb friction, Int. J. Numer. Methods Eng. 39, 2673";

constexpr Method friction_pyramids_variants[] = {
    {.name = "anitescu_potra_4",
     .documentation =
         "The linear complementarity time stepping of Anitescu and Potra: velocities at the end of the step and "
         "impulses obey non-penetration of the closed contacts and maximal dissipation in a friction pyramid of 4 "
         "sides, solved by Lemke's method. Loads and the gyroscopic term are explicit. Restitution by Poisson's law: a "
         "phase of compression, then e times its impulse. The pyramid is inscribed in Coulomb's cone: friction "
         "opposing a slip between its edges is up to sqrt(1/2) of Coulomb's, and does not oppose the slip exactly. "
         "Penetration of up to one step is not corrected. Order 1, to the motion with this pyramid.",
     .source = potra_source,
     .solve = solve_friction_pyramids<double, potra_4>},
    {.name = "anitescu_potra_8",
     .documentation = "`anitescu_potra_4` with a pyramid of 8 sides: friction is at least 0.924 of Coulomb's.",
     .source = potra_source,
     .solve = solve_friction_pyramids<double, potra_8>},
    {.name = "anitescu_potra_cone",
     .documentation =
         "`anitescu_potra_4` with the circular cone: the contacts are solved exactly one by one and iterated "
         "(Gauss-Seidel) instead of Lemke's method.",
     .source = potra_source,
     .solve = solve_friction_pyramids<double, potra_cone>},
    {.name = "stewart_trinkle_4",
     .documentation =
         "The linear complementarity time stepping of Stewart and Trinkle: as `anitescu_potra_4`, but a contact is a "
         "constraint on the gap at the end of the step, gap + h u_n >= 0, for all contacts that the step can close. A "
         "body therefore lands within the step without penetration. Impacts are inelastic: scenes with restitution "
         "are refused. Order 1, to the motion with a pyramid of 4 sides.",
     .source = trinkle_source,
     .solve = solve_friction_pyramids<double, trinkle_4>,
     .refusal = stewart_trinkle_refusal},
    {.name = "stewart_trinkle_8",
     .documentation = "`stewart_trinkle_4` with a pyramid of 8 sides: friction is at least 0.924 of Coulomb's.",
     .source = trinkle_source,
     .solve = solve_friction_pyramids<double, trinkle_8>,
     .refusal = stewart_trinkle_refusal},
    {.name = "stewart_trinkle_cone",
     .documentation =
         "`stewart_trinkle_4` with the circular cone: the contacts are solved exactly one by one and iterated "
         "(Gauss-Seidel) instead of Lemke's method.",
     .source = trinkle_source,
     .solve = solve_friction_pyramids<double, trinkle_cone>,
     .refusal = stewart_trinkle_refusal},
};

constexpr auto friction_pyramids_binary64_family =
    apply_defaults({.conserves = "|q|",
                    .control = Control::fixed_step,
                    .planes = true,
                    .order = 1,
                    .pendulum_amplification = semi_implicit_euler_pendulum_amplification,
                    .family = Family::published_update,
                    .formulation = Formulation::full,
                    .refusal = contact_stepping::contact_refusal},
                   friction_pyramids_variants);

constexpr auto friction_pyramids_family =
    with_binary32<friction_pyramids_binary64_family, binary32_refusal, solve_friction_pyramids<float, potra_4>,
                  solve_friction_pyramids<float, potra_8>, solve_friction_pyramids<float, potra_cone>,
                  solve_friction_pyramids<float, trinkle_4>, solve_friction_pyramids<float, trinkle_8>,
                  solve_friction_pyramids<float, trinkle_cone>>();

}  // namespace

extern const std::span<const Method> friction_pyramids_methods{friction_pyramids_family};

}  // namespace polhode
