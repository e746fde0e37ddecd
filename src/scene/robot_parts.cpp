#include "scene/robot_parts.h"

#include <fmt/format.h>

#include "text/message.h"

namespace polhode {

RobotPose operator*(const RobotPose& outer, const RobotPose& inner) {
    return {outer * inner.position, outer.turn * inner.turn};
}
RobotPose inverse(const RobotPose& pose) { return {-rotate_back(pose.turn, pose.position), conjugate(pose.turn)}; }
Vector3<Wide> operator*(const RobotPose& pose, const Vector3<Wide>& point) {
    return rotate(pose.turn, point) + pose.position;
}

MassProperties<Wide> mass_of(const ImportedBody& inertial) { return MassPropertiesOf<Wide>{}(inertial); }

void RobotNames::add(const XMLElement& at, const std::string& name, std::size_t index) {
    if (!index_.emplace(name, index).second)
        xml_.fail(at, fmt::format("is a second {} \"{}\"", what_, one_line(name, 60)),
                  fmt::format("give each {} a name of its own", what_));
}

std::size_t RobotNames::find(const XMLElement& at, const std::string& name) const {
    const auto found = index_.find(name);
    if (found != index_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [one, index] : index_) known.push_back(one);
    const std::string meant = did_you_mean(name, known);
    xml_.fail(at, fmt::format("names \"{}\", which is no {}", one_line(name, 60), what_),
              !meant.empty() ? meant : "give one of " + listed(known));
}

Robot parse_robot(std::string_view text, const std::string& path) {
    tinyxml2::XMLDocument document;
    parse_robot_xml(document, text, path);
    const RobotXml xml(path);
    XMLElement& root = *document.RootElement();
    const std::string_view kind = root.Name();
    if (kind == "robot") return urdf_robot(xml, root);
    if (kind == "mujoco") return mjcf_robot(xml, root);
    if (kind == "sdf") return sdf_robot(xml, root);
    xml.fail(root, "is the root of no known format", "give a URDF (<robot>), MJCF (<mujoco>) or SDFormat (<sdf>) file");
}

}  // namespace polhode
