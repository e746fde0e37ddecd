// Second formulation of contact dynamics, written independently: momenta in world axes with the contact force as a
// multiplier of the constraint on the contact point's velocity.
//
//   dL/dt = tau + r x F,  dP/dt = f + F,  u = P/m + w x r,  w = I_W^-1 L
//   du/dt = P'/m + I_W^-1 (L' - w x L) x r + w x r' + K F
//
// F is zero in flight; N (n - mu u_t / |u_t|) with n . du/dt = 0 in sliding; and solves du/dt = 0 in rolling. The loads
// are those of formula_form.h. With n fixed, the contact point of an ellipsoid with A A^T = B in world axes is
// r = c - radius n - B n / sqrt(n . B n), and (B n)' = w x B n - B (w x n). The independent variable is stretched as in
// contact/reduced_form.h, and the state is laid out like there: L, q, p, P (shock: L, P, work), the clock, the observed
// functions.
#pragma once

#include <array>
#include <vector>

#include "integrators/contact/contact_state.h"
#include "integrators/contact/rotation_friction.h"
#include "integrators/contact/two_contacts.h"
#include "integrators/truth/formula_form.h"
#include "motion/body_equations.h"

namespace polhode::truth {

template <class P>
class MultiplierForm {
  public:
    static constexpr const char* name = "momenta in world axes with multipliers";
    using System = contact::System;

    /// `geometry` must outlive the form.
    MultiplierForm(const Scene& scene, const ContactGeometry<P>& geometry)
        : geometry_(&geometry),
          loads_(scene),
          body_(mass_properties<P>(scene.body)),
          inverse_inertia_(inverse(body_.inertia)),
          inverse_(inverse_inertia_),
          held_values_(static_cast<std::size_t>(loads_.terms().holds())) {
        const Vector3<double> m(static_cast<double>(body_.inertia[0][0]), static_cast<double>(body_.inertia[1][1]),
                                static_cast<double>(body_.inertia[2][2]));
        least_moment_ = std::min({m[0], m[1], m[2]});
    }

    Motion<P> initial() const {
        std::vector<P> y = load_state();
        loads_.initial(y.data());
        return loads_.motion(y.data());
    }
    void enter(double begin, Motion<P>& m) {
        std::vector<P> y = load_state();
        momenta(m, y.data());
        std::copy(held_values_.begin(), held_values_.end(), y.begin() + loads_.time_index() + 1);
        loads_.enter(begin, y.data());
        std::copy_n(y.begin() + loads_.time_index() + 1, held_values_.size(), held_values_.begin());
        m = loads_.motion(y.data());
    }
    /// Sets the time (s) for response() and load_torque().
    void set_time(const P& t) { time_ = t; }
    void select(System system, contact::Pair pair) {
        system_ = system, pair_ = pair;
        others_.clear();
        for (std::size_t k = 0; k < geometry_->size(); ++k)
            if (system == System::flight || !(pair_at(k) == pair)) others_.push_back(k);
    }
    void select_two(const contact::TwoContacts<P>& two) {
        system_ = System::two_contacts, two_ = two;
        others_.clear();
        for (std::size_t k = 0; k < geometry_->size(); ++k)
            if (!(pair_at(k) == two.pairs[0]) && !(pair_at(k) == two.pairs[1])) others_.push_back(k);
    }
    contact::Pair pair_at(std::size_t k) const { return {k / geometry_->pieces.size(), k % geometry_->pieces.size()}; }
    const std::vector<std::size_t>& observed_gaps() const { return others_; }
    bool is_stretched() const {
        return system_ == System::shock || is_stretched_by_slip() || is_stretched_by_rolling();
    }
    bool is_stretched_by_slip() const { return system_ == System::sliding && mu() > P(0) && !rotation_.starts_rolling; }
    bool is_stretched_by_rolling() const {
        return (system_ == System::sliding || system_ == System::rolling) && rotation_.opposes_rolling() &&
               !rotation_.starts_rolling;
    }
    int first_rotation_function() const { return 14 + own_functions() - contact::rotation_functions; }
    void set_rotation(const contact::RotationFriction<P>& rotation) { rotation_ = rotation; }
    int clock() const { return system_ == System::shock ? 7 : 13; }
    int work() const { return 6; }
    int own_functions() const {
        const bool touches = system_ != System::flight && system_ != System::shock;
        return (system_ == System::flight         ? 0
                : system_ == System::two_contacts ? contact::two_contacts_functions
                : system_ == System::shock        ? 2
                : system_ == System::onset        ? 6
                                                  : 5) +
               (touches && rotation_.acts ? contact::rotation_functions : 0);
    }
    int dimension() const { return first_variable() + (system_ == System::shock ? 0 : loads_.terms().auxiliaries()); }
    int first_variable() const {
        return clock() + 1 + own_functions() + (system_ == System::shock ? 0 : static_cast<int>(others_.size()));
    }
    void refresh(P* y) const {
        if (first_variable() == dimension()) return;
        P* variables = y + first_variable();
        std::copy(held_values_.begin(), held_values_.end(), variables);
        loads_.terms().update_auxiliaries(loads_.formula_state(y, variables), variables);
    }
    std::vector<contact::Block> blocks(const contact::Sizes& sizes, double) const {
        const double mass = static_cast<double>(body_.mass), turn = least_moment_ * sizes.angular_velocity;
        if (system_ == System::shock)
            return {{0, 3, turn}, {3, 3, mass * sizes.velocity}, {6, 1, mass * sizes.velocity * sizes.velocity}};
        std::vector<contact::Block> all{
            {0, 3, turn}, {3, 4, 1}, {7, 3, sizes.position}, {10, 3, mass * sizes.velocity}};
        for (int i = first_variable(); i < dimension(); ++i) all.push_back({i, 1, 1});
        return all;
    }

