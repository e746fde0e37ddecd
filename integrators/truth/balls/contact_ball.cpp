// Proof for a sphere with equal moments on planes, under constant gravity: closed forms in ball arithmetic.
//
// SphereCertifier follows the ball from event to event. In flight, in sliding with a constant direction and in rolling
// the centre has a constant acceleration and the angular velocity (world axes) a constant rate alpha:
//   flight      a = g,                          alpha = 0
//   sliding     a = g_t - mu |g_n| d,           alpha = (r m mu |g_n| / I) n x d          d: direction of the slip
//   rolling     a = g_t m r^2 / (I + m r^2),    alpha = n x a / r
// Times of events are roots of quadratic or linear equations, and enclosed like all other numbers. The order of events,
// signs and modes are decided only where the balls prove them; otherwise the attempt fails and asks for more bits. The
// attitude solves dq/dt = (0, w_0 + alpha t) q / 2, a linear equation, by its Taylor series with a bound of the rest.
//
// An impact has the closed form of spheres (integrators/contact/sphere_impact.h). Infinitely many impacts are followed
// until the normal speed is below the precision. The time left is the sum of a geometric series, and the change of all
// other quantities in it is bounded. The slip at the limit is zero if all of the last impacts stick.
#include <algorithm>
#include <cmath>
#include <optional>

#include "integrators/truth/allowance.h"
#include "integrators/truth/balls/certify.h"
#include "motion/exact_body_of.h"
#include "scene/body_hull.h"

