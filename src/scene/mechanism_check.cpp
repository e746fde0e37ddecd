// Validates scenes of several bodies: names, trees of joints, loops and loads.
//
// Names maps names to indices and reports unknown ones with suggestions. carriers() finds the joint of which each
// body is the child and rejects cycles of joints by walking from each body towards the world. Whether the loops close
// is checked later, by the start of the motion (motion/tree_start.h).
#include <algorithm>
#include <cmath>
#include <map>

#include "scene/coupled_joints.h"
#include "scene/joint_file.h"
#include "scene/scene_check.h"
#include "text/decimal.h"

namespace polhode {
namespace {

// Maps names to indices. Reports unknown names with a suggestion.
class Names {
  public:
    // `what`: "body", "joint or loop"; for messages
    Names(const SceneCheck& check, const char* what) : check_(check), what_(what) {}

    void add(const std::string& place, const std::string& name, std::size_t index) {
        check_.text(place, name);
        if (name.empty()) check_.fail(place, "is empty", fmt::format("give the {} a name", what_));
        if (one_line(name, name.size()) != name || name.find_first_of(",\"") != name.npos || name.front() == ' ' ||
            name.back() == ' ')
            check_.fail(
                place, "is not a valid name for tables",
                "use printable characters without commas and quotation marks, and no space at the start or end");
        check_.name(place, name);
        if (name == "world")
            check_.fail(place, "is reserved for the world", fmt::format("give the {} another name", what_));
        const auto [found, is_new] = index_.emplace(name, index);
        if (!is_new)
            check_.fail(place, fmt::format("names a second {} \"{}\"", what_, one_line(name, 60)),
                        fmt::format("give each {} a unique name", what_));
    }
    std::size_t find(const std::string& place, const std::string& name) const {
        const auto found = index_.find(name);
        if (found != index_.end()) return found->second;
        std::vector<std::string> known;
        for (const auto& [one, index] : index_) known.push_back(one);
        const std::string meant = did_you_mean(name, known);
        check_.fail(place, fmt::format("is \"{}\", which is not the name of a {}", one_line(name, 60), what_),
                    !meant.empty()  ? meant
                    : known.empty() ? fmt::format("the scene has no {}", what_)
                                    : "give one of " + join_with_commas(known));
    }

    void set_kind(const char* what) { what_ = what; }

