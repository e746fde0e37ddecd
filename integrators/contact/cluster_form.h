// Motion of touching spheres, with the forces of planes eliminated sphere by sphere.
//
// State of each sphere: position, velocity, angular velocity (world axes), attitude; then the clock and the integrals
// of the observed functions over s (sphere_cluster.h). The force f and the torque tau of loads and pairs on a sphere
// that touches a plane give
//   N = -n . f,   F = -mu N u_t / |u_t|  or, rolling,  F = -(f_t / m - r tau x n / I) / (1/m + r^2/I)
//   m v' = f + N n + F,   I w' = tau - r n x F.
// This response is linear in (f, tau). The forces of the pairs then follow from one equation for a pair that slides,
//   n . (v_1' - v_2') = -(v_1 - v_2) . n',   n' = ((v_1 - v_2) - n n . (v_1 - v_2)) / |p_1 - p_2|
// and three for a pair that rolls, which state that its contact points have the same acceleration.
#pragma once

#include <optional>
#include <vector>

#include "integrators/contact/small_system.h"
#include "integrators/contact/sphere_cluster.h"
#include "motion/body_equations.h"
#include "motion/exact_body_of.h"

namespace polhode::contact {

template <class P>
class ClusterForm {
  public:
    /// The scenes of the spheres alone, which must outlive the form, and their radii, m.
    ClusterForm(const std::vector<const Scene*>& scenes, const std::vector<P>& radii) {
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            const ExactBody<P> body = exact_body<P>(*scenes[i]);
            spheres_.push_back({scenes[i],
                                body,
                                {body.inertia_B, inverse(body.inertia_B)},
                                {},
                                {body.mass, body.inertia_B[0][0], radii[i]}});
        }
    }

    std::size_t size() const { return spheres_.size(); }
    /// Sets the loads that act from `begin` on, and applies the impulses at that time if `with_impulses`.
    void enter(double begin, bool with_impulses, std::vector<BodyMotion<P>>& motions) {
        for (std::size_t i = 0; i < size(); ++i) {
            Sphere& sphere = spheres_[i];
            sphere.forcing = forcing_at<P>(*sphere.scene, sphere.body, begin, Quaternion<P>{});
            if (!with_impulses) continue;
            BodyMotion<P>& m = motions[i];
            for (const PosedImpulse<P>& impulse : impulses_at<P>(*sphere.scene, sphere.body, begin, Quaternion<P>{}))
                apply(impulse, sphere.inertia, sphere.body.mass, false, m.angular_velocity_B, m.q, m.position_W,
                      m.velocity_W);
        }
    }
    void set_mode(const ClusterMode<P>& mode) {
        mode_ = mode;
        supports_.assign(size(), std::nullopt);
        for (std::size_t k = 0; k < mode_.closed.size(); ++k)
            if (!mode_.closed[k].is_pair()) supports_[mode_.closed[k].first] = k;
    }
    int clock() const { return 13 * static_cast<int>(size()); }
    /// Index of the first observed function of a closed contact.
    int function(std::size_t k) const { return clock() + 1 + cluster_functions * static_cast<int>(k); }
    /// Index of the gap of an open contact.
    int gap(std::size_t k) const { return function(mode_.closed.size()) + static_cast<int>(k); }
    int dimension() const { return gap(mode_.open.size()); }
    std::vector<Block> blocks(const Sizes& sizes) const {
        std::vector<Block> all;
        for (std::size_t i = 0; i < size(); ++i) {
            const int at = first(i);
            all.insert(all.end(), {{at, 3, sizes.position},
                                   {at + 3, 3, sizes.velocity},
                                   {at + 6, 3, sizes.angular_velocity},
                                   {at + 9, 4, 1}});
        }
        return all;
    }
    void start(const std::vector<BodyMotion<P>>& motions, const P& t, P* y) const {
        for (int i = 0; i < dimension(); ++i) y[i] = P(0);
        for (std::size_t i = 0; i < size(); ++i) {
            const BodyMotion<P>& m = motions[i];
            const int at = first(i);
            put(y, at, m.position_W), put(y, at + 3, m.velocity_W);
            put(y, at + 6, rotate(m.q, m.angular_velocity_B)), put(y, at + 9, m.q);
        }
        y[clock()] = t;
    }
    std::vector<BodyMotion<P>> motions(const P* y) const {
        std::vector<BodyMotion<P>> all;
        for (std::size_t i = 0; i < size(); ++i) {
            const int at = first(i);
            const Quaternion<P> q = normalized(quaternion_at(y, at + 9));
            all.push_back({q, rotate_back(q, vector_at(y, at + 6)), vector_at(y, at), vector_at(y, at + 3)});
        }
        return all;
    }
    /// Accelerations by the loads alone.
    SphereRates<P> free_rates(std::size_t i, const BodyMotion<P>& m) const {
        const Push<P> push = load(i, State<P>{m.position_W, m.velocity_W, rotate(m.q, m.angular_velocity_B), m.q});
        return {(P(1) / spheres_[i].mass.mass) * push.force, (P(1) / spheres_[i].mass.moment) * push.torque};
    }

