// Contact dynamics of one body in body axes, with the constraint forces eliminated as far as the mode permits.
//
//   flight    w, q, p, v                Euler's equations
//   sliding   w, q, p, slip (2)         v follows from the slip u_t:  v = u_t - w x r,  r from the centre to the
//   contact rolling   w, q, p                   v = -w x r; momentum about the contact point:
//       (I + m (s^2 1 - s s^T)) dw/dt = tau - w x Iw + m s x (s' x w + w x (s x w)) - m s x a
//   two contacts of a ball  w, q, p, V    v = V d along the line of the planes (two_contacts.h)
//   shock     u, work                   du/dp = K (n - mu u_t / |u_t|),  dW/dp = u_n
//
// s is the contact point from the centre of mass in body axes, s' its velocity over the body, a the acceleration by the
// loads. While the body slides with friction, the independent variable is stretched, dt = |u_t| ds (shock: dp = |u_t|
// ds): the direction of the slip then stays smooth up to the end of the slip. State: the variables above, the clock (t,
// or p of a shock), the integrals of the observed functions over s, from which their series follow, and the variables
// of formulas (contact_formulas.h).
#pragma once

#include <array>
#include <vector>

#include "integrators/contact/contact_formulas.h"
#include "integrators/contact/contact_point.h"
#include "integrators/contact/contact_state.h"
#include "integrators/contact/rotation_friction.h"
#include "integrators/contact/two_contacts.h"
#include "motion/body_equations.h"
#include "motion/exact_body_of.h"

namespace polhode::contact {

template <class P>
class ReducedForm {
  public:
    static constexpr const char* name = "reduced coordinates in body axes";

    /// `geometry` must outlive the form.
    ReducedForm(const Scene& scene, const ContactGeometry<P>& geometry)
        : scene_(&scene),
          geometry_(&geometry),
          body_(exact_body<P>(scene)),
          inertia_{body_.inertia_B, inverse(body_.inertia_B)},
          formulas_(scene, body_) {}