  private:
    const SceneCheck& check_;
    const char* what_;
    std::map<std::string, std::size_t, std::less<>> index_;
};

bool is_default(const Initial& initial) {
    const Initial none;
    return initial.orientation == none.orientation && initial.angular_velocity == none.angular_velocity &&
           initial.position_W == none.position_W && initial.velocity_W == none.velocity_W;
}

void check_numbers(const SceneCheck& check, const std::string& place, const Joint& joint) {
    check.finite(place + "/parent_point", joint.parent_point);
    check.finite(place + "/child_point", joint.child_point);
    check.unit(place + "/parent_orientation", joint.parent_orientation);
    const auto finite = [&](const char* one, const char* two, const std::array<double, 2>& values) {
        if (joint.type != JointType::universal) return check.finite(fmt::format("{}/{}", place, one), values[0]);
        for (int i = 0; i < 2; ++i) check.finite(fmt::format("{}/{}/{}", place, two, i), values[i]);
    };
    switch (joint.type) {
        case JointType::fixed:
            return;
        case JointType::revolute:
            check.direction(place + "/axis", joint.axes[0]);
            finite("initial/angle", "", joint.coordinate), finite("initial/rate", "", joint.rate);
            break;
        case JointType::prismatic:
            check.direction(place + "/axis", joint.axes[0]);
            finite("initial/displacement", "", joint.coordinate), finite("initial/speed", "", joint.rate);
            break;
        case JointType::universal: {
            for (int i = 0; i < 2; ++i) check.direction(fmt::format("{}/axes/{}", place, i), joint.axes[i]);
            const Vector3<Wide> a = cast<Wide>(joint.axes[0]), b = cast<Wide>(joint.axes[1]), across = cross(a, b);
            if (!(dot(across, across) > Wide(1e-12) * dot(a, a) * dot(b, b)))
                check.fail(place + "/axes", "are parallel",
                           "give two axes more than 1e-6 rad apart, or a revolute joint");
            finite("", "initial/angles", joint.coordinate), finite("", "initial/rates", joint.rate);
            break;
        }
        case JointType::spherical:
            check.unit(place + "/initial/orientation", joint.orientation);
            check.finite(place + "/initial/angular_velocity", joint.angular_velocity);
            check.unit(place + "/rest", joint.rest_orientation);
            break;
    }
    finite("stiffness", "stiffness", joint.stiffness), finite("damping", "damping", joint.damping);
    finite("armature", "armature", joint.armature);
    for (const double d : joint.armature)
        if (d < 0)
            check.fail(place + "/armature", fmt::format("is negative ({})", shortest_decimal(d)),
                       "give an inertia >= 0 in kg m^2, or kg for a prismatic joint");
    if (joint.type != JointType::spherical) finite("rest", "rest", joint.rest);
}

// Checks friction, limits and armature, which require a coordinate.
void check_joint_laws(const SceneCheck& check, const std::string& place, const Joint& joint) {
    if (joint.type == JointType::fixed && joint.armature != std::array<double, 2>{})
        check.fail(place + "/armature", "is given for a fixed joint", "remove it: a fixed joint does not move");
    check.finite(place + "/friction", joint.friction);
    if (joint.friction < 0)
        check.fail(place + "/friction", fmt::format("is negative ({})", shortest_decimal(joint.friction)),
                   "give a torque or force >= 0");
    const JointLimits& limits = joint.limits;
    if (joint.friction == 0 && !limits.any()) return;
    const char* key = joint.friction != 0 ? "/friction" : "/limits";
    if (joint.type != JointType::revolute && joint.type != JointType::prismatic)
        check.fail(place + key, fmt::format("is given for a {} joint", name_of(joint.type)),
                   "only revolute and prismatic joints can have friction and limits");
    if (!limits.any()) return;
    if (std::isnan(limits.lower) || std::isnan(limits.upper) || !(limits.lower < limits.upper))
        check.fail(
            place + "/limits",
            fmt::format("have lower {} and upper {}", shortest_decimal(limits.lower), shortest_decimal(limits.upper)),
            "lower must be less than upper");
    if (!(limits.restitution >= 0 && limits.restitution <= 1))
        check.fail(place + "/limits/restitution", fmt::format("is {}", shortest_decimal(limits.restitution)),
                   "give a number from 0 to 1");
    // where dependent joints start is known only later
    const double x = joint.coordinate[0];
    if (!joint.dependent && !(x >= limits.lower && x <= limits.upper))
        check.fail(place + "/initial", fmt::format("has the coordinate {}, outside of the limits", shortest_decimal(x)),
                   "start within the limits");
}

void check_couplings(const SceneCheck& check, const Scene& scene, const Names& joints) {
    for (std::size_t i = 0; i < scene.couplings.size(); ++i) {
        const Coupling& coupling = scene.couplings[i];
        const std::string place = fmt::format("/couplings/{}", i);
        for (const auto& [key, name] : {std::pair{"/first", &coupling.first}, {"/second", &coupling.second}}) {
            const Joint& joint = scene.joints[joints.find(place + key, *name)];
            if (joint.type != JointType::revolute && joint.type != JointType::prismatic)
                check.fail(place + key, fmt::format("is \"{}\", a {} joint", one_line(*name, 60), name_of(joint.type)),
                           "give a revolute or prismatic joint");
        }
        if (coupling.first == coupling.second)
            check.fail(place + "/second", "is the same joint as the first", "give two different joints");
        check.finite(place + "/ratio", coupling.ratio), check.finite(place + "/offset", coupling.offset);
        if (coupling.ratio == 0)
            check.fail(place + "/ratio", "is 0", "give a ratio other than 0, or use a fixed joint");
    }
    for (std::size_t j = 0; !scene.couplings.empty() && j < scene.joints.size(); ++j) {
        if (!scene.joints[j].limits.any()) continue;
        const CoupledLaws<double> laws = coupled_laws(scene, coupled_joints<double>(scene, j));
        if (laws.lower.exists && laws.upper.exists && !(laws.lower.coordinate < laws.upper.coordinate))
            check.fail(fmt::format("/joints/{}/limits", j),
                       fmt::format("and those of coupled joints leave this joint from {} to {}",
                                   shortest_decimal(laws.lower.coordinate), shortest_decimal(laws.upper.coordinate)),
                       "widen the limits: the lower one must be less than the upper one");
    }
}

// Checks each body. A body that a joint carries must have no initial state.
void check_bodies(const SceneCheck& check, const Scene& scene, const std::vector<const Joint*>& carrier) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const NamedBody& one = scene.bodies[i];
        const std::string place = fmt::format("/bodies/{}", i);
        check_body(check, place + "/body", one.body, BodyRole::mechanism);
        if (!carrier[i])
            check_initial(check, place + "/initial", one.initial);
        else if (!is_default(one.initial))
            check.fail(place + "/initial", "is given for a body that is the child of a joint",
                       "remove it: the \"initial\" of the joint defines the start");
    }
}