    template <class S>
    void derivative(const S* y, S* dy) const {
        std::vector<State<S>> states;
        std::vector<Push<S>> pushes;
        for (std::size_t i = 0; i < size(); ++i) {
            const int at = first(i);
            states.push_back({vector_at(y, at), vector_at(y, at + 3), vector_at(y, at + 6), quaternion_at(y, at + 9)});
            pushes.push_back(load(i, states.back()));
        }
        std::vector<Touch<S>> touches;
        for (const ClusterContact<P>& contact : mode_.closed) touches.push_back(touch(contact, states, y[clock()]));
        add_pair_forces(touches, pushes);
        S pace(1);
        if (mode_.is_stretched())
            for (std::size_t k = 0; k < touches.size(); ++k)
                if (mode_.closed[k].grip == Grip::sliding) pace = pace * touches[k].speed;
        std::vector<Response<S>> rates;
        for (std::size_t i = 0; i < size(); ++i) {
            rates.push_back(respond(i, pushes[i], touches));
            const int at = first(i);
            const Vector3<S> w_B = rotate_back(states[i].q, states[i].w);
            const Quaternion<S> q_rate = attitude_rate(P(1) / P(2), states[i].q, w_B);
            put(dy, at, pace * states[i].v), put(dy, at + 3, pace * rates[i].acceleration);
            put(dy, at + 6, pace * rates[i].angular);
            put(dy, at + 9, Quaternion<S>{pace * q_rate.w, pace * q_rate.x, pace * q_rate.y, pace * q_rate.z});
        }
        dy[clock()] = pace;
        for (std::size_t k = 0; k < touches.size(); ++k) observe(k, touches, rates, dy);
        for (std::size_t k = 0; k < mode_.open.size(); ++k) dy[gap(k)] = gap_of(mode_.open[k], states);
    }

  private:
    struct Sphere {
        const Scene* scene;
        ExactBody<P> body;
        FullInertia<P> inertia;
        Forcing<P> forcing;
        SphereBody<P> mass;
    };
    template <class S>
    struct State {
        Vector3<S> p, v, w;
        Quaternion<S> q;
    };
    template <class S>
    struct Push {
        Vector3<S> force, torque;
    };
    template <class S>
    struct Response {
        Vector3<S> acceleration, angular;
        S normal{0};          // N at the plane
        Vector3<S> friction;  // F at the plane
    };
    /// A closed contact at a state.
    template <class S>
    struct Touch {
        Vector3<S> normal, normal_rate;
        Vector3<S> direction;  // unit vector along u_t
        S speed{0};            // |u_t|
        S bias{0};             // pair: (v_1 - v_2) . n'
        Vector3<S> slip_bias;  // pair: w_1 x r_1' - w_2 x r_2'
        Vector3<S> force;      // pair: force on the first sphere
        SlipHeading<S> heading;
        S along{0};  // the slip along the heading
    };

    std::vector<Sphere> spheres_;
    ClusterMode<P> mode_;
    std::vector<std::optional<std::size_t>> supports_;  // by sphere: the closed contact with a plane

    static int first(std::size_t i) { return 13 * static_cast<int>(i); }

