// Selects the mode of a cluster of touching spheres: which contacts close, stick or slide.
//
// ClusterResponse holds velocities, accelerations without contact forces and the matrix of responses of all contacts of
// zero gap, in the axes of each contact. ClusterModes enumerates the modes: a contact opens, slides in the direction of
// its slip or, without slip, sticks or starts to slide in the direction of its own acceleration. A mode is consistent
// if all normal forces press, friction that sticks is in its cone, slips that start grow forward and open contacts do
// not approach. If several modes are consistent, closed contacts precede open ones and sticking precedes sliding; modes
// with different accelerations end the run.
//
// The directions of slips that start are searched in binary64, in a system from which all other contacts are eliminated
// (StartingSlips). Modes that are inconsistent in binary64 by more than its error are not solved in P.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "integrators/contact/small_system.h"
#include "integrators/contact/sphere_cluster.h"
#include "integrators/contact/transitions.h"

namespace polhode::contact {

/// Velocities and accelerations of contacts, each in the axes of its contact: forces f add K f to the accelerations.
template <class P>
struct ClusterResponse {
    std::vector<ContactAxes<P>> axes;
    std::vector<Vector3<P>> velocity, acceleration;
    std::vector<P> matrix;  ///< K, 3 m by 3 m, row by row

    std::size_t contacts() const { return axes.size(); }
    const P& K(std::size_t row, std::size_t column) const { return matrix[row * 3 * contacts() + column]; }
};

/// The response of `contacts` at a motion of the spheres, with their rates without contact forces.
template <class P>
ClusterResponse<P> cluster_response(const std::vector<ClusterContact<P>>& contacts,
                                    const std::vector<SphereBody<P>>& spheres,
                                    const std::vector<BodyMotion<P>>& motions,
                                    const std::vector<SphereRates<P>>& rates) {
    ClusterResponse<P> result;
    const std::size_t m = contacts.size();
    const auto sign = [&](std::size_t k, std::size_t i) { return P(contacts[k].first == i ? 1 : -1); };
    // the arm of a contact's point at a sphere
    const auto arm = [&](std::size_t k, std::size_t i) {
        return Vector3<P>((-sign(k, i) * spheres[i].radius) * result.axes[k].normal_W);
    };
    for (const ClusterContact<P>& contact : contacts) {
        const std::size_t k = result.axes.size();
        Vector3<P> normal = contact.normal_W, normal_rate;
        if (contact.is_pair()) {
            const BodyMotion<P>&one = motions[contact.first], &other = motions[*contact.second];
            const Vector3<P> away = one.position_W - other.position_W, V = one.velocity_W - other.velocity_W;
            const P distance = length(away);
            normal = (P(1) / distance) * away;
            normal_rate = (P(1) / distance) * Vector3<P>(V - dot(V, normal) * normal);
        }
        result.axes.emplace_back(normal);
        Vector3<P> u, c;
        P normal_acceleration(0);
        for (std::size_t i = 0; i < spheres.size(); ++i) {
            if (!contact.has(i)) continue;
            const Vector3<P> w = rotate(motions[i].q, motions[i].angular_velocity_B);
            const P s = sign(k, i);
            u = u + s * Vector3<P>(motions[i].velocity_W + cross(w, arm(k, i)));
            c = c + s * Vector3<P>(rates[i].acceleration + cross(rates[i].angular, arm(k, i))) -
                spheres[i].radius * cross(w, normal_rate);
            normal_acceleration = normal_acceleration +
                                  s * (dot(normal, rates[i].acceleration) + dot(normal_rate, motions[i].velocity_W));
        }
        result.velocity.push_back(result.axes[k].from_world(u));
        result.acceleration.push_back(result.axes[k].from_world(c));
        result.acceleration.back()[2] = normal_acceleration;
    }
    result.matrix.assign(9 * m * m, P(0));
    for (std::size_t k = 0; k < m; ++k)
        for (std::size_t l = 0; l < m; ++l)
            for (std::size_t i = 0; i < spheres.size(); ++i) {
                if (!contacts[k].has(i) || !contacts[l].has(i)) continue;
                for (std::size_t b = 0; b < 3; ++b) {
                    const Vector3<P>& g = result.axes[l][b];
                    const Vector3<P> angular = (P(1) / spheres[i].moment) * cross(arm(l, i), g);
                    const Vector3<P> change = (sign(k, i) * sign(l, i)) *
                                              Vector3<P>((P(1) / spheres[i].mass) * g + cross(angular, arm(k, i)));
                    for (std::size_t a = 0; a < 3; ++a) {
                        P& entry = result.matrix[(3 * k + a) * 3 * m + 3 * l + b];
                        entry = entry + dot(result.axes[k][a], change);
                    }
                }
            }
    return result;
}

/// What a contact does in a mode.
enum class ContactChoice { opens, smooth, slides, starts, sticks };

/// Forces and accelerations in a mode, in the axes of the contacts.
template <class P>
struct ClusterForces {
    std::vector<Vector3<P>> force, acceleration;
};

template <class P>
struct ClusterSolution {
    std::vector<ContactChoice> choices;
    std::vector<Vector3<P>> directions;  ///< of slips, in the axes of the contacts
    ClusterForces<P> forces;
};

/// Contacts whose slips start, in a mode whose other contacts are eliminated: forces f on them give the accelerations
/// c + K f, in binary64.
class StartingSlips {
  public:
    /// `matrix`: K, 3 n by 3 n, row by row
    StartingSlips(std::vector<Vector3<double>> acceleration, std::vector<double> matrix, std::vector<double> friction)
        : c_(std::move(acceleration)), K_(std::move(matrix)), friction_(std::move(friction)) {
        for (std::size_t k = 0; k < count(); ++k) {
            const double response = K(3 * k + 2, 3 * k + 2);
            scale_.push_back(response > 0 ? 1 / std::sqrt(response) : 0);
        }
    }

