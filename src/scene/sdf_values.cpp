#include "scene/sdf_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "text/message.h"

namespace polhode {
namespace {

bool is_flag(const RobotXml& xml, const XMLElement& at, std::string text, const char* where) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    if (text == "true" || text == "1") return true;
    if (text != "false" && text != "0")
        xml.fail(at, fmt::format("has \"{}\" in {}", one_line(text, 40), where), "give true or false");
    return false;
}

}  // namespace

int sdf_version(const RobotXml& xml, const XMLElement& root, RobotNotes& assumed) {
    const char* given = root.Attribute("version");
    if (!given || !*given) {
        assumed["SDFormat version, missing in the file"].push_back(fmt::format("1.{}", newest_sdf_version));
        return newest_sdf_version;
    }
    for (int minor = oldest_sdf_version; minor <= newest_sdf_version; ++minor)
        if (std::string_view(given) == fmt::format("1.{}", minor)) return minor;
    xml.fail(root, fmt::format("has the version \"{}\"", one_line(given, 40)),
             fmt::format("versions 1.{} to 1.{} are supported: convert the file to one of them, for example by gz sdf",
                         oldest_sdf_version, newest_sdf_version));
}

bool sdf_flag(const RobotXml& xml, const XMLElement* at) { return at && is_flag(xml, *at, sdf_text(*at), "it"); }

bool sdf_flag_attribute(const RobotXml& xml, const XMLElement& at, const char* name) {
    const char* text = at.Attribute(name);
    return text && *text && is_flag(xml, at, text, name);
}

std::string sdf_text(const XMLElement& at) {
    const std::string_view text = at.GetText() ? at.GetText() : "";
    const char* blanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return "";
    return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

std::string sdf_child_text(const RobotXml& xml, const XMLElement& of, const char* name, const char* what) {
    const XMLElement& at = xml.child(of, name);
    std::string text = sdf_text(at);
    if (text.empty()) xml.fail(at, "is empty", fmt::format("give {}", what));
    return text;
}

SdfPlace sdf_place(const RobotXml& xml, const XMLElement& pose) {
    const char* given = pose.Attribute("rotation_format");
    const std::string_view format = given && *given ? given : "euler_rpy";
    if (format != "euler_rpy" && format != "quat_xyzw")
        xml.fail(pose, fmt::format("has the rotation_format \"{}\"", one_line(format, 40)),
                 "give euler_rpy or quat_xyzw");
    const bool in_degrees = sdf_flag_attribute(xml, pose, "degrees");
    if (sdf_text(pose).empty()) return {{}, Quaternion<double>{1, 0, 0, 0}};
    if (format == "quat_xyzw") {
        if (in_degrees) xml.fail(pose, "is a quaternion in degrees", "remove \"degrees\"");
        const std::vector<double> v = xml.content(pose, 7);
        return {three_of(v), xml.rotate_by(pose, {v[6], v[3], v[4], v[5]})};
    }
    const std::vector<double> v = xml.content(pose, 6);
    return {three_of(v), roll_pitch_yaw(three_of(v, 3), in_degrees)};
}

RobotPose sdf_pose(const RobotXml& xml, const XMLElement* pose) {
    if (!pose) return {};
    const SdfPlace place = sdf_place(xml, *pose);
    return {cast<Wide>(place.position), unit_quaternion<Wide>(place.turn)};
}

std::string sdf_relative_to(const XMLElement* pose, int version) {
    if (!pose) return "";
    if (const char* name = pose->Attribute("relative_to"); name && *name) return name;
    const char* frame = version < 7 ? pose->Attribute("frame") : nullptr;
    return frame ? frame : "";
}

}  // namespace polhode