    BodyMotion<P> initial() const { return {body_.q, body_.angular_velocity_B, body_.position_W, body_.velocity_W}; }
    /// Sets the loads that act from `begin` on, and applies the impulses at that time.
    void enter(double begin, BodyMotion<P>& m) {
        forcing_ = forcing_at<P>(*scene_, body_, begin, Quaternion<P>{});
        for (const PosedImpulse<P>& impulse : impulses_at<P>(*scene_, body_, begin, Quaternion<P>{}))
            apply(impulse, inertia_, body_.mass, false, m.angular_velocity_B, m.q, m.position_W, m.velocity_W);
        formulas_.enter(begin, m.angular_velocity_B, m.q, m.position_W, m.velocity_W);
    }
    /// Whether loads depend on time or state by formulas.
    bool has_formulas() const { return formulas_.act(); }
    /// Sets the time (s) for response() and load_torque().
    void set_time(const P& t) { time_ = t; }
    /// Selects the system for later calls of the functions of a state.
    void select(System system, Pair pair) {
        system_ = system, pair_ = pair;
        if (!geometry_->planes.empty()) axes_ = ContactAxes<P>(geometry_->planes[pair.plane].normal_W);
        others_.clear();
        for (std::size_t k = 0; k < geometry_->size(); ++k)
            if (system == System::flight || !(pair_at(k) == pair)) others_.push_back(k);
    }
    /// Selects the contacts of a ball with two planes.
    void select_two(const TwoContacts<P>& two) {
        system_ = System::two_contacts, two_ = two;
        others_.clear();
        for (std::size_t k = 0; k < geometry_->size(); ++k)
            if (!(pair_at(k) == two.pairs[0]) && !(pair_at(k) == two.pairs[1])) others_.push_back(k);
    }
    Pair pair_at(std::size_t k) const { return {k / geometry_->pieces.size(), k % geometry_->pieces.size()}; }
    /// Indices of the pairs whose gaps are observed, in this order, after the system's own functions.
    const std::vector<std::size_t>& observed_gaps() const { return others_; }
    bool is_stretched() const {
        return system_ == System::shock || is_stretched_by_slip() || is_stretched_by_rolling();
    }
    /// Whether |u_t| is a factor of dt/ds.
    bool is_stretched_by_slip() const {
        return system_ == System::sliding && friction() > P(0) && !rotation_.starts_rolling;
    }
    /// Whether |w_t| is a factor of dt/ds.
    bool is_stretched_by_rolling() const {
        return (system_ == System::sliding || system_ == System::rolling) && rotation_.opposes_rolling() &&
               !rotation_.starts_rolling;
    }
    int clock() const {
        switch (system_) {
            case System::flight:
                return 13;
            case System::sliding:
            case System::onset:
                return 12;
            case System::rolling:
                return 10;
            case System::two_contacts:
                return 11;
            case System::shock:
                break;
        }
        return 4;
    }
    int work() const { return 3; }  ///< shock: index of the normal work
    /// Number of the system's own observed functions: sliding N, slip^2, force (3); rolling N, (mu N)^2 - F_t^2, force
    /// (3); shock u_n, slip^2.
    /// With torsional or rolling friction, rotation_functions further ones (see rotation_functions()).
    int own_functions() const {
        const int rotation = is_contact() && rotation_.acts ? rotation_functions : 0;
        return (system_ == System::flight         ? 0
                : system_ == System::two_contacts ? two_contacts_functions
                : system_ == System::shock        ? 2
                : system_ == System::onset        ? 6
                                                  : 5) +
               rotation;
    }
    /// Index of the first function of torsional and rolling friction: rolling (w_t^2, or (rho N)^2 - M_t^2 while it is
    /// held, or the angular acceleration across the direction in which it starts), spin (|w_n|, or (sigma N)^2 - M_n^2
    /// while it is held), the angular acceleration along the direction in which rolling starts, and the torque (3).
    int first_rotation_function() const { return clock() + 1 + own_functions() - rotation_functions; }
    int dimension() const { return first_variable() + (system_ == System::shock ? 0 : formulas_.auxiliaries()); }
    /// Index of the first of the formulas' variables, after all observed functions.
    int first_variable() const {
        return clock() + 1 + own_functions() + (system_ == System::shock ? 0 : static_cast<int>(others_.size()));
    }
    /// Sets the formulas' variables to their values at a state.
    void refresh(P* y) const {
        if (first_variable() == dimension()) return;
        const BodyMotion<P> m = motion(y);
        formulas_.update(formulas_.state(y[clock()], m.angular_velocity_B, m.q, m.position_W, m.velocity_W),
                         y + first_variable());
    }
    std::vector<Block> blocks(const Sizes& sizes, double slip) const {
        if (system_ == System::shock) {
            const double speed = sizes.velocity, mass = static_cast<double>(body_.mass);
            return {{0, 3, speed}, {3, 1, mass * speed * speed}};
        }
        std::vector<Block> all{{0, 3, sizes.angular_velocity}, {3, 4, 1}, {7, 3, sizes.position}};
        if (system_ == System::flight) all.push_back({10, 3, sizes.velocity});
        if (system_ == System::two_contacts) all.push_back({10, 1, sizes.velocity});
        if (system_ == System::sliding || system_ == System::onset)
            all.push_back({10, 2, is_stretched_by_slip() ? slip : sizes.velocity});
        for (int i = first_variable(); i < dimension(); ++i) all.push_back({i, 1, 1});
        return all;
    }

    /// Restricts the rotation in contact.
    void permit(const PermittedRotation<P>& rotation) { permitted_ = rotation; }
    /// Torque of the loads about the centre of mass, N m, world axes.
    Vector3<P> load_torque(const BodyMotion<P>& m) const {
        const auto acting = loads<P>(nullptr, time_, m.angular_velocity_B, m.q, m.position_W, m.velocity_W);
        return rotate(m.q, acting.torque_B);
    }
    /// Sets torsional and rolling friction for later calls.
    void set_rotation(const RotationFriction<P>& rotation) { rotation_ = rotation; }
    /// The direction of the slip for System::onset.
    void set_path(const SlipPath<P>& path) { path_ = path; }

