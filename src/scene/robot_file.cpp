#include "scene/robot_file.h"

#include <fmt/format.h>

#include "scene/inertia_repair.h"
#include "scene/robot_parts.h"
#include "text/content_hash.h"
#include "text/message.h"

namespace polhode {
namespace {

LinkInertial read_inertial(const RobotXml& xml, XMLElement& root, const std::string& link) {
    const std::string_view kind = root.Name();
    if (kind == "robot") return urdf_link_inertial(xml, root, link);
    if (kind == "mujoco") return mjcf_body_inertial(xml, root, link);
    if (kind == "sdf") return sdf_link_inertial(xml, root, link);
    if (kind == "gazebo")
        xml.fail(root, "is SDFormat 1.0 to 1.2",
                 "versions 1.3 to 1.12 are supported: convert the file, for example by gz sdf");
    xml.fail(root, "is not the root element of a known format",
             "give a URDF (<robot>), MJCF (<mujoco>) or SDFormat (<sdf>) file");
}

}  // namespace

BodyDefinition parse_robot_body(std::string_view text, const std::string& path, const std::string& link,
                                bool balance_inertia, const RobotFiles& files) {
    tinyxml2::XMLDocument document;
    parse_robot_xml(document, text, path);
    const RobotXml xml(path, files);
    XMLElement& root = *document.RootElement();
    LinkInertial inertial = read_inertial(xml, root, link);
    const MassProperties<Wide> properties = mass_of(inertial);
    const auto fail = [&](const std::string& fault, const std::string& remedy) {
        const char* tag = std::string_view(root.Name()) == "mujoco" ? "body" : "link";
        xml.fail(named_element(xml, root, tag, link), fmt::format("\"{}\" {}", one_line(link, 60), fault), remedy);
    };
    if (!(properties.mass > 0)) fail("has no mass", "choose a link with a mass > 0");
    const InertiaRepair repair = repair_inertia(properties.inertia);
    if (repair.excess > 0 && !repair.is_small && !balance_inertia)
        fail(repair.description(),
             "correct the tensor, or permit the smallest correction by \"balance_inertia\": true");
    if (auto* body = std::get_if<ImportedBody>(&inertial); body && repair.excess == 0) {
        body->hash = content_hash(text);
        return *body;
    }
    return NumericBody{double(properties.mass),
                       round_tensor(repair.inertia),
                       {double(properties.center[0]), double(properties.center[1]), double(properties.center[2])}};
}

}  // namespace polhode