    std::size_t count() const { return c_.size(); }
    /// Normal forces and accelerations if the slips have these directions; nothing if the forces are not unique.
    struct Motion {
        std::vector<double> normal_force;
        std::vector<Vector3<double>> acceleration;
    };
    std::optional<Motion> at(const std::vector<Vector3<double>>& directions) const {
        const std::size_t n = count();
        const auto force = [&](std::size_t k) { return Vector3<double>(unit_normal() - friction_[k] * directions[k]); };
        std::vector<double> B(n * n, 0), x;
        for (std::size_t k = 0; k < n; ++k) {
            x.push_back(-scale_[k] * c_[k][2]);
            for (std::size_t l = 0; l < n; ++l) B[k * n + l] = scale_[k] * scale_[l] * change(k, l, force(l))[2];
        }
        if (!solve_pivoted(B, x, 1e-9)) return {};
        Motion motion{{}, c_};
        for (std::size_t l = 0; l < n; ++l) {
            motion.normal_force.push_back(scale_[l] * x[l]);
            for (std::size_t k = 0; k < n; ++k)
                motion.acceleration[k] = motion.acceleration[k] + motion.normal_force[l] * change(k, l, force(l));
        }
        return motion;
    }

  private:
    std::vector<Vector3<double>> c_;
    std::vector<double> K_, friction_, scale_;

    static Vector3<double> unit_normal() { return {0, 0, 1}; }
    double K(std::size_t row, std::size_t column) const { return K_[row * 3 * count() + column]; }
    // change of the acceleration of contact k by a force at contact l
    Vector3<double> change(std::size_t k, std::size_t l, const Vector3<double>& f) const {
        Vector3<double> result;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) result[a] += K(3 * k + a, 3 * l + b) * f[b];
        return result;
    }
};

template <class P>
class ClusterModes {
  public:
    /// `slips`: whether each contact has a slip. `rounding`: relative error of forces and accelerations.
    ClusterModes(const ClusterResponse<P>& at, const std::vector<P>& friction, const std::vector<bool>& slips,
                 double rounding, double acceleration_scale)
        : at_(at), friction_(friction), slips_(slips), rounding_(rounding), scale_(acceleration_scale) {
        rounded_.matrix.reserve(at.matrix.size());
        for (const P& k : at.matrix) rounded_.matrix.push_back(static_cast<double>(k));
        for (const Vector3<P>& c : at.acceleration) rounded_.acceleration.push_back(cast<double>(c));
        rounded_.axes.resize(at.contacts());
        for (const P& mu : friction) rounded_friction_.push_back(static_cast<double>(mu));
    }

