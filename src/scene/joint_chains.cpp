// Expands joints of several coordinates into chains of revolute and prismatic joints.
//
// The bodies between the joints of a chain have no mass and the frame of the child, as several joints of one MJCF body.
// All axes and points are therefore given in the child's frame at coordinate zero. Where the first point is not the
// joint's child_point, a fixed joint to one more massless body places the child's frame, so that no point is rounded.
#include "scene/joint_chains.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "scene/initial_file.h"
#include "scene/joint_file.h"
#include "scene/json_values.h"
#include "scene/scene_keys.h"
#include "text/message.h"

namespace polhode {
namespace {

class ChainReader {
  public:
    ChainReader(const JsonNode& node, std::size_t index) : node_(node), place_(fmt::format("/joints/{}", index)) {
        name_ = node.require_member("name", "the joint's name").string();
        child_ = node.require_member("child", "a body's name").string();
        last_ = node.require_member("parent", "a body's name or \"world\"").string();
        const auto point = [&](const char* key) {
            const JsonNode* given = node.find(key);
            return given ? vector3(*given) : Vector3<double>();
        };
        parent_point_ = point("parent_point"), child_point_ = point("child_point");
        if (const JsonNode* q = node.find("parent_orientation")) orientation_ = quaternion(*q);
    }

    const JsonNode& node() const { return node_; }
    const Vector3<double>& child_point() const { return child_point_; }

    /// Appends a joint. `coordinate`: the object with its name, initial state and forces, or null.
    void add(JointType type, const Vector3<double>& axis, const Vector3<double>& point, const JsonNode* coordinate,
             const std::string& name, const std::string& place) {
        if (chain_.joints.empty() && !(point == child_point_)) {
            Joint frame = next(JointType::fixed, name_ + "_frame", place_);
            frame.parent_point = parent_point_, frame.child_point = child_point_;
            frame.parent_orientation = orientation_;
            append(frame);
        }
        Joint joint = next(type, name, place_ + place);
        if (coordinate) {
            if (const JsonNode* given = coordinate->find("name")) joint.name = given->string();
            parse_coordinate(*coordinate, joint);
        }
        joint.axes[0] = axis, joint.child_point = point;
        joint.parent_point = chain_.joints.empty() ? parent_point_ : point;
        if (chain_.joints.empty()) joint.parent_orientation = orientation_;
        append(joint);
    }
    /// The last joint carries the child itself.
    JointChain finish() {
        chain_.joints.back().child = child_;
        chain_.bodies.pop_back();
        return std::move(chain_);
    }
    JointChain& chain() { return chain_; }

  private:
    const JsonNode& node_;
    std::string place_, name_, child_, last_;
    Vector3<double> parent_point_, child_point_;
    Quaternion<double> orientation_;
    JointChain chain_;

