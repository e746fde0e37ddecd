#include "check/system_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "body/orientation.h"
#include "integrators/game/gyroscopic_term.h"
#include "motion/mechanism.h"

namespace polhode {
namespace {

using Vector = Vector3<double>;
using maximal::Kind;

void append(std::vector<double>& all, const Vector& v) {
    all.insert(all.end(), v.component.begin(), v.component.end());
}

// y + h dy
std::vector<double> moved(const std::vector<double>& y, double h, const std::vector<double>& dy) {
    std::vector<double> sum(y.size());
    for (std::size_t i = 0; i < y.size(); ++i) sum[i] = y[i] + h * dy[i];
    return sum;
}

// The order in which move_along_joints() moves the bodies, parents first, and the joint of each body.
struct JointOrder {
    std::vector<std::size_t> order;  // of bodies
    std::vector<std::size_t> links;  // the joint whose child a body is; the number of links for a free body
    std::vector<std::size_t> first;  // index of the first rate of a body's joint, or of a free body

    JointOrder(const maximal::Mechanism<double>& mechanism, std::size_t bodies)
        : order(bodies), links(bodies, mechanism.links.size()), first(bodies, 0) {
        std::size_t place = 0;
        for (std::size_t k = 0; k < mechanism.links.size(); ++k) {
            const maximal::Link<double>& link = mechanism.links[k];
            if (!link.is_joint()) continue;
            const std::size_t b = static_cast<std::size_t>(link.to.body);
            links[b] = k, first[b] = place;
            place += link.kind == Kind::spherical ? 3 : static_cast<std::size_t>(link.coordinates());
        }
        std::iota(order.begin(), order.end(), std::size_t{0});
        for (const std::size_t b : order)
            if (links[b] == mechanism.links.size()) first[b] = place, place += 6;
        std::ranges::stable_sort(order, {}, [&](std::size_t b) { return mechanism.depth[b]; });
    }
};

// The motion of a joint's child after a time h at the joint's rates. `before_from` and `before`: the placements of
// parent and child at the start; `from`: the parent's motion after h.
BodyMotion<double> moved_child(const maximal::Link<double>& link, const maximal::Placement<double>& before_from,
                               const maximal::Placement<double>& before, const BodyMotion<double>& from,
                               const double* rates, double h) {
    const auto turn = [&](const Vector& by) { return quaternion_from_rotation_vector(h * by); };
    Quaternion<double> joint = conjugate(before_from.q * link.orientation) * before.q;
    Vector relative_B;  // angular velocity relative to the parent, axes of the child
    double slid = 0, rate = 0;
    switch (link.kind) {
        case Kind::revolute:
            relative_B = rates[0] * link.axes_to[0], joint = joint * turn(relative_B);
            break;
        case Kind::spherical:
            relative_B = Vector(rates[0], rates[1], rates[2]), joint = joint * turn(relative_B);
            break;
        case Kind::universal:
            joint = turn(rates[0] * link.axes_to[0]) * joint * turn(rates[1] * link.axes_to[1]);
            relative_B = rates[0] * rotate_back(joint, link.axes_to[0]) + rates[1] * link.axes_to[1];
            break;
        case Kind::prismatic:
            rate = rates[0];
            slid = maximal::LinkView<double, double>(link, before_from, before).displacement() + h * rate;
            break;
        default:
            break;
    }
    BodyMotion<double> body;
    body.q = normalized(from.q * link.orientation * joint);
    const Vector from_W = rotate(from.q, from.angular_velocity_B), axis_W = rotate(from.q, link.axis_from),
                 arm_W = rotate(from.q, link.from.arm_B) + slid * axis_W, to_W = rotate(body.q, link.to.arm_B);
    body.angular_velocity_B = rotate_back(body.q, from_W) + relative_B;
    body.position_W = from.position_W + arm_W - to_W;
    body.velocity_W =
        from.velocity_W + cross(from_W, arm_W) + rate * axis_W - cross(rotate(body.q, body.angular_velocity_B), to_W);
    return body;
}

}  // namespace

std::string_view name_of(SystemRule rule) {
    switch (rule) {
        case SystemRule::accurate:
            return "accurate steps";
        case SystemRule::joint_impulses:
            return "semi-implicit Euler of each body with impulses at the joints";
        case SystemRule::joint_impulses_implicit:
            return "semi-implicit Euler of each body with an implicit gyroscopic term and impulses at the joints";
        case SystemRule::joint_rates:
            return "semi-implicit Euler of the joint coordinates";
    }
    return "";
}

SystemEngine::SystemEngine(const SystemCause& cause)
    : scene_(std::make_shared<const Scene>(cause.scene)),
      engine_(cause.engine),
      friction_(cause.friction),
      start_(mechanism_initial_motions(*scene_)),
      system_(std::make_shared<const maximal::System<double>>(*scene_, start_)) {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    std::vector<bool> is_child(scene_->bodies.size(), false);
    const auto note_vector = [&](std::size_t count) { first_of_.insert(first_of_.end(), count, first_of_.size()); };
    for (const maximal::Link<double>& link : mechanism.links) {
        if (!link.is_joint()) continue;
        is_child[static_cast<std::size_t>(link.to.body)] = true;
        if (link.kind == Kind::spherical) note_vector(3);
        for (int i = 0; i < link.coordinates(); ++i) note_vector(1);
    }
    for (std::size_t b = 0; b < is_child.size(); ++b)
        if (!is_child[b]) note_vector(3), note_vector(3);
}

std::vector<double> SystemEngine::vector_of(const SystemState& state) const {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    std::vector<double> y(static_cast<std::size_t>(system_->dimension()), 0.0);
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
        const int place = system_->place(static_cast<int>(b));
        if (place < 0) continue;
        const BodyMotion<double>& body = state.bodies[b];
        const maximal::MaximalBody<double>& held = mechanism.bodies[b];
        put(y.data(), place, body.q);
        put(y.data(), place + 4, body.position_W);
        put(y.data(), place + 7, rotate(body.q, held.inertia * body.angular_velocity_B));
        put(y.data(), place + 10, held.mass * body.velocity_W);
    }
    std::copy(state.angles.begin(), state.angles.end(), y.begin() + system_->angles());
    return y;
}

