// Closed forms and first integrals of the scenes of joints/. Columns of the truth refer to centres of mass, so that
// displacements of joints are differences from the start.
#include <algorithm>

#include "experiment/kinds/closed_form_numbers.h"
#include "scene/scene_file.h"

namespace polhode::closed_forms {
namespace {

Vector3<Exact> displacement(const Comparison& c, std::size_t b = 0) {
    return c.last(b).position_W - c.first(b).position_W;
}
const Joint& joint(const Comparison& c, std::size_t index) { return c.scene.joints.at(index); }

void add_energy(Comparison& c) { c.add_constant("energy (J)", c.energy(0), c.energy(c.last_sample())); }

// Weight m g l of a body that hangs from a hinge of its parent at its origin.
Exact weight_moment(const Comparison& c) { return c.body().mass * -c.gravity()[2] * length(c.body().center); }

// The generalized momentum of the vertical base joint: gravity and the other joints do not act on it.
void arm6_limits_friction(Comparison& c) {
    const Joint& base = joint(c, 0);
    const auto momentum = [&](std::size_t sample) {
        Exact sum = Exact(base.armature[0]) * c.at(sample, 0).angular_velocity_W[2];
        for (std::size_t b = 0; b < c.bodies(); ++b) sum += c.angular_momentum_W(c.at(sample, b), b)[2];
        return sum;
    };
    c.add("final L_z with the armature (N m s)", "L_z - F T", momentum(0) - Exact(base.friction) * c.duration(),
          momentum(c.last_sample()));
}

// Fingers on rails in the hand's axes; the spring of the first finger stores energy too.
void arm_with_gripper(Comparison& c) {
    const auto way = [&](std::size_t sample, std::size_t b) {
        const ExactMotion hand = c.at(sample, 2);
        return rotate_back(hand.q, Vector3<Exact>(c.at(sample, b).position_W - hand.position_W))[0];
    };
    const Joint& spring = joint(c, 3);
    const auto energy = [&](std::size_t sample) {
        const Exact x = way(sample, 3) - Exact(spring.parent_point[0]);
        return Exact(c.energy(sample) + Exact(spring.stiffness[0]) * x * x / 2);
    };
    c.add_constant("energy (J)", energy(0), energy(c.last_sample()));
    c.add("place of the second finger (m)", "-1 times that of the first", -way(c.last_sample(), 3),
          way(c.last_sample(), 4));
}

void bead_on_rotating_rod(Comparison& c) {
    const Exact r = Exact(joint(c, 1).coordinate[0]), phase = 2 * c.duration();
    c.add("final x (m)", "r0 cosh(w T) cos(w T)", r * cosh(phase) * cos(phase), c.last(1).position_W[0]);
    c.add("final y (m)", "r0 cosh(w T) sin(w T)", r * cosh(phase) * sin(phase), c.last(1).position_W[1]);
}

void bouncing_slider(Comparison& c) {
    const Joint& rail = joint(c, 0);
    const Exact g = -c.gravity()[2], h = Exact(rail.coordinate[0]) - Exact(rail.limits.lower);
    const Exact e = rail.limits.restitution, t1 = sqrt(2 * h / g);
    c.add("first impact (s)", "t1 = sqrt(2 h / g)", t1, c.event("impact"));
    c.add("end of the impacts (s)", "t1 + 2 v1/g e/(1 - e)", t1 + 2 * t1 * e / (1 - e), c.event("rests"));
}

// The end of the second arm, 1 m from its hinge.
void cardan_gear(Comparison& c) {
    const ExactMotion small = c.last(1);
    const Vector3<Exact> end = small.position_W + rotate(small.q, Vector3<Exact>(0, 0, -1) - c.body(1).center);
    c.add("final x of the end (m)", "0", 0, end[0], 1);
    add_energy(c);
}

// Half periods pi sqrt(m/k) with turning points that approach the middle by 2 F/k.
void coulomb_oscillator(Comparison& c) {
    const Joint& rail = joint(c, 0);
    const Exact k = rail.stiffness[0], F = rail.friction;
    Exact x = rail.coordinate[0], t = 0;
    for (; abs(x) * k > F; t += pi() * sqrt(c.body().mass / k)) x = x > 0 ? 2 * F / k - x : -2 * F / k - x;
    c.add("stop (s)", "n pi sqrt(m/k)", t, c.event("sticks"));
    c.add("final x (m)", "(-1)^n (x0 - 2 n F/k)", x, c.last().position_W[0], Exact(rail.coordinate[0]));
}

// Turning points a, -b with m g l (cos b - cos a) = F (a + b), while m g l sin a > F.
void coulomb_pendulum(Comparison& c) {
    const Exact weight = weight_moment(c), F = joint(c, 0).friction;
    Exact a = joint(c, 0).coordinate[0];
    int side = 1;
    for (; weight * sin(a) > F; side = -side) {
        Exact b = a - 2 * F / weight;
        for (int i = 0; i < 40; ++i) b += (weight * (cos(b) - cos(a)) - F * (a + b)) / (weight * sin(b) + F);
        a = b;
    }
    c.add("final angle (rad)", "m g l (cos b - cos a) = F (a + b)", side * a, angle_about_y(c.last()));
}

void driven_slider_crank(Comparison& c) {
    const Exact T = c.duration(), a = 4 * T + sin(4 * T) / 4;  // the prescribed motion of the crank
    const Exact r = 2 * Exact(joint(c, 1).parent_point[0]), l = 2 * Exact(c.scene.loops.at(0).first_point[0]);
    const Exact side = r * sin(a);
    c.add("final x of the slider (m)", "r cos a + sqrt(l^2 - r^2 sin^2 a)", r * cos(a) + sqrt(l * l - side * side),
          c.last(2).position_W[0]);
}

// A motor against spring and friction, up to the limit of the second finger.
void gripper_closes(Comparison& c) {
    const Joint &left = joint(c, 0), &right = joint(c, 1);
    const Exact force = std::get<Motor>(c.scene.loads.at(0)).force - Exact(left.friction) - Exact(right.friction);
    const Exact k = left.stiffness[0], limit = -Exact(right.limits.lower),
                w = sqrt(k / (c.body(0).mass + c.body(1).mass));
    c.add("first impact (s)", "acos(1 - k x/F) sqrt(m/k)", acos(1 - k * limit / force) / w, c.event("impact"));
    c.add("final opening (m)", "0", 0, displacement(c, 0)[0], limit);
}

// Sums over the bodies with mass: a planar root has bodies without mass.
void planar_flight(Comparison& c) {
    struct Sums {
        Exact mass;
        Vector3<Exact> place, momentum;
        Exact L;
    };
    const auto sums = [&](std::size_t sample) {
        Sums s{0, {}, {}, 0};
        for (std::size_t b = 0; b < c.bodies(); ++b) {
            const ExactMotion motion = c.at(sample, b);
            const Exact m = c.body(b).mass;
            s.mass += m, s.place = s.place + m * motion.position_W, s.momentum = s.momentum + m * motion.velocity_W;
            s.L += c.angular_momentum_W(motion, b)[1];
        }
        s.place = (1 / s.mass) * s.place;
        s.L -= cross(s.place, s.momentum)[1];
        return s;
    };
    const Sums start = sums(0), end = sums(c.last_sample());
    const Exact T = c.duration();
    c.add("final height of the centre of mass (m)", "z0 + v0 T - g T^2/2",
          start.place[2] + start.momentum[2] / start.mass * T + c.gravity()[2] * T * T / 2, end.place[2]);
    c.add_constant("momentum p_x (N s)", start.momentum[0], end.momentum[0]);
    c.add_constant("angular momentum about the centre of mass (N m s)", start.L, end.L);
}

// Only the motion of the cart is known: x = a cos(w t).
void kapitza_cart(Comparison& c) {
    const Exact a = c.scene.parameters.at(0).value, w = c.scene.parameters.at(1).value;
    c.add("final height of the cart (m)", "a cos(w T)", a * cos(w * c.duration()), c.last(0).position_W[2]);
}

// E of an arm on a hinge at its origin, whose coordinate has the armature A: geared rotors add ratio^2 I.
void add_pendulum_energy(Comparison& c, const Exact& A) {
    const auto energy = [&](const ExactMotion& motion) {
        const Exact w = motion.angular_velocity_W[1];
        return Exact(c.body().mass *
                         (dot(motion.velocity_W, motion.velocity_W) / 2 - dot(c.gravity(), motion.position_W)) +
                     (c.body().inertia[1][1] + A) * w * w / 2);
    };
    c.add_constant("energy (J)", energy(c.first()), energy(c.last()));
}
void pendulum_with_armature(Comparison& c) { add_pendulum_energy(c, joint(c, 0).armature[0]); }
void pendulum_with_rotor(Comparison& c) {
    const Exact ratio = c.scene.couplings.at(0).ratio;
    add_pendulum_energy(c, ratio * ratio * c.body(1).inertia[1][1]);
    // the same arm, with the rotor as an armature
    const Scene equivalent = find_scene("joints/pendulum_with_armature");
    const truth::Truth truth = truth::find_truth(equivalent, 1, 25);
    if (!truth.reference.available) return;
    c.add("final angle of the arm (rad)", "that of joints/pendulum_with_armature",
          angle_about_y(Comparison(equivalent, truth, "").last()), angle_about_y(c.last(0)));
}

// Impacts at alternating stops keep e^2 of the kinetic energy.
void pendulum_with_stops(Comparison& c) {
    const JointLimits& limits = joint(c, 0).limits;
    const Exact weight = weight_moment(c), l = length(c.body().center),
                J = c.body().inertia[1][1] + c.body().mass * l * l, e = limits.restitution;
    const auto energy = [&](const Exact& x, const Exact& w) { return Exact(weight * (1 - cos(x)) + J * w * w / 2); };
    Exact E = energy(joint(c, 0).coordinate[0], joint(c, 0).rate[0]);
    for (std::size_t n = 0; n < c.count("impact"); ++n) {
        const Exact at = energy(n % 2 == 0 ? limits.upper : limits.lower, 0);
        E = at + e * e * (E - at);
    }
    const ExactMotion end = c.last();
    c.add("final energy (J)", "E - (1 - e^2)(E - V) at each impact", E,
          energy(angle_about_y(end), end.angular_velocity_W[1]));
}

// The coupling adds I ratio^-2 to the rack's mass.
void rack_and_pinion(Comparison& c) {
    const Exact ratio = c.scene.couplings.at(0).ratio, T = c.duration();
    const Exact a = c.body(1).mass * c.gravity()[2] / (c.body(1).mass + c.body(0).inertia[1][1] / (ratio * ratio));
    const Exact v = joint(c, 1).rate[0];
    c.add("displacement of the rack (m)", "v0 T - m g/(m + I/r^2) T^2/2", v * T + a * T * T / 2, displacement(c, 1)[2]);
    c.add("final spin of the pinion (rad/s)", "(v0 - m g/(m + I/r^2) T)/r", (v + a * T) / ratio,
          c.last(0).angular_velocity_W[1]);
}

// The total angular momentum stays 0. That of a wheel about its axis is the integral of the motor's torque.
void reaction_wheels(Comparison& c) {
    Vector3<Exact> sum;
    for (std::size_t b = 0; b < c.bodies(); ++b) sum = sum + c.angular_momentum_W(c.last(b), b);
    const auto& motor = std::get<Motor>(c.scene.loads.at(3));  // motor_3, which acts over the whole run
    const ExactMotion wheel = c.last(3);
    const Exact h = c.body(3).inertia[2][2] * rotate_back(wheel.q, wheel.angular_velocity_W)[2];
    c.add("angular momentum of wheel 3 (N m s)", "torque times T", Exact(motor.force) * c.duration(), h);
    c.add("total angular momentum (N m s)", "0", 0, length(sum), h);
}

// m z'' = -m g - I z''/h^2, with the moment I about the axis and h = pitch / 2 pi in binary64.
void screw_jack(Comparison& c) {
    const Exact h = c.scene.couplings.at(0).ratio, m = c.body().mass, x = c.body().center[0], y = c.body().center[1];
    const Exact I = c.body().inertia[2][2] + m * (x * x + y * y), a = m * c.gravity()[2] / (m + I / (h * h));
    const Exact T = c.duration();
    c.add("displacement (m)", "-m g/(m + I/h^2) T^2/2", a * T * T / 2, displacement(c)[2]);
    c.add("final spin (rad/s)", "-m g/(m + I/h^2) T/h", a * T / h, c.last().angular_velocity_W[2]);
}

// The block moves with the belt, x = t/2 + (1 - cos 2t)/8, until spring and inertia need the limit of friction.
void stick_slip_belt(Comparison& c) {
    const Exact k = std::get<PointSpring>(c.scene.loads.at(0)).stiffness, m = c.body(1).mass, F = joint(c, 1).friction;
    Exact t = F / k * 2;
    for (int i = 0; i < 60; ++i) {
        const Exact x = t / 2 + (1 - cos(2 * t)) / 8, need = k * x + m * cos(2 * t) / 2;
        t -= (need - F) / (k * (Exact(1) / 2 + sin(2 * t) / 4) - m * sin(2 * t));
    }
    c.add("first slip (s)", "k x + m x'' = F on the belt", t, c.event("slips"));
}

}  // namespace

std::span<const SceneForms> joint_forms() {
    static constexpr SceneForms list[] = {
        {"joints/arm6_limits_friction", "balance of angular momentum", arm6_limits_friction},
        {"joints/arm_with_gripper", "conservation of energy", arm_with_gripper},
        {"joints/bead_on_rotating_rod", "H. Goldstein 1980", bead_on_rotating_rod},
        {"joints/bouncing_slider", "textbook", bouncing_slider},
        {"joints/cardan_gear", "G. Cardano 1570", cardan_gear},
        {"joints/coulomb_oscillator", "J. P. Den Hartog 1930", coulomb_oscillator},
        {"joints/coulomb_pendulum", "energy balance of a half swing", coulomb_pendulum},
        {"joints/driven_slider_crank", "J. J. Uicker et al. 2003", driven_slider_crank},
        {"joints/geared_double_pendulum", "conservation of energy", add_energy},
        {"joints/gripper_closes", "textbook", gripper_closes},
        {"joints/hopper_in_flight", "conservation of momentum", planar_flight},
        {"joints/kapitza_cart", "prescribed motion", kapitza_cart},
        {"joints/pendulum_with_armature", "conservation of energy", pendulum_with_armature},
        {"joints/pendulum_with_rotor", "R. Featherstone 2008", pendulum_with_rotor},
        {"joints/pendulum_with_stops", "F. Pfeiffer and C. Glocker 1996", pendulum_with_stops},
        {"joints/point_mass_double_pendulum", "conservation of energy", add_energy},
        {"joints/rack_and_pinion", "textbook", rack_and_pinion},
        {"joints/reaction_wheels", "F. L. Markley and J. L. Crassidis 2014", reaction_wheels},
        {"joints/runner_in_flight", "conservation of momentum", planar_flight},
        {"joints/screw_jack", "textbook", screw_jack},
        {"joints/stick_slip_belt", "R. I. Leine et al. 1998", stick_slip_belt},
        {"joints/trebuchet", "conservation of energy", add_energy},
    };
    return list;
}

}  // namespace polhode::closed_forms
