#include "motion/joint_motion.h"

#include <cmath>

#include "motion/mechanism_motion_of.h"
#include "text/decimal.h"

namespace polhode {
namespace {

template <class P>
Vector3<P> unit_vector(const Vector3<double>& v) {
    const Vector3<P> w = cast<P>(v);
    const P size = length(w);
    return size > P(0) ? Vector3<P>(w[0] / size, w[1] / size, w[2] / size) : w;
}

// The angles and rates of a universal joint: J = exp(a x) exp(b y), a and b unit vectors, w in the child's axes.
template <class P>
void set_universal(JointMotion<P>& motion, const Quaternion<P>& J, const Vector3<P>& w, const Vector3<P>& a,
                   const Vector3<P>& b) {
    // exp(b y) leaves b fixed: x is the angle about a from b to J b
    const P between = dot(a, b);
    const Vector3<P> u = b - between * a, Jb = rotate(J, b);
    const P sine = dot(a, cross(u, Jb)), cosine = dot(u, Jb);
    // the quaternion about a with half of that angle, without cancellation
    const P size = square_root(P(sine * sine + cosine * cosine));
    const P sign = sine >= P(0) ? P(1) : P(-1);
    const P along = cosine >= P(0) ? P(size + cosine) : P(sign * sine);
    const P about = cosine >= P(0) ? sine : P(sign * (size - cosine));
    const Quaternion<P> first = normalized(Quaternion<P>{along, about * a[0], about * a[1], about * a[2]});
    const Quaternion<P> second = conjugate(first) * J;
    motion.coordinate = {turn_about(first, a), turn_about(second, b)};
    // w = a_child x' + b y'
    const Vector3<P> a_child = rotate_back(second, a);
    const P determinant = P(1) - between * between, wa = dot(w, a_child), wb = dot(w, b);
    motion.rate = {(wa - between * wb) / determinant, (wb - between * wa) / determinant};
}

}  // namespace

template <class P>
std::vector<P> JointMotion<P>::coordinates() const {
    switch (type) {
        case JointType::revolute:
        case JointType::prismatic:
            return {coordinate[0]};
        case JointType::universal:
            return {coordinate[0], coordinate[1]};
        case JointType::spherical:
            return {orientation.w, orientation.x, orientation.y, orientation.z};
        case JointType::fixed:
            break;
    }
    return {};
}

template <class P>
std::vector<P> JointMotion<P>::rates() const {
    if (type != JointType::spherical) {
        const std::size_t count = coordinates().size();
        return {rate.begin(), rate.begin() + static_cast<std::ptrdiff_t>(count)};
    }
    // dJ/dt = J (0, w) / 2
    const Vector3<P>& w = angular_velocity;
    const Quaternion<P> change = orientation * Quaternion<P>{P(0), w[0] / P(2), w[1] / P(2), w[2] / P(2)};
    return {change.w, change.x, change.y, change.z};
}

template <class P>
JointKinematics<P>::JointKinematics(const Scene& scene) {
    const std::vector<MassProperties<P>> bodies = bodies_mass_properties<P>(scene);
    const auto point = [&](int body, const Vector3<double>& from_origin) {
        const Vector3<P> p = cast<P>(from_origin);
        return body < 0 ? p : p - bodies[static_cast<std::size_t>(body)].center;
    };
    for (const Joint& joint : scene.joints) {
        Link link;
        link.type = joint.type;
        link.parent = body_index(scene, joint.parent), link.child = body_index(scene, joint.child);
        link.parent_point = point(link.parent, joint.parent_point);
        link.child_point = point(link.child, joint.child_point);
        link.q0 = normalized(cast<P>(joint.parent_orientation));
        link.axes = {unit_vector<P>(joint.axes[0]), unit_vector<P>(joint.axes[1])};
        link.start = normalized(cast<P>(joint.orientation));
        links_.push_back(std::move(link));
    }
}

template <class P>
JointMotion<P> JointKinematics<P>::motion_of(const Link& link, std::span<const BodyMotion<P>> motions) const {
    BodyMotion<P> parent;
    parent.q = Quaternion<P>{P(1), P(0), P(0), P(0)};
    if (link.parent >= 0) parent = motions[static_cast<std::size_t>(link.parent)];
    const BodyMotion<P>& child = motions[static_cast<std::size_t>(link.child)];
    JointMotion<P> motion;
    motion.type = link.type;
    const Quaternion<P> J = conjugate(link.q0) * (conjugate(parent.q) * child.q);
    const Vector3<P> parent_rate_W = rotate(parent.q, parent.angular_velocity_B);
    // angular velocity of the child relative to the parent, in the child's axes
    const Vector3<P> w = child.angular_velocity_B - rotate_back(child.q, parent_rate_W);
    switch (link.type) {
        case JointType::revolute:
            motion.coordinate[0] = turn_about(J, link.axes[0]), motion.rate[0] = dot(w, link.axes[0]);
            break;
        case JointType::prismatic: {
            const Vector3<P> along = rotate(parent.q * link.q0, link.axes[0]);
            const auto speed = [](const BodyMotion<P>& m, const Vector3<P>& arm) {
                return m.velocity_W + rotate(m.q, cross(m.angular_velocity_B, arm));
            };
            const Vector3<P> apart = (child.position_W + rotate(child.q, link.child_point)) -
                                     (parent.position_W + rotate(parent.q, link.parent_point));
            const Vector3<P> change = speed(child, link.child_point) - speed(parent, link.parent_point);
            // x = along . apart, and `along` rotates with the parent
            motion.coordinate[0] = dot(along, apart);
            motion.rate[0] = dot(along, change - cross(parent_rate_W, apart));
            break;
        }
        case JointType::universal:
            set_universal(motion, J, w, link.axes[0], link.axes[1]);
            break;
        case JointType::spherical:
            motion.orientation = normalized(J), motion.angular_velocity = w;
            break;
        case JointType::fixed:
            break;
    }
    return motion;
}

template <class P>
std::vector<JointMotion<P>> JointKinematics<P>::at(double t, std::span<const BodyMotion<P>> motions,
                                                   JointCoordinates& tracked,
                                                   std::span<const JointMotion<P>> previous) const {
    std::vector<JointMotion<P>> all;
    all.reserve(links_.size());
    for (std::size_t j = 0; j < links_.size(); ++j) {
        JointMotion<P>& motion = all.emplace_back(motion_of(links_[j], motions));
        const bool angles = motion.type == JointType::revolute || motion.type == JointType::universal;
        for (std::size_t i = 0; i < (angles ? motion.coordinates().size() : 0); ++i) {
            P& x = motion.coordinate[i];
            const double rate = static_cast<double>(motion.rate[i]);
            x = x + P(tracked.turns(j, i, t, static_cast<double>(x), rate)) * P(2) * Elementary<P>::pi();
            tracked.keep(j, i, t, static_cast<double>(x), rate);
        }
        if (motion.type != JointType::spherical) continue;
        const Quaternion<P>&q = motion.orientation,
              &near = previous.empty() ? links_[j].start : previous[j].orientation;
        if (q.w * near.w + q.x * near.x + q.y * near.y + q.z * near.z < P(0))
            motion.orientation = {-q.w, -q.x, -q.y, -q.z};
    }
    return all;
}

std::string joints_csv(std::span<const double> times, std::span<const JointMotion<double>> motions,
                       std::span<const std::string> names) {
    std::string text = "t,joint,coordinate,rate\n";
    for (std::size_t k = 0; k < motions.size(); ++k) {
        const std::string start = shortest_decimal(times[k / names.size()]) + "," + names[k % names.size()] + ",";
        const std::vector<double> coordinates = motions[k].coordinates(), rates = motions[k].rates();
        for (std::size_t i = 0; i < coordinates.size(); ++i)
            text.append(start)
                .append(shortest_decimal(coordinates[i]))
                .append(",")
                .append(shortest_decimal(rates[i])) += '\n';
    }
    return text;
}

template struct JointMotion<double>;
template struct JointMotion<Wide>;
template class JointKinematics<double>;
template class JointKinematics<Wide>;

}  // namespace polhode
