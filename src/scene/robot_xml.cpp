#include "scene/robot_xml.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "body/orientation.h"
#include "scene/builtin.h"
#include "scene/scene_limits.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {
namespace {

bool is_one_of(const char* text, const char* one, const char* other) {
    return std::string_view(text) == one || std::string_view(text) == other;
}

}  // namespace

void RobotXml::fail(const XMLElement& at, const std::string& fault, const std::string& remedy) const {
    throw InputError(path_, fmt::format("line {}, <{}>", at.GetLineNum(), at.Name()), fault, remedy);
}

const XMLElement& RobotXml::child(const XMLElement& of, const char* name) const {
    const XMLElement* one = of.FirstChildElement(name);
    if (!one) fail(of, fmt::format("has no <{}>", name), "give it: there is no default");
    if (const XMLElement* second = one->NextSiblingElement(name)) fail(*second, "stands there twice", "give one");
    return *one;
}

const XMLElement* RobotXml::optional_child(const XMLElement& of, const char* name) const {
    return of.FirstChildElement(name) ? &child(of, name) : nullptr;
}

std::string RobotXml::name(const XMLElement& at, const char* attribute, const char* what) const {
    const char* text = at.Attribute(attribute);
    if (!text || !*text) fail(at, fmt::format("has no \"{}\"", attribute), fmt::format("give {}", what));
    return text;
}

std::vector<double> RobotXml::numbers(const XMLElement& at, const char* what, std::string_view text, std::size_t least,
                                      std::size_t most) const {
    std::vector<double> values;
    const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    for (std::size_t i = 0; i < text.size();) {
        if (space(text[i])) {
            ++i;
            continue;
        }
        std::size_t end = i;
        while (end < text.size() && !space(text[end])) ++end;
        const std::string_view word = text.substr(i, end - i);
        const std::optional<double> value = parse_decimal(word);
        if (!value || !std::isfinite(*value))
            fail(at, fmt::format("has \"{}\" in {}", one_line(word, 40), what), "give finite decimal numbers");
        values.push_back(*value);
        i = end;
    }
    if (values.size() < least || values.size() > most)
        fail(at, fmt::format("has {} numbers in {}", values.size(), what),
             least == most ? fmt::format("give {}", least) : fmt::format("give {} to {}", least, most));
    return values;
}

std::vector<double> RobotXml::attribute(const XMLElement& at, const char* name, std::size_t n) const {
    const char* text = at.Attribute(name);
    if (!text) fail(at, fmt::format("has no \"{}\"", name), "give it: there is no default");
    return numbers(at, name, text, n, n);
}

std::vector<double> RobotXml::content(const XMLElement& at, std::size_t n) const {
    return numbers(at, "it", at.GetText() ? at.GetText() : "", n, n);
}

double RobotXml::attribute_or(const XMLElement& at, const char* name, double fallback) const {
    return at.Attribute(name) ? attribute(at, name, 1)[0] : fallback;
}

double RobotXml::content_or(const XMLElement* at, double fallback) const { return at ? content(*at, 1)[0] : fallback; }

bool RobotXml::flag(const XMLElement& at, const char* name) const {
    const char* text = at.Attribute(name);
    if (!text || is_one_of(text, "false", "0")) return false;
    if (!is_one_of(text, "true", "1"))
        fail(at, fmt::format("has \"{}\" in {}", one_line(text, 40), name), "give true or false");
    return true;
}

double RobotXml::checked_mass(const XMLElement& at, double mass) const {
    if (!(mass > 0)) fail(at, fmt::format("has the mass {}", shortest_decimal(mass)), "the mass in kg must be > 0");
    return mass;
}

Matrix3<double> RobotXml::tensor(const XMLElement& at, const std::vector<double>& v) const {
    Matrix3<double> m;
    m[0] = {v[0], v[3], v[4]}, m[1] = {v[3], v[1], v[5]}, m[2] = {v[4], v[5], v[2]};
    if (const std::string fault = tensor_fault(m); !fault.empty())
        fail(at, fault, "give the tensor of some distribution of mass");
    return m;
}

RobotTurn RobotXml::turn_by(const XMLElement& at, const Quaternion<double>& q) const {
    const double length = norm(q);
    if (!(length > 1e-100 && length < 1e100)) fail(at, "has a quaternion without direction", "give one of length 1");
    return q;
}

