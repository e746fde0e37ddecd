// Converts a Robot (links and joints as read from a file) to bodies and joints of a scene.
//
// RobotMerger first gives every root a fixed or free joint. merge() then works from the leaves of the trees to their
// roots: it moves tensors of links without mass to links that they are fixed to, merges or drops massless links,
// combines two hinges that meet at a massless link into a universal joint, and merges links whose inertia tensor is
// impossible with links that they are fixed to. It repairs or refuses the remaining impossible tensors
// (inertia_repair.h). build() rounds each number once to binary64 and adds gravity, drag and the notes.

#include "scene/robot_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "body/rigid_body.h"
#include "scene/inertia_repair.h"
#include "scene/robot_actuators.h"
#include "scene/robot_chains.h"
#include "scene/robot_parts.h"
#include "scene/scene_limits.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

// Merges links and builds the scene; see above.
class RobotMerger {
  public:
    RobotMerger(const Robot& robot, const RobotOptions& options, const std::string& path)
        : robot_(robot), options_(options), path_(path) {
        if (options.limits_and_friction) note_laws();
        expand_robot_joints(robot_, options.limits_and_friction);
        carrier_.assign(robot_.links.size(), none);
        for (std::size_t j = 0; j < robot_.joints.size(); ++j) carrier_[robot_.joints[j].child] = j;
        robot_.places.resize(robot_.links.size());
        const bool format_default = options.base == RobotBase::format_default;
        connect_roots(format_default ? robot_.roots_are_free : options.base == RobotBase::free);
        children_.resize(robot_.links.size());
        for (std::size_t j = 0; j < robot_.joints.size(); ++j)
            if (robot_.joints[j].parent != RobotJoint::world) children_[robot_.joints[j].parent].push_back(j);
        removed_.assign(robot_.links.size(), false);
    }