    void start(const BodyMotion<P>& m, const P& clock_time, P* y) {
        for (int i = 0; i < dimension(); ++i) y[i] = P(0);
        y[clock()] = clock_time;
        if (system_ == System::shock) {
            frozen_ = m;
            response_ = response(pair_, m);
            put(y, 0, response_.velocity);
            return;
        }
        put(y, 0, m.angular_velocity_B), put(y, 3, m.q), put(y, 7, m.position_W);
        if (system_ == System::flight) put(y, 10, m.velocity_W);
        if (system_ == System::two_contacts) y[10] = dot(m.velocity_W, two_.line_W);
        if (system_ == System::sliding || system_ == System::onset) {
            const Vector3<P> u = response(pair_, m).velocity;
            y[10] = u[0], y[11] = u[1];
        }
        refresh(y);
    }
    BodyMotion<P> motion(const P* y) const {
        if (system_ == System::shock) {
            const Vector3<P> change = vector_at(y, 0) - response_.velocity;
            BodyMotion<P> m = frozen_;
            push(m, pair_, axes_.to_world(inverse(response_.matrix) * change));
            return m;
        }
        BodyMotion<P> m{normalized(quaternion_at(y, 3)), vector_at(y, 0), vector_at(y, 7), {}};
        if (system_ == System::flight) {
            m.velocity_W = vector_at(y, 10);
            return m;
        }
        if (system_ == System::two_contacts) {
            m.velocity_W = y[10] * two_.line_W;
            return m;
        }
        const Vector3<P> n = rotate_back(m.q, axes_.normal_W);
        const ContactPoint<P> at = contact_point(piece(), n, m.angular_velocity_B);
        m.velocity_W = rotate(m.q, cross(at.point_B, m.angular_velocity_B));
        if (system_ == System::sliding || system_ == System::onset)
            m.velocity_W = m.velocity_W + y[10] * axes_.first_W + y[11] * axes_.second_W;
        return m;
    }

    /// Velocity and accelerations at a contact.
    ContactResponse<P> response(Pair pair, const BodyMotion<P>& m) const {
        const ContactAxes<P> axes(geometry_->planes[pair.plane].normal_W);
        const Vector3<P>& w = m.angular_velocity_B;
        const Vector3<P> n = rotate_back(m.q, axes.normal_W);
        const ContactPoint<P> at = contact_point(geometry_->pieces[pair.piece], n, w);
        ContactResponse<P> result;
        const Vector3<P> spin = rotate(m.q, cross(w, at.point_B));
        result.velocity = axes.from_world(m.velocity_W + spin);
        const auto acting = loads<P>(nullptr, time_, w, m.q, m.position_W, m.velocity_W);
        const Vector3<P> free = angular_acceleration(w, acting.torque_B);
        const Vector3<P> b = cross(free, at.point_B) + cross(w, at.moves_B) + cross(w, cross(w, at.point_B));
        result.acceleration = axes.from_world(acting.acceleration_W + rotate(m.q, b));
        for (std::size_t j = 0; j < 3; ++j) {
            const Vector3<P> f_B = rotate_back(m.q, axes[j]);
            const Vector3<P> d_B = (P(1) / body_.mass) * f_B + cross(turning(cross(at.point_B, f_B)), at.point_B);
            const Vector3<P> column = axes.from_world(rotate(m.q, d_B));
            for (std::size_t i = 0; i < 3; ++i) result.matrix[i][j] = column[i];
        }
        return result;
    }
    /// Applies an impulse (N s, world axes) at a contact.
    void push(BodyMotion<P>& m, Pair pair, const Vector3<P>& impulse_W) const {
        const Vector3<P> n = rotate_back(m.q, geometry_->planes[pair.plane].normal_W);
        const Vector3<P> point = contact_point(geometry_->pieces[pair.piece], n, m.angular_velocity_B).point_B;
        m.angular_velocity_B = m.angular_velocity_B + inertia_.response(cross(point, rotate_back(m.q, impulse_W)));
        m.velocity_W = m.velocity_W + (P(1) / body_.mass) * impulse_W;
    }
    double friction_of(Pair pair) const { return static_cast<double>(geometry_->planes[pair.plane].friction); }

    template <class S>
    void derivative(const S* y, S* dy) const {
        switch (system_) {
            case System::flight:
                flight(y, dy);
                break;
            case System::sliding:
            case System::onset:
                sliding(y, dy);
                break;
            case System::rolling:
                rolling(y, dy);
                break;
            case System::two_contacts:
                two_contacts(y, dy);
                break;
            case System::shock:
                shock(y, dy);
                break;
        }
    }

  private:
    const Scene* scene_;
    const ContactGeometry<P>* geometry_;
    ExactBody<P> body_;
    FullInertia<P> inertia_;
    Forcing<P> forcing_;
    System system_ = System::flight;
    Pair pair_;
    PermittedRotation<P> permitted_;
    ContactAxes<P> axes_;
    std::vector<std::size_t> others_;
    BodyMotion<P> frozen_;         // shock: the motion before it
    ContactResponse<P> response_;  // shock: before it
    SlipPath<P> path_;             // onset
    RotationFriction<P> rotation_;
    TwoContacts<P> two_;
    ContactFormulas<P> formulas_;
    P time_{0};