    void permit(const contact::PermittedRotation<P>& rotation) {
        permitted_ = rotation;
        inverse_ = inverse_inertia_;
        if (rotation.kind == Permitted::any) return;
        for (std::size_t j = 0; j < 3; ++j) {
            Vector3<P> unit;
            unit[j] = P(1);
            const Vector3<P> column = rotation.response(unit);
            for (std::size_t i = 0; i < 3; ++i) inverse_[i][j] = column[i];
        }
    }
    Vector3<P> load_torque(const Motion<P>& m) const {
        std::vector<P> y = load_state(), rate = y;
        find_rates(m, y, rate);
        return vector_at(rate.data(), 0);
    }
    /// The direction of the slip for System::onset.
    void set_path(const contact::SlipPath<P>& path) { path_ = path; }

    void start(const Motion<P>& m, const P& clock_time, P* y) {
        for (int i = 0; i < dimension(); ++i) y[i] = P(0);
        y[clock()] = clock_time;
        if (system_ != System::shock) {
            momenta(m, y);
            refresh(y);
            return;
        }
        frozen_ = m;
        P all[13];
        momenta(m, all);
        put(y, 0, vector_at(all, 0)), put(y, 3, vector_at(all, 10));
    }
    Motion<P> motion(const P* y) const {
        if (system_ != System::shock) return loads_.motion(y);
        P all[13];
        momenta(frozen_, all);
        put(all, 0, vector_at(y, 0)), put(all, 10, vector_at(y, 3));
        return loads_.motion(all);
    }

    contact::ContactResponse<P> response(contact::Pair pair, const Motion<P>& m) const {
        const contact::ContactAxes<P> axes(geometry_->planes[pair.plane].normal_W);
        std::vector<P> y = load_state(), rate = y;
        find_rates(m, y, rate);
        const Kinematics<P> k = kinematics(pair, y.data(), rate.data());
        contact::ContactResponse<P> result{axes.from_world(k.velocity), axes.from_world(k.acceleration), {}};
        for (std::size_t j = 0; j < 3; ++j) {
            const Vector3<P> column = axes.from_world(k.respond(axes[j]));
            for (std::size_t i = 0; i < 3; ++i) result.matrix[i][j] = column[i];
        }
        return result;
    }
    void push(Motion<P>& m, contact::Pair pair, const Vector3<P>& impulse_W) const {
        std::vector<P> y = load_state(), rate = y;
        find_rates(m, y, rate);
        const Vector3<P> arm = kinematics(pair, y.data(), rate.data()).arm;
        put(y.data(), 0, vector_at(y.data(), 0) + cross(arm, impulse_W));
        put(y.data(), 10, vector_at(y.data(), 10) + impulse_W);
        m = loads_.motion(y.data());
    }
    double friction_of(contact::Pair pair) const { return static_cast<double>(geometry_->planes[pair.plane].friction); }

