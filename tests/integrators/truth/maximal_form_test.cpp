// Mechanisms in maximal coordinates against closed forms, invariants, the truth of a single body, and Newton's
// equations of each body.
#include "integrators/truth/maximal_form.h"

#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "integrators/truth/euler_form.h"
#include "integrators/truth/jointed_start.h"
#include "integrators/truth/taylor.h"

namespace polhode::maximal {
namespace {

using P = Real<50>;
using truth::Motion;
using V = Vector3<P>;

double size(const P& x) { return std::abs(x.convert_to<double>()); }
double size(const V& v) { return length(v).convert_to<double>(); }

/// A mechanism that also returns the state and the reactions.
struct Shown {
    std::vector<Motion<P>> bodies;
    std::vector<Reaction<P>> reactions;
    std::vector<P> y;
    JointGap<P> gap;
};
struct Form : truth::MaximalForm<P> {
    using Base = truth::MaximalForm<P>;
    explicit Form(const Scene& scene) : Base(scene, jointed_start<P>(scene)) {}
    Shown motion(const P* y) const {
        return {Base::motion(y), reactions(y), std::vector<P>(y, y + dimension()), gap(y)};
    }
};

std::vector<Shown> solved(const Form& form, const Scene& scene, const std::vector<double>& times) {
    const Scales scales{5, 5, 5};
    const auto run =
        truth::taylor<P>(form, itinerary(scene), times, form.blocks(scales), truth::TaylorSettings{42, 34, 1, 20'000});
    EXPECT_EQ(run.fault, "") << scene.name;
    EXPECT_EQ(run.motions.size(), times.size()) << scene.name;
    return run.motions;
}
std::vector<Shown> solved(const Scene& scene, const std::vector<double>& times) {
    return solved(Form(scene), scene, times);
}

V angular_momentum(const Scene& scene, const std::vector<Motion<P>>& bodies) {
    V sum;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const MassProperties<P> m = mass_properties<P>(scene.bodies[b].body);
        sum = sum + rotate(bodies[b].q, m.inertia * bodies[b].angular_velocity_B) +
              m.mass * cross(bodies[b].position_W, bodies[b].velocity_W);
    }
    return sum;
}
V linear_momentum(const Scene& scene, const std::vector<Motion<P>>& bodies) {
    V sum;
    for (std::size_t b = 0; b < bodies.size(); ++b)
        sum = sum + mass_properties<P>(scene.bodies[b].body).mass * bodies[b].velocity_W;
    return sum;
}
P kinetic_energy(const Scene& scene, const std::vector<Motion<P>>& bodies) {
    P sum(0);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const MassProperties<P> m = mass_properties<P>(scene.bodies[b].body);
        const V w = bodies[b].angular_velocity_B, v = bodies[b].velocity_W;
        sum += (dot(w, m.inertia * w) + m.mass * dot(v, v)) / P(2);
    }
    return sum;
}

// a rod on a hinge along y, at rest at 2 rad
Scene pendulum() {
    Scene scene;
    scene.name = "pendulum";
    scene.duration = 4;
    scene.bodies = {{"rod", {1.5, diagonal(Vector3<double>{0.5, 0.375, 0.25}), {0, 0, -0.75}}, {}}};
    Joint joint;
    joint.name = "hinge", joint.child = "rod", joint.parent_point = {0.5, 0.25, 1};
    joint.axes[0] = {0, 1, 0}, joint.coordinate[0] = 2;
    scene.joints = {joint};
    scene.loads = {Gravity{{0, 0, -9.5}, {}}};
    return scene;
}

TEST(MaximalForm, SwingsAsAPendulumInClosedForm) {
    const Scene scene = pendulum();
    const std::vector<double> times{0, 0.5, 1.75, 4};
    const std::vector<Shown> motion = solved(scene, times);
    // sin(x/2) = k sn(W t + K), W^2 = m g l / (I + m l^2), k = sin(x0/2)
    const P moment = P(0.375) + P(1.5) * P(0.75) * P(0.75);
    const P rate = sqrt(P(P(1.5) * P(9.5) * P(0.75) / moment)), k = sin(P(1));
    const P quarter = boost::math::ellint_1(k);
    for (std::size_t i = 0; i < times.size(); ++i) {
        P cn, dn;
        const P sn = boost::math::jacobi_elliptic(k, P(rate * times[i] + quarter), &cn, &dn);
        const Quaternion<P> q = motion[i].bodies[0].q;
        EXPECT_LT(size(P(q.y - k * sn)), 1e-30) << times[i];
        EXPECT_LT(size(P(motion[i].bodies[0].angular_velocity_B[1] - P(2) * k * rate * cn)), 1e-30);
        EXPECT_LT(size(P(motion[i].gap.point + motion[i].gap.turn + motion[i].gap.velocity)), 1e-30);
        // the hinge carries m g cos x + m l x'^2 along the rod and no torque about its axis
        const Reaction<P>& reaction = motion[i].reactions[0];
        const P cosine = 1 - 2 * q.y * q.y, x_rate = P(2) * k * rate * cn;
        const V along = rotate(q, V(P(0), P(0), P(1)));
        const P pull = P(1.5) * (P(9.5) * cosine + P(0.75) * x_rate * x_rate);
        EXPECT_LT(size(P(dot(reaction.force_W, along) - pull)), 1e-28);
        EXPECT_LT(size(reaction.torque_W[1]), 1e-28);
    }
}

TEST(MaximalForm, KeepsEnergyAndMomentaOfFreeTrees) {
    for (unsigned seed = 0; seed < 3; ++seed) {
        const Scene scene = random_tree(seed, 4, true);
        const std::vector<Shown> motion = solved(scene, {0, 0.125});
        EXPECT_LT(size(linear_momentum(scene, motion[1].bodies) - linear_momentum(scene, motion[0].bodies)), 1e-30);
        EXPECT_LT(size(angular_momentum(scene, motion[1].bodies) - angular_momentum(scene, motion[0].bodies)), 1e-30);
        EXPECT_LT(size(P(kinetic_energy(scene, motion[1].bodies) - kinetic_energy(scene, motion[0].bodies))), 1e-30);
        for (const Shown& shown : motion)
            EXPECT_LT(size(P(shown.gap.point + shown.gap.turn + shown.gap.velocity)), 1e-30) << seed;
        EXPECT_GT(size(motion[1].bodies[3].position_W - motion[0].bodies[3].position_W), 1e-2);
    }
}

TEST(MaximalForm, KeepsTheEnergyOfSpringsAndGravity) {
    for (unsigned seed = 0; seed < 3; ++seed) {
        Scene scene = random_tree(seed, 4, false);
        scene.loads = {Gravity{{1, 2, -9}, {}}, PointSpring{"b2", {0.5, 0, 0}, "b3", {0, 0.25, 0}, 5, 0.5, {}},
                       PointSpring{"world", {1, 2, 0}, "b3", {0, 0.25, 0}, 3, 0, {}}};
        for (Joint& joint : scene.joints) {
            joint.stiffness = {3, 2}, joint.rest = {0.25, -0.5};
            joint.rest_orientation = {0.5, 0.5, -0.5, 0.5};
        }
        const Form form(scene);
        const auto energy = [&](const Shown& shown) {
            P sum = kinetic_energy(scene, shown.bodies);
            const auto point = [&](const std::string& name, const Vector3<double>& at) {
                for (std::size_t b = 0; b < scene.bodies.size(); ++b)
                    if (scene.bodies[b].name == name)
                        return V(
                            shown.bodies[b].position_W +
                            rotate(shown.bodies[b].q, V(cast<P>(at) - cast<P>(scene.bodies[b].body.center_of_mass))));
                return cast<P>(at);
            };
            const auto attitude = [&](const std::string& name) {
                for (std::size_t b = 0; b < scene.bodies.size(); ++b)
                    if (scene.bodies[b].name == name) return shown.bodies[b].q;
                return Quaternion<P>{};
            };
            for (std::size_t b = 0; b < scene.bodies.size(); ++b)
                sum -= P(scene.bodies[b].body.mass) * dot(V(P(1), P(2), P(-9)), shown.bodies[b].position_W);
            for (const Load& load : scene.loads)
                if (const auto* tie = std::get_if<PointSpring>(&load)) {
                    const P stretch =
                        length(V(point(tie->second, tie->second_point) - point(tie->first, tie->first_point))) -
                        P(tie->rest_length);
                    sum += P(tie->stiffness) * stretch * stretch / P(2);
                }
            for (std::size_t k = 0; k < scene.joints.size(); ++k) {
                const Joint& joint = scene.joints[k];
                const Link<P>& link = form.mechanism().links[k];
                const P* angles = shown.y.data() + form.dimension() - form.mechanism().turns + link.angles;
                const Quaternion<P> q0 = normalized(cast<P>(joint.parent_orientation));
                const Quaternion<P> turned = conjugate(attitude(joint.parent) * q0) * attitude(joint.child);
                if (joint.type == JointType::spherical) {
                    const V r = vector_part(conjugate(cast<P>(joint.rest_orientation)) * turned);
                    sum += P(2) * P(joint.stiffness[0]) * dot(r, r);
                } else if (joint.type == JointType::prismatic) {
                    const V d = point(joint.child, joint.child_point) - point(joint.parent, joint.parent_point);
                    const V rail = rotate(attitude(joint.parent) * q0, unit(cast<P>(joint.axes[0])));
                    const P x = dot(d, rail) - P(joint.rest[0]);
                    sum += P(joint.stiffness[0]) * x * x / P(2);
                } else if (joint.type != JointType::fixed) {
                    // the angles from the attitude must agree with the counted ones
                    Quaternion<P> J = turn_about(joint.axes[0], angles[0]);
                    if (joint.type == JointType::universal) J = J * turn_about(joint.axes[1], angles[1]);
                    EXPECT_LT(size(vector_part(conjugate(J) * turned)), 1e-30) << seed;
                    for (int i = 0; i < link.coordinates(); ++i) {
                        const P x = angles[i] - P(joint.rest[i]);
                        sum += P(joint.stiffness[i]) * x * x / P(2);
                    }
                }
            }
            return sum;
        };
        const std::vector<Shown> motion = solved(form, scene, {0, 0.125});
        EXPECT_LT(size(P(energy(motion[1]) - energy(motion[0]))), 1e-29) << seed;
        EXPECT_GT(size(P(kinetic_energy(scene, motion[1].bodies) - kinetic_energy(scene, motion[0].bodies))), 1e-2);
    }
}

// m v' and d(R I w)/dt by seventh-order differences of samples h apart
TEST(MaximalForm, ReactionsObeyNewtonsEquationsOfEachBody) {
    for (unsigned seed = 0; seed < 3; ++seed) {
        Scene scene = random_tree(seed, 5, false);
        scene.loads = {Gravity{{1, 2, -9}, {}}, Motor{"to b4", 2, {}}, Motor{"to b3", -1, {}}};
        for (Joint& joint : scene.joints) joint.stiffness = {3, 2}, joint.damping = {0.5, 0.25};
        for (Load& load : scene.loads)
            if (auto* motor = std::get_if<Motor>(&load))
                for (const Joint& joint : scene.joints)
                    if (joint.name == motor->joint && joint.type != JointType::revolute &&
                        joint.type != JointType::prismatic)
                        motor->force = 0;
        constexpr double h = 0x1p-11, middle = 0.0625;
        std::vector<double> times;
        for (int i = -4; i <= 4; ++i) times.push_back(middle + i * h);
        const std::vector<Shown> motion = solved(scene, times);
        static constexpr int weights[] = {3, -32, 168, -672, 0, 672, -168, 32, -3};
        const auto momentum_rate = [&](std::size_t b, bool angular) {
            V sum;
            for (int i = 0; i < 9; ++i) {
                const Motion<P>& m = motion[i].bodies[b];
                const MassProperties<P> body = mass_properties<P>(scene.bodies[b].body);
                const V momentum =
                    angular ? rotate(m.q, body.inertia * m.angular_velocity_B) : body.mass * m.velocity_W;
                sum = sum + P(P(weights[i]) / P(840 * h)) * momentum;
            }
            return sum;
        };
        const Shown& now = motion[4];
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
            const P mass(scene.bodies[b].body.mass);
            V force = mass * V(P(1), P(2), P(-9)), torque;
            for (std::size_t k = 0; k < scene.joints.size(); ++k) {
                const Joint& joint = scene.joints[k];
                const bool is_child = joint.child == scene.bodies[b].name;
                if (!is_child && joint.parent != scene.bodies[b].name) continue;
                // the child's point
                std::size_t c = 0;
                while (scene.bodies[c].name != joint.child) ++c;
                const V point = now.bodies[c].position_W +
                                rotate(now.bodies[c].q,
                                       V(cast<P>(joint.child_point) - cast<P>(scene.bodies[c].body.center_of_mass)));
                const P sign(is_child ? 1 : -1);
                force = force + sign * now.reactions[k].force_W;
                torque = torque + sign * (now.reactions[k].torque_W +
                                          cross(V(point - now.bodies[b].position_W), now.reactions[k].force_W));
            }
            EXPECT_LT(size(force - momentum_rate(b, false)), 1e-20) << seed << " " << b;
            EXPECT_LT(size(torque - momentum_rate(b, true)), 1e-20) << seed << " " << b;
        }
    }
}

TEST(MaximalForm, TopOnASphericalJointIsTheOneBodysOwn) {
    Scene one;
    one.body = {1, diagonal(Vector3<double>{0.75, 0.75, 0.5}), {0, 0, 0.5}};
    one.initial.orientation = {0.9689124217106447, 0.24740395925452294, 0, 0};
    one.initial.angular_velocity = {0, 0, 20};
    one.pivot = Vector3<double>{};
    one.loads = {Gravity{{0, 0, -10}, {}}};
    one.duration = 2;
    Scene scene;
    scene.name = "top", scene.duration = one.duration, scene.loads = one.loads;
    scene.bodies = {{"top", one.body, {}}};
    Joint joint;
    joint.name = "tip", joint.type = JointType::spherical, joint.child = "top";
    joint.child_point = *one.pivot;
    joint.orientation = one.initial.orientation;
    joint.angular_velocity = one.initial.angular_velocity;
    ASSERT_EQ(one.initial.angular_velocity_frame, Frame::body);
    scene.joints = {joint};
    const std::vector<double> times{0, 0.5, 2};
    const Scales scales{30, 1, 10};
    const auto other = truth::taylor<P, truth::EulerForm<P>>(one, times, scales, {0.5, 0.5, 0.5},
                                                             truth::TaylorSettings{42, 36, 1, 20'000});
    const std::vector<Shown> motion = solved(scene, times);
    for (std::size_t i = 0; i < times.size(); ++i) {
        const Motion<P>&a = motion[i].bodies[0], &b = other.motions[i];
        EXPECT_LT(size(vector_part(conjugate(a.q) * b.q)), 1e-28);
        EXPECT_LT(size(a.angular_velocity_B - b.angular_velocity_B), 1e-28);
        EXPECT_LT(size(a.position_W - b.position_W), 1e-28);
        EXPECT_LT(size(a.velocity_W - b.velocity_W), 1e-28);
    }
}

TEST(MaximalForm, SpringsAndMotorsCountTurns) {
    // I x'' = Q - k (x - rest): oscillation about rest + Q/k with W^2 = k/I, from 20 rad, several rotations
    Scene scene = pendulum();
    scene.joints[0].coordinate[0] = 20, scene.joints[0].rate[0] = -3;
    scene.joints[0].stiffness[0] = 2, scene.joints[0].rest[0] = 1;
    scene.loads = {Motor{"hinge", 0.5, {0, 1}}};
    const Form form(scene);
    const P moment = P(0.375) + P(1.5) * P(0.75) * P(0.75), rate = sqrt(P(2) / moment);
    const auto follow = [&](const P& middle, const P& t, P& x, P& v) {
        const P c = cos(P(rate * t)), s = sin(P(rate * t)), from = x - middle, speed = v;
        x = middle + from * c + speed / rate * s, v = speed * c - rate * from * s;
    };
    P x(20), v(-3);
    const std::vector<Shown> motion = solved(form, scene, {0, 1, 4});
    follow(P(1.25), P(1), x, v);
    EXPECT_LT(size(P(motion[1].y.back() - x)), 1e-30);
    follow(P(1), P(3), x, v);
    EXPECT_LT(size(P(motion[2].y.back() - x)), 1e-30);
    EXPECT_LT(size(P(motion[2].bodies[0].angular_velocity_B[1] - v)), 1e-30);
    EXPECT_LT(size(P(motion[2].reactions[0].torque_W[1] + P(2) * (x - P(1)))), 1e-28);
}

TEST(MaximalForm, ImpulsesActThroughAllJoints) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        Scene scene = random_tree(seed, 5, seed % 2 == 0);
        Form form(scene);
        std::vector<P> y(form.dimension());
        form.initial(y.data());
        const std::vector<Motion<P>> before = form.motion(y.data()).bodies;
        const V given(P(1), P(2), P(-3));
        scene.loads = {Impulse{{1, 2, -3}, Frame::world, {0.5, -0.25, 1}, Frame::body, 0, "b3"}};
        form.enter(0, y.data());
        const std::vector<Motion<P>> after = form.motion(y.data()).bodies;
        // joints do no work: the kinetic energy increases by J . (v + v') / 2 at the point
        const V arm = V(P(0.5), P(-0.25), P(1)) - cast<P>(scene.bodies[3].body.center_of_mass);
        const auto speed = [&](const Motion<P>& m) {
            return V(m.velocity_W + rotate(m.q, cross(m.angular_velocity_B, arm)));
        };
        const P work = dot(given, V(speed(before[3]) + speed(after[3]))) / P(2);
        EXPECT_LT(size(P(kinetic_energy(scene, after) - kinetic_energy(scene, before) - work)), 1e-40) << seed;
        EXPECT_GT(size(work), 1e-3);
        const JointGap<P> gap = static_cast<const Form::Base&>(form).gap(y.data());
        EXPECT_LT(size(P(gap.point + gap.turn + gap.velocity)), 1e-40) << seed;
        if (seed % 2 != 0) continue;
        EXPECT_LT(size(linear_momentum(scene, after) - linear_momentum(scene, before) - given), 1e-40) << seed;
        const V point = before[3].position_W + rotate(before[3].q, arm);
        EXPECT_LT(size(angular_momentum(scene, after) - angular_momentum(scene, before) - cross(point, given)), 1e-40);
    }
}

// rods along the edges of a polygon, hinged at each corner about an axis in the world; only one rate is not zero
Scene ring(const std::vector<Vector3<double>>& corners, const std::vector<Vector3<double>>& axes, std::size_t cut) {
    Scene scene;
    scene.name = "ring";
    scene.duration = 2;
    const std::size_t n = corners.size();
    Dice dice(11);
    // the origin and axes of every body are the world's at the start; the first and the last corner are fixed
    for (std::size_t i = 0; i + 1 < n; ++i) {
        Body body = random_body(dice);
        body.center_of_mass = 0.5 * (corners[i] + corners[i + 1]);
        scene.bodies.push_back({"rod" + std::to_string(i), body, {}});
    }
    const auto rod = [&](std::size_t i) { return i + 1 < n ? "rod" + std::to_string(i) : std::string("world"); };
    for (std::size_t corner = 0; corner < n; ++corner) {
        if (corner == cut) continue;
        // before the cut the left body carries the right one, behind it the right one carries the left one
        Joint joint;
        joint.name = "at " + std::to_string(corner);
        const std::size_t left = corner == 0 ? n - 1 : corner - 1, right = corner;
        joint.parent = rod(corner < cut ? left : right), joint.child = rod(corner < cut ? right : left);
        joint.parent_point = joint.child_point = corners[corner];
        joint.axes[0] = axes[corner];
        if (corner < cut)
            scene.joints.push_back(joint);
        else
            scene.joints.insert(scene.joints.begin(), joint);
    }
    Loop loop;
    loop.name = "closure", loop.type = LoopType::revolute;
    loop.first = rod(cut == 0 ? n - 1 : cut - 1), loop.second = rod(cut);
    loop.first_point = loop.second_point = corners[cut], loop.first_axis = loop.second_axis = axes[cut];
    scene.loops = {loop};
    scene.loads = {Gravity{{1, 2, -9}, {}}};
    return scene;
}

void expect_same_wherever_cut(const std::vector<Vector3<double>>& corners, const std::vector<Vector3<double>>& axes,
                              int freedoms, int spare, double duration) {
    std::vector<std::vector<Shown>> motions;
    for (const std::size_t cut : {corners.size() - 1, corners.size() / 2}) {
        Scene scene = ring(corners, axes, cut);
        scene.duration = duration;
        const Form form(scene);
        EXPECT_EQ(6 * static_cast<int>(scene.bodies.size()) - form.dynamics().independent_rows(), freedoms);
        EXPECT_EQ(form.dynamics().rows() - form.dynamics().independent_rows(), spare);
        motions.push_back(solved(form, scene, {0, duration / 2, duration}));
        const auto energy = [&](const Shown& shown) {
            P sum = kinetic_energy(scene, shown.bodies);
            for (std::size_t b = 0; b < scene.bodies.size(); ++b)
                sum -= P(scene.bodies[b].body.mass) * dot(V(P(1), P(2), P(-9)), shown.bodies[b].position_W);
            return sum;
        };
        ASSERT_EQ(motions.back().size(), 3U);
        const Shown& end = motions.back()[2];
        EXPECT_LT(size(P(energy(end) - energy(motions.back()[0]))), 1e-28);
        EXPECT_LT(size(P(end.gap.point + end.gap.turn + end.gap.velocity)), 1e-28);
        EXPECT_GT(size(kinetic_energy(scene, end.bodies)), 1e-2);
    }
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t b = 0; b < motions[0][k].bodies.size(); ++b) {
            const Motion<P>&one = motions[0][k].bodies[b], &other = motions[1][k].bodies[b];
            EXPECT_LT(size(vector_part(conjugate(one.q) * other.q)), 1e-28);
            EXPECT_LT(size(one.velocity_W - other.velocity_W), 1e-28);
        }
}