namespace polhode::truth {
namespace {

using Vector = Vector3<Ball>;

// |v|; [-b, b] with an upper bound b if the balls do not prove that it is positive
Ball length_of(const Vector& v) {
    const Ball square = dot(v, v);
    if (square.is_positive() || square.is_zero()) return sqrt(square);
    return widened(Ball(0), root(Bound(square)));
}
bool is_exact_zero(const Vector& v) { return v[0].is_zero() && v[1].is_zero() && v[2].is_zero(); }
bool may_be_zero(const Vector& v) { return v[0].contains_zero() && v[1].contains_zero() && v[2].contains_zero(); }
Vector widened(const Vector& v, const Bound& radius) {
    return {widened(v[0], radius), widened(v[1], radius), widened(v[2], radius)};
}
// 2^exponent as a bound
Bound power_of_two(double exponent) { return Bound(std::exp2(exponent)); }

// q after the time t of dq/dt = (0, w + alpha t) q / 2, over a time in which |w| t / 2 + |alpha| t^2 / 2 <= 1. The
// coefficients are bounded by d_(k+1) = (|w| t d_k + |alpha| t^2 d_(k-1)) / (2 (k + 1)), whose sum from k + 1 on is at
// most 4 max(d_k, d_(k-1)) / (k + 1).
Quaternion<Ball> rotate_in_short_time(const Quaternion<Ball>& q, const Vector& w, const Vector& alpha, const Ball& t) {
    const Vector first = (t / Ball(2)) * w, second = (t * t / Ball(2)) * alpha;
    const Bound a(length_of(first)), b(length_of(second));
    Quaternion<Ball> sum = q, last = q, former{Ball(0), Ball(0), Ball(0), Ball(0)};
    Bound d(1.0), d_former;
    const Bound small = power_of_two(-static_cast<double>(Ball::precision()) - 8);
    const auto as_quaternion = [](const Vector& v) { return Quaternion<Ball>{Ball(0), v[0], v[1], v[2]}; };
    Bound rest(1.0);
    for (int k = 0; k < 2000 && small < rest; ++k) {
        const Ball per = Ball(1) / Ball(k + 1);
        const Quaternion<Ball> by_w = as_quaternion(first) * last, by_alpha = as_quaternion(second) * former;
        former = last;
        last = {per * (by_w.w + by_alpha.w), per * (by_w.x + by_alpha.x), per * (by_w.y + by_alpha.y),
                per * (by_w.z + by_alpha.z)};
        sum = {sum.w + last.w, sum.x + last.x, sum.y + last.y, sum.z + last.z};
        const Bound next = (a * d + b * d_former) / Bound(static_cast<double>(k + 1));
        d_former = d, d = next;
        rest = Bound(4.0) * (d < d_former ? d_former : d) / Bound(static_cast<double>(k + 2));
    }
    return {widened(sum.w, rest), widened(sum.x, rest), widened(sum.y, rest), widened(sum.z, rest)};
}

// q after the time t
Quaternion<Ball> rotate_by(const Quaternion<Ball>& q, const Vector& w, const Vector& alpha, const Ball& t) {
    const double end = t.near(), speed = length_of(w).near(), growth = length_of(alpha).near();
    const double angle = std::abs(end) * (speed + growth * std::abs(end));
    // half of it per step at most, with a margin for what the balls add
    const auto steps = static_cast<long>(std::ceil(angle)) + 1;
    const Ball h = t / Ball(steps);
    Quaternion<Ball> turned = q;
    for (long i = 0; i < steps; ++i) turned = rotate_in_short_time(turned, w + (Ball(i) * h) * alpha, alpha, h);
    return turned;
}

}  // namespace

std::string SphereCertifier::refusal(const Scene& scene) {
    for (const Load& load : scene.loads) {
        const auto* gravity = std::get_if<Gravity>(&load);
        if (!gravity) return "contact is certified under gravity alone";
        if (gravity->window.from > 0 || gravity->window.until < scene.duration)
            return "contact is certified under constant gravity";
    }
    for (const Plane& plane : scene.planes)
        if (plane.torsional_friction > 0 || plane.rolling_friction > 0)
            return "torsional and rolling friction are not supported";
    const auto* shaped = scene.body.source ? std::get_if<ShapedBody>(&scene.body.source->definition) : nullptr;
    const bool is_sphere = shaped && (std::holds_alternative<SolidSphere>(shaped->shape) ||
                                      std::holds_alternative<HollowSphere>(shaped->shape));
    if (!is_sphere || scene.pivot)
        return "contact is certified for free uniform spheres, whose motion has closed forms";
    return "";
}

SphereCertifier::SphereCertifier(const Scene& scene, const std::vector<double>& times) : scene_(scene), times_(times) {}

CertifiedAttempt SphereCertifier::attempt() {
    result_ = {}, next_sample_ = 0;
    result_.by_closed_form = true;
    start();
    while (result_.fault.empty() && next_sample_ < times_.size()) {
        if (Allowance::is_spent()) {
            result_.fault = Allowance::fault;
            break;
        }
        follow_piece();
    }
    return std::move(result_);
}

void SphereCertifier::ask_for_bits(const char* why) {
    if (!result_.fault.empty()) return;
    const auto bits = static_cast<double>(Ball::precision());
    result_.fault = why;
    result_.wanted_bits = 2 * bits;
    // numbers that are equal are not separated by any precision
    result_.hopeless = bits > 700;
}
void SphereCertifier::end_hopelessly(const char* why) {
    if (!result_.fault.empty()) return;
    result_.fault = why, result_.hopeless = true;
}

void SphereCertifier::start() {
    const ExactBody<Ball> body = exact_body<Ball>(scene_);
    mass_ = body.mass, moment_ = body.inertia_B[2][2];
    radius_ = hull<Ball>(*scene_.body.source).front().radius;
    planes_.clear();
    for (const Plane& plane : scene_.planes) {
        const Vector normal = cast<Ball>(plane.normal_W);
        const Ball length = length_of(normal);
        planes_.push_back(
            {(Ball(1) / length) * normal, Ball(plane.offset) / length, Ball(plane.restitution), Ball(plane.friction)});
    }
    gravity_ = Vector();
    for (const Load& load : scene_.loads) gravity_ = gravity_ + cast<Ball>(std::get<Gravity>(load).acceleration_W);
    t_ = Ball(0), x_ = body.position_W, v_ = body.velocity_W, q_ = body.q;
    w_ = rotate(body.q, body.angular_velocity_B);
    mode_ = Mode::flight, plane_.reset(), touched_.reset(), sticks_ = false;
    // a start that touches to 1e-12 of the size touches exactly
    const Ball least = Ball(1e-12) * radius_;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
        const Ball distance = gap(k);
        if (distance > least) continue;
        if (distance < -least) return end_hopelessly("the ball starts in a plane");
        if (plane_) return end_hopelessly("the ball touches two planes at once");
        plane_ = k;
    }
    if (!plane_) return;
    place_on(*plane_);
    const Ball u = dot(planes_[*plane_].normal_W, v_);
    if (u.is_positive()) {
        leave(*plane_, u, v_ - u * planes_[*plane_].normal_W);
        return;
    }
    if (u.is_negative()) return collide(*plane_, u, v_ - u * planes_[*plane_].normal_W, slip(*plane_));
    if (!u.is_zero()) return ask_for_bits("the precision does not resolve whether the ball approaches the plane");
    stay_on(*plane_, false);
}