std::vector<double> SystemEngine::velocities(const Placements& at) const {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    std::vector<double> all;
    all.reserve(first_of_.size());
    std::vector<bool> is_child(scene_->bodies.size(), false);
    for (const maximal::Link<double>& link : mechanism.links) {
        if (!link.is_joint()) continue;
        is_child[static_cast<std::size_t>(link.to.body)] = true;
        const auto &from = at[static_cast<std::size_t>(link.from.body)],
                   &to = at[static_cast<std::size_t>(link.to.body)];
        if (link.kind == Kind::spherical) {
            append(all, to.angular_velocity_B - to.body(from.world(from.angular_velocity_B)));
        } else {
            const std::array<double, 2> rates = maximal::LinkView<double, double>(link, from, to).rates();
            for (int i = 0; i < link.coordinates(); ++i) all.push_back(rates[static_cast<std::size_t>(i)]);
        }
    }
    for (std::size_t b = 0; b < is_child.size(); ++b)
        if (!is_child[b]) append(all, at[b].angular_velocity_B), append(all, at[b].velocity_W);
    return all;
}

std::vector<double> SystemEngine::velocities(const SystemState& state) const {
    return velocities(system_->placements(vector_of(state).data()));
}

std::vector<maximal::Wrench<double>> SystemEngine::forces(const maximal::Loads<double>& loads, const Placements& at,
                                                          const double* angles) const {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    std::vector<maximal::Wrench<double>> on(at.size());
    add_forces(mechanism, loads, at, angles, on);
    for (std::size_t b = 0; b + 1 < at.size(); ++b) {
        const maximal::MaximalBody<double>& body = mechanism.bodies[b];
        const Vector &w = at[b].angular_velocity_B, L = body.inertia * w;
        // I dw/dt = tau - g w x I w, where the equations below have g = 1
        on[b].torque_B = on[b].torque_B + (1 - engine_.gyroscopic) * cross(w, L) - engine_.angular_damping * L;
        on[b].force_W = on[b].force_W - (engine_.linear_damping * body.mass) * at[b].velocity_W;
    }
    for (const JointFriction& friction : friction_) {
        const maximal::Link<double>& link = mechanism.links[friction.joint];
        const auto &from = at[static_cast<std::size_t>(link.from.body)],
                   &to = at[static_cast<std::size_t>(link.to.body)];
        const maximal::LinkView<double, double> view(link, from, to);
        const double u = view.rates()[friction.axis];
        const maximal::Row<double> row = view.coordinate_rows()[friction.axis];
        const double size = u > 0 ? -friction.size : u < 0 ? friction.size : 0;
        on[static_cast<std::size_t>(link.to.body)].add_to(row, size);
        on[static_cast<std::size_t>(link.from.body)].add_from(row, size);
    }
    return on;
}