RobotPlace sdf_place(const RobotXml& xml, const XMLElement& pose) {
    RobotPlace place;
    const char* format = pose.Attribute("rotation_format");
    if (format && std::string_view(format) == "quat_xyzw") {
        const std::vector<double> v = xml.content(pose, 7);
        return {three_of(v), xml.turn_by(pose, {v[6], v[3], v[4], v[5]})};
    }
    if (format && std::string_view(format) != "euler_rpy")
        xml.fail(pose, fmt::format("has the rotation_format \"{}\"", one_line(format, 40)),
                 "give euler_rpy or quat_xyzw");
    const std::vector<double> v = xml.content(pose, 6);
    const char* degrees = pose.Attribute("degrees");
    return {three_of(v), roll_pitch_yaw(three_of(v, 3), degrees && is_one_of(degrees, "true", "1"))};
}

ImportedBody urdf_inertial(const RobotXml& xml, const XMLElement& inertial) {
    ImportedBody body;
    if (const XMLElement* origin = xml.optional_child(inertial, "origin")) {
        if (origin->Attribute("xyz")) body.center_of_mass = three_of(xml.attribute(*origin, "xyz", 3));
        if (origin->Attribute("rpy"))
            body.orientation = roll_pitch_yaw(three_of(xml.attribute(*origin, "rpy", 3)), false);
    }
    const XMLElement& mass = xml.child(inertial, "mass");
    body.mass = xml.checked_mass(mass, xml.attribute(mass, "value", 1)[0]);
    const XMLElement& inertia = xml.child(inertial, "inertia");
    std::vector<double> entries;
    for (const char* name : {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"})
        entries.push_back(xml.attribute(inertia, name, 1)[0]);
    body.inertia = xml.tensor(inertia, entries);
    return body;
}

ImportedBody sdf_inertial(const RobotXml& xml, const XMLElement& inertial) {
    ImportedBody body;
    if (const XMLElement* pose = xml.optional_child(inertial, "pose")) {
        const char* relative = pose->Attribute("relative_to");
        if (relative && *relative) xml.fail(*pose, "is relative to another frame", "give it relative to the link");
        const RobotPlace place = sdf_place(xml, *pose);
        body.center_of_mass = place.position, body.orientation = place.turn;
    }
    const XMLElement& mass = xml.child(inertial, "mass");
    body.mass = xml.checked_mass(mass, xml.content(mass, 1)[0]);
    const XMLElement& inertia = xml.child(inertial, "inertia");
    std::vector<double> entries;
    for (const char* name : {"ixx", "iyy", "izz"}) entries.push_back(xml.content(xml.child(inertia, name), 1)[0]);
    for (const char* name : {"ixy", "ixz", "iyz"})
        entries.push_back(xml.content_or(xml.optional_child(inertia, name), 0));
    body.inertia = xml.tensor(inertia, entries);
    return body;
}

const XMLElement& parse_robot_xml(tinyxml2::XMLDocument& document, std::string_view text, const std::string& path) {
    document.Parse(text.data(), text.size());
    if (document.Error())
        throw InputError(path, fmt::format("line {}", document.ErrorLineNum()),
                         fmt::format("is not XML: {}", tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID())),
                         "give a URDF, MJCF or SDFormat file");
    const XMLElement* root = document.RootElement();
    if (!root) throw InputError(path, "", "has no element", "give a URDF, MJCF or SDFormat file");
    return *root;
}

std::string robot_text(const std::string& directory, const std::string& file) {
    // what the catalogue itself names is built in
    if (!directory.starts_with(builtin_directory) || file.starts_with('/'))
        return read_named_text(directory, file, largest_robot_file, "a URDF, MJCF or SDFormat file");
    const std::string folder = directory.substr(builtin_directory.size());
    const std::string name = (std::filesystem::path(folder) / file).lexically_normal().generic_string();
    const std::string_view text = builtin_robot_text(name);
    if (text.empty())
        throw InputError(name, "", "is no file that is built in", "give one of " + listed(builtin_robot_names()));
    return std::string(text);
}

}  // namespace polhode
