#include "check/golden.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "body/orientation.h"
#include "check/file_errors.h"
#include "check/limits.h"
#include "integrators/analysis/conditioning.h"
#include "motion/contact.h"
#include "motion/mechanism_motion.h"
#include "scene/body_hull.h"
#include "scene/scene_file.h"
#include "scene/sphere_contacts.h"
#include "text/content_hash.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

Vector3<double> rounded(const Vector3<Pair>& v) { return {v[0].high, v[1].high, v[2].high}; }

// Converts numbers to a convention's axes and unit of length.
class ConventionConverter {
  public:
    explicit ConventionConverter(const Convention& convention)
        : axes_(convention.axes), unit_(convention.length_unit) {}

    // x in m^power
    double scale(double x, int power) const {
        for (int i = 0; i < power; ++i) x /= unit_;
        return x;
    }
    Vector3<double> scale(const Vector3<double>& v, int power) const {
        return {scale(v[0], power), scale(v[1], power), scale(v[2], power)};
    }
    Vector3<double> vector(const Vector3<double>& v, int power) const { return scale(vector_to(axes_, v), power); }
    Vector3<double> pseudovector(const Vector3<double>& v, int power) const {
        return scale(pseudovector_to(axes_, v), power);
    }
    // M T M^T: transforms the columns of T, then the rows
    Matrix3<double> tensor(const Matrix3<double>& T, int power) const {
        Matrix3<double> half;
        for (int i = 0; i < 3; ++i) half[i] = vector_to(axes_, T[i]);
        half = transposed(half);
        for (int i = 0; i < 3; ++i) half[i] = vector(half[i], power);
        return half;
    }
    Quaternion<double> attitude(const Quaternion<double>& q) const { return quaternion_to(axes_, q); }

    // a force is a vector with unit kg m/s^2, a torque a pseudovector with unit kg m^2/s^2
    void operator()(Gravity& g) const { g.acceleration_W = vector(g.acceleration_W, 1); }
    void operator()(Torque& t) const { t.vector = pseudovector(t.vector, 2); }
    void operator()(Force& f) const { f.vector = vector(f.vector, 1), f.point = vector(f.point, 1); }
    void operator()(Impulse& i) const { i.vector = vector(i.vector, 1), i.point = vector(i.point, 1); }
    void operator()(Drag& d) const {
        const Matrix3<double> T = tensor(diagonal(d.rotational), 2);
        d.rotational = {T[0][0], T[1][1], T[2][2]};
    }
    void operator()(Spring& s) const {
        s.stiffness = scale(s.stiffness, 2), s.rest_orientation = attitude(s.rest_orientation);
    }
    void operator()(UserTorque&) const {}
    void operator()(Motor&) const {}
    void operator()(FormulaLoad&) const {}
    void operator()(PointSpring& s) const {
        s.first_point = vector(s.first_point, 1), s.second_point = vector(s.second_point, 1);
        s.rest_length = scale(s.rest_length, 1);
    }

    // force along a joint's coordinate: kg m/s^2 for prismatic joints, else kg m^2/s^2
    double generalized(const Joint& joint, double force) const {
        return scale(force, joint.type == JointType::prismatic ? 1 : 2);
    }
    void operator()(Joint& j) const {
        const bool slides = j.type == JointType::prismatic;
        j.parent_point = vector(j.parent_point, 1), j.child_point = vector(j.child_point, 1);
        j.parent_orientation = attitude(j.parent_orientation), j.orientation = attitude(j.orientation);
        j.rest_orientation = attitude(j.rest_orientation);
        j.angular_velocity = pseudovector(j.angular_velocity, 0);
        for (std::size_t i = 0; i < 2; ++i) {
            j.axes[i] = slides ? vector(j.axes[i], 0) : pseudovector(j.axes[i], 0);
            for (double* x : {&j.stiffness[i], &j.damping[i], &j.armature[i]}) *x = scale(*x, slides ? 0 : 2);
            for (double* x : {&j.coordinate[i], &j.rate[i], &j.rest[i]}) *x = scale(*x, slides ? 1 : 0);
        }
        j.friction = scale(j.friction, slides ? 1 : 2);
        if (slides) j.limits.lower = scale(j.limits.lower, 1), j.limits.upper = scale(j.limits.upper, 1);
    }
    void operator()(Loop& l) const {
        l.first_point = vector(l.first_point, 1), l.second_point = vector(l.second_point, 1);
        l.first_axis = pseudovector(l.first_axis, 0), l.second_axis = pseudovector(l.second_axis, 0);
        l.length = scale(l.length, 1);
    }
    void operator()(Plane& plane) const {
        // the offset refers to the unit normal
        const double size = length(plane.normal_W);
        plane.offset = scale(plane.offset, 1) / size, plane.normal_W = vector((1 / size) * plane.normal_W, 0);
        plane.torsional_friction = scale(plane.torsional_friction, 1);
        plane.rolling_friction = scale(plane.rolling_friction, 1);
    }
    void operator()(Body& body) const {
        body.source = nullptr;
        body.center_of_mass = vector(body.center_of_mass, 1);
        body.inertia_B = tensor(body.inertia_B, 2);
    }
    void operator()(Initial& start) const {
        start.orientation = attitude(start.orientation);
        start.angular_velocity = pseudovector(start.angular_velocity, 0);
        start.position_W = vector(start.position_W, 1), start.velocity_W = vector(start.velocity_W, 1);
    }