Ball SphereCertifier::gap(std::size_t k) const { return dot(planes_[k].normal_W, x_) - planes_[k].offset - radius_; }
void SphereCertifier::place_on(std::size_t k) { x_ = x_ - gap(k) * planes_[k].normal_W; }
SphereCertifier::Vector SphereCertifier::slip(std::size_t k) const {
    const Vector& n = planes_[k].normal_W;
    return v_ - dot(n, v_) * n + radius_ * cross(n, w_);
}

// The first time (s from now) at which the gap of a plane closes under the acceleration a; empty if it does not.
std::optional<Ball> SphereCertifier::closing_time(std::size_t k, const Vector& a) {
    const Vector& n = planes_[k].normal_W;
    const Ball u = dot(n, v_), acceleration = dot(n, a);
    if (touched_ == k) {
        // the ball has just left the plane with u > 0
        if (acceleration.is_negative()) return -(Ball(2) * leaves_) / acceleration;
        if (acceleration.is_zero() || acceleration.is_positive()) return {};
        ask_for_bits("the precision does not resolve the direction of gravity to a plane");
        return {};
    }
    const Ball distance = gap(k), square = u * u - Ball(2) * acceleration * distance;
    const bool away = !u.is_negative() && !u.contains_zero();
    if ((away || u.is_zero()) && (acceleration.is_zero() || acceleration.is_positive())) return {};
    if (acceleration.is_positive() && square.is_negative()) return {};
    if (!distance.is_positive() || !square.is_positive()) {
        ask_for_bits("the precision does not resolve whether a plane is reached");
        return {};
    }
    if (away) return (u + sqrt(square)) / -acceleration;
    return Ball(2) * distance / (sqrt(square) - u);
}

// The plane that is reached first, not counting the one in contact.
std::optional<SphereCertifier::Arrival> SphereCertifier::first_arrival(const Vector& a) {
    std::optional<Arrival> first;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
        if (mode_ != Mode::flight && plane_ == k) continue;
        const std::optional<Ball> time = closing_time(k, a);
        if (!time) continue;
        if (!first || *time < first->time)
            first = Arrival{k, *time};
        else if (!(*time > first->time))
            ask_for_bits("two planes are reached at once, or the precision does not resolve which is first");
    }
    return first;
}

// Whether the sample is before the time `end` (s from now); nothing if this is not proven.
std::optional<bool> SphereCertifier::is_before(double sample, const Ball& end) {
    const Ball time = Ball(sample) - t_;
    if (time < end) return true;
    if (time >= end) return false;
    ask_for_bits("a sample cannot be separated from an event");
    return {};
}

void SphereCertifier::add_sample(double sample, const Path& path) {
    const Ball h = Ball(sample) - t_;
    const Quaternion<Ball> q = rotate_by(q_, w_, path.alpha, h);
    const Vector w = w_ + h * path.alpha, x = x_ + (h * v_ + (h * h / Ball(2)) * path.a), v = v_ + h * path.a;
    result_.columns.push_back({q.w, q.x, q.y, q.z, w[0], w[1], w[2], x[0], x[1], x[2], v[0], v[1], v[2]});
    ++next_sample_;
}

// Moves to the time `end` (s from now).
void SphereCertifier::move(const Ball& end, const Path& path) {
    q_ = rotate_by(q_, w_, path.alpha, end);
    x_ = x_ + (end * v_ + (end * end / Ball(2)) * path.a);
    v_ = v_ + end * path.a, w_ = w_ + end * path.alpha, t_ = t_ + end;
    ++result_.steps;
}

SphereCertifier::Path SphereCertifier::path() const {
    if (mode_ == Mode::flight) return {gravity_, Vector()};
    const ContactPlane<Ball>& plane = planes_[*plane_];
    const Vector tangential = gravity_ - dot(plane.normal_W, gravity_) * plane.normal_W;
    if (mode_ == Mode::rolling) {
        const Ball square = mass_ * radius_ * radius_;
        const Vector a = (square / (moment_ + square)) * tangential;
        return {a, (Ball(1) / radius_) * cross(plane.normal_W, a)};
    }
    const Ball f = plane.friction * -dot(plane.normal_W, gravity_);
    return {tangential - f * direction_, (radius_ * mass_ * f / moment_) * cross(plane.normal_W, direction_)};
}