// The joint of which each body is the child; null for a free body. Rejects cycles.
std::vector<const Joint*> carriers(const SceneCheck& check, const Scene& scene, const Names& bodies) {
    const std::size_t n = scene.bodies.size(), none = n;
    std::vector<const Joint*> carrier(n, nullptr);
    std::vector<std::size_t> parent(n, none);
    for (std::size_t i = 0; i < scene.joints.size(); ++i) {
        const Joint& joint = scene.joints[i];
        const std::string place = fmt::format("/joints/{}", i);
        if (joint.child == "world")
            check.fail(place + "/child", "is \"world\"",
                       "make \"world\" the parent: it cannot be the child of a joint");
        const std::size_t child = bodies.find(place + "/child", joint.child);
        if (carrier[child])
            check.fail(place + "/child",
                       fmt::format("is \"{}\", which is already the child of joint \"{}\"", one_line(joint.child, 60),
                                   one_line(carrier[child]->name, 60)),
                       "a body can be the child of only one joint: close the chain by one of \"loops\"");
        carrier[child] = &joint;
        if (joint.parent != "world") parent[child] = bodies.find(place + "/parent", joint.parent);
    }
    // each walk ends at the world, at a free body or at a body visited by an earlier walk
    std::vector<std::size_t> walk(n, none);
    for (std::size_t start = 0; start < n; ++start)
        for (std::size_t at = start; at != none && walk[at] != start; at = parent[at]) {
            if (walk[at] != none) break;
            walk[at] = start;
            if (parent[at] != none && walk[parent[at]] == start)
                check.fail(fmt::format("/joints/{}", carrier[at] - scene.joints.data()),
                           fmt::format("closes a cycle of joints at body \"{}\"", one_line(carrier[at]->parent, 60)),
                           "joints must form trees: close the chain by one of \"loops\"");
        }
    return carrier;
}

void check_ends(const SceneCheck& check, const std::string& place, const Names& bodies, const std::string& first,
                const std::string& second) {
    if (first != "world") bodies.find(place + "/first", first);
    if (second != "world") bodies.find(place + "/second", second);
    if (first == second)
        check.fail(place + "/second", fmt::format("is \"{}\", the same as the first", one_line(second, 60)),
                   "give two different bodies, or a body and \"world\"");
}

void check_loops(const SceneCheck& check, const Scene& scene, const Names& bodies) {
    for (std::size_t i = 0; i < scene.loops.size(); ++i) {
        const Loop& loop = scene.loops[i];
        const std::string place = fmt::format("/loops/{}", i);
        check_ends(check, place, bodies, loop.first, loop.second);
        check.finite(place + "/first_point", loop.first_point),
            check.finite(place + "/second_point", loop.second_point);
        if (loop.type == LoopType::revolute) {
            check.direction(place + "/first_axis", loop.first_axis);
            check.direction(place + "/second_axis", loop.second_axis);
        }
        if (loop.type == LoopType::distance) check.positive(place + "/length", loop.length, "a length in m");
    }
}

struct NamesInLoad {
    const SceneCheck& check;
    const Scene& scene;
    const std::string& place;
    const Names &bodies, &joints;