  private:
    Axes axes_;
    double unit_;
};

SupportPiece<double> convert_piece(const ConventionConverter& converter, SupportPiece<double> piece) {
    piece.center = converter.vector(piece.center, 1), piece.radius = converter.scale(piece.radius, 1);
    Matrix3<double> columns = transposed(piece.semi_axes);
    for (int i = 0; i < 3; ++i) columns[i] = converter.vector(columns[i], 1);
    piece.semi_axes = transposed(columns);
    return piece;
}

// Moves a body whose start was rounded back to the planes that it touches. `alone`: a scene of this body.
void restore_contacts(const Scene& alone, Initial& start) {
    if (alone.planes.empty() || !alone.body.source) return;
    const Vector3<double> center = mass_properties<double>(alone.body).center;
    const ContactGeometry<double> geometry = contact_geometry(alone, center, Quaternion<double>{});
    const auto distance = [&](std::size_t plane, const Initial& at) {
        return geometry.distance(plane, {normalized(at.orientation), at.position_W, at.velocity_W, {}});
    };
    constexpr double touching = 1e-9;
    std::vector<std::size_t> touched;
    for (std::size_t k = 0; k < alone.planes.size(); ++k)
        if (distance(k, alone.initial) < touching * geometry.reach) touched.push_back(k);
    // projections onto several planes alternate
    const int most_rounds = touched.size() > 1 ? 200 : 1;
    for (int round = 0; round < most_rounds; ++round)
        for (const std::size_t k : touched)
            start.position_W = start.position_W - distance(k, start) * geometry.planes[k].normal_W;
}

// Attitude error caused by rounding the start to binary32, rad; pi if it is not available.
double measured_float32_floor(const Scene& scene, const Reference& truth) {
    Scene rounded_scene = scene;
    const auto narrow = [](double& x) { x = static_cast<double>(static_cast<float>(x)); };
    // a rounded start does not close loops
    if (!scene.loops.empty()) return std::numbers::pi;
    const auto narrow_attitude = [&](Quaternion<double>& q) {
        for (double* x : {&q.w, &q.x, &q.y, &q.z}) narrow(*x);
        q = normalized(q);
    };
    const auto narrow_start = [&](Initial& start) {
        narrow_attitude(start.orientation);
        for (Vector3<double>* v : {&start.angular_velocity, &start.position_W, &start.velocity_W})
            for (double& x : v->component) narrow(x);
    };
    narrow_start(rounded_scene.initial);
    if (scene.bodies.empty()) restore_contacts(scene, rounded_scene.initial);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        Initial& start = rounded_scene.bodies[b].initial;
        narrow_start(start);
        if (has_sphere_contacts(scene)) restore_contacts(scene_of_sphere(scene, b), start);
    }
    for (Joint& joint : rounded_scene.joints) {
        narrow_attitude(joint.orientation);
        for (double& x : joint.angular_velocity.component) narrow(x);
        for (std::size_t i = 0; i < 2; ++i) narrow(joint.coordinate[i]), narrow(joint.rate[i]);
    }
    std::vector<double> times;
    const std::size_t bodies = static_cast<std::size_t>(truth.bodies);
    for (std::size_t k = 0; k < truth.samples.size(); k += bodies) times.push_back(truth.samples[k].t);
    Reference other;
    try {
        other = reference(rounded_scene, times);
    } catch (const InputError&) {
        // bodies that touch each other at the start may penetrate after rounding
        return std::numbers::pi;
    }
    if (!other.available) return std::numbers::pi;
    double largest = 0;
    for (std::size_t k = 0; k < truth.samples.size(); ++k)
        largest = std::max(largest, rotation_angle_between(truth.samples[k].rounded().q, other.samples[k].rounded().q));
    return largest;
}

