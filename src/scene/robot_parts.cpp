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

MassProperties<Wide> mass_of(const LinkInertial& inertial) {
    if (const auto* body = std::get_if<ImportedBody>(&inertial)) return MassPropertiesOf<Wide>{}(*body);
    return std::get<MassProperties<Wide>>(inertial);
}

namespace {

// Collects elements with this tag and name; names are qualified by the surrounding models.
void find_elements(const XMLElement& within, std::string_view tag, const std::string& wanted, const std::string& scope,
                   std::vector<const XMLElement*>& found, std::vector<std::string>& names) {
    for (const XMLElement* one = within.FirstChildElement(); one; one = one->NextSiblingElement()) {
        const std::string name = name_or(*one, "");
        if (one->Name() == tag && !name.empty()) {
            names.push_back(name);
            if (name == wanted || scope + name == wanted) found.push_back(one);
        }
        const bool is_model = std::string_view(one->Name()) == "model";
        find_elements(*one, tag, wanted, is_model ? scope + name + "::" : scope, found, names);
    }
}

}  // namespace

const XMLElement& named_element(const RobotXml& xml, const XMLElement& root, const char* tag, const std::string& name) {
    std::vector<const XMLElement*> found;
    std::vector<std::string> names;
    find_elements(root, tag, name, "", found, names);
    if (found.empty()) {
        const std::string meant = did_you_mean(name, names);
        throw InputError(xml.path(), "", fmt::format("has no {} \"{}\"", tag, one_line(name, 60)),
                         !meant.empty()  ? meant
                         : names.empty() ? fmt::format("give a file with a named {}", tag)
                                         : "give one of " + join_with_commas(names));
    }
    if (found.size() > 1)
        xml.fail(*found[1], fmt::format("is a second {} \"{}\"", tag, one_line(name, 60)),
                 "give \"model::link\", or rename one of them");
    return *found.front();
}

void RobotNames::add(const XMLElement& at, const std::string& name, std::size_t index) {
    if (!index_.emplace(name, index).second)
        xml_.fail(at, fmt::format("is a second {} \"{}\"", what_, one_line(name, 60)),
                  fmt::format("give each {} a unique name", what_));
}

std::size_t RobotNames::find(const XMLElement& at, const std::string& name) const {
    const auto found = index_.find(name);
    if (found != index_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [one, index] : index_) known.push_back(one);
    const std::string meant = did_you_mean(name, known);
    xml_.fail(at, fmt::format("refers to \"{}\", which is not a {}", one_line(name, 60), what_),
              !meant.empty() ? meant : "give one of " + join_with_commas(known));
}

namespace {

// Refuses files that still contain xacro macros.
void refuse_xacro(const RobotXml& xml, const XMLElement& at) {
    const char* remedy = "expand the file with xacro first: xacro FILE > robot.urdf";
    if (std::string_view(at.Name()).starts_with("xacro:")) xml.fail(at, "is an xacro macro", remedy);
    for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next())
        if (const std::string_view value = a->Value(); value.find("${") != value.npos || value.find("$(") != value.npos)
            xml.fail(
                at,
                fmt::format("has the xacro expression \"{}\" in {}", one_line(a->Value(), 40), one_line(a->Name(), 40)),
                remedy);
    for (const XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement()) refuse_xacro(xml, *one);
}

}  // namespace

Robot parse_robot(std::string_view text, const std::string& path, const RobotOptions& options,
                  const RobotFiles& files) {
    tinyxml2::XMLDocument document;
    parse_robot_xml(document, text, path);
    const RobotXml xml(path, files);
    XMLElement& root = *document.RootElement();
    const std::string_view kind = root.Name();
    if (!options.model.empty() && kind != "sdf")
        throw InputError(path, "", "is not an SDFormat file: only SDFormat files have a choice of models",
                         "remove \"model\" from the import");
    if (kind == "robot") {
        refuse_xacro(xml, root);
        return urdf_robot(xml, root);
    }
    if (kind == "mujoco") return mjcf_robot(xml, root);
    if (kind == "sdf") return sdf_robot(xml, root, options.model);
    if (kind == "gazebo")
        xml.fail(root, "is SDFormat 1.0 to 1.2",
                 "versions 1.3 to 1.12 are supported: convert the file, for example by gz sdf");
    xml.fail(root, "is not the root element of a known format",
             "give a URDF (<robot>), MJCF (<mujoco>) or SDFormat (<sdf>) file");
}

}  // namespace polhode