    Joint next(JointType type, const std::string& name, const std::string& place) const {
        Joint joint;
        joint.name = name, joint.type = type, joint.parent = last_, joint.place = place;
        return joint;
    }
    void append(Joint joint) {
        NamedBody body;
        body.name = fmt::format("{} ({})", name_, joint.name);
        body.body.mass = 0, body.body.inertia_B = {};
        joint.child = last_ = body.name;
        chain_.bodies.push_back(std::move(body));
        chain_.joints.push_back(std::move(joint));
    }
};

void require_keys(const JsonNode& node, const char* object) { node.require_known_keys(keys_of(scene_keys(), object)); }

// The object of a coordinate, if it is given.
const JsonNode* coordinate_at(const JsonNode& node, const char* key, const char* object) {
    const JsonNode* given = node.find(key);
    if (!given) return nullptr;
    if (!given->is_object()) given->fail(given->describe(), "give an object {\"initial\": .., \"damping\": ..}");
    require_keys(*given, object);
    return given;
}

std::string name_at(const JsonNode& node, const char* suffix) {
    return node.require_member("name", "the joint's name").string() + suffix;
}

void add_coordinate(ChainReader& chain, JointType type, const Vector3<double>& axis, const char* key) {
    const bool turns = type == JointType::revolute;
    chain.add(type, axis, chain.child_point(),
              coordinate_at(chain.node(), key, turns ? "coordinate revolute" : "coordinate prismatic"),
              name_at(chain.node(), fmt::format("_{}", key).c_str()), fmt::format("/{}", key));
}

JointChain parse_compound(ChainReader& chain) {
    const JsonNode& axes = chain.node().require_member("axes", "a list of axes {\"type\": .., \"axis\": ..}");
    if (!axes.is_array() || axes.elements().empty())
        axes.fail(axes.describe(), "give at least one axis {\"type\": .., \"axis\": ..}");
    for (std::size_t k = 0; k < axes.elements().size(); ++k) {
        const JsonNode& axis = *axes.elements()[k];
        if (!axis.is_object()) axis.fail(axis.describe(), "give an object {\"type\": .., \"axis\": ..}");
        const JsonNode& type = axis.require_member("type", "\"revolute\" or \"prismatic\"");
        const bool turns = type.string() == "revolute";
        if (!turns && type.string() != "prismatic") type.fail(type.describe(), "give \"revolute\" or \"prismatic\"");
        require_keys(axis, turns ? "axis revolute" : "axis prismatic");
        const JsonNode* point = axis.find("point");
        chain.add(turns ? JointType::revolute : JointType::prismatic,
                  vector3(axis.require_member("axis", "[x, y, z], in the child's axes")),
                  point ? vector3(*point) : chain.child_point(), &axis,
                  name_at(chain.node(), fmt::format("_{}", k + 1).c_str()), fmt::format("/axes/{}", k));
    }
    return chain.finish();
}

// Two directions in the plane: the coordinate axes after a normal that is one, else computed from the normal.
std::pair<Vector3<double>, Vector3<double>> directions_across(const Vector3<double>& n) {
    int nonzero = 0, along = 0, least = 0;
    for (int i = 0; i < 3; ++i) {
        if (n[i] != 0) ++nonzero, along = i;
        if (std::abs(n[i]) < std::abs(n[least])) least = i;
    }
    Vector3<double> first, second;
    if (nonzero == 1) {
        first[(along + 1) % 3] = 1, second[(along + 2) % 3] = n[along] > 0 ? 1 : -1;
        return {first, second};
    }
    Vector3<double> e;
    e[least] = 1;
    first = cross(n, e);
    return {first, cross(n, first)};
}

JointChain parse_planar(ChainReader& chain) {
    const JsonNode& given = chain.node().require_member("normal", "[x, y, z], in the child's axes");
    const Vector3<double> normal = vector3(given);
    if (normal == Vector3<double>()) given.fail("is zero", "give a direction");
    const auto [first, second] = directions_across(normal);
    add_coordinate(chain, JointType::prismatic, first, "first");
    add_coordinate(chain, JointType::prismatic, second, "second");
    add_coordinate(chain, JointType::revolute, normal, "rotation");
    return chain.finish();
}

JointChain parse_cylindrical(ChainReader& chain, bool is_screw) {
    const Vector3<double> axis = vector3(chain.node().require_member("axis", "[x, y, z], in the child's axes"));
    add_coordinate(chain, JointType::prismatic, axis, "translation");
    add_coordinate(chain, JointType::revolute, axis, "rotation");
    if (is_screw) {
        constexpr double turn = 6.283185307179586;
        const JsonNode& pitch = chain.node().require_member("pitch", "m per revolution");
        std::vector<Joint>& joints = chain.chain().joints;
        chain.chain().couplings.push_back({joints[1].name, joints[0].name, pitch.number() / turn, 0});
    }
    return chain.finish();
}

JointChain parse_free(const JsonNode& node) {
    JointChain chain;
    const JsonNode& parent = node.require_member("parent", "\"world\"");
    if (parent.string() != "world")
        parent.fail(fmt::format("is \"{}\"", one_line(parent.string(), 60)),
                    "the parent of a free joint is \"world\": a free body moves independently of others");
    chain.free_child = node.require_member("child", "a body's name").string();
    if (const JsonNode* start = node.find("initial")) chain.free_initial = parse_initial(*start, false);
    return chain;
}

}  // namespace

std::optional<JointChain> parse_joint_chain(const JsonNode& node, std::size_t index) {
    const JsonNode* type = node.is_object() ? node.find("type") : nullptr;
    if (!type || !type->is_string()) return std::nullopt;
    const std::string& name = type->string();
    if (name != "compound" && name != "cylindrical" && name != "screw" && name != "planar" && name != "free")
        return std::nullopt;
    require_keys(node, fmt::format("joint {}", name).c_str());
    if (name == "free") return parse_free(node);
    ChainReader chain(node, index);
    if (name == "compound") return parse_compound(chain);
    if (name == "planar") return parse_planar(chain);
    return parse_cylindrical(chain, name == "screw");
}

}  // namespace polhode
