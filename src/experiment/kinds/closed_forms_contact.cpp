// Closed forms and first integrals of the scenes of contact/. Slip u = v - r w x n, with the normal n and the radius r;
// a tangential impulse J changes v of a solid sphere by J/m and u by 7/2 J/m.
#include <fmt/format.h>

#include "experiment/kinds/closed_form_numbers.h"
#include "scene/body_source.h"

namespace polhode::closed_forms {
namespace {

Vector3<Exact> first_velocity(const Comparison& c, std::size_t b = 0) { return c.first(b).velocity_W; }

// The slip of a sphere on a horizontal plane at the start.
Vector3<Exact> first_slip(const Comparison& c, std::size_t b = 0) {
    const ExactMotion start = c.first(b);
    const Vector3<Exact> down(0, 0, -c.radius(b));
    Vector3<Exact> u = start.velocity_W + cross(start.angular_velocity_W, down);
    u[2] = 0;
    return u;
}

Exact mu(const Comparison& c, std::size_t plane = 0) { return c.scene.planes.at(plane).friction; }

// Sliding on a parabola up to t = 2 |u0| / (7 mu g), then straight with v0 - 2/7 u0.
void sliding_ball(Comparison& c) {
    const Vector3<Exact> v = first_velocity(c), u = first_slip(c), x = c.first().position_W;
    const Exact t = 2 * length(u) / (7 * mu(c) * -c.gravity()[2]);
    c.add("start of rolling (s)", "2 |u0| / (7 mu g)", t, c.event("rolls"));
    const char* const names[] = {"x", "y"};
    for (int i = 0; i < 2; ++i) {
        const Exact end = v[i] - 2 * u[i] / 7;
        c.add(std::string("final v_") + names[i] + " (m/s)", "v0 - 2/7 u0", end, c.last().velocity_W[i]);
        c.add(std::string("final ") + names[i] + " (m)", "x0 + t (v0 + v)/2 + (T - t) v",
              x[i] + t * (v[i] + end) / 2 + (c.duration() - t) * end, c.last().position_W[i], 1);
    }
}

void ball_incline_rolls(Comparison& c) {
    const Exact a = 5 * c.gravity()[0] / 7, T = c.duration();
    c.add("final speed (m/s)", "5/7 g T sin a", a * T, c.last().velocity_W[0]);
    c.add("distance (m)", "5/14 g T^2 sin a", a * T * T / 2, c.last().position_W[0]);
}

void ball_incline_slides(Comparison& c) {
    const Vector3<Exact> g = c.gravity();
    const Exact T = c.duration();
    c.add("final speed (m/s)", "(g sin a - mu g cos a) T", (g[0] + mu(c) * g[2]) * T, c.last().velocity_W[0]);
    c.add("final spin (rad/s)", "5/2 mu g T cos a / r", 5 * mu(c) * -g[2] * T / (2 * c.radius()),
          c.last().angular_velocity_W[1]);
}

// After rolling starts at the floor, 2/7 of the wall's friction acts on the slip there.
void ball_and_wall(Comparison& c) {
    const Vector3<Exact> g = c.gravity();
    const Exact speed = first_velocity(c)[0], floor = mu(c, 0) * -g[2], wall = mu(c, 1) * -g[1];
    const Exact t1 = 2 * speed / (7 * floor + 2 * wall);
    const Exact t2 = t1 + (speed - (floor + 7 * wall / 2) * t1) / (45 * wall / 14);
    c.add("rolling on the floor (s)", "t1 = 2 v0 / (7 f1 + 2 f2)", t1, c.event("rolls", 0));
    c.add("rolling on the wall (s)", "t1 + (v0 - (f1 + 7/2 f2) t1) 14 / (45 f2)", t2, c.event("rolls", 1));
    c.add("final speed (m/s)", "v0 - (f1 + f2) t1 - 5/7 f2 (t2 - t1)",
          speed - (floor + wall) * t1 - 5 * wall * (t2 - t1) / 7, c.last().velocity_W[0]);
}

// n is the vertical component of both normals. The contacts are b = n r below the centre.
void ball_in_gutter(Comparison& c) {
    const Vector3<Exact> normal = cast<Exact>(c.scene.planes.at(0).normal_W);
    const Exact n = normal[2] / length(normal), speed = first_velocity(c)[0];
    const Exact end = speed / (1 + 2 / (5 * n * n)), t = (speed - end) * n / (mu(c) * -c.gravity()[2]);
    c.add("start of rolling (s)", "(v0 - v) b / (mu g r)", t, c.event("rolls"));
    c.add("final speed (m/s)", "v = v0 / (1 + 2/5 (r/b)^2)", end, c.last().velocity_W[0]);
    c.add("distance (m)", "t (v0 + v)/2 + (T - t) v", t * (speed + end) / 2 + (c.duration() - t) * end,
          c.last().position_W[0]);
}

// The time of the first impact, and that at which the impacts end.
void add_bounces(Comparison& c) {
    const Exact g = -c.gravity()[2], e = c.scene.planes.at(0).restitution;
    const Exact t1 = sqrt(2 * (c.first().position_W[2] - c.radius()) / g);
    c.add("first impact (s)", "t1 = sqrt(2 h / g)", t1, c.event("impact"));
    c.add("end of the impacts (s)", "t1 + 2 v1/g e/(1 - e)", t1 + 2 * t1 * e / (1 - e), c.event("accumulates"));
}
void ball_bounces_to_rest(Comparison& c) {
    add_bounces(c);
    c.add("final height (m)", "r", c.radius(), c.last().position_W[2]);
}
void ball_bounces_and_rolls(Comparison& c) {
    add_bounces(c);
    const Vector3<Exact> v = first_velocity(c), u = first_slip(c);
    c.add("final v_x (m/s)", "v0 - 2/7 u0", v[0] - 2 * u[0] / 7, c.last().velocity_W[0]);
    c.add("final v_y (m/s)", "v0 - 2/7 u0", v[1] - 2 * u[1] / 7, c.last().velocity_W[1]);
}

// The moment of inertia about the axis is m r^2 / 2.
void cylinder_slides_and_rolls(Comparison& c) {
    const Exact speed = first_velocity(c)[0], t = speed / (3 * mu(c) * -c.gravity()[2]), end = 2 * speed / 3;
    c.add("start of rolling (s)", "v0 / (3 mu g)", t, c.event("rolls"));
    c.add("final speed (m/s)", "2/3 v0", end, c.last().velocity_W[0]);
    c.add("distance (m)", "t (v0 + v)/2 + (T - t) v", t * (speed + end) / 2 + (c.duration() - t) * end,
          c.last().position_W[0]);
}

// With the angle a of both lines of centres to the vertical, the lower balls have v^2 = 2 g d cos^2 a (cos a0 - cos a).
// The contacts open where it is largest, at cos a = 2/3 cos a0.
void ball_parts_balls(Comparison& c) {
    const Exact d = c.radius(1) + c.radius(2), height = c.first(2).position_W[2] - c.first(1).position_W[2],
                cosine = 2 * height / (3 * d), g = -c.gravity()[2];
    const Exact speed = cosine * sqrt(2 * g * (height - d * cosine));
    c.add("final speed of the lower balls (m/s)", "sqrt(8/27 g d cos^3 a0)", speed, c.last(1).velocity_W[0]);
    c.add_constant("momentum (N s)", 0, c.last(0).velocity_W[0] + c.last(1).velocity_W[0], speed);
    const Exact fall = sqrt(2 * g * ((1 - cosine * cosine) * (height - d * cosine) + d * cosine));
    const DecimalContactEvent* landing = c.find_event("lands");
    std::optional<Exact> impulse;
    if (landing) impulse = Exact(landing->normal_impulse);
    c.add("normal impulse on the floor (N s)", "m sqrt(2 g d (sin^2 a (cos a0 - cos a) + cos a))", 2 * fall, impulse);
}

// Every impact ends the slip u = v -+ r w at floor and table: v changes by -2/7 u, w by +-5/7 u/r.
void superball(Comparison& c) {
    Exact v = first_velocity(c)[0], w = 0;
    const Exact r = c.radius();
    for (const DecimalContactEvent& event : c.events()) {
        const Exact side = event.plane == 0 ? -1 : 1, u = v + side * r * w;
        v -= 2 * u / 7, w -= side * 5 * u / (7 * r);
    }
    c.add("final v_x (m/s)", "v - 2/7 (v -+ r w) at each impact", v, c.last().velocity_W[0]);
    c.add("final spin (rad/s)", "w +- 5/7 (v -+ r w)/r at each impact", w, c.last().angular_velocity_W[1]);
}

// A half-ball hit: a is the angle between the velocity of the cue ball and the line of centres.
Exact sine_of_cut(const Comparison& c) { return c.first(1).position_W[1] / (c.radius(0) + c.radius(1)); }

void billiard_natural_angle(Comparison& c) {
    const Exact sine = sine_of_cut(c), square = sine * sine, cosine = sqrt(1 - square);
    const Exact speed = first_velocity(c)[0];
    c.add("start of rolling (s)", "2 v0 / (7 mu g)", 2 * speed / (7 * mu(c) * -c.gravity()[2]), c.event("rolls"));
    const Vector3<Exact> v = c.last(0).velocity_W;
    c.add("tangent of the natural angle", "sin a cos a / (sin^2 a + 2/5)", sine * cosine / (square + Exact(2) / 5),
          -v[1] / v[0]);
    c.add("final speed of the object ball (m/s)", "(5/7)^2 v0 cos a", 25 * speed * cosine / 49,
          length(c.last(1).velocity_W));
}

void billiard_throw(Comparison& c) {
    const Exact sine = sine_of_cut(c), cosine = sqrt(1 - sine * sine), speed = first_velocity(c)[0];
    const SphereContact& pair = c.scene.contacts.at(0);
    const Exact way = c.first(1).position_W[0] - (c.radius(0) + c.radius(1)) * cosine,
                v = sqrt(speed * speed + 2 * mu(c) * c.gravity()[2] * way);
    const Exact normal = (1 + Exact(pair.restitution)) / 2 * c.body().mass * v * cosine;
    const DecimalContactEvent* hit = c.find_event("impact");
    std::optional<Exact> struck, thrown;
    if (hit) {
        Exact square = 0;
        for (const std::string& component : hit->tangential_impulse) square += Exact(component) * Exact(component);
        struck = Exact(hit->normal_impulse), thrown = sqrt(square);
    }
    c.add("normal impulse (N s)", "(1 + e)/2 m cos a sqrt(v0^2 - 2 mu g s)", normal, struck);
    c.add("tangential impulse (N s)", "mu times the normal impulse", Exact(pair.friction) * normal, thrown);
}

// Each impact passes the fraction (1 + e)/2 of the velocity on.
void newtons_cradle(Comparison& c) {
    const Exact passed = (1 + Exact(c.scene.contacts.at(0).restitution)) / 2;
    Exact speed = first_velocity(c)[0], t = 0, momentum = 0;
    for (std::size_t k = 0; k + 1 < c.bodies(); ++k) {
        t += (c.first(k + 1).position_W[0] - c.first(k).position_W[0] - c.radius(k) - c.radius(k + 1)) / speed;
        speed *= passed;
    }
    const DecimalContactEvent* fourth = c.find_event("impact", c.bodies() - 2);
    c.add("time of the fourth impact (s)", "sum of gaps / (v0 ((1 + e)/2)^k)", t, c.event("impact", c.bodies() - 2));
    c.add("fourth impulse (N s)", "m v0 ((1 + e)/2)^4", c.body().mass * speed,
          fourth ? std::optional(Exact(fourth->normal_impulse)) : std::nullopt);
    for (std::size_t k = 0; k < c.bodies(); ++k) momentum += c.body(k).mass * c.last(k).velocity_W[0];
    c.add_constant("momentum (N s)", c.body().mass * first_velocity(c)[0], momentum);
}

// Both balls fall by h with the speed v = sqrt(2 g h); the lower one returns and meets the upper one at 2 v.
void stacked_ball_drop(Comparison& c) {
    const Exact g = -c.gravity()[2], R = c.radius(0), r = c.radius(1), M = c.body(0).mass, m = c.body(1).mass;
    const Exact v = sqrt(2 * g * (c.first(0).position_W[2] - R)),
                gap = c.first(1).position_W[2] - c.first(0).position_W[2] - R - r;
    const Exact t = v / g + gap / (2 * v), J = 4 * v * M * m / (M + m);
    const DecimalContactEvent* meeting = c.find_event("impact", 1);
    c.add("impact of the balls (s)", "v/g + s / (2 v)", t, c.event("impact", 1));
    c.add("impulse of the balls (N s)", "4 v M m / (M + m)", J,
          meeting ? std::optional(Exact(meeting->normal_impulse)) : std::nullopt);
    c.add("final speed of the upper ball (m/s)", "J/m - g T", J / m - g * c.duration(), c.last(1).velocity_W[2]);
}

// With k = 1 + I/(m r^2) of each ball and equal masses: the balls roll with the same acceleration a, the force N
// between them and its friction mu N satisfy k_1 m a = m g_x - (1 + mu) N and k_2 m a = m g_x + (1 - mu) N.
void ball_pushes_hollow_ball(Comparison& c) {
    const auto factor = [&](std::size_t b) {
        return Exact(1 + c.body(b).inertia[0][0] / (c.body(b).mass * c.radius(b) * c.radius(b)));
    };
    const Exact k1 = factor(0), k2 = factor(1), friction = c.scene.contacts.at(0).friction, T = c.duration();
    const Exact a = 2 * c.gravity()[0] / (k1 + k2 + friction * (k2 - k1));
    c.add("final speed (m/s)", "a T,  a = 2 g_x / (k1 + k2 + mu (k2 - k1))", a * T, c.last(0).velocity_W[0]);
    c.add("distance (m)", "a T^2/2", a * T * T / 2, c.last(0).position_W[0]);
    c.add("distance of the balls (m)", "2 r", c.radius(0) + c.radius(1),
          c.last(1).position_W[0] - c.last(0).position_W[0]);
}

// The line of centres, of length R, has the cosine y to the vertical. Momentum and energy give, with k = m/(M + m),
//   R w^2 (1 - k y^2) = 2 g (y0 - y),
// and the force between the balls vanishes where R w^2 = g y. Then the lower ball has the speed k R w y.
void ball_leaves_ball(Comparison& c) {
    const Exact M = c.body(0).mass, m = c.body(1).mass, k = m / (M + m), R = c.radius(0) + c.radius(1);
    const Exact start = (c.first(1).position_W[2] - c.first(0).position_W[2]) / R;
    Exact y = 2 * start / 3;
    for (int i = 0; i < 100; ++i) y -= (k * y * y * y - 3 * y + 2 * start) / (3 * k * y * y - 3);
    const Exact speed = sqrt(Exact(-c.gravity()[2] * y * R)) * y;
    c.add("final speed of the lower ball (m/s)", "k sqrt(g R y) y,  k y^3 - 3 y + 2 y0 = 0", k * speed,
          -c.last(0).velocity_W[0]);
    c.add("final speed of the upper ball (m/s)", "(1 - k) sqrt(g R y) y", (1 - k) * speed, c.last(1).velocity_W[0]);
    c.add_constant("momentum (N s)", 0, M * c.last(0).velocity_W[0] + m * c.last(1).velocity_W[0], m * speed);
}

// The force F0 sin k t moves the block while it exceeds the friction, and again, mirrored, in each half period pi/k.
void forced_block(Comparison& c) {
    const Exact F0 = c.scene.parameters.at(0).value, k = c.scene.parameters.at(1).value, m = c.body().mass;
    const Exact friction = mu(c) * m * -c.gravity()[2], start = asin(Exact(friction / F0)) / k;
    const Exact half_period = acos(Exact(-1)) / k, after = c.duration() - 3 * half_period;
    c.add("first start (s)", "t1 = arcsin(mu m g / F0) / k", start, c.event("slides", 0));
    c.add("second start (s)", "t1 + pi/k", start + half_period, c.event("slides", 1));
    c.add("final speed (m/s)", "F0 (cos k t1 - cos k s)/(m k) - mu g (s - t1),  s = T - 3 pi/k",
          F0 * (cos(Exact(k * start)) - cos(Exact(k * after))) / (m * k) - friction * (after - start) / m,
          -c.last().velocity_W[0]);
}

// The height of the centre of a spheroid on a plane, from its axis: z^2 = a^2 sin^2 + c^2 cos^2. The semi-axes follow
// from the moments, I_x = m (a^2 + c^2)/5 and I_z = 2/5 m a^2.
void spinning_egg(Comparison& c) {
    const Matrix3<Exact>& inertia = c.body().inertia;
    const Exact m = c.body().mass, a2 = 5 * inertia[2][2] / (2 * m), c2 = 5 * inertia[0][0] / m - a2;
    const ExactMotion last = c.last();
    const Exact axis = rotate(last.q, Vector3<Exact>(0, 0, 1))[2];
    c.add("final height (m)", "z^2 = a^2 sin^2 + c^2 cos^2 of the axis", sqrt(Exact(a2 + (c2 - a2) * axis * axis)),
          last.position_W[2]);
}

void block_on_ramp(Comparison& c) {
    const Vector3<Exact> g = c.gravity();
    const Exact v = -first_velocity(c)[0], up = g[0] - mu(c) * g[2], down = g[0] + mu(c) * g[2];
    const Exact t = v / up, rest = c.duration() - t;
    c.add("final speed (m/s)", "(g sin a - mu g cos a)(T - v0/(g sin a + mu g cos a))", down * rest,
          c.last().velocity_W[0]);
    c.add("final place (m)", "x0 - v0 t/2 + g (sin a - mu cos a)(T - t)^2/2",
          c.first().position_W[0] - v * t / 2 + down * rest * rest / 2, c.last().position_W[0]);
}

// With the speed u and its angle p to the fall line.
void block_across_slope(Comparison& c) {
    const Vector3<Exact> g = c.gravity();
    const Exact power = mu(c) * g[2] / g[0];  // -mu / tan a
    const auto integral = [&](const Vector3<Exact>& v) {
        return Exact(abs(v[1]) * pow(Exact(tan(atan2(abs(v[1]), v[0]) / 2)), power));
    };
    c.add_constant("u sin p tan(p/2)^(-mu/tan a) (m/s)", integral(first_velocity(c)), integral(c.last().velocity_W));
}

// L.r, with r from the centre of mass to the contact of an axisymmetric body with a spherical tip. Gravity and impacts
// keep it, in flight and in any contact of the same tip. `center` is from the centre of mass to that of the tip.
void add_jellett(Comparison& c, const std::string& name, const Vector3<Exact>& center, std::size_t from,
                 std::size_t to) {
    const auto jellett = [&](const ExactMotion& motion) {
        const Vector3<Exact> w = rotate_back(motion.q, motion.angular_velocity_W);
        Vector3<Exact> r = rotate(motion.q, center);
        r[2] -= c.radius();
        return Exact(dot(rotate(motion.q, c.body().inertia * w), r));
    };
    c.add_constant(name + " (kg m^3/s)", jellett(c.at(from)), jellett(c.at(to)));
}
void tippe_top(Comparison& c) {
    add_jellett(c, "Jellett's constant", Vector3<Exact>() - c.body().center, 0, c.last_sample());
}
// Each end has its own constant: the first one while it is the only end that has landed, the other one after its
// landing.
void capsule_lands(Comparison& c) {
    const auto& shape = std::get<Capsule>(std::get<ShapedBody>(c.scene.body.source->definition).shape);
    const Exact lower = rotate(c.first().q, Vector3<Exact>(0, 0, 1))[2] > 0 ? -1 : 1;
    const Vector3<Exact> center(0, 0, lower * shape.half_height);
    const std::size_t before = c.last_sample_before(c.event("lands", 1).value_or(c.duration()));
    add_jellett(c, "Jellett's constant of the first end", center, 0, before);
    if (before + 1 < c.last_sample())
        add_jellett(c, "Jellett's constant of the other end", Exact(-1) * center, before + 1, c.last_sample());
}

void rolling_body(Comparison& c) { c.add_constant("energy (J)", c.energy(0), c.energy(c.last_sample())); }
// The angular momentum about the contact point is constant in world axes.
void chaplygin_ball(Comparison& c) {
    rolling_body(c);
    const auto about_contact = [&](ExactMotion motion) {
        motion.position_W = {0, 0, c.radius()};
        return c.angular_momentum_W(motion);
    };
    const Vector3<Exact> start = about_contact(c.first()), end = about_contact(c.last());
    c.add_constant("L_x about the contact (N m s)", start[0], end[0], length(start));
    c.add_constant("L_y about the contact (N m s)", start[1], end[1], length(start));
    c.add_constant("L_z about the contact (N m s)", start[2], end[2], length(start));
}

// In flight before the impacts end: their impulses account for the change of momentum.
void ellipsoid_bounces(Comparison& c) {
    const std::size_t sample = c.last_sample_before(c.event("accumulates").value_or(c.duration()));
    const Exact m = c.body().mass, t = c.time(sample);
    Vector3<Exact> p = m * first_velocity(c) + m * t * c.gravity();
    for (const DecimalContactEvent& event : c.events()) {
        if (Exact(event.t) > t) break;
        for (int i = 0; i < 3; ++i) p[i] += Exact(event.tangential_impulse[static_cast<std::size_t>(i)]);
        p[2] += Exact(event.normal_impulse);
    }
    const Vector3<Exact> end = m * c.at(sample).velocity_W;
    const char* const names[] = {"p_x", "p_y", "p_z"};
    for (int i = 0; i < 3; ++i)
        c.add(fmt::format("momentum {} at {} s (N s)", names[i], t.convert_to<double>()),
              "m v0 + m g t + sum of the impulses", p[i], end[i], length(p));
}

}  // namespace

std::span<const SceneForms> contact_forms() {
    static constexpr SceneForms list[] = {
        {"contact/ball_and_wall", "E. J. Routh 1905", ball_and_wall},
        {"contact/ball_bounces_and_rolls", "R. Cross 2002", ball_bounces_and_rolls},
        {"contact/ball_bounces_to_rest", "textbook", ball_bounces_to_rest},
        {"contact/ball_in_gutter", "E. J. Routh 1905", ball_in_gutter},
        {"contact/ball_incline_rolls", "E. J. Routh 1905", ball_incline_rolls},
        {"contact/ball_incline_slides", "E. J. Routh 1905", ball_incline_slides},
        {"contact/ball_leaves_ball", "D. Morin 2008", ball_leaves_ball},
        {"contact/ball_parts_balls", "balance of energy", ball_parts_balls},
        {"contact/ball_pushes_hollow_ball", "balance of momentum", ball_pushes_hollow_ball},
        {"contact/billiard_natural_angle", "D. G. Alciatore, TP 3.3", billiard_natural_angle},
        {"contact/billiard_side_spin", "G.-G. Coriolis 1835", sliding_ball},
        {"contact/billiard_throw", "D. G. Alciatore, TP A-14", billiard_throw},
        {"contact/block_across_slope", "textbook", block_across_slope},
        {"contact/block_on_ramp", "C.-A. Coulomb 1785", block_on_ramp},
        {"contact/bowling_ball", "D. C. Hopkins and J. D. Patterson 1977", sliding_ball},
        {"contact/capsule_lands", "J. H. Jellett 1872", capsule_lands},
        {"contact/chaplygin_ball", "S. A. Chaplygin 1903", chaplygin_ball},
        {"contact/cylinder_slides_and_rolls", "D. Kleppner and R. J. Kolenkow 2014", cylinder_slides_and_rolls},
        {"contact/ellipsoid_bounces", "balance of momentum", ellipsoid_bounces},
        {"contact/eulers_disc", "E. J. Routh 1905", rolling_body},
        {"contact/forced_block", "J. P. Den Hartog 1931", forced_block},
        {"contact/newtons_cradle", "F. Herrmann and P. Schmaelzle 1981", newtons_cradle},
        {"contact/rattleback", "A. Garcia and M. Hubbard 1988", rolling_body},
        {"contact/rolling_coin", "E. J. Routh 1905", rolling_body},
        {"contact/rolling_ellipsoid", "E. J. Routh 1905", rolling_body},
        {"contact/spinning_egg", "H. K. Moffatt and Y. Shimomura 2002", spinning_egg},
        {"contact/stacked_ball_drop", "W. G. Harter 1971", stacked_ball_drop},
        {"contact/superball", "R. L. Garwin 1969", superball},
        {"contact/tippe_top", "C. G. Gray and B. G. Nickel 2000", tippe_top},
    };
    return list;
}

}  // namespace polhode::closed_forms