    // works from the leaves of the trees to their roots
    void merge() {
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < robot_.links.size(); ++i)
            if (joint_of(i).parent == RobotJoint::world) order.push_back(i);
        for (std::size_t k = 0; k < order.size(); ++k)
            for (const std::size_t j : children_[order[k]]) order.push_back(robot_.joints[j].child);
        if (order.size() < robot_.links.size())
            throw InputError(path_, "", "has joints that form a cycle",
                             "joints must form a tree: close chains by \"loops\" in the scene");
        for (std::size_t k = order.size(); k-- > 0;) move_tensor(order[k]);
        for (std::size_t k = order.size(); k-- > 0;)
            if (!robot_.links[order[k]].mass) merge_link(order[k]);
        // a link that is fixed to another link does not need a possible tensor of its own
        for (std::size_t k = order.size(); k-- > 0;)
            if (!removed_[order[k]] && has_impossible_tensor(order[k])) merge_impossible(order[k]);
        for (const std::size_t i : order)
            if (!removed_[i]) repair(i);
    }

    void build(Scene& scene) {
        for (std::size_t i = 0; i < robot_.links.size(); ++i)
            if (!removed_[i]) build_link(i, scene);
        if (scene.bodies.empty())
            throw InputError(path_, "", "has no link with a mass", "give at least one link an <inertial>");
        require_motion();
        for (const Robot::Coupling& coupling : robot_.couplings) add_coupling(coupling, scene);
        start_coupled_joints(scene);
        for (const Robot::Loop& loop : robot_.loops) add_loop(loop, scene);
        for (const Robot::FreeDamping& damping : robot_.free_damping) add_drag(damping, scene);
        if (robot_.gravity_W && !options_.scene_has_gravity) {
            const Vector3<double>& g = *robot_.gravity_W;
            scene.loads.push_back(Gravity{g, {}});
            scene.assumed.push_back(fmt::format("gravity ({}, {}, {}) m/s^2: {}", shortest_decimal(g[0]),
                                                shortest_decimal(g[1]), shortest_decimal(g[2]), robot_.gravity_source));
        } else if (robot_.gravity_W) {
            scene.assumed.push_back(fmt::format("gravity: the scene's load, instead of {}", robot_.gravity_source));
        } else if (!options_.scene_has_gravity) {
            scene.assumed.push_back("gravity: none; neither the file nor the scene defines it");
        }
        add_actuators(robot_, options_, path_, scene);
        for (const auto& [what, names] : robot_.assumed) scene.assumed.push_back(format_note(what, names));
        for (const auto& [what, names] : robot_.omitted) scene.omitted.push_back(format_note(what, names));
    }

  private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    static constexpr double heavy = 1e5;  // kg

    RobotJoint& joint_of(std::size_t link) { return robot_.joints[carrier_[link]]; }
    const RobotJoint& joint_of(std::size_t link) const { return robot_.joints[carrier_[link]]; }

    [[noreturn]] void fail(const std::string& place, const std::string& fault, const std::string& remedy) const {
        throw InputError(path_, place, fault, remedy);
    }

    // The place with the file's name; empty if the file does not state it.
    std::string full_place(const std::string& place) const {
        return place.empty() ? "" : fmt::format("{}: {}", one_line(path_, 200), place);
    }

    void connect_roots(bool are_free) {
        std::set<std::string, std::less<>> names;
        for (const RobotJoint& joint : robot_.joints) names.insert(joint.name);
        for (std::size_t i = 0; i < robot_.links.size(); ++i) {
            if (carrier_[i] != none) continue;
            RobotJoint joint;
            joint.name = robot_.links[i].name + "_base";
            while (names.contains(joint.name)) joint.name += "_";
            names.insert(joint.name);
            joint.place = robot_.links[i].place, joint.child = i;
            joint.motion = are_free ? RobotMotion::free : RobotMotion::fixed;
            joint.placement = robot_.places[i];
            carrier_[i] = robot_.joints.size();
            robot_.joints.push_back(std::move(joint));
        }
    }

    void note(const char* what, const std::string& name) { robot_.omitted[what].push_back(name); }
    void note_assumed(const char* what, const std::string& name) { robot_.assumed[what].push_back(name); }

    void merge_link(std::size_t i) {
        const RobotLink& link = robot_.links[i];
        RobotJoint& joint = joint_of(i);
        std::vector<std::size_t>& children = children_[i];
        const auto child = std::find_if(children.begin(), children.end(),
                                        [&](std::size_t j) { return robot_.joints[j].motion == RobotMotion::fixed; });
        removed_[i] = true;
        if (children.empty()) {
            if (joint.parent != RobotJoint::world) std::erase(children_[joint.parent], carrier_[i]);
            // a massless leaf moves nothing, and its own motion is undetermined
            if (joint.motion != RobotMotion::fixed && joint.motion != RobotMotion::free)
                note("links without mass at moving joints, dropped with their joints", link.name);
            else if (joint.parent != RobotJoint::world || robot_.links.size() > 1)
                note_assumed("links without mass, dropped", link.name);
        } else if (joint.motion == RobotMotion::fixed) {
            merge_up(i, joint, "links without mass, merged");
        } else if (child != children.end()) {
            merge_down(i, joint, *child, "links without mass, merged");
        } else if (is_universal(joint, children)) {
            make_universal(i, joint, children[0]);
        } else {
            // keep it as a massless body; the scene's mass matrix determines whether it can move
            removed_[i] = false;
            robot_.links[i].mass = MassProperties<Wide>{};
            note_assumed("links without mass between moving joints", link.name);
        }
    }

    // attaches the children of link i to its parent
    void merge_up(std::size_t i, const RobotJoint& joint, const char* heading) {
        if (joint.parent != RobotJoint::world) std::erase(children_[joint.parent], carrier_[i]);
        for (const std::size_t j : children_[i]) {
            RobotJoint& below = robot_.joints[j];
            below.placement = joint.placement * below.placement, below.parent = joint.parent;
            if (joint.parent != RobotJoint::world) children_[joint.parent].push_back(j);
        }
        children_[i].clear();
        note_assumed(heading, robot_.links[i].name);
    }

    // replaces link i by the child that is fixed to it, with the child's frame
    void merge_down(std::size_t i, RobotJoint& joint, std::size_t fixed, const char* heading) {
        const RobotJoint fixed_joint = robot_.joints[fixed];
        const std::size_t c = fixed_joint.child;
        const RobotPose back = inverse(fixed_joint.placement);
        joint.placement = joint.placement * fixed_joint.placement;
        joint.point = back * joint.point;
        for (Vector3<Wide>& axis : joint.axes) axis = rotate(back.turn, axis);
        joint.child = c, carrier_[c] = carrier_[i];
        for (const std::size_t j : children_[i]) {
            if (j == fixed) continue;
            robot_.joints[j].placement = back * robot_.joints[j].placement, robot_.joints[j].parent = c;
            children_[c].push_back(j);
        }
        children_[i].clear();
        note_assumed(heading, robot_.links[i].name);
    }

    // Two hinge axes and their distance, in the frame of the link between them.
    struct HingePair {
        Vector3<Wide> p, a, b, n, d;
        Wide across = 0;
    };
    HingePair hinge_pair(const RobotJoint& joint, const RobotJoint& second) const {
        HingePair m;
        m.p = joint.point, m.a = joint.axes[0];
        m.d = second.placement * second.point - m.p, m.b = rotate(second.placement.turn, second.axes[0]);
        m.n = cross(m.a, m.b), m.across = dot(m.n, m.n);
        return m;
    }
    bool is_universal(const RobotJoint& joint, const std::vector<std::size_t>& children) const {
        if (joint.motion != RobotMotion::revolute || children.size() != 1) return false;
        const RobotJoint& second = robot_.joints[children[0]];
        if (second.motion != RobotMotion::revolute) return false;
        // a universal joint has neither friction nor limits
        if (options_.limits_and_friction && (joint.has_law() || second.has_law())) return false;
        const HingePair m = hinge_pair(joint, second);
        const Wide apart = dot(m.d, m.n);
        return m.across > Wide(1e-12) * dot(m.a, m.a) * dot(m.b, m.b) &&
               apart * apart <= Wide(1e-18) * dot(m.d, m.d) * m.across;
    }

    void make_universal(std::size_t i, RobotJoint& joint, std::size_t second_joint) {
        const RobotJoint& second = robot_.joints[second_joint];
        const auto [p, a, b, n, d, across] = hinge_pair(joint, second);
        const Vector3<Wide> meeting = p + (dot(cross(d, b), n) / across) * a;
        const RobotPose back = inverse(second.placement);
        const std::size_t c = second.child;
        joint.motion = RobotMotion::universal;
        joint.name += "+" + second.name;
        joint.axes = {rotate(back.turn, a), second.axes[0]};
        joint.point = back * meeting;
        joint.placement = joint.placement * second.placement;
        joint.stiffness[1] = second.stiffness[0], joint.rest[1] = second.rest[0], joint.damping[1] = second.damping[0];
        joint.armature[1] = second.armature[0], joint.start[1] = second.start[0];
        joint.child = c, carrier_[c] = carrier_[i];
        children_[i].clear();
        note_assumed("pairs of hinges converted to one universal joint", joint.name);
    }

    // Adds the tensor of a link with mass 0 to a link that is fixed to it.
    void move_tensor(std::size_t i) {
        RobotLink& link = robot_.links[i];
        if (!link.mass || link.mass->mass > Wide(0)) return;
        const MassProperties<Wide> tensor = *link.mass;
        link.mass.reset();
        if (tensor.inertia == Matrix3<Wide>()) return;
        const RobotJoint& joint = joint_of(i);
        const auto fixed_joint = std::find_if(children_[i].begin(), children_[i].end(), [&](std::size_t j) {
            return robot_.joints[j].motion == RobotMotion::fixed && robot_.links[robot_.joints[j].child].mass;
        });
        if (joint.motion == RobotMotion::fixed) {
            if (joint.parent != RobotJoint::world) add_mass(joint.parent, tensor, joint.placement);
        } else if (fixed_joint != children_[i].end()) {
            add_mass(robot_.joints[*fixed_joint].child, tensor, inverse(robot_.joints[*fixed_joint].placement));
        } else {
            return note("inertia tensors of links with mass 0", link.name);
        }
        note_assumed("inertia tensors of links with mass 0, added to the links they are fixed to", link.name);
    }

    bool has_impossible_tensor(std::size_t i) const {
        const std::optional<MassProperties<Wide>>& mass = robot_.links[i].mass;
        return mass && repair_inertia(mass->inertia).excess > 0;
    }

    // Merges the link with one that is fixed to it, or with the world, where its mass has no effect.
    void merge_impossible(std::size_t i) {
        RobotLink& link = robot_.links[i];
        const RobotJoint joint = joint_of(i);
        if (joint.motion == RobotMotion::fixed) {
            removed_[i] = true;
            if (joint.parent == RobotJoint::world) {
                link.mass.reset();
                merge_up(i, joint, "links fixed to the world with an impossible inertia tensor, which has no effect");
                return;
            }
            add_mass(joint.parent, *link.mass, joint.placement);
            return merge_up(i, joint, "links with an impossible inertia tensor, merged with their parents");
        }
        for (const std::size_t j : children_[i]) {
            if (robot_.joints[j].motion != RobotMotion::fixed) continue;
            removed_[i] = true;
            add_mass(robot_.joints[j].child, *link.mass, inverse(robot_.joints[j].placement));
            return merge_down(i, joint_of(i), j, "links with an impossible inertia tensor, merged with their children");
        }
    }

    // `place`: pose of the added mass's frame in the link
    void add_mass(std::size_t link, const MassProperties<Wide>& mass, const RobotPose& place) {
        std::optional<MassProperties<Wide>>& whole = robot_.links[link].mass;
        const MassProperties<Wide> added = placed(mass, place.position, place.turn);
        whole = whole ? composite(std::vector<MassProperties<Wide>>{*whole, added}) : added;
    }

    void repair(std::size_t i) {
        RobotLink& link = robot_.links[i];
        if (!link.mass) return;
        const InertiaRepair repair = repair_inertia(link.mass->inertia);
        if (repair.excess == 0) return;
        if (!repair.is_small && !options_.balance_inertia)
            fail(link.place, fmt::format("link \"{}\" {}", one_line(link.name, 60), repair.description()),
                 "correct the tensor, or permit the smallest correction by \"balance_inertia\": true");
        link.mass->inertia = repair.inertia;
        robot_.assumed["inertia tensors corrected by the smallest change of the principal moments"].push_back(
            fmt::format("{} (excess {:.3g} of the largest moment {:.6g} kg m^2, largest change {:.3g} kg m^2)",
                        one_line(link.name, 60), repair.excess, repair.largest, repair.change));
    }

    // Throws if no link can move.
    void require_motion() const {
        const RobotLink* first = nullptr;
        for (std::size_t i = 0; i < robot_.links.size(); ++i) {
            if (removed_[i]) continue;
            if (joint_of(i).motion != RobotMotion::fixed) return;
            if (!first) first = &robot_.links[i];
        }
        const std::string name = one_line(first->name, 60);
        fail(first->place, fmt::format("cannot move: \"{}\" and all other links are fixed to the world", name),
             "free the robot by \"base\": \"free\" in the import, or add a movable joint");
    }

    void add_coupling(const Robot::Coupling& coupling, Scene& scene) {
        const auto find = [&](const std::string& name) -> Joint* {
            for (Joint& joint : scene.joints)
                if (joint.name == name && (joint.type == JointType::revolute || joint.type == JointType::prismatic))
                    return &joint;
            return nullptr;
        };
        Joint* const second = find(coupling.second);
        if (!second || !find(coupling.first) || second == find(coupling.first) || coupling.ratio == 0)
            return note("mimic joints of a joint that has been merged or does not move", coupling.second);
        second->dependent = true;
        scene.couplings.push_back({coupling.first, coupling.second, coupling.ratio, coupling.offset});
    }

    // Names of loops and joints are unique.
    void add_loop(const Robot::Loop& from, Scene& scene) {
        const auto is_gone = [&](std::size_t link) { return link != RobotJoint::world && removed_[link]; };
        if (is_gone(from.first) || is_gone(from.second)) return note("loops of links that have been merged", from.name);
        const auto name_of = [&](std::size_t link) {
            return link == RobotJoint::world ? std::string("world") : robot_.links[link].name;
        };
        const auto is_taken = [&](const std::string& name) {
            const auto has_name = [&](const auto& one) { return one.name == name; };
            return std::ranges::any_of(scene.joints, has_name) || std::ranges::any_of(scene.loops, has_name);
        };
        Loop loop;
        loop.name = from.name;
        while (is_taken(loop.name)) loop.name += "_";
        loop.type = LoopType::spherical;
        loop.first = name_of(from.first), loop.second = name_of(from.second);
        loop.first_point = round_to_double(from.first_point), loop.second_point = round_to_double(from.second_point);
        scene.loops.push_back(std::move(loop));
    }

    // The second joint of a coupling starts where the first requires it. Its limits are omitted if they exclude that.
    void start_coupled_joints(Scene& scene) {
        const auto find = [&](const std::string& name) {
            return std::ranges::find_if(scene.joints, [&](const Joint& one) { return one.name == name; });
        };
        for (std::size_t round = 0; round < scene.couplings.size(); ++round)
            for (const Coupling& coupling : scene.couplings)
                find(coupling.second)->coordinate[0] =
                    coupling.ratio * find(coupling.first)->coordinate[0] + coupling.offset;
        for (const Coupling& coupling : scene.couplings) {
            Joint& second = *find(coupling.second);
            const double x = second.coordinate[0];
            if (second.limits.lower <= x && x <= second.limits.upper) continue;
            second.limits = {};
            note("limits of coupled joints, which exclude their start", second.name);
        }
    }

    // Moves limits and friction that are modelled from the notes about omissions to those about assumptions.
    void note_laws() {
        std::vector<std::string> modelled;
        for (const RobotJoint& joint : robot_.joints)
            if (joint.has_law()) modelled.push_back(joint.name);
        for (const char* what : {"joint limits", "joint friction"}) remove_notes(robot_, what, modelled);
        if (!modelled.empty())
            robot_.assumed["limits and friction of joints by rigid laws, with restitution 0"] = modelled;
    }

    // A drag load acts at the centre of mass; damping of a free joint acts at the origin of its link.
    void add_drag(const Robot::FreeDamping& damping, Scene& scene) {
        const RobotLink& link = robot_.links[damping.link];
        const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                       [&](const NamedBody& one) { return one.name == link.name; });
        if (body == scene.bodies.end() ||
            !(damping.translational == 0 || body->body.center_of_mass == Vector3<double>()))
            return note("damping of free joints away from the centre of mass", link.name);
        const double c = damping.rotational;
        scene.loads.push_back(Drag{{c, c, c}, damping.translational, {}, link.name});
    }

    // rounds to binary64 without negative zeros
    static double round_to_double(const Wide& x) { return double(x) + 0.0; }
    static Vector3<double> round_to_double(const Vector3<Wide>& v) {
        return {round_to_double(v[0]), round_to_double(v[1]), round_to_double(v[2])};
    }
    static Quaternion<double> round_to_double(const Quaternion<Wide>& q) {
        return {round_to_double(q.w), round_to_double(q.x), round_to_double(q.y), round_to_double(q.z)};
    }

    // World pose of the child of a free joint. Returns nothing if a link above it moves.
    std::optional<RobotPose> free_place(const RobotJoint& joint) const {
        RobotPose place = joint.placement;
        for (std::size_t at = joint.parent; at != RobotJoint::world;) {
            const RobotJoint& above = joint_of(at);
            if (above.motion != RobotMotion::fixed) return {};
            place = above.placement * place, at = above.parent;
        }
        return place;
    }

    void build_link(std::size_t i, Scene& scene) {
        const RobotLink& link = robot_.links[i];
        const RobotJoint& joint = joint_of(i);
        NamedBody one;
        one.name = link.name, one.place = full_place(link.place);
        one.body.mass = double(link.mass->mass);
        one.body.center_of_mass = round_to_double(link.mass->center);
        one.body.inertia_B = round_tensor(link.mass->inertia);
        if (link.gravity_compensation != 0) compensate_gravity(link, scene);
        if (one.body.mass > heavy)
            note_assumed("links heavier than 1e5 kg: check the units of lengths and densities",
                         fmt::format("{} ({:.4g} kg)", one_line(link.name, 60), one.body.mass));
        if (joint.motion == RobotMotion::free) {
            const std::optional<RobotPose> place = free_place(joint);
            if (!place)
                fail(joint.place,
                     fmt::format("joint \"{}\" is a free joint below a moving link", one_line(joint.name, 60)),
                     "make its parent the world or a link that is fixed to the world");
            one.initial.orientation = round_to_double(place->turn);
            one.initial.position_W = round_to_double(*place * link.mass->center);
        } else {
            scene.joints.push_back(make_joint(joint));
        }
        scene.bodies.push_back(std::move(one));
    }

    // A force that carries a part of the weight of a link.
    void compensate_gravity(const RobotLink& link, Scene& scene) {
        if (!robot_.gravity_W || options_.scene_has_gravity) return;
        for (const char* what : {"gravity compensation of bodies", "links without gravity"})
            remove_notes(robot_, what, {link.name});
        if (*robot_.gravity_W == Vector3<double>()) return;
        Force lift;
        lift.body = link.name, lift.point = round_to_double(link.mass->center);
        lift.vector =
            round_to_double((Wide(-link.gravity_compensation) * link.mass->mass) * cast<Wide>(*robot_.gravity_W));
        scene.loads.push_back(lift);
        note_assumed("gravity compensation as a force at the centre of mass", link.name);
    }

    // Starts a joint at the nearest limit if its limits exclude its coordinate.
    void limit_start(Joint& joint) {
        const double x = std::clamp(joint.coordinate[0], joint.limits.lower, joint.limits.upper);
        if (x == joint.coordinate[0]) return;
        joint.coordinate[0] = x;
        note_assumed("joints that start at a limit, because their limits exclude the coordinate of the file",
                     fmt::format("{} ({})", one_line(joint.name, 60), shortest_decimal(x)));
    }

    Joint make_joint(const RobotJoint& from) {
        Joint joint;
        joint.name = from.name, joint.place = full_place(from.place);
        joint.type = from.motion == RobotMotion::revolute    ? JointType::revolute
                     : from.motion == RobotMotion::prismatic ? JointType::prismatic
                     : from.motion == RobotMotion::spherical ? JointType::spherical
                     : from.motion == RobotMotion::universal ? JointType::universal
                                                             : JointType::fixed;
        if (from.parent != RobotJoint::world) joint.parent = robot_.links[from.parent].name;
        joint.child = robot_.links[from.child].name;
        joint.parent_point = round_to_double(from.placement * from.point);
        joint.child_point = round_to_double(from.point);
        joint.parent_orientation = round_to_double(from.placement.turn);
        const std::size_t axes = joint.type == JointType::universal                                        ? 2
                                 : joint.type == JointType::revolute || joint.type == JointType::prismatic ? 1
                                                                                                           : 0;
        for (std::size_t k = 0; k < axes; ++k) {
            joint.coordinate[k] = from.start[k];
            joint.axes[k] = round_to_double(from.axes[k]);
            joint.stiffness[k] = round_to_double(from.stiffness[k]), joint.rest[k] = round_to_double(from.rest[k]);
        }
        if (options_.limits_and_friction && axes == 1) {
            joint.friction = from.friction[0], joint.limits = from.limits[0];
            limit_start(joint);
        }
        if (joint.type != JointType::fixed)
            for (std::size_t k = 0; k < std::max<std::size_t>(axes, 1); ++k)
                joint.damping[k] = round_to_double(from.damping[k]),
                joint.armature[k] = round_to_double(from.armature[k]);
        return joint;
    }

    // "limits of joints: a, b, c"; long lists end with their number of entries
    static std::string format_note(const std::string& what, const std::vector<std::string>& names) {
        constexpr std::size_t most = 8;
        std::vector<std::string> unique_names;
        for (const std::string& name : names)
            if (!name.empty() && unique_names.size() < most &&
                std::find(unique_names.begin(), unique_names.end(), name) == unique_names.end())
                unique_names.push_back(one_line(name, 200));
        if (names.size() > most) unique_names.push_back(fmt::format("{} in total", names.size()));
        return unique_names.empty() ? what : what + ": " + join_with_commas(unique_names);
    }

    Robot robot_;
    const RobotOptions options_;
    const std::string& path_;
    std::vector<std::size_t> carrier_;                // index of the joint that carries each link
    std::vector<std::vector<std::size_t>> children_;  // indices of the joints whose parent is this link
    std::vector<bool> removed_;
};

}  // namespace