    template <class S>
    void derivative(const S* y, S* dy) const {
        if (system_ == System::shock) {
            shock(y, dy);
            return;
        }
        const formula::Evaluation<S, P> values = loads_.load_rates(y, y + first_variable(), dy);
        S pace(1);
        if (system_ == System::two_contacts) {
            add_two_contacts(y, dy);
        } else if (system_ != System::flight) {
            const Vector3<P>& n = geometry_->planes[pair_.plane].normal_W;
            const Kinematics<S> k = kinematics(pair_, y, dy);
            const bool rotates = rotation_.acts;
            Vector3<S> F, g, g_response;  // torque of friction for N = 1, and the acceleration by it
            if (rotates) {
                g = rotation_.torque(n, k.angular_velocity, y[13], [](const Vector3<S>& v) { return v; });
                g_response = cross(k.rotate_by(g), k.arm);
            }
            if (system_ == System::rolling) {
                Matrix3<S> K;
                for (std::size_t j = 0; j < 3; ++j) {
                    Vector3<P> unit;
                    unit[j] = P(1);
                    const Vector3<S> column = k.respond(unit);
                    for (std::size_t i = 0; i < 3; ++i)
                        K[i][j] = rotates ? column[i] + n[j] * g_response[i] : column[i];
                }
                F = P(-1) * (inverse(K) * k.acceleration);
                const S N = dot(n, F);
                dy[14] = N, dy[15] = (mu() * mu()) * (N * N) - (dot(F, F) - N * N);
            } else {
                const Vector3<S> slip = k.velocity - dot(n, k.velocity) * n;
                const S square = dot(slip, slip);
                Vector3<S> f = cast<S>(n);
                if (system_ == System::onset) {
                    f = n - mu() * path_.at(y[13]);
                } else if (mu() > P(0)) {
                    pace = square_root(square);
                    f = n - (mu() / pace) * slip;
                    if (rotation_.starts_rolling) pace = S(1);
                }
                Vector3<S> response = k.respond(f);
                if (rotates) response = response + g_response;
                const S N = P(-1) * (dot(n, k.acceleration) / dot(n, response));
                F = N * f;
                dy[14] = N, dy[15] = square;
                if (system_ == System::onset) {
                    const Vector3<S> u_rate = k.acceleration + N * response;
                    dy[15] = dot(path_.across_at(y[13]), u_rate), dy[19] = dot(path_.at(y[13]), u_rate);
                }
            }
            put(dy, 16, F);
            if (rotates) {
                add_rotation_torque(k, y, F, g, dy);
                if (is_stretched_by_rolling()) {
                    const Vector3<S> rolls = k.angular_velocity - dot(n, k.angular_velocity) * n;
                    pace = pace * square_root(dot(rolls, rolls));
                }
            } else {
                put(dy, 0, permitted_part(quaternion_at(y, 3), Vector3<S>(vector_at(dy, 0) + cross(k.arm, F))));
            }
            put(dy, 10, vector_at(dy, 10) + F);
        }
        loads_.variable_rates(y, y + first_variable(), values, dy, dy + first_variable());
        if (is_stretched()) {
            for (int i = 0; i < 13; ++i) dy[i] = pace * dy[i];
            for (int i = first_variable(); i < dimension(); ++i) dy[i] = pace * dy[i];
        }
        dy[13] = pace;
        int next = 14 + own_functions();
        const Quaternion<S> q = quaternion_at(y, 3);
        for (const std::size_t k : others_) dy[next++] = gap(pair_at(k), q, vector_at(y, 7));
    }