    /// The consistent mode; nothing if there is none or several differ, with the reason in fault().
    std::optional<ClusterSolution<P>> choose() {
        if (at_.contacts() > most_contacts) {
            fault_ = "more than seven contacts of touching spheres are not supported";
            return {};
        }
        enumerate({});
        if (found_ && differs_)
            fault_ = "several modes of touching spheres are consistent with friction and their motions differ";
        if (!found_)
            fault_ = is_singular_ ? "the forces at the contacts of touching spheres are not unique"
                                  : "no mode of touching spheres is consistent with friction";
        if (!found_ || differs_) return {};
        return std::move(found_);
    }
    const std::string& fault() const { return fault_; }

    /// Forces and accelerations for given choices; nothing if the forces are not unique.
    std::optional<ClusterForces<P>> solve(const std::vector<ContactChoice>& choices,
                                          const std::vector<Vector3<P>>& directions) const {
        return solve_in<P>(at_, friction_, choices, directions);
    }

  private:
    static constexpr std::size_t most_contacts = 7;

    const ClusterResponse<P>& at_;
    ClusterResponse<double> rounded_;
    std::vector<P> friction_;
    std::vector<double> rounded_friction_;
    std::vector<bool> slips_;
    double rounding_, scale_;
    std::optional<ClusterSolution<P>> found_;
    bool differs_ = false, is_singular_ = false;
    std::string fault_;