    void operator()(const Gravity&) const {}
    void operator()(const UserTorque&) const {
        check.fail(place, "is a user-defined torque, which scenes with several bodies do not support",
                   "give a load of type torque or force with \"body\", or a motor on a joint");
    }
    JointType check_motor(const std::string& name) const {
        const JointType type = scene.joints[joints.find(place + "/joint", name)].type;
        if (type != JointType::revolute && type != JointType::prismatic)
            check.fail(place + "/joint", fmt::format("is \"{}\", a {} joint", one_line(name, 60), name_of(type)),
                       "give a revolute or prismatic joint");
        return type;
    }
    void check_body(const std::string& name) const {
        if (name.empty())
            check.fail(place, "does not name a body", "give \"body\": the name of the body that the load acts on");
        bodies.find(place + "/body", name);
    }
    void operator()(const Motor& load) const {
        const JointType type = check_motor(load.joint);
        check.finite(place + (type == JointType::revolute ? "/torque" : "/force"), load.force);
    }
    void operator()(const FormulaLoad& load) const {
        if (load.kind == FormulaKind::motor)
            check_motor(load.joint);
        else if (load.kind != FormulaKind::potential || !load.body.empty())
            check_body(load.body);
    }
    void operator()(const PointSpring& load) const { check_ends(check, place, bodies, load.first, load.second); }
    void operator()(const auto& load) const { check_body(load.body); }
};

}  // namespace

void check_mechanism(const SceneCheck& check, const Scene& scene) {
    if (scene.pivot)
        check.fail("/pivot", "is given together with \"bodies\"",
                   "connect a body to the world by a joint whose parent is \"world\"");
    Names bodies(check, "body"), joints(check, "joint or loop");
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        bodies.add(fmt::format("/bodies/{}/name", i), scene.bodies[i].name, i);
    for (std::size_t i = 0; i < scene.joints.size(); ++i)
        joints.add(fmt::format("/joints/{}/name", i), scene.joints[i].name, i);
    // motors act only on joints, not on loops
    Names moving = joints;
    moving.set_kind("joint");
    for (std::size_t i = 0; i < scene.loops.size(); ++i)
        joints.add(fmt::format("/loops/{}/name", i), scene.loops[i].name, i);
    check_bodies(check, scene, carriers(check, scene, bodies));
    const auto is_fixed = [](const Joint& joint) { return joint.type == JointType::fixed; };
    if (scene.joints.size() == scene.bodies.size() && std::ranges::all_of(scene.joints, is_fixed))
        check.fail("/joints", "fix every body to the world, so nothing moves",
                   "change the type of one of them, or remove it");
    for (std::size_t i = 0; i < scene.joints.size(); ++i) {
        const std::string place = fmt::format("/joints/{}", i);
        check_numbers(check, place, scene.joints[i]);
        check_joint_laws(check, place, scene.joints[i]);
        if (!scene.joints[i].dependent) continue;
        const JointType type = scene.joints[i].type;
        if (type != JointType::revolute && type != JointType::prismatic)
            check.fail(place + "/initial/dependent", "is given for a joint with several coordinates",
                       "only revolute and prismatic joints can be dependent");
        if (scene.loops.empty() && scene.couplings.empty())
            check.fail(place + "/initial/dependent", "is given in a scene without loops",
                       "remove it, or close a chain by one of \"loops\"");
    }
    check_loops(check, scene, bodies);
    check_couplings(check, scene, moving);
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
        const std::string place = fmt::format("/loads/{}", i);
        std::visit(NamesInLoad{check, scene, place, bodies, moving}, scene.loads[i]);
    }
}

void check_single_body_names(const SceneCheck& check, const Scene& scene) {
    const std::pair<const char*, bool> parts[] = {{"joints", !scene.joints.empty()},
                                                  {"loops", !scene.loops.empty()},
                                                  {"couplings", !scene.couplings.empty()},
                                                  {"contacts", !scene.contacts.empty()}};
    for (const auto& [key, is_given] : parts)
        if (is_given)
            check.fail(fmt::format("/{}", key), "are given together with \"body\"",
                       "use \"bodies\" instead of \"body\"");
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
        const std::string place = fmt::format("/loads/{}", i);
        if (const std::string name = load_body(scene.loads[i]); !name.empty())
            check.fail(place + "/body", fmt::format("is \"{}\" in a scene with one body", one_line(name, 60)),
                       "remove it, or use \"bodies\" instead of \"body\"");
        if (std::holds_alternative<Motor>(scene.loads[i]) || std::holds_alternative<PointSpring>(scene.loads[i]))
            check.fail(place, "acts between several bodies, but the scene has one",
                       "use \"bodies\" instead of \"body\"");
    }
}

}  // namespace polhode
