// Construction of Tree (motion/tree.h): its loops, its state at t = 0, and its loads and impulses at events.
//
// find_start() writes the initial state. close_by_dependent() moves the dependent joints by Newton's method until the
// loops close, with constraints chosen by complete pivoting. require_inertia() (tree_inertia.h) rejects a singular mass
// matrix. choose_rows() selects independent constraint rows by symmetric pivoting of G M^-1 G^T. project() then refines
// the state to the precision of P.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "motion/tree.h"
#include "text/message.h"

namespace polhode {

template <class P>
Tree<P>::Tree(const Scene& scene, const std::vector<MassProperties<P>>& properties)
    : links_(links_of(scene, properties)) {
    find_loops(scene);
    find_start(scene);
}

template <class P>
std::vector<int> Tree<P>::dependent_links() const {
    std::vector<int> all;
    for (std::size_t i = 0; i < links_.links.size(); ++i)
        if (links_.links[i].coordinates() == 1 && links_.links[i].dependent) all.push_back(static_cast<int>(i));
    return all;
}

template <class P>
void Tree<P>::restart(const std::vector<Start>& starts) {
    for (const Start& one : starts) {
        const Link<P>& link = links_.links[static_cast<std::size_t>(one.link)];
        start_[static_cast<std::size_t>(link.coordinate)] = one.coordinate;
        start_[static_cast<std::size_t>(link.rate)] = one.rate;
    }
    if (const std::vector<int> dependent = dependent_links(); !dependent.empty()) close_by_dependent(dependent);
}

template <class P>
LinkPoint<P> Tree<P>::point_of(const Scene& scene, const std::string& body, const Vector3<double>& point) const {
    const int b = body_index(scene, body);
    if (b < 0) return {world_link, cast<P>(point), b};
    const LinkBody<P>& there = links_.bodies[static_cast<std::size_t>(b)];
    return {there.link, there.origin + there.turn * cast<P>(point), b};
}

template <class P>
void Tree<P>::find_loops(const Scene& scene) {
    for (std::size_t l = 0; l < scene.loops.size(); ++l) {
        const Loop& loop = scene.loops[l];
        LinkLoop<P> own;
        own.type = loop.type;
        own.first = point_of(scene, loop.first, loop.first_point);
        own.second = point_of(scene, loop.second, loop.second_point);
        own.length = P(loop.length);
        if (loop.type == LoopType::revolute) {
            const auto turn = [&](const std::string& body) {
                const int b = body_index(scene, body);
                return b < 0 ? diagonal(Vector3<P>(P(1), P(1), P(1))) : links_.bodies[static_cast<std::size_t>(b)].turn;
            };
            // the vectors perpendicular to the first axis are x and y rotated together with z onto that axis
            const Matrix3<P> along = turn(loop.first) * rotation_matrix(from_z<P>(loop.first_axis));
            for (std::size_t k = 0; k < 2; ++k) own.across[k] = {along[0][k], along[1][k], along[2][k]};
            const Matrix3<P> second = turn(loop.second) * rotation_matrix(from_z<P>(loop.second_axis));
            own.second_axis = {second[0][2], second[1][2], second[2][2]};
        }
        loop_of_row_.insert(loop_of_row_.end(), static_cast<std::size_t>(own.rows()), static_cast<int>(l));
        loops_.push_back(std::move(own));
    }
    for (const Coupling& coupling : scene.couplings) {
        LinkLoop<P> own;
        own.couples = true, own.ratio = P(coupling.ratio), own.offset = P(coupling.offset);
        const auto link = [&](const std::string& joint) {
            return links_.link_of_joint[static_cast<std::size_t>(joint_index(scene, joint))];
        };
        own.first.link = link(coupling.first), own.second.link = link(coupling.second);
        loop_of_row_.push_back(static_cast<int>(loops_.size()));
        loops_.push_back(std::move(own));
    }
    all_rows_ = loop_of_row_.size();
}

template <class P>
void Tree<P>::find_start(const Scene& scene) {
    start_.assign(static_cast<std::size_t>(dimension()), P(0));
    const std::vector<int> dependent = dependent_links();
    for (std::size_t i = 0; i < links_.links.size(); ++i) {
        const Link<P>& link = links_.links[i];
        P *const x = start_.data() + link.coordinate, *const rate = start_.data() + link.rate;
        if (link.coordinates() == 1) {
            x[0] = link.start, rate[0] = link.start_rate;
            continue;
        }
        x[0] = link.start_q.w, x[1] = link.start_q.x, x[2] = link.start_q.y, x[3] = link.start_q.z;
        for (std::size_t k = 0; k < 3; ++k) {
            rate[k] = link.start_w[k];
            if (link.kind == LinkJoint::free) x[4 + k] = link.start_position[k], rate[3 + k] = link.start_velocity[k];
        }
    }
    if (loops_.empty()) return require_inertia(scene);
    if (!dependent.empty()) close_by_dependent(dependent);
    const double off = static_cast<double>(loop_gap(start_.data()));
    constexpr double closed = 1e-9;
    if (!(off <= closed)) {
        // the worst row identifies the loop
        const TreeWork<P>& at = work<P>();
        std::size_t worst = 0;
        const auto size = [&](std::size_t row) {
            return std::max(Elementary<P>::magnitude(at.rows[row].value),
                            Elementary<P>::magnitude(at.rows[row].velocity));
        };
        for (std::size_t row = 1; row < all_rows_; ++row)
            if (size(row) > size(worst)) worst = row;
        const std::size_t open = static_cast<std::size_t>(loop_of_row_[worst]), loops = scene.loops.size();
        throw InputError(
            scene.name, open < loops ? fmt::format("/loops/{}", open) : fmt::format("/couplings/{}", open - loops),
            fmt::format("is open by {:.3g} at the start (m, rad, m/s or rad/s)", off),
            dependent.empty() ? "mark joints as \"dependent\": true, or give a start that closes the loop to 1e-9"
                              : "start the dependent joints closer to a closed position");
    }
    require_inertia(scene);
    choose_rows();
    // refine to the last digit of P
    project(start_.data());
}

/// Index of the largest remaining entry of a matrix, among rows and columns not yet taken.
template <class P>
std::pair<std::size_t, std::size_t> largest_left(const std::vector<P>& matrix, std::size_t columns,
                                                 const std::vector<char>& row_taken,
                                                 const std::vector<char>& column_taken) {
    std::pair<std::size_t, std::size_t> best{0, 0};
    P largest(-1);
    for (std::size_t r = 0; r < row_taken.size(); ++r)
        for (std::size_t c = 0; c < columns; ++c) {
            if (row_taken[r] || column_taken[c]) continue;
            const P size = Elementary<P>::magnitude(matrix[r * columns + c]);
            if (size > largest) largest = size, best = {r, c};
        }
    return best;
}

template <class P>
void Tree<P>::close_by_dependent(const std::vector<int>& dependent) {
    constexpr int most_steps = 60;
    const std::size_t m = dependent.size();
    std::vector<P> y = start_;
    TreeWork<P>& at = work<P>();
    // d g / d x of the dependent joints: the rates of the constraints when only one joint moves
    const auto slopes = [&] {
        std::vector<P> matrix(all_rows_ * m), moving = y;
        for (std::size_t c = 0; c < m; ++c) {
            std::fill(moving.begin() + links_.coordinates, moving.end(), P(0));
            moving[static_cast<std::size_t>(links_.links[static_cast<std::size_t>(dependent[c])].rate)] = P(1);
            move(moving.data(), at), compute_frames(moving.data(), at), find_rows(at);
            for (std::size_t r = 0; r < all_rows_; ++r) matrix[r * m + c] = at.rows[r].velocity;
        }
        return matrix;
    };
    // solves the m or fewer constraints that determine the joints, by elimination with complete pivoting
    const auto solved = [&](std::vector<P> matrix, std::vector<P> right) {
        std::vector<char> row_taken(all_rows_, 0), column_taken(m, 0);
        std::vector<std::pair<std::size_t, std::size_t>> pivots;
        P first(0);
        for (std::size_t k = 0; k < std::min(m, all_rows_); ++k) {
            const auto [r, c] = largest_left(matrix, m, row_taken, column_taken);
            const P pivot = matrix[r * m + c];
            if (k == 0) first = Elementary<P>::magnitude(pivot);
            if (!(Elementary<P>::magnitude(pivot) > P(1e-9) * first)) break;
            row_taken[r] = 1, column_taken[c] = 1;
            pivots.push_back({r, c});
            for (std::size_t i = 0; i < all_rows_; ++i) {
                if (row_taken[i]) continue;
                const P factor = matrix[i * m + c] / pivot;
                for (std::size_t j = 0; j < m; ++j) matrix[i * m + j] = matrix[i * m + j] - factor * matrix[r * m + j];
                right[i] = right[i] - factor * right[r];
            }
        }
        std::vector<P> x(m, P(0));
        for (std::size_t k = pivots.size(); k-- > 0;) {
            const auto [r, c] = pivots[k];
            P sum = right[r];
            for (std::size_t j = k + 1; j < pivots.size(); ++j) {
                const std::size_t other = pivots[j].second;
                sum = sum - matrix[r * m + other] * x[other];
            }
            x[c] = sum / matrix[r * m + c];
        }
        return x;
    };
    P before(-1);
    for (int step = 0; step < most_steps; ++step) {
        move(y.data(), at), compute_frames(y.data(), at), find_rows(at);
        std::vector<P> right(all_rows_);
        P worst(0);
        for (std::size_t r = 0; r < all_rows_; ++r) {
            right[r] = -at.rows[r].value;
            worst = std::max(worst, P(Elementary<P>::magnitude(at.rows[r].value)));
        }
        if (!(worst > P(0)) || (worst < P(1e-12) && before >= P(0) && !(worst + worst < before))) break;
        before = worst;
        const std::vector<P> change = solved(slopes(), std::move(right));
        for (std::size_t c = 0; c < m; ++c) {
            P& x = y[static_cast<std::size_t>(links_.links[static_cast<std::size_t>(dependent[c])].coordinate)];
            x = x + change[c];
        }
    }
    for (const int link : dependent)
        y[static_cast<std::size_t>(links_.links[static_cast<std::size_t>(link)].rate)] = P(0);
    move(y.data(), at), compute_frames(y.data(), at), find_rows(at);
    std::vector<P> right(all_rows_);
    for (std::size_t r = 0; r < all_rows_; ++r) right[r] = -at.rows[r].velocity;
    const std::vector<P> rates = solved(slopes(), std::move(right));
    for (std::size_t c = 0; c < m; ++c)
        y[static_cast<std::size_t>(links_.links[static_cast<std::size_t>(dependent[c])].rate)] = rates[c];
    start_ = std::move(y);
}

template <class P>
void Tree<P>::choose_rows() {
    // start with all rows; symmetric elimination keeps those with nonvanishing pivots
    chosen_.clear();
    for (std::size_t r = 0; r < all_rows_; ++r) chosen_.push_back(static_cast<int>(r));
    TreeWork<P>& at = work<P>();
    const std::size_t n = links_.links.size(), rates = static_cast<std::size_t>(links_.rates);
    move(start_.data(), at), compute_frames(start_.data(), at);
    for (LinkWork<P>& link : at.links) link.force = {};
    articulate(at), find_rows(at);
    std::vector<P> matrix(all_rows_ * all_rows_), response_rates(rates);
    std::vector<Pair6<P>> response(n);
    for (std::size_t r = 0; r < all_rows_; ++r) {
        start_response(r, at);
        respond(at, response.data(), response_rates.data(), static_cast<P*>(nullptr));
        for (std::size_t c = 0; c < all_rows_; ++c)
            matrix[r * all_rows_ + c] = applied(c, at, response.data(), response_rates.data());
    }
    // scale each constraint by its own size; a constraint that is nonzero only by rounding, as perpendicular to a
    // plane, is dropped
    std::vector<P> size(all_rows_);
    P most(0);
    for (std::size_t r = 0; r < all_rows_; ++r) {
        size[r] = matrix[r * all_rows_ + r];
        if (size[r] > most) most = size[r];
    }
    std::vector<char> taken(all_rows_, 0);
    std::vector<int> independent;
    for (;;) {
        std::size_t best = all_rows_;
        P largest(1e-8);
        for (std::size_t r = 0; r < all_rows_; ++r) {
            if (taken[r] || !(size[r] > P(1e-20) * most)) continue;
            // ties go to the first row
            const P left = matrix[r * all_rows_ + r] / size[r];
            if (left > largest + P(1e-6)) largest = left, best = r;
        }
        if (best == all_rows_) break;
        taken[best] = 1;
        independent.push_back(static_cast<int>(best));
        for (std::size_t r = 0; r < all_rows_; ++r) {
            if (taken[r]) continue;
            const P factor = matrix[r * all_rows_ + best] / matrix[best * all_rows_ + best];
            for (std::size_t c = 0; c < all_rows_; ++c)
                matrix[r * all_rows_ + c] = matrix[r * all_rows_ + c] - factor * matrix[best * all_rows_ + c];
        }
    }
    std::sort(independent.begin(), independent.end());
    chosen_ = std::move(independent);
}

template <class P>
LinkLoads<P> Tree<P>::loads_at(const Scene& scene, double begin) const {
    LinkLoads<P> loads;
    loads.motors.assign(links_.links.size(), P(0));
    bool motors = false;
    int b = -1;  // index of the body on which the load acts
    const auto body = [&](const std::string& name) -> const LinkBody<P>& {
        b = body_index(scene, name);
        return links_.bodies[static_cast<std::size_t>(b)];
    };
    for (const Load& load : scene.loads) {
        if (std::holds_alternative<Impulse>(load) || !acts(window_of(load), begin)) continue;
        if (const auto* gravity = std::get_if<Gravity>(&load)) {
            loads.gravity_W = loads.gravity_W + cast<P>(gravity->acceleration_W);
        } else if (const auto* motor = std::get_if<Motor>(&load)) {
            const int link = links_.link_of_joint[static_cast<std::size_t>(joint_index(scene, motor->joint))];
            P& sum = loads.motors[static_cast<std::size_t>(link)];
            sum = sum + P(motor->force), motors = true;
        } else if (const auto* torque = std::get_if<Torque>(&load)) {
            const LinkBody<P>& on = body(torque->body);
            const Vector3<P> v = cast<P>(torque->vector);
            if (torque->frame == Frame::body)
                loads.constant.push_back({on.link, b, {on.turn * v, {}}});
            else
                loads.in_world.push_back({on.link, b, v, {}, {}});
        } else if (const auto* force = std::get_if<Force>(&load)) {
            const LinkBody<P>& on = body(force->body);
            const Vector3<P> F = cast<P>(force->vector), point = cast<P>(force->point);
            const bool in_body = force->frame == Frame::body;
            const Vector3<P> F_link = in_body ? on.turn * F : F;
            if (force->point_frame == Frame::world) {
                loads.at_world_points.push_back({on.link, b, F_link, point, in_body});
                continue;
            }
            const Vector3<P> at = on.origin + on.turn * point;
            if (in_body)
                loads.constant.push_back({on.link, b, {cross(at, F_link), F_link}});
            else
                loads.in_world.push_back({on.link, b, {}, F, at});
        } else if (const auto* drag = std::get_if<Drag>(&load)) {
            const LinkBody<P>& on = body(drag->body);
            const Matrix3<P> C = on.turn * diagonal(cast<P>(drag->rotational)) * transposed(on.turn);
            loads.drags.push_back({on.link, b, C, P(drag->translational), on.center});
        } else if (const auto* spring = std::get_if<Spring>(&load)) {
            const LinkBody<P>& on = body(spring->body);
            if (spring->stiffness == 0) continue;
            const Quaternion<P> rest = normalized(cast<P>(spring->rest_orientation));
            loads.springs.push_back({on.link, b, P(spring->stiffness), on.q, rest});
        } else if (const auto* between = std::get_if<PointSpring>(&load)) {
            loads.between.push_back({point_of(scene, between->first, between->first_point),
                                     point_of(scene, between->second, between->second_point), P(between->stiffness),
                                     P(between->rest_length)});
        }
    }
    if (!motors) loads.motors.clear();
    return loads;
}

template <class P>
bool Tree<P>::apply_impulses(const Scene& scene, double time, P* y) const {
    const auto acts_now = [&](const Load& load) {
        const auto* impulse = std::get_if<Impulse>(&load);
        return impulse && impulse->at == time;
    };
    if (std::none_of(scene.loads.begin(), scene.loads.end(), acts_now)) return false;
    TreeWork<P>& at = work<P>();
    const std::size_t n = links_.links.size(), rates = static_cast<std::size_t>(links_.rates);
    move(y, at), compute_frames(y, at);
    for (LinkWork<P>& link : at.links) link.force = {};
    articulate(at);
    std::vector<Pair6<P>> sum(n);
    for (const Load& load : scene.loads) {
        if (!acts_now(load)) continue;
        const auto* impulse = std::get_if<Impulse>(&load);
        const LinkBody<P>& on = links_.bodies[static_cast<std::size_t>(body_index(scene, impulse->body))];
        if (on.link < 0) continue;
        const std::size_t i = static_cast<std::size_t>(on.link);
        const LinkFrame<P>& frame = at.frames[i];
        const Vector3<P> J = cast<P>(impulse->vector), point = cast<P>(impulse->point);
        const Vector3<P> J_link = impulse->frame == Frame::body ? on.turn * J : transposed_times(frame.R, J);
        const Vector3<P> arm = impulse->point_frame == Frame::body
                                   ? Vector3<P>(on.origin + on.turn * point)
                                   : transposed_times(frame.R, Vector3<P>(point - frame.x));
        sum[i].turning = sum[i].turning + cross(arm, J_link), sum[i].linear = sum[i].linear + J_link;
    }
    std::vector<P> jump(rates);
    std::vector<Pair6<P>> jumps(n);
    std::copy(sum.begin(), sum.end(), at.wrench.begin());
    respond(at, jumps.data(), jump.data(), static_cast<P*>(nullptr));
    hold_rows(at, jumps.data(), jump.data());
    for (std::size_t k = 0; k < rates; ++k) {
        P& rate = y[static_cast<std::size_t>(links_.coordinates) + k];
        rate = rate + jump[k];
    }
    return true;
}

}  // namespace polhode