    // A component of the force at a contact, and the component of its acceleration that the force makes zero.
    template <class S>
    struct Unknown {
        std::size_t contact;
        Vector3<S> force, row;
    };
    // Equations and unknowns are scaled by the response of each contact, because masses may differ much. `without`:
    // contacts whose forces are given.
    template <class S>
    static std::vector<Unknown<S>> unknowns_of(const ClusterResponse<S>& at, const std::vector<S>& friction,
                                               const std::vector<ContactChoice>& choices,
                                               const std::vector<Vector3<S>>& directions,
                                               const std::vector<std::size_t>& without) {
        std::vector<Unknown<S>> unknowns;
        const Vector3<S> n(S(0), S(0), S(1));
        for (std::size_t k = 0; k < at.contacts(); ++k) {
            if (choices[k] == ContactChoice::opens || std::ranges::find(without, k) != without.end()) continue;
            const S scale = S(1) / square_root(at.K(3 * k + 2, 3 * k + 2));
            if (choices[k] == ContactChoice::sticks)
                for (std::size_t c = 0; c < 3; ++c) {
                    Vector3<S> unit;
                    unit[c] = scale;
                    unknowns.push_back({k, unit, unit});
                }
            else if (choices[k] == ContactChoice::smooth)
                unknowns.push_back({k, scale * n, scale * n});
            else
                unknowns.push_back({k, scale * Vector3<S>(n - friction[k] * directions[k]), scale * n});
        }
        return unknowns;
    }
    // change of the acceleration of contact k by a force at contact l
    template <class S>
    static Vector3<S> response(const ClusterResponse<S>& at, std::size_t k, std::size_t l, const Vector3<S>& force) {
        Vector3<S> result;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) result[a] = result[a] + at.K(3 * k + a, 3 * l + b) * force[b];
        return result;
    }
    template <class S>
    static std::vector<S> matrix_of(const ClusterResponse<S>& at, const std::vector<Unknown<S>>& unknowns) {
        std::vector<S> B;
        for (const Unknown<S>& row : unknowns)
            for (const Unknown<S>& one : unknowns)
                B.push_back(dot(row.row, response(at, row.contact, one.contact, one.force)));
        return B;
    }

    template <class S>
    static std::optional<ClusterForces<S>> solve_in(const ClusterResponse<S>& at, const std::vector<S>& friction,
                                                    const std::vector<ContactChoice>& choices,
                                                    const std::vector<Vector3<S>>& directions) {
        const std::vector<Unknown<S>> unknowns = unknowns_of(at, friction, choices, directions, {});
        std::vector<S> B = matrix_of(at, unknowns), x;
        for (const Unknown<S>& row : unknowns) x.push_back(-dot(row.row, at.acceleration[row.contact]));
        if (!solve_pivoted(B, x, S(1e-9))) return {};
        ClusterForces<S> result;
        result.force.resize(at.contacts());
        for (std::size_t c = 0; c < unknowns.size(); ++c) {
            Vector3<S>& force = result.force[unknowns[c].contact];
            force = force + x[c] * unknowns[c].force;
        }
        result.acceleration = at.acceleration;
        for (std::size_t k = 0; k < at.contacts(); ++k)
            for (std::size_t l = 0; l < at.contacts(); ++l)
                if (choices[l] != ContactChoice::opens)
                    result.acceleration[k] = result.acceleration[k] + response(at, k, l, result.force[l]);
        return result;
    }
    // Eliminates the contacts whose slips do not start; nothing if their forces are not unique.
    std::optional<StartingSlips> starting_slips(const std::vector<ContactChoice>& choices,
                                                const std::vector<std::size_t>& starting,
                                                const std::vector<Vector3<P>>& directions) const {
        const std::size_t n = starting.size();
        std::vector<Vector3<double>> rounded;
        for (const Vector3<P>& d : directions) rounded.push_back(cast<double>(d));
        const auto unknowns = unknowns_of(rounded_, rounded_friction_, choices, rounded, starting);
        const std::vector<double> B = matrix_of(rounded_, unknowns);
        bool is_unique = true;
        // accelerations of the contacts that start if those of the others without the unknown forces are `given`
        const auto eliminated = [&](const auto& given) {
            std::vector<double> matrix = B, x;
            for (const auto& row : unknowns) x.push_back(-dot(row.row, given(row.contact)));
            is_unique = is_unique && solve_pivoted(matrix, x, 1e-9);
            std::vector<Vector3<double>> all;
            for (const std::size_t k : starting) {
                all.push_back(given(k));
                for (std::size_t c = 0; c < unknowns.size() && is_unique; ++c)
                    all.back() = all.back() + x[c] * response(rounded_, k, unknowns[c].contact, unknowns[c].force);
            }
            return all;
        };
        const std::vector<Vector3<double>> c = eliminated([&](std::size_t k) { return rounded_.acceleration[k]; });
        std::vector<double> K(9 * n * n), friction;
        for (std::size_t l = 0; l < n; ++l) {
            friction.push_back(rounded_friction_[starting[l]]);
            for (std::size_t b = 0; b < 3; ++b) {
                Vector3<double> unit;
                unit[b] = 1;
                const auto column = eliminated([&](std::size_t k) { return response(rounded_, k, starting[l], unit); });
                for (std::size_t k = 0; k < n; ++k)
                    for (std::size_t a = 0; a < 3; ++a) K[(3 * k + a) * 3 * n + 3 * l + b] = column[k][a];
            }
        }
        if (!is_unique) return {};
        return StartingSlips(c, std::move(K), std::move(friction));
    }

    void enumerate(std::vector<ContactChoice> choices) {
        const std::size_t k = choices.size();
        if (found_ && differs_) return;
        if (k == at_.contacts()) return test(choices);
        const bool rubs = friction_[k] > P(0);
        std::vector<ContactChoice> options;
        if (!rubs)
            options = {ContactChoice::smooth};
        else if (slips_[k])
            options = {ContactChoice::slides};
        else
            options = {ContactChoice::sticks, ContactChoice::starts};
        options.push_back(ContactChoice::opens);
        choices.push_back(ContactChoice::opens);
        for (const ContactChoice option : options) {
            choices.back() = option;
            enumerate(choices);
        }
    }
    void test(const std::vector<ContactChoice>& choices) {
        std::vector<std::size_t> starting;
        std::vector<Vector3<P>> directions(at_.contacts());
        for (std::size_t k = 0; k < at_.contacts(); ++k) {
            if (choices[k] == ContactChoice::starts) starting.push_back(k);
            if (choices[k] == ContactChoice::slides) directions[k] = unit_slip(at_.velocity[k]);
        }
        if (starting.empty()) return test_directions(choices, directions);
        const std::optional<StartingSlips> slips = starting_slips(choices, starting, directions);
        if (!slips) {
            is_singular_ = true;
            return;
        }
        if (starting.size() == 1) return test_one_start(choices, starting.front(), *slips, directions);
        test_starts(choices, starting, *slips, directions);
    }
    static Vector3<P> unit_slip(const Vector3<P>& u) {
        const P size = square_root(P(u[0] * u[0] + u[1] * u[1]));
        return {u[0] / size, u[1] / size, P(0)};
    }
    void test_one_start(const std::vector<ContactChoice>& choices, std::size_t k, const StartingSlips& slips,
                        std::vector<Vector3<P>>& directions) {
        const auto direction = forward_direction<P>(
            [&](const Vector3<double>& d) -> std::optional<Vector3<double>> {
                const auto motion = slips.at({d});
                if (!motion || !(motion->normal_force[0] >= -force_rounding(k))) return {};
                return motion->acceleration[0];
            },
            [&](const Vector3<P>& d) -> std::optional<Vector3<P>> {
                directions[k] = d;
                const auto forces = solve(choices, directions);
                if (!forces) return {};
                return forces->acceleration[k];
            });
        if (!direction) return;
        directions[k] = *direction;
        test_directions(choices, directions);
    }
    double force_rounding(std::size_t k) const {
        return std::max(1e-12, rounding_) * scale_ / rounded_.K(3 * k + 2, 3 * k + 2);
    }

    /// Several slips start: Newton's iteration for their directions in binary64, from starts on a grid, continued in P
    /// with the same Jacobian.
    void test_starts(const std::vector<ContactChoice>& choices, const std::vector<std::size_t>& starting,
                     const StartingSlips& slips, const std::vector<Vector3<P>>& directions) {
        const std::size_t n = starting.size(), grid = n == 2 ? 12 : 6;
        if (n > 3) return;
        std::size_t all = 1;
        for (std::size_t i = 0; i < n; ++i) all *= grid;
        std::vector<std::vector<double>> known;
        for (std::size_t start = 0; start < all; ++start) {
            std::vector<double> angles;
            for (std::size_t i = 0, rest = start; i < n; ++i, rest /= grid)
                angles.push_back(2 * std::numbers::pi * (static_cast<double>(rest % grid) + 0.37) /
                                 static_cast<double>(grid));
            std::vector<double> jacobian;
            if (!find_angles(slips, angles, jacobian)) continue;
            const bool is_known = std::ranges::any_of(known, [&](const std::vector<double>& other) {
                for (std::size_t i = 0; i < n; ++i)
                    if (std::cos(angles[i] - other[i]) < 1 - 1e-10) return false;
                return true;
            });
            if (is_known) continue;
            known.push_back(angles);
            std::vector<Vector3<P>> exact = directions;
            if (refine(choices, starting, angles, jacobian, exact)) test_directions(choices, exact);
        }
    }
    static bool find_angles(const StartingSlips& slips, std::vector<double>& angles, std::vector<double>& jacobian) {
        constexpr int most_iterations = 40;
        constexpr double shift = 1e-7;
        const std::size_t n = slips.count();
        bool is_forward = false;
        // the accelerations across the directions
        const auto residual = [&](const std::vector<double>& at) -> std::optional<std::vector<double>> {
            std::vector<Vector3<double>> directions;
            for (const double angle : at) directions.emplace_back(std::cos(angle), std::sin(angle), 0);
            const auto motion = slips.at(directions);
            if (!motion) return {};
            std::vector<double> result;
            is_forward = true;
            for (std::size_t i = 0; i < n; ++i) {
                const Vector3<double>&d = directions[i], &a = motion->acceleration[i];
                result.push_back(d[0] * a[1] - d[1] * a[0]);
                is_forward = is_forward && d[0] * a[0] + d[1] * a[1] > 0;
            }
            return result;
        };
        for (int iteration = 0; iteration < most_iterations; ++iteration) {
            const auto now = residual(angles);
            if (!now) return false;
            const bool forward = is_forward;
            jacobian.assign(n * n, 0);
            for (std::size_t j = 0; j < n; ++j) {
                std::vector<double> moved = angles;
                moved[j] += shift;
                const auto there = residual(moved);
                if (!there) return false;
                for (std::size_t i = 0; i < n; ++i) jacobian[i * n + j] = ((*there)[i] - (*now)[i]) / shift;
            }
            std::vector<double> matrix = jacobian, step = *now;
            if (!solve_pivoted(matrix, step)) return false;
            double largest = 0;
            for (std::size_t i = 0; i < n; ++i) {
                step[i] = std::clamp(step[i], -0.5, 0.5);
                angles[i] -= step[i];
                largest = std::max(largest, std::abs(step[i]));
            }
            if (largest < 1e-9) return forward;
        }
        return false;
    }
    bool refine(const std::vector<ContactChoice>& choices, const std::vector<std::size_t>& starting,
                const std::vector<double>& angles, const std::vector<double>& jacobian,
                std::vector<Vector3<P>>& directions) const {
        constexpr int most_iterations = 60;
        std::vector<P> exact;
        for (const double angle : angles) exact.push_back(P(angle));
        for (int iteration = 0; iteration < most_iterations; ++iteration) {
            for (std::size_t i = 0; i < starting.size(); ++i) {
                P sine, cosine;
                Elementary<P>::sine_cosine(exact[i], sine, cosine);
                directions[starting[i]] = Vector3<P>(cosine, sine, P(0));
            }
            const auto forces = solve(choices, directions);
            if (!forces) return false;
            std::vector<P> matrix, step;
            for (const std::size_t k : starting) {
                const Vector3<P>&d = directions[k], &a = forces->acceleration[k];
                step.push_back(d[0] * a[1] - d[1] * a[0]);
            }
            for (const double entry : jacobian) matrix.push_back(P(entry));
            if (!solve_pivoted(matrix, step)) return false;
            P largest(0);
            for (std::size_t i = 0; i < starting.size(); ++i) {
                exact[i] = exact[i] - step[i];
                largest = std::max(largest, Elementary<P>::magnitude(step[i]));
            }
            if (!(largest > P(8) * Elementary<P>::epsilon())) break;
        }
        return true;
    }

    void test_directions(const std::vector<ContactChoice>& choices, const std::vector<Vector3<P>>& directions) {
        if (found_ && differs_) return;
        if (is_clearly_inconsistent(choices, directions)) return;
        auto forces = solve(choices, directions);
        if (!forces) {
            is_singular_ = true;
            return;
        }
        for (std::size_t k = 0; k < at_.contacts(); ++k)
            if (!is_consistent<P>(k, choices[k], directions[k], *forces, at_.K(3 * k + 2, 3 * k + 2), friction_[k],
                                  rounding_))
                return;
        if (!found_) {
            found_ = ClusterSolution<P>{choices, directions, std::move(*forces)};
            return;
        }
        for (std::size_t k = 0; k < at_.contacts(); ++k) {
            const Vector3<P> difference = forces->acceleration[k] - found_->forces.acceleration[k];
            if (static_cast<double>(length(difference)) > 1e-6 * scale_) differs_ = true;
        }
    }
    // in binary64, by more than its error
    bool is_clearly_inconsistent(const std::vector<ContactChoice>& choices,
                                 const std::vector<Vector3<P>>& directions) const {
        if constexpr (std::is_same_v<P, double>) return false;
        std::vector<Vector3<double>> rounded;
        for (const Vector3<P>& d : directions) rounded.push_back(cast<double>(d));
        const auto forces = solve_in<double>(rounded_, rounded_friction_, choices, rounded);
        if (!forces) return false;
        constexpr double error = 1e-4;
        for (std::size_t k = 0; k < at_.contacts(); ++k)
            if (!is_consistent<double>(k, choices[k], rounded[k], *forces, rounded_.K(3 * k + 2, 3 * k + 2),
                                       rounded_friction_[k], std::max(error, 10 * rounding_)))
                return true;
        return false;
    }
    template <class S>
    bool is_consistent(std::size_t k, ContactChoice choice, const Vector3<S>& d, const ClusterForces<S>& forces,
                       const S& response, const S& friction, double rounding) const {
        const Vector3<S>&f = forces.force[k], &a = forces.acceleration[k];
        const S small_acceleration(rounding * scale_), small = small_acceleration / response;
        if (choice == ContactChoice::opens) return a[2] >= -small_acceleration;
        if (!(f[2] >= -small)) return false;
        if (choice == ContactChoice::sticks) {
            const S limit = friction * f[2] * S(1 + rounding) + small;
            return !(f[0] * f[0] + f[1] * f[1] > limit * limit);
        }
        // in binary64, errors may turn a slow start
        const S least = std::is_same_v<S, P> ? small_acceleration : S(-small_acceleration);
        return choice != ContactChoice::starts || d[0] * a[0] + d[1] * a[1] > least;
    }
};

}  // namespace polhode::contact