bool RobotJoint::has_law() const { return friction[0] != 0 || friction[1] != 0 || limits[0].any() || limits[1].any(); }

void RobotJoint::lock(const Wide& x) {
    const Vector3<Wide> along = (Wide(1) / length(axes[0])) * axes[0];
    RobotPose moved;
    if (motion == RobotMotion::prismatic) {
        moved.position = x * along;
    } else {
        Wide sine, cosine;
        sine_cosine(Wide(x / Wide(2)), sine, cosine);
        moved.turn = {cosine, sine * along[0], sine * along[1], sine * along[2]};
        moved.position = point - rotate(moved.turn, point);
    }
    placement = placement * moved;
    motion = RobotMotion::fixed;
    friction = {}, limits = {}, start = {};
    stiffness = damping = armature = {};
}

void remove_notes(Robot& robot, const std::string& heading, const std::vector<std::string>& names) {
    const auto notes = robot.omitted.find(heading);
    if (notes == robot.omitted.end()) return;
    std::erase_if(notes->second,
                  [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); });
    if (notes->second.empty()) robot.omitted.erase(notes);
}

void add_robot(const Robot& robot, const RobotOptions& options, const std::string& path, Scene& scene) {
    if (robot.links.size() > most_bodies)
        throw InputError(path, "", fmt::format("has {} links", robot.links.size()),
                         fmt::format("give at most {}", most_bodies));
    RobotMerger merger(robot, options, path);
    merger.merge();
    merger.build(scene);
}

}  // namespace polhode