    template <class S>
    Push<S> load(std::size_t i, const State<S>& at) const {
        const Forcing<P>& forcing = spheres_[i].forcing;
        Vector3<S> a = cast<S>(forcing.acceleration_W);
        if (forcing.has_body_force) a = a + rotate(at.q, forcing.specific_force);
        if (forcing.has_translational_drag) a = a - forcing.specific_drag * at.v;
        const Vector3<S> torque_B = torque(forcing, 0, Vector3<S>(rotate_back(at.q, at.w)), at.q, at.p, at.v);
        return {spheres_[i].mass.mass * a, rotate(at.q, torque_B)};
    }
    template <class S>
    Touch<S> touch(const ClusterContact<P>& contact, const std::vector<State<S>>& states, const S& t) const {
        Touch<S> at;
        const State<S>& one = states[contact.first];
        const P r = spheres_[contact.first].mass.radius;
        Vector3<S> slip;
        if (contact.is_pair()) {
            const State<S>& other = states[*contact.second];
            const P r_other = spheres_[*contact.second].mass.radius;
            const Vector3<S> away = one.p - other.p, V = one.v - other.v;
            const S inverse_distance = P(1) / square_root(dot(away, away));
            at.normal = inverse_distance * away;
            at.normal_rate = inverse_distance * (V - dot(V, at.normal) * at.normal);
            at.bias = dot(V, at.normal_rate);
            const Vector3<S> w = r * one.w + r_other * other.w;
            at.slip_bias = cross(at.normal_rate, w);
            slip = V + cross(at.normal, w);
        } else {
            at.normal = cast<S>(contact.normal_W);
            slip = one.v + r * cross(at.normal, one.w);
        }
        slip = slip - dot(slip, at.normal) * at.normal;
        if (contact.grip == Grip::sliding) {
            at.speed = square_root(dot(slip, slip));
            at.direction = (P(1) / at.speed) * slip;
        } else if (contact.grip == Grip::starting) {
            at.heading = slip_heading(contact.path, t, at.normal, at.normal_rate);
            at.direction = at.heading.direction;
            at.along = dot(slip, at.direction);
        }
        return at;
    }
    // the response of a sphere with its plane to a force at the centre and a torque
    template <class S>
    Response<S> respond(std::size_t i, const Push<S>& push, const std::vector<Touch<S>>& touches) const {
        const SphereBody<P>& sphere = spheres_[i].mass;
        Response<S> result;
        Vector3<S> force = push.force, torque = push.torque;
        if (supports_[i]) {
            const ClusterContact<P>& plane = mode_.closed[*supports_[i]];
            const Vector3<P>& n = plane.normal_W;
            result.normal = P(-1) * dot(n, push.force);
            force = force + result.normal * n;
            if (plane.grip == Grip::sticking) {
                const P k = P(1) / sphere.mass + sphere.radius * sphere.radius / sphere.moment;
                result.friction = (P(-1) / k) * ((P(1) / sphere.mass) * force -
                                                 (sphere.radius / sphere.moment) * cross(push.torque, n));
            } else if (plane.grip != Grip::smooth) {
                result.friction = (P(-1) * plane.friction * result.normal) * touches[*supports_[i]].direction;
            }
            force = force + result.friction;
            torque = torque - sphere.radius * cross(n, result.friction);
        }
        result.acceleration = (P(1) / sphere.mass) * force;
        result.angular = (P(1) / sphere.moment) * torque;
        return result;
    }
    // the force of a pair on the first sphere, acting on one of its spheres
    template <class S>
    Push<S> pair_push(const ClusterContact<P>& pair, bool on_first, const Vector3<S>& normal,
                      const Vector3<S>& force) const {
        const P r = spheres_[on_first ? pair.first : *pair.second].mass.radius;
        // the arms are -r_1 n and r_2 n
        return {on_first ? force : Vector3<S>(P(-1) * force), (P(-1) * r) * cross(normal, force)};
    }
    // acceleration of the contact point of the first sphere relative to that of the second, by given accelerations
    template <class S>
    Vector3<S> relative(const ClusterContact<P>& pair, const Touch<S>& at, std::size_t sphere,
                        const Response<S>& rates) const {
        const Vector3<S> rolled = spheres_[sphere].mass.radius * cross(at.normal, rates.angular);
        return sphere == pair.first ? Vector3<S>(rates.acceleration + rolled) : Vector3<S>(rolled - rates.acceleration);
    }
    // The unknowns of pairs, as forces on their first spheres.
    template <class S>
    struct Column {
        std::size_t contact;
        Vector3<S> force;
    };
    template <class S>
    void add_pair_forces(std::vector<Touch<S>>& touches, std::vector<Push<S>>& pushes) const {
        std::vector<Column<S>> columns;
        for (std::size_t k = 0; k < touches.size(); ++k) {
            const ClusterContact<P>& pair = mode_.closed[k];
            if (!pair.is_pair()) continue;
            const Touch<S>& at = touches[k];
            if (pair.grip == Grip::sticking)
                for (std::size_t c = 0; c < 3; ++c) {
                    Vector3<S> unit;
                    unit[c] = S(1);
                    columns.push_back({k, unit});
                }
            else
                columns.push_back(
                    {k, pair.grip == Grip::smooth ? at.normal : Vector3<S>(at.normal - pair.friction * at.direction)});
        }
        const std::size_t m = columns.size();
        std::vector<S> B(m * m, S(0)), x(m, S(0));
        for (std::size_t i = 0; i < size(); ++i)
            add_to_rows(columns, touches, i, respond(i, pushes[i], touches),
                        [&](std::size_t row, const S& value) { x[row] = x[row] - value; });
        for (std::size_t row = 0; row < m; ++row) {
            const Touch<S>& at = touches[columns[row].contact];
            x[row] = x[row] - (mode_.closed[columns[row].contact].grip == Grip::sticking
                                   ? at.slip_bias[component(columns, row)]
                                   : at.bias);
        }
        for (std::size_t c = 0; c < m; ++c) {
            const ClusterContact<P>& pair = mode_.closed[columns[c].contact];
            for (const bool on_first : {true, false}) {
                const std::size_t i = on_first ? pair.first : *pair.second;
                const Push<S> push = pair_push(pair, on_first, touches[columns[c].contact].normal, columns[c].force);
                add_to_rows(columns, touches, i, respond(i, push, touches),
                            [&](std::size_t row, const S& value) { B[row * m + c] = B[row * m + c] + value; });
            }
        }
        solve_definite(B, x);
        for (std::size_t c = 0; c < m; ++c) {
            Touch<S>& at = touches[columns[c].contact];
            at.force = at.force + x[c] * columns[c].force;
        }
        for (std::size_t k = 0; k < touches.size(); ++k)
            if (const ClusterContact<P>& pair = mode_.closed[k]; pair.is_pair())
                for (const bool on_first : {true, false}) {
                    Push<S>& total = pushes[on_first ? pair.first : *pair.second];
                    const Push<S> push = pair_push(pair, on_first, touches[k].normal, touches[k].force);
                    total.force = total.force + push.force, total.torque = total.torque + push.torque;
                }
    }
    // which of the three rows of a pair that sticks this is
    template <class S>
    static std::size_t component(const std::vector<Column<S>>& columns, std::size_t row) {
        std::size_t c = 0;
        while (c < 2 && row > c && columns[row - c - 1].contact == columns[row].contact) ++c;
        return c;
    }
    // adds what the accelerations of a sphere contribute to the equations of the pairs
    template <class S, class Add>
    void add_to_rows(const std::vector<Column<S>>& columns, const std::vector<Touch<S>>& touches, std::size_t sphere,
                     const Response<S>& rates, const Add& add) const {
        for (std::size_t row = 0; row < columns.size(); ++row) {
            const ClusterContact<P>& pair = mode_.closed[columns[row].contact];
            if (!pair.has(sphere)) continue;
            const Touch<S>& at = touches[columns[row].contact];
            const Vector3<S> a = relative(pair, at, sphere, rates);
            add(row, pair.grip == Grip::sticking ? a[component(columns, row)] : dot(at.normal, a));
        }
    }
    template <class S>
    void observe(std::size_t k, const std::vector<Touch<S>>& touches, const std::vector<Response<S>>& rates,
                 S* dy) const {
        const ClusterContact<P>& contact = mode_.closed[k];
        const Touch<S>& at = touches[k];
        const Response<S>& one = rates[contact.first];
        const S N = contact.is_pair() ? dot(at.normal, at.force) : one.normal;
        const Vector3<S> T = contact.is_pair() ? Vector3<S>(at.force - N * at.normal) : one.friction;
        const int to = function(k);
        dy[to] = N;
        dy[to + 1] = dy[to + 2] = S(0);
        if (contact.grip == Grip::sticking) dy[to + 1] = (contact.friction * contact.friction) * (N * N) - dot(T, T);
        if (contact.grip == Grip::sliding) dy[to + 1] = at.speed * at.speed;
        if (contact.grip == Grip::starting) {
            Vector3<S> a = relative(contact, at, contact.first, one) + at.slip_bias;
            if (contact.is_pair()) a = a + relative(contact, at, *contact.second, rates[*contact.second]);
            dy[to + 1] = dot(a, at.heading.across) - at.along * at.heading.frame_rate;
            dy[to + 2] = dot(a, at.heading.direction);
        }
        put(dy, to + 3, Vector3<S>(N * at.normal + T));
    }
    template <class S>
    S gap_of(const ClusterContact<P>& contact, const std::vector<State<S>>& states) const {
        const Vector3<S>& p = states[contact.first].p;
        if (!contact.is_pair())
            return dot(contact.normal_W, p) - (contact.offset + spheres_[contact.first].mass.radius);
        const Vector3<S> away = p - states[*contact.second].p;
        return square_root(dot(away, away)) - contact.offset;
    }
};

}  // namespace polhode::contact