std::vector<double> SystemEngine::rate(const maximal::Loads<double>& loads, const std::vector<double>& y) const {
    const Placements at = system_->placements(y.data());
    std::vector<maximal::Wrench<double>> on = forces(loads, at, y.data() + system_->angles());
    const maximal::Rows<double> rows = system_->dynamics().constraints(at);
    system_->dynamics().add_constraint_forces(rows, system_->dynamics().multipliers(at, rows, on), on);
    std::vector<double> dy(y.size(), 0.0);
    system_->put_rates(at, on, dy.data());
    return dy;
}

// Advances the velocities by a time h under the forces, without the joints.
void SystemEngine::accelerate(Placements& at, const std::vector<maximal::Wrench<double>>& on, double h,
                              bool implicit) const {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    for (std::size_t b = 0; b + 1 < at.size(); ++b) {
        if (!mechanism.movable(static_cast<int>(b))) continue;
        const maximal::MaximalBody<double>& body = mechanism.bodies[b];
        const Vector w = at[b].angular_velocity_B;
        const Vector gyroscopic = cross(w, body.inertia * w);
        Vector torque_B = on[b].torque_B + at[b].body(on[b].torque_W) - gyroscopic;
        if (implicit) {
            // first the loads, then the gyroscopic term
            torque_B = torque_B + engine_.gyroscopic * gyroscopic;
            const BodyInertia<double> inertia{body.inertia, body.inverse_inertia};
            at[b].angular_velocity_B = inertia.apply_gyroscopic_term<GyroscopicTerm::one_newton_step>(
                w + h * (body.inverse_inertia * torque_B), engine_.gyroscopic * h);
        } else {
            at[b].angular_velocity_B = w + h * (body.inverse_inertia * torque_B);
        }
        at[b].velocity_W = at[b].velocity_W + (h / body.mass) * on[b].force_W;
    }
}

// Applies impulses so that the velocities satisfy the joints.
void SystemEngine::project(Placements& at) const {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    const maximal::Dynamics<double>& dynamics = system_->dynamics();
    const maximal::Rows<double> rows = dynamics.constraints(at);
    std::vector<maximal::Wrench<double>> given(at.size());
    dynamics.add_constraint_forces(rows, dynamics.impulses(at, rows, given), given);
    for (std::size_t b = 0; b + 1 < at.size(); ++b) {
        if (!mechanism.movable(static_cast<int>(b))) continue;
        const maximal::MaximalBody<double>& body = mechanism.bodies[b];
        at[b].angular_velocity_B =
            at[b].angular_velocity_B + body.inverse_inertia * (given[b].torque_B + at[b].body(given[b].torque_W));
        at[b].velocity_W = at[b].velocity_W + (1 / body.mass) * given[b].force_W;
    }
}

// Advances the bodies by a time h with the constant velocities of `by`.
void SystemEngine::move(std::vector<double>& y, const Placements& by, double h) const {
    SystemState next;
    for (std::size_t b = 0; b + 1 < by.size(); ++b)
        next.bodies.push_back({normalized(by[b].q * quaternion_from_rotation_vector(h * by[b].angular_velocity_B)),
                               by[b].angular_velocity_B, by[b].position_W + h * by[b].velocity_W, by[b].velocity_W});
    next.angles.assign(y.begin() + system_->angles(), y.end());
    for (const maximal::Link<double>& link : system_->mechanism().links) {
        if (link.angles < 0) continue;
        const std::array<double, 2> rates = system_->view(link, by).rates();
        for (int i = 0; i < link.coordinates(); ++i)
            next.angles[static_cast<std::size_t>(link.angles) + static_cast<std::size_t>(i)] +=
                h * rates[static_cast<std::size_t>(i)];
    }
    y = vector_of(next);
}