// Follows the present mode to its end, and selects the next one.
void SphereCertifier::follow_piece() {
    const Path now = path();
    const std::optional<Arrival> arrival = first_arrival(now.a);
    std::optional<Ball> end, stops;
    if (mode_ == Mode::sliding) stops = end_of_slip();
    if (arrival) end = arrival->time;
    const bool slip_ends = stops && (!end || *stops < *end);
    if (stops && end && !slip_ends && !(*end < *stops))
        ask_for_bits("the precision does not resolve which event is first");
    if (slip_ends) end = stops;
    while (result_.fault.empty() && next_sample_ < times_.size()) {
        const double sample = times_[next_sample_];
        if (end) {
            const std::optional<bool> before = is_before(sample, *end);
            if (!before || !*before) break;
        }
        add_sample(sample, now);
    }
    if (!result_.fault.empty() || next_sample_ == times_.size()) return;
    if (!slip_ends && mode_ != Mode::flight) return end_hopelessly("the ball touches two planes at once");
    if (slip_ends) {
        move(*end, now);
        place_on(*plane_);
        v_ = v_ - dot(planes_[*plane_].normal_W, v_) * planes_[*plane_].normal_W;
        stay_on(*plane_, true);
        return;
    }
    // the speed at the plane from the energy: u^2 = u_0^2 - 2 a gap, and -u_0 after a flight from the plane itself
    const std::size_t k = arrival->plane;
    const Vector& n = planes_[k].normal_W;
    const Ball u = touched_ == k ? leaves_ : dot(n, v_);
    const Ball arrives = touched_ == k ? -u : -sqrt(u * u - Ball(2) * dot(n, now.a) * gap(k));
    // In a flight from the plane itself the components along and normal to it are separate, because the balls of their
    // sums and differences would grow with each impact. Slip that gravity adds to none starts from exactly zero.
    const Vector tangential = gravity_ - dot(n, gravity_) * n;
    const bool returns = touched_ == k;
    Vector along = tangent_ + *end * tangential, slipping = *end * tangential;
    if (returns) foot_ = foot_ + *end * tangent_ + (*end * *end / Ball(2)) * tangential;
    const bool started_without_slip = returns && sticks_;
    move(*end, now);
    if (returns) {
        x_ = foot_ + (planes_[k].offset + radius_) * n;
    } else {
        along = v_ - dot(n, v_) * n;
        place_on(k);
    }
    if (!started_without_slip) slipping = along + radius_ * cross(n, w_);
    collide(k, arrives, along, slipping);
}

// The time (s from now) at which the slip vanishes; empty if it does not.
std::optional<Ball> SphereCertifier::end_of_slip() {
    const ContactPlane<Ball>& plane = planes_[*plane_];
    const Ball k = Ball(1) / mass_ + radius_ * radius_ / moment_;
    const Vector tangential = gravity_ - dot(plane.normal_W, gravity_) * plane.normal_W;
    const Ball loss = plane.friction * -dot(plane.normal_W, gravity_) * mass_ * k - dot(tangential, direction_);
    if (loss.is_positive()) return dot(slip(*plane_), direction_) / loss;
    if (loss.is_negative() || loss.is_zero()) return {};
    ask_for_bits("the precision does not resolve whether the slip ends");
    return {};
}

// A flight from a plane with a normal velocity and one along the plane.
void SphereCertifier::leave(std::size_t k, const Ball& normal, const Vector& along) {
    const Vector& n = planes_[k].normal_W;
    mode_ = Mode::flight, plane_ = k, touched_ = k;
    leaves_ = normal, tangent_ = along, foot_ = x_ - dot(n, x_) * n;
    v_ = along + normal * n;
}

// An impact with the normal velocity u < 0, this velocity along the plane and this slip.
void SphereCertifier::collide(std::size_t k, const Ball& u, const Vector& along, const Vector& slipping) {
    const bool returns = touched_ == k;
    const Vector foot = foot_;
    const ContactPlane<Ball>& plane = planes_[k];
    const Ball normal = -(Ball(1) + plane.restitution) * u * mass_,
               inverse = Ball(1) / mass_ + radius_ * radius_ / moment_;
    const Ball limit = plane.friction * normal * inverse, size = length_of(slipping);
    Vector tangential;
    sticks_ = false;
    if (plane.friction.is_zero() || is_exact_zero(slipping)) {
        sticks_ = is_exact_zero(slipping);
    } else if (Bound(size).ball() < limit) {
        tangential = (Ball(-1) / inverse) * slipping;
        sticks_ = true;
    } else if (size > limit) {
        tangential = (-plane.friction * normal / size) * slipping;
    } else {
        return ask_for_bits("the precision does not resolve whether the slip ends in an impact");
    }
    const Vector after = along + (Ball(1) / mass_) * tangential;
    v_ = after;
    w_ = w_ - (radius_ / moment_) * cross(plane.normal_W, tangential);
    const bool ends = plane.restitution.is_zero();
    result_.events.push_back({t_, k, ends ? "lands" : "impact"});
    if (ends) return stay_on(k, sticks_);
    const Ball leaves = -plane.restitution * u;
    leave(k, leaves, after);
    if (returns) foot_ = foot;
    if (const Ball a = dot(plane.normal_W, gravity_); plane.restitution < Ball(1) && a.is_negative())
        accumulate(k, leaves, a);
}