TEST(MaximalForm, FourBarIsTheSameWhereverItIsCut) {
    // in a plane oblique to all axes: 2 of the closure's 5 equations are independent
    const Vector3<double> e{0.8, 0.6, 0}, f{-0.6, 0.8, 0};
    const auto at = [&](double x, double y) { return Vector3<double>(x * e + y * Vector3<double>{0, 0, 1}); };
    expect_same_wherever_cut({at(0, 0), at(0.25, 1), at(1.25, 1.5), at(1.5, 0.25)}, {f, f, f, f}, 1, 0, 0.25);
}

// Which of the closure's 5 equations is redundant depends on the state, so all are kept.
TEST(MaximalForm, BricardsMechanismIsTheSameWhereverItIsCut) {
    const Vector3<double> x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    expect_same_wherever_cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}}, {y, z, x, y, z, x}, 1,
                             1, 0.25);
}

TEST(MaximalForm, BodyOnARodSwingsAsAPoint) {
    // a free body whose centre of mass has a constant distance of 2 m from the world's origin
    Scene scene;
    scene.name = "rod", scene.duration = 2;
    Dice dice(5);
    Body body = random_body(dice);
    body.center_of_mass = {0.25, 0.5, -0.5};
    Initial initial;
    initial.position_W = {1.2, 0, 1.6};
    initial.velocity_W = {-1.6, 0, 1.2};
    initial.angular_velocity = {1, 2, 3};
    scene.bodies = {{"b", body, initial}};
    Loop loop;
    loop.name = "rod", loop.type = LoopType::distance, loop.second = "b", loop.second_point = body.center_of_mass;
    loop.length = 2;
    scene.loops = {loop};
    scene.loads = {Gravity{{0, 0, -9}, {}}};
    const std::vector<Shown> motion = solved(scene, {0, 2});
    // 1.2 and 1.6 are rounded: the constant distance is that at the start
    const V start = motion[0].bodies[0].position_W, end = motion[1].bodies[0].position_W;
    EXPECT_LT(size(P(dot(end, end) - dot(start, start))), 1e-16);
    const auto energy = [&](const Shown& shown) {
        const Motion<P>& m = shown.bodies[0];
        return P(dot(m.velocity_W, m.velocity_W) / P(2) + P(9) * m.position_W[2]);
    };
    EXPECT_LT(size(P(energy(motion[1]) - energy(motion[0]))), 1e-15);
    EXPECT_LT(size(end[1]), 1e-30);
    // force along the rod: -m (v^2 / l + g . p / l)
    const Motion<P>& m = motion[1].bodies[0];
    const P pull = P(body.mass) * (dot(m.velocity_W, m.velocity_W) - P(9) * m.position_W[2]) / P(2);
    EXPECT_LT(size(P(dot(motion[1].reactions[0].force_W, m.position_W) / P(2) + pull)), 1e-14);
}

}  // namespace
}  // namespace polhode::maximal