    bool is_contact() const { return system_ != System::flight && system_ != System::shock; }
    const SupportPiece<P>& piece() const { return geometry_->pieces[pair_.piece]; }
    const P& friction() const { return geometry_->planes[pair_.plane].friction; }

    bool is_restricted() const { return permitted_.kind != PermittedRotation<P>::Kind::any; }
    // angular acceleration by a torque, and its part that is linear in the torque
    template <class S>
    Vector3<S> angular_acceleration(const Vector3<S>& w, const Vector3<S>& tau) const {
        return is_restricted() ? permitted_.response(tau) : inertia_.angular_acceleration(w, tau);
    }
    template <class S>
    Vector3<S> turning(const Vector3<S>& tau) const {
        return is_restricted() ? permitted_.response(tau) : inertia_.response(tau);
    }
    template <class S>
    Vector3<S> load_acceleration(const Quaternion<S>& q, const Vector3<S>& v) const {
        Vector3<S> a = cast<S>(forcing_.acceleration_W);
        if (forcing_.has_body_force) a = a + rotate(q, forcing_.specific_force);
        if (forcing_.has_translational_drag) a = a - forcing_.specific_drag * v;
        return a;
    }
    /// What the loads do at a state.
    template <class S>
    struct ActingLoads {
        Vector3<S> torque_B, acceleration_W;
        typename ContactFormulas<P>::template Values<S> values;
    };
    // `y`: the state, for the formulas' variables of recorded equations
    template <class S>
    ActingLoads<S> loads(const S* y, const S& t, const Vector3<S>& w, const Quaternion<S>& q, const Vector3<S>& p,
                         const Vector3<S>& v) const {
        ActingLoads<S> acting{torque(forcing_, 0, w, q, p, v), load_acceleration(q, v), {}};
        if (formulas_.act())
            formulas_.add(formulas_.state(t, w, q, p, v), y ? y + first_variable() : y, acting.values, acting.torque_B,
                          acting.acceleration_W);
        return acting;
    }
    // rates of the formulas' variables, given the rates of the state in time
    template <class S>
    void variable_rates(const ActingLoads<S>& acting, const S& pace, const Vector3<S>& w_rate,
                        const Quaternion<S>& q_rate, const Vector3<S>& v, const Vector3<S>& v_rate, S* dy) const {
        if (first_variable() < dimension())
            formulas_.variable_rates(formulas_.rates(w_rate, q_rate, v, v_rate), acting.values, pace,
                                     dy + first_variable());
    }
    template <class S>
    void observe_gaps(const Quaternion<S>& q, const Vector3<S>& p, S* dy) const {
        int next = clock() + 1 + own_functions();
        for (const std::size_t k : others_) {
            const Pair pair = pair_at(k);
            const ContactPlane<P>& plane = geometry_->planes[pair.plane];
            const Vector3<S> n = rotate_back(q, plane.normal_W);
            dy[next++] = dot(plane.normal_W, p) + lowest_height(geometry_->pieces[pair.piece], n) - plane.offset;
        }
    }
    template <class S>
    void flight(const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0), p = vector_at(y, 7), v = vector_at(y, 10);
        const Quaternion<S> q = quaternion_at(y, 3);
        const ActingLoads<S> acting = loads(y, y[13], w, q, p, v);
        put(dy, 0, inertia_.angular_acceleration(w, acting.torque_B));
        put(dy, 3, attitude_rate(P(1) / P(2), q, w));
        put(dy, 7, v), put(dy, 10, acting.acceleration_W);
        dy[13] = S(1);
        variable_rates(acting, S(1), vector_at(dy, 0), quaternion_at(dy, 3), v, acting.acceleration_W, dy);
        observe_gaps(q, p, dy);
    }
    // Torque of torsional and rolling friction for N = 1; w and n in body axes.
    template <class S>
    Vector3<S> rotation_torque(const Quaternion<S>& q, const Vector3<S>& n, const Vector3<S>& w, const S& t) const {
        return rotation_.torque(n, w, t, [&](const Vector3<S>& v) { return rotate_back(q, v); });
    }
    template <class S>
    Vector3<S> held_rotation(const Vector3<S>& n, const Vector3<S>& torque) const {
        return held_response(rotation_.holds_rolling, rotation_.holds_spin, inertia_.tensor, inertia_.inverse, n,
                             torque);
    }
    // Functions of torsional and rolling friction, given the angular acceleration W and the torques: of the loads and
    // the contact force (`given`), and of friction against w_t and w_n (N g).
    template <class S>
    void observe_rotation(const S* y, const Vector3<S>& n, const S& N, const Vector3<S>& W, const Vector3<S>& given,
                          const Vector3<S>& opposing, S* dy) const {
        const Vector3<S> w = vector_at(y, 0);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Vector3<S> holding = inertia_.tensor * W - given - opposing, rolls = w - dot(w, n) * n;
        const S about_normal = dot(holding, n);
        const Vector3<S> M = holding - about_normal * n;
        int next = first_rotation_function();
        const S& t = y[clock()];
        if (rotation_.starts_rolling)
            dy[next] = dot(rotation_.path.across_at(t), rotate(q, W));
        else
            dy[next] = rotation_.holds_rolling ? (rotation_.rolling * rotation_.rolling) * (N * N) - dot(M, M)
                                               : dot(rolls, rolls);
        dy[next + 1] = rotation_.holds_spin
                           ? (rotation_.torsional * rotation_.torsional) * (N * N) - about_normal * about_normal
                           : P(rotation_.spin) * dot(w, n);
        dy[next + 2] = rotation_.starts_rolling ? dot(rotation_.path.at(t), rotate(q, W)) : S(0) * N;
        // free motions do not get the small torques that remain by rounding
        Vector3<S> torque = opposing;
        if (rotation_.holds_rolling) torque = torque + M;
        if (rotation_.holds_spin) torque = torque + about_normal * n;
        put(dy, next + 3, rotate(q, torque));
    }
    template <class S>
    void sliding(const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0), p = vector_at(y, 7);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Vector3<S> n = rotate_back(q, axes_.normal_W), e1 = rotate_back(q, axes_.first_W),
                         e2 = rotate_back(q, axes_.second_W);
        const ContactPoint<S> at = contact_point(piece(), n, w);
        const Vector3<S>& s = at.point_B;
        const Vector3<S> v = y[10] * axes_.first_W + y[11] * axes_.second_W + rotate(q, cross(s, w));
        const S square = y[10] * y[10] + y[11] * y[11];
        const bool rubs = friction() > P(0);
        const bool is_starting = rotation_.acts && rotation_.starts_rolling;
        S pace(1);
        Vector3<S> f = n;
        if (system_ == System::onset) {
            f = n - friction() * rotate_back(q, path_.at(y[12]));
        } else if (rubs) {
            pace = square_root(square);
            const S share = friction() / pace;
            if (is_starting) pace = S(1);
            f = n - (share * y[10]) * e1 - (share * y[11]) * e2;
        }
        const ActingLoads<S> acting = loads(y, y[12], w, q, p, v);
        const Vector3<S>&tau = acting.torque_B, &a = acting.acceleration_W;
        Vector3<S> free, turn, g;
        if (rotation_.acts) {
            g = rotation_torque(q, n, w, y[12]);
            free = held_rotation(n, Vector3<S>(tau + cross(inertia_.tensor * w, w)));
            turn = held_rotation(n, Vector3<S>(cross(s, f) + g));
            if (is_stretched_by_rolling()) pace = pace * rolling_speed(n, w);
        } else {
            free = angular_acceleration(w, tau);
            turn = turning(cross(s, f));
        }
        const Vector3<S> b = cross(free, s) + cross(w, at.moves_B) + cross(w, cross(w, s));
        const Vector3<S> d = (P(1) / body_.mass) * f + cross(turn, s);
        const S N = P(-1) * ((dot(axes_.normal_W, a) + dot(n, b)) / dot(n, d));
        put(dy, 0, pace * (free + N * turn));
        const Quaternion<S> turning = attitude_rate(P(1) / P(2), q, w);
        put(dy, 3, Quaternion<S>{pace * turning.w, pace * turning.x, pace * turning.y, pace * turning.z});
        put(dy, 7, pace * v);
        dy[10] = pace * (dot(axes_.first_W, a) + dot(e1, b) + N * dot(e1, d));
        dy[11] = pace * (dot(axes_.second_W, a) + dot(e2, b) + N * dot(e2, d));
        dy[12] = pace;
        dy[13] = N, dy[14] = square;
        const Vector3<S> force = N * rotate(q, f);
        put(dy, 15, force);
        variable_rates(acting, pace, Vector3<S>(free + N * turn), turning, v,
                       Vector3<S>(a + (P(1) / body_.mass) * force), dy);
        if (system_ == System::onset) {
            // the acceleration of the slip across and along its direction
            const Vector3<S> slip_rate = dy[10] * axes_.first_W + dy[11] * axes_.second_W;
            dy[14] = dot(path_.across_at(y[12]), slip_rate), dy[18] = dot(path_.at(y[12]), slip_rate);
        }
        if (rotation_.acts) {
            const Vector3<S> W = free + N * turn, given = tau + cross(inertia_.tensor * w, w) + N * cross(s, f);
            observe_rotation(y, n, N, W, given, Vector3<S>(N * g), dy);
        }
        observe_gaps(q, p, dy);
    }
    template <class S>
    S rolling_speed(const Vector3<S>& n, const Vector3<S>& w) const {
        const Vector3<S> rolls = w - dot(w, n) * n;
        return square_root(dot(rolls, rolls));
    }
    // The angular acceleration of rolling with friction torques N g, N = n . F, F = m (c + s x W):
    //   (A - m g (n x s)^T) W = moment + m (n . c) g, up to torques that hold w_t or w_n.
    template <class S>
    Vector3<S> rolling_acceleration(Matrix3<S> about, const Vector3<S>& n, const Vector3<S>& s, const Vector3<S>& c,
                                    const Vector3<S>& g, const Vector3<S>& moment) const {
        const Vector3<S> lever = cross(n, s);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) about[i][j] = about[i][j] - body_.mass * (g[i] * lever[j]);
        const Vector3<S> right = moment + (body_.mass * dot(n, c)) * g;
        const Matrix3<S> inverse_about = rotation_.holds_rolling ? about : Matrix3<S>(inverse(about));
        return held_response(rotation_.holds_rolling, rotation_.holds_spin, about, inverse_about, n, right);
    }
    template <class S>
    void rolling(const S* y, S* dy) const {
        const Vector3<S> w = vector_at(y, 0), p = vector_at(y, 7);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Vector3<S> n = rotate_back(q, axes_.normal_W);
        const ContactPoint<S> at = contact_point(piece(), n, w);
        const Vector3<S>& s = at.point_B;
        const Vector3<S> v_B = cross(s, w), v = rotate(q, v_B);
        const ActingLoads<S> acting = loads(y, y[10], w, q, p, v);
        const Vector3<S> a_B = rotate_back(q, acting.acceleration_W);
        const Vector3<S> c = cross(at.moves_B, w) + cross(w, v_B) - a_B;
        const S square = dot(s, s);
        Matrix3<S> about;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                const S shift = i == j ? square - s[i] * s[j] : P(-1) * (s[i] * s[j]);
                about[i][j] = inertia_.tensor[i][j] + body_.mass * shift;
            }
        const Vector3<S> free = acting.torque_B - cross(w, inertia_.tensor * w);
        const Vector3<S> moment = free + body_.mass * cross(s, c);
        Vector3<S> w_rate, g;
        if (rotation_.acts) {
            g = rotation_torque(q, n, w, y[10]);
            w_rate = rolling_acceleration(about, n, s, c, g, moment);
        } else if (permitted_.kind == PermittedRotation<P>::Kind::about_axis) {
            const Vector3<P>& a = permitted_.axis_B;
            const S share = dot(a, moment) / dot(a, Vector3<S>(about * a));
            w_rate = share * a;
        } else if (!is_restricted()) {
            w_rate = inverse(about) * moment;
        }
        const Vector3<S> force_B = body_.mass * (c + cross(s, w_rate));
        const S N = dot(n, force_B);
        const P mu_square = friction() * friction();
        put(dy, 0, w_rate);
        const Quaternion<S> q_rate = attitude_rate(P(1) / P(2), q, w);
        put(dy, 3, q_rate);
        put(dy, 7, v);
        dy[10] = S(1);
        dy[11] = N, dy[12] = (mu_square + P(1)) * (N * N) - dot(force_B, force_B);
        const Vector3<S> force = rotate(q, force_B);
        put(dy, 13, force);
        S pace(1);
        if (rotation_.acts) {
            observe_rotation(y, n, N, w_rate, Vector3<S>(free + cross(s, force_B)), Vector3<S>(N * g), dy);
            if (is_stretched_by_rolling()) {
                pace = rolling_speed(n, w);
                for (int i = 0; i <= 10; ++i) dy[i] = pace * dy[i];
            }
        }
        variable_rates(acting, pace, w_rate, q_rate, v, Vector3<S>(acting.acceleration_W + (P(1) / body_.mass) * force),
                       dy);
        observe_gaps(q, p, dy);
    }
    // The motion of a ball along the line of two planes, see two_contacts.h.
    template <class S>
    void two_contacts(const S* y, S* dy) const {
        const Vector3<S> w_B = vector_at(y, 0), p = vector_at(y, 7);
        const Quaternion<S> q = quaternion_at(y, 3);
        const Vector3<P>& d = two_.line_W;
        const Vector3<S> v = y[10] * d, w = rotate(q, w_B);
        const ActingLoads<S> acting = loads(y, y[11], w_B, q, p, v);
        const Vector3<S>& a = acting.acceleration_W;
        const Vector3<S> tau = rotate(q, acting.torque_B);
        const P& r = piece_of(two_.pairs[0]).radius;
        const P m = body_.mass, per_moment = r / body_.inertia_B[0][0];
        const std::array<Vector3<P>, 2> n{plane_of(0).normal_W, plane_of(1).normal_W};
        const std::array<Vector3<P>, 2> t{cross(n[0], d), cross(n[1], d)};
        const P c = dot(n[0], n[1]), scale = -m / (P(1) - c * c);
        const P k = P(1) / m + r * per_moment, coupling = P(1) / m + c * r * per_moment;
        std::array<S, 2> N{}, A{}, b{};
        for (std::size_t i = 0; i < 2; ++i) {
            N[i] = scale * (dot(a, n[i]) - c * dot(a, n[1 - i]));
            b[i] = per_moment * dot(tau, t[i]) - dot(a, d);
            A[i] = P(-two_.slip[i]) * (plane_of(i).friction * N[i]);
        }
        if (two_.slip[0] == 0 && two_.slip[1] == 0) {
            const P determinant = k * k - coupling * coupling;
            for (std::size_t i = 0; i < 2; ++i) A[i] = (P(1) / determinant) * (k * b[i] - coupling * b[1 - i]);
        } else {
            for (std::size_t i = 0; i < 2; ++i)
                if (two_.slip[i] == 0) A[i] = (P(1) / k) * (b[i] - coupling * A[1 - i]);
        }
        const Vector3<S> by_friction = (P(-1) * r) * Vector3<S>(A[0] * t[0] + A[1] * t[1]);
        const Vector3<S> w_rate = (P(1) / body_.inertia_B[0][0]) * (tau + by_friction);
        put(dy, 0, rotate_back(q, w_rate));
        put(dy, 3, attitude_rate(P(1) / P(2), q, w_B));
        put(dy, 7, v);
        dy[10] = dot(a, d) + (P(1) / m) * (A[0] + A[1]);
        dy[11] = S(1);
        variable_rates(acting, S(1), vector_at(dy, 0), quaternion_at(dy, 3), v, Vector3<S>(dy[10] * d), dy);
        for (std::size_t i = 0; i < 2; ++i) {
            const int at = static_cast<int>(i);
            const P mu = plane_of(i).friction;
            dy[12 + at] = N[i];
            dy[14 + at] = two_.slip[i] == 0 ? (mu * mu) * (N[i] * N[i]) - A[i] * A[i]
                                            : P(two_.slip[i]) * (y[10] - r * dot(w, t[i]));
            put(dy, 16 + 3 * at, Vector3<S>(N[i] * n[i] + A[i] * d));
        }
        observe_gaps(q, p, dy);
    }
    const SupportPiece<P>& piece_of(Pair pair) const { return geometry_->pieces[pair.piece]; }
    const ContactPlane<P>& plane_of(std::size_t i) const { return geometry_->planes[two_.pairs[i].plane]; }
    template <class S>
    void shock(const S* y, S* dy) const {
        const S square = y[0] * y[0] + y[1] * y[1], pace = square_root(square);
        const P mu = friction();
        const Vector3<S> f(P(-1) * (mu * y[0]), P(-1) * (mu * y[1]), pace);
        put(dy, 0, response_.matrix * f);
        dy[3] = pace * y[2];
        dy[4] = pace;
        dy[5] = y[2], dy[6] = square;
    }
};

}  // namespace polhode::contact