// Advances joints and free bodies by a time h at the rates u. Joints stay closed.
void SystemEngine::move_along_joints(std::vector<double>& y, const Placements& at, const std::vector<double>& u,
                                     double h) const {
    const maximal::Mechanism<double>& mechanism = system_->mechanism();
    SystemState next;
    next.bodies = start_;
    next.angles.assign(y.begin() + system_->angles(), y.end());
    const JointOrder places(mechanism, next.bodies.size());
    for (const std::size_t b : places.order) {
        const double* const rates = u.data() + places.first[b];
        if (places.links[b] == mechanism.links.size()) {
            BodyMotion<double>& body = next.bodies[b];
            body.angular_velocity_B = {rates[0], rates[1], rates[2]}, body.velocity_W = {rates[3], rates[4], rates[5]};
            body.q = normalized(at[b].q * quaternion_from_rotation_vector(h * body.angular_velocity_B));
            body.position_W = at[b].position_W + h * body.velocity_W;
            continue;
        }
        if (!mechanism.movable(static_cast<int>(b))) continue;
        const maximal::Link<double>& link = mechanism.links[places.links[b]];
        BodyMotion<double> world;
        world.q = {1, 0, 0, 0};
        const BodyMotion<double>& from =
            link.from.body == mechanism.world() ? world : next.bodies[static_cast<std::size_t>(link.from.body)];
        next.bodies[b] = moved_child(link, at[static_cast<std::size_t>(link.from.body)], at[b], from, rates, h);
        for (int i = 0; link.angles >= 0 && i < link.coordinates(); ++i)
            next.angles[static_cast<std::size_t>(link.angles) + static_cast<std::size_t>(i)] += h * rates[i];
    }
    y = vector_of(next);
}

std::vector<double> SystemEngine::predicted(const SystemState& state, const SystemState& next, double t, double h,
                                            SystemRule rule, int steps) const {
    std::vector<double> y = vector_of(state);
    const maximal::Loads<double> loads(system_->mechanism(), t);
    const double dt = h * engine_.time / steps;
    for (int i = 0; i < steps; ++i) {
        if (rule == SystemRule::accurate) {
            const std::vector<double> a = rate(loads, y), b = rate(loads, moved(y, dt / 2, a)),
                                      c = rate(loads, moved(y, dt / 2, b)), d = rate(loads, moved(y, dt, c));
            for (std::size_t k = 0; k < y.size(); ++k) y[k] += dt / 6 * (a[k] + 2 * (b[k] + c[k]) + d[k]);
            continue;
        }
        Placements at = system_->placements(y.data());
        if (rule != SystemRule::joint_rates) {
            accelerate(at, forces(loads, at, y.data() + system_->angles()), dt,
                       rule == SystemRule::joint_impulses_implicit);
            if (i + 1 < steps) {
                project(at);
                move(y, at, dt);
                continue;
            }
            // the difference from the file, without components that impulses at the joints could cause
            for (std::size_t b = 0; b + 1 < at.size(); ++b) {
                const BodyMotion<double>& file = next.bodies[b];
                at[b].angular_velocity_B =
                    at[b].angular_velocity_B - at[b].body(rotate(file.q, file.angular_velocity_B));
                at[b].velocity_W = at[b].velocity_W - file.velocity_W;
            }
            project(at);
            std::vector<double> sum = velocities(at);
            const std::vector<double> there = velocities(next);
            for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += there[k];
            return sum;
        }
        // u + h du/dt, where du/dt is the change of the rates along the exact motion
        const std::vector<double> dy = rate(loads, y);
        constexpr double small = 1e-4;
        std::vector<double> u = velocities(at);
        const std::vector<double> ahead = velocities(system_->placements(moved(y, small * dt, dy).data())),
                                  behind = velocities(system_->placements(moved(y, -small * dt, dy).data()));
        for (std::size_t k = 0; k < u.size(); ++k) u[k] += (ahead[k] - behind[k]) / (2 * small);
        if (i + 1 == steps) return u;
        move_along_joints(y, at, u, dt);
    }
    return velocities(system_->placements(y.data()));
}

}  // namespace polhode