void find_floors(const Scene& scene, const Reference& truth, Golden& g) {
    ConditioningSettings settings;
    settings.max_steps = prompt_conditioning_steps;
    const Conditioning kappa = conditioning(scene, sample_times(truth.samples.back().t, 400), settings);
    if (kappa.available) g.float64_floor = kappa.floor_peak(float64_roundoff).value;
    const double floor =
        kappa.available ? kappa.floor_peak(float32_roundoff).value : measured_float32_floor(scene, truth);
    // at pi the attitude is lost
    g.float32_floor = floor < std::numbers::pi ? floor : std::numbers::pi;
}

// Size of the motion as in `check`. It depends on the truth only.
PerMeasure<double> sizes_of(const Scene& scene, const Reference& truth) {
    TrajectoryFile file;
    file.has_angular_velocity = file.has_position = file.has_velocity = true;
    file.bodies = body_names(scene);
    for (const ReferenceSample& s : truth.samples) file.rows.push_back({s.t, s.rounded().q, {}, {}, {}});
    return compute_file_errors(scene, file, truth, ErrorArithmetic::binary64).size;
}

void set_tolerances(const Scene& scene, const PerMeasure<double>& sizes, const Convention& convention, Golden& g) {
    const ErrorLimits limits(scene);
    for (const ErrorBlock& block : error_blocks()) {
        // an engine's test compares the states of bodies
        if (is_of_joints(block.name)) continue;
        const ErrorLimit& limit = limits[block.name];
        GoldenTolerance t{std::string(block.name), limit.value, limit.from};
        const bool by_default = limit.from == "by default", attitude = block.name == "attitude";
        const double least = by_default ? 10 * g.float32_floor : attitude ? g.float32_floor : 0;
        if (least > t.value) {
            t.value = std::min(least, attitude ? std::numbers::pi : 2.0);
            t.from = by_default ? "ten times the float32 floor" : "the float32 floor";
        }
        if (limit.relative && !block.unit.empty()) t.value = std::max(t.value * sizes[block.measure], block.absolute);
        if (block.name == "position" || block.name == "velocity") t.value /= convention.length_unit;
        if (block.name == "angular_velocity" && convention.degrees) t.value *= 180 / std::numbers::pi;
        g.tolerances.push_back(std::move(t));
    }
}

}  // namespace

Scene convert_scene(const Convention& convention, const Scene& scene) {
    const ConventionConverter converter(convention);
    Scene there = scene;
    converter(there.body);
    if (scene.pivot) there.pivot = converter.vector(*scene.pivot, 1);
    converter(there.initial);
    for (NamedBody& body : there.bodies) converter(body.body), converter(body.initial);
    for (Joint& joint : there.joints) converter(joint);
    for (Loop& loop : there.loops) converter(loop);
    for (Load& load : there.loads) {
        std::visit(converter, load);
        if (auto* motor = std::get_if<Motor>(&load))
            motor->force =
                converter.generalized(*std::ranges::find(scene.joints, motor->joint, &Joint::name), motor->force);
    }
    for (Plane& plane : there.planes) converter(plane);
    return there;
}