  private:
    const ContactGeometry<P>* geometry_;
    FormulaMomentumForm<P> loads_;  // its time has the index of the clock
    MassProperties<P> body_;
    Matrix3<P> inverse_inertia_, inverse_;  // the second one with restricted rotation
    double least_moment_ = 1;
    System system_ = System::flight;
    contact::Pair pair_;
    using Permitted = typename contact::PermittedRotation<P>::Kind;
    contact::PermittedRotation<P> permitted_;
    std::vector<std::size_t> others_;
    Motion<P> frozen_;           // shock: the motion before it
    contact::SlipPath<P> path_;  // onset
    contact::RotationFriction<P> rotation_;
    contact::TwoContacts<P> two_;
    std::vector<P> held_values_;  // of formulas
    P time_{0};

    // a state of loads_
    std::vector<P> load_state() const { return std::vector<P>(static_cast<std::size_t>(loads_.dimension())); }
    // the state of loads_ at a motion, and its rates
    void find_rates(const Motion<P>& m, std::vector<P>& y, std::vector<P>& rates) const {
        momenta(m, y.data());
        y[static_cast<std::size_t>(loads_.time_index())] = time_;
        std::copy(held_values_.begin(), held_values_.end(), y.begin() + loads_.time_index() + 1);
        loads_.derivative(y.data(), rates.data());
    }

    const P& mu() const { return geometry_->planes[pair_.plane].friction; }

    // L, q, p, P
    void momenta(const Motion<P>& m, P* y) const {
        put(y, 0, rotate(m.q, Vector3<P>(body_.inertia * m.angular_velocity_B)));
        put(y, 3, m.q), put(y, 7, m.position_W), put(y, 10, Vector3<P>(body_.mass * m.velocity_W));
    }

    /// The contact point in world axes.
    template <class S>
    struct Kinematics {
        Vector3<S> arm;                                     // r
        Vector3<S> velocity;                                // u
        Vector3<S> acceleration;                            // du/dt without contact force
        Vector3<S> angular_velocity, angular_acceleration;  // w, and dw/dt without contact force
        Matrix3<S> inverse_inertia_W, inertia_W;            // the inertia with rotation friction only
        bool holds_rolling = false, holds_spin = false;
        Vector3<P> normal;
        P inverse_mass;

        // angular acceleration by a torque
        Vector3<S> rotate_by(const Vector3<S>& torque) const {
            if (!holds_rolling && !holds_spin) return inverse_inertia_W * torque;
            return contact::held_response(holds_rolling, holds_spin, inertia_W, inverse_inertia_W, normal, torque);
        }