// Continues at the limit of the impacts if the speed u after the last one is below the precision.
void SphereCertifier::accumulate(std::size_t k, const Ball& u, const Ball& a) {
    const double scale = std::max({1.0, length_of(v_).near(), (radius_ * length_of(w_)).near()});
    if (std::log2(u.near() / scale) > 24 - static_cast<double>(Ball::precision())) return;
    const ContactPlane<Ball>& plane = planes_[k];
    const Ball e = plane.restitution, time = Ball(2) * u / (-a * (Ball(1) - e));
    const Vector tangential = gravity_ - a * plane.normal_W;
    // all later impulses together, over the mass
    const Ball impulses = plane.friction * (Ball(1) + e) / (Ball(1) - e) * u;
    const Bound change(impulses + length_of(tangential) * time), spin(impulses * mass_ * radius_ / moment_);
    v_ = tangent_;
    const Bound turned = Bound(0.5) * spin * Bound(time), shift = change * Bound(time);
    const std::optional<bool> before = is_before(times_[next_sample_], time);
    if (!before) return;
    if (*before) return ask_for_bits("a sample lies between the last impacts of an accumulation");
    for (std::size_t i = 0; i < planes_.size(); ++i)
        if (i != k && !(gap(i) > (length_of(v_) + u + change.ball()) * time))
            return ask_for_bits("another plane may be reached between the last impacts of an accumulation");
    move(time, {Vector(), Vector()});
    x_ = widened(x_, shift), v_ = widened(v_, change), w_ = widened(w_, spin);
    q_ = {widened(q_.w, turned), widened(q_.x, turned), widened(q_.y, turned), widened(q_.z, turned)};
    v_ = v_ - dot(plane.normal_W, v_) * plane.normal_W;
    place_on(k);
    result_.events.push_back({t_, k, "accumulates"});
    // a flight of the time 2 u / |a| adds the slip 2 |g_t| u / |a|, and the next impact can end mu (1 + e) m u k of it
    const Ball inverse = Ball(1) / mass_ + radius_ * radius_ / moment_;
    const bool all_stick =
        sticks_ && length_of(tangential) * Ball(2) < plane.friction * (Ball(1) + e) * mass_ * inverse * -a;
    stay_on(k, all_stick || (sticks_ && is_exact_zero(tangential)));
}

// Selects the mode of lasting contact. `no_slip`: the slip is exactly zero.
void SphereCertifier::stay_on(std::size_t k, bool no_slip) {
    const ContactPlane<Ball>& plane = planes_[k];
    const Ball normal = dot(plane.normal_W, gravity_);
    const bool was_sliding = mode_ == Mode::sliding;
    plane_ = k, touched_.reset(), mode_ = Mode::sliding;
    if (!normal.is_negative()) {
        if (normal.is_positive()) {
            mode_ = Mode::flight, touched_ = k;
            return;
        }
        return ask_for_bits("the ball touches the plane without a normal force");
    }
    const Vector slipping = slip(k);
    const Vector tangential = gravity_ - normal * plane.normal_W;
    if (plane.friction.is_zero()) {
        direction_ = Vector();
        return;
    }
    if (!no_slip && !is_exact_zero(slipping)) {
        if (may_be_zero(slipping)) return ask_for_bits("the precision does not resolve whether the ball slips");
        if (!is_exact_zero(tangential) && !is_exact_zero(cross(tangential, slipping)))
            return end_hopelessly("sliding whose direction changes has no closed form");
        direction_ = (Ball(1) / length_of(slipping)) * slipping;
        return;
    }
    // rolling needs the force m g_t I / (I + m r^2) within the cone
    v_ = v_ - slipping;
    const Ball needed = length_of(tangential) * moment_ / (moment_ + mass_ * radius_ * radius_);
    const Ball limit = plane.friction * -normal;
    if (needed <= limit) {
        if (was_sliding) result_.events.push_back({t_, k, "rolls"});
        mode_ = Mode::rolling;
        return;
    }
    if (!(needed > limit)) return ask_for_bits("the precision does not resolve whether the ball rolls");
    direction_ = (Ball(1) / length_of(tangential)) * tangential;
}

}  // namespace polhode::truth