static GoldenEvent golden_event(const Scene& scene, const DecimalContactEvent& event,
                                const ConventionConverter& converter) {
    const auto number = [](const std::string& decimal) { return parse_decimal(decimal).value_or(0); };
    GoldenEvent result{number(event.t), "", "", event.event, number(event.normal_impulse), {}};
    if (scene.planes.empty() && scene.contacts.empty()) {
        const Joint& joint = scene.joints[event.plane];
        result.body = joint.name, result.impulse = converter.generalized(joint, result.impulse);
        return result;
    }
    const ContactNames names = contact_names(scene, event.plane);
    result.body = names.body, result.other = names.other, result.impulse = converter.scale(result.impulse, 1);
    for (std::size_t i = 0; i < 3; ++i) result.tangential_impulse[i] = number(event.tangential_impulse[i]);
    result.tangential_impulse = converter.vector(result.tangential_impulse, 1);
    return result;
}

Golden golden(const Scene& scene, const Reference& truth, const Convention& convention,
              std::span<const DecimalContactEvent> events) {
    if (!truth.available || truth.samples.empty()) throw std::invalid_argument("no truth available to export");
    const ConventionConverter converter(convention);
    Golden g;
    g.scene_hash = content_hash(write_scene(scene)), g.truth = truth.message, g.convention = convention;
    g.scene = convert_scene(convention, scene);
    const auto add_shape = [&](const Body& body) {
        g.shapes.emplace_back();
        if (!body.source) return;
        for (const SupportPiece<double>& piece : hull<double>(*body.source))
            g.shapes.back().push_back(convert_piece(converter, piece));
    };
    // joints keep bodies apart: their shapes do not affect the motion
    if (scene.bodies.empty()) add_shape(scene.body);
    if (has_sphere_contacts(scene))
        for (const NamedBody& body : scene.bodies) add_shape(body.body);
    for (const DecimalContactEvent& event : events) g.events.push_back(golden_event(scene, event, converter));
    // rounding to binary64 rotates a quaternion by at most 4 2^-53 rad; the relative change of a vector is less
    g.bound = truth.bound + 0x1p-51;
    g.motion.has_angular_velocity = g.motion.has_position = g.motion.has_velocity = true;
    for (const ReferenceSample& s : truth.samples) {
        // w in world axes is computed from both parts of each number and rounded once
        const Quaternion<Wide> exact{Wide(s.q.w.high) + s.q.w.low, Wide(s.q.x.high) + s.q.x.low,
                                     Wide(s.q.y.high) + s.q.y.low, Wide(s.q.z.high) + s.q.z.low};
        Vector3<Wide> w;
        for (int i = 0; i < 3; ++i) w[i] = Wide(s.angular_velocity_B[i].high) + s.angular_velocity_B[i].low;
        const Wide unit = convention.degrees ? Wide(180) / Wide(std::numbers::pi) : Wide(1);
        g.motion.rows.push_back(
            {s.t, converter.attitude(s.rounded().q),
             converter.pseudovector(cast<double>(unit * (convention.body_rates ? w : rotate(exact, w))), 0),
             converter.vector(rounded(s.position_W), 1), converter.vector(rounded(s.velocity_W), 1)});
        // the energy of several bodies is that of the system
        if (!truth.system.empty()) continue;
        g.energy.push_back(converter.scale(s.energy.high, 2));
        g.momentum.push_back(converter.pseudovector(rounded(s.angular_momentum_W), 2));
    }
    g.motion.bodies = body_names(scene);
    for (const ReferenceSystem& system : truth.system) {
        g.energy.push_back(converter.scale(system.energy.high, 2));
        g.momentum.push_back(converter.pseudovector(rounded(system.angular_momentum_W), 2));
    }
    const auto is_known = [](const Reaction<Pair>& r) {
        return !std::isnan(length(rounded(r.force_W)) + length(rounded(r.torque_W)));
    };
    // reactions of redundant constraints are not determined
    if (std::ranges::all_of(truth.reactions, is_known))
        for (const Reaction<Pair>& reaction : truth.reactions) {
            g.forces.push_back(converter.vector(rounded(reaction.force_W), 1));
            g.torques.push_back(converter.pseudovector(rounded(reaction.torque_W), 2));
        }
    const PerMeasure<double> sizes = sizes_of(scene, truth);
    if (sizes["energy"] > 0) g.energy_scale = converter.scale(sizes["energy"], 2);
    if (sizes["momentum"] > 0) g.momentum_scale = converter.scale(sizes["momentum"], 2);
    find_floors(scene, truth, g);
    set_tolerances(scene, sizes, convention, g);
    return g;
}

}  // namespace polhode