        // K f
        template <class T>
        Vector3<S> respond(const Vector3<T>& f) const {
            return inverse_mass * f + cross(rotate_by(cross(arm, f)), arm);
        }
    };
    // `rate` holds dL/dt and dP/dt by the loads
    template <class S>
    Kinematics<S> kinematics(contact::Pair pair, const S* y, const S* rate) const {
        const SupportPiece<P>& piece = geometry_->pieces[pair.piece];
        const Vector3<P>& n = geometry_->planes[pair.plane].normal_W;
        const Matrix3<S> axes = rotation_matrix(quaternion_at(y, 3));
        Kinematics<S> k;
        k.inverse_mass = P(1) / body_.mass;
        if (permitted_.kind != Permitted::none) k.inverse_inertia_W = axes * inverse_ * transposed(axes);
        const Vector3<S> L = vector_at(y, 0), w = k.inverse_inertia_W * L;
        const Vector3<S> center = axes * piece.center;
        Vector3<S> moves = cross(w, center);
        k.arm = center - piece.radius * n;
        if (piece.extended) {
            const Matrix3<S> G = axes * piece.semi_axes;
            const auto shape = [&](const auto& v) { return Vector3<S>(G * (transposed(G) * v)); };
            const Vector3<S> Bn = shape(n), Bn_rate = cross(w, Bn) - shape(cross(w, n));
            const S h = dot(n, Bn), root = square_root(h), h_rate = dot(n, Bn_rate);
            k.arm = k.arm - (P(1) / root) * Bn;
            moves = moves - (P(1) / root) * Bn_rate + (h_rate / (P(2) * (h * root))) * Bn;
        }
        k.velocity = k.inverse_mass * vector_at(y, 10) + cross(w, k.arm);
        k.angular_velocity = w, k.normal = n;
        if (rotation_.acts) {
            k.inertia_W = axes * body_.inertia * transposed(axes);
            k.holds_rolling = rotation_.holds_rolling, k.holds_spin = rotation_.holds_spin;
        }
        const Vector3<S> w_rate = k.rotate_by(vector_at(rate, 0) - cross(w, L));
        k.angular_acceleration = w_rate;
        k.acceleration = k.inverse_mass * vector_at(rate, 10) + cross(w_rate, k.arm) + cross(w, moves);
        return k;
    }
    // the part of a torque that changes L if the rotation is restricted
    template <class S>
    Vector3<S> permitted_part(const Quaternion<S>& q, const Vector3<S>& torque_W) const {
        if (permitted_.kind == Permitted::any) return torque_W;
        if (permitted_.kind == Permitted::none) return {};
        const Vector3<S> axis = rotation_matrix(q) * permitted_.axis_B;
        return dot(axis, torque_W) * axis;
    }
    // dL/dt = I W + w x L with the friction torques, and their functions as in contact/reduced_form.h
    template <class S>
    void add_rotation_torque(const Kinematics<S>& k, const S* y, const Vector3<S>& F, const Vector3<S>& g,
                             S* dy) const {
        const Vector3<P>& n = k.normal;
        const Vector3<S>&w = k.angular_velocity, opposing = dot(n, F) * g;
        const Vector3<S> by_force = cross(k.arm, F);
        const Vector3<S> W = k.angular_acceleration + k.rotate_by(Vector3<S>(by_force + opposing));
        const Vector3<S> L_rate = k.inertia_W * W + cross(w, vector_at(y, 0));
        const Vector3<S> holding = L_rate - vector_at(dy, 0) - by_force - opposing;
        const S N = dot(n, F), twist = dot(n, holding), rolling_limit = rotation_.rolling * N,
                spin_limit = rotation_.torsional * N, spin = dot(n, w);
        const Vector3<S> M = holding - twist * n, rolls = w - spin * n;
        const int next = first_rotation_function();
        const S& t = y[13];
        const bool starts = rotation_.starts_rolling;
        dy[next] = starts                    ? dot(rotation_.path.across_at(t), W)
                   : rotation_.holds_rolling ? rolling_limit * rolling_limit - dot(M, M)
                                             : dot(rolls, rolls);
        dy[next + 1] = rotation_.holds_spin ? spin_limit * spin_limit - twist * twist : P(rotation_.spin) * spin;
        dy[next + 2] = starts ? dot(rotation_.path.at(t), W) : P(0) * N;
        Vector3<S> torque = opposing;
        if (rotation_.holds_rolling) torque = torque + M;
        if (rotation_.holds_spin) torque = torque + twist * n;
        put(dy, next + 3, torque);
        put(dy, 0, L_rate);
    }
    // The multipliers N_1, N_2, A_1, A_2 of a ball that touches two planes solve n_i . du_i/dt = 0 and, for each
    // contact, d . du_i/dt = 0 while it rolls or A_i + s_i mu_i N_i = 0 while it slides with the sign s_i.
    template <class S>
    void add_two_contacts(const S* y, S* dy) const {
        const Vector3<P>& d = two_.line_W;
        const std::array<Kinematics<S>, 2> at{kinematics(two_.pairs[0], y, dy), kinematics(two_.pairs[1], y, dy)};
        std::array<Vector3<P>, 4> unit;
        for (std::size_t i = 0; i < 2; ++i) unit[i] = at[i].normal, unit[2 + i] = d;
        std::array<std::array<S, 5>, 4> row;
        for (std::size_t i = 0; i < 4; ++i) {
            const Kinematics<S>& here = at[i % 2];
            const bool slides = i >= 2 && two_.slip[i % 2] != 0;
            const P friction = P(two_.slip[i % 2]) * geometry_->planes[two_.pairs[i % 2].plane].friction;
            for (std::size_t j = 0; j < 4; ++j) {
                // the acceleration of point i by a unit force at point j
                const Vector3<S> turn = here.rotate_by(Vector3<S>(cross(at[j % 2].arm, unit[j])));
                row[i][j] = slides ? S(i == j       ? P(1)
                                       : j + 2 == i ? friction
                                                    : P(0))
                                   : dot(unit[i], Vector3<S>(here.inverse_mass * unit[j] + cross(turn, here.arm)));
            }
            row[i][4] = slides ? S(0) : P(-1) * dot(unit[i], here.acceleration);
        }
        const std::array<S, 4> x = eliminate(row);
        Vector3<S> force, moment;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vector3<S> F = x[i] * unit[i] + x[2 + i] * d;
            force = force + F, moment = moment + cross(at[i].arm, F);
            const P mu = geometry_->planes[two_.pairs[i].plane].friction, mu_square = mu * mu;
            const int to = static_cast<int>(i);
            dy[14 + to] = x[i];
            dy[16 + to] = two_.slip[i] == 0 ? mu_square * (x[i] * x[i]) - x[2 + i] * x[2 + i]
                                            : P(two_.slip[i]) * dot(d, at[i].velocity);
            put(dy, 18 + 3 * to, F);
        }
        put(dy, 0, Vector3<S>(vector_at(dy, 0) + moment));
        put(dy, 10, Vector3<S>(vector_at(dy, 10) + force));
    }
    // Gaussian elimination; the diagonal does not vanish
    template <class S>
    static std::array<S, 4> eliminate(std::array<std::array<S, 5>, 4>& row) {
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t i = k + 1; i < 4; ++i) {
                const S factor = row[i][k] / row[k][k];
                for (std::size_t j = k; j < 5; ++j) row[i][j] = row[i][j] - factor * row[k][j];
            }
        std::array<S, 4> x;
        for (std::size_t k = 4; k-- > 0;) {
            S sum = row[k][4];
            for (std::size_t j = k + 1; j < 4; ++j) sum = sum - row[k][j] * x[j];
            x[k] = sum / row[k][k];
        }
        return x;
    }
    template <class S>
    S gap(contact::Pair pair, const Quaternion<S>& q, const Vector3<S>& p) const {
        const SupportPiece<P>& piece = geometry_->pieces[pair.piece];
        const ContactPlane<P>& plane = geometry_->planes[pair.plane];
        const Matrix3<S> axes = rotation_matrix(q);
        S height = dot(plane.normal_W, p + axes * piece.center) - (piece.radius + plane.offset);
        if (!piece.extended) return height;
        const Vector3<S> m = transposed(axes * piece.semi_axes) * plane.normal_W;
        return height - square_root(dot(m, m));
    }
    // attitude and position are constant during a shock
    template <class S>
    void shock(const S* y, S* dy) const {
        const Vector3<P>& n = geometry_->planes[pair_.plane].normal_W;
        std::vector<P> all = load_state(), rate = all;
        find_rates(frozen_, all, rate);
        const Kinematics<P> k = kinematics(pair_, all.data(), rate.data());
        const Vector3<S> w = k.inverse_inertia_W * vector_at(y, 0);
        const Vector3<S> u = k.inverse_mass * vector_at(y, 3) + cross(w, k.arm);
        const S normal = dot(n, u);
        const Vector3<S> slip = u - normal * n;
        const S square = dot(slip, slip), pace = square_root(square);
        const Vector3<S> f = pace * n - mu() * slip;
        put(dy, 0, cross(k.arm, f)), put(dy, 3, f);
        dy[6] = pace * normal;
        dy[7] = pace;
        dy[8] = normal, dy[9] = square;
    }
};

}  // namespace polhode::truth
