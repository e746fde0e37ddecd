#include "scene/robot_xml.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "body/orientation.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

bool is_one_of(const char* text, const char* one, const char* other) {
    return std::string_view(text) == one || std::string_view(text) == other;
}

}  // namespace

void RobotXml::fail(const XMLElement& at, const std::string& fault, const std::string& remedy) const {
    const auto* origin = static_cast<const RobotOrigin*>(at.GetUserData());
    throw InputError(origin ? origin->path : path_,
                     fmt::format("line {}, <{}>", origin ? origin->line : at.GetLineNum(), one_line(at.Name(), 40)),
                     fault, remedy);
}

std::string RobotXml::place_of(const XMLElement& at) const {
    const auto* origin = static_cast<const RobotOrigin*>(at.GetUserData());
    return origin ? fmt::format("{}: line {}", one_line(origin->path, 60), origin->line)
                  : fmt::format("line {}", at.GetLineNum());
}

const XMLElement& RobotXml::child(const XMLElement& of, const char* name) const {
    const XMLElement* one = of.FirstChildElement(name);
    if (!one) fail(of, fmt::format("has no <{}>", name), "add it: it has no default");
    if (const XMLElement* second = one->NextSiblingElement(name)) fail(*second, "is given twice", "give it once");
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
    if (!text) fail(at, fmt::format("has no \"{}\"", name), "add it: it has no default");
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
    if (!(mass >= 0))
        fail(at, fmt::format("has the negative mass {}", shortest_decimal(mass)), "the mass in kg must be >= 0");
    return mass;
}

Matrix3<double> RobotXml::tensor(const std::vector<double>& v) {
    Matrix3<double> m;
    m[0] = {v[0], v[3], v[4]}, m[1] = {v[3], v[1], v[5]}, m[2] = {v[4], v[5], v[2]};
    return m;
}

RobotRotation RobotXml::rotate_by(const XMLElement& at, const Quaternion<double>& q) const {
    const double length = norm(q);
    if (!(length > 1e-100 && length < 1e100))
        fail(at, "has a quaternion of length zero or beyond 1e100", "give a unit quaternion");
    return q;
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
    body.inertia = RobotXml::tensor(entries);
    return body;
}

const XMLElement& parse_robot_xml(tinyxml2::XMLDocument& document, std::string_view text, const std::string& path) {
    document.Parse(text.data(), text.size());
    if (document.Error())
        throw InputError(path, fmt::format("line {}", document.ErrorLineNum()),
                         fmt::format("is not XML: {}", tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID())),
                         "give a URDF, MJCF or SDFormat file");
    const XMLElement* root = document.RootElement();
    if (!root) throw InputError(path, "", "has no root element", "give a URDF, MJCF or SDFormat file");
    return *root;
}

}  // namespace polhode
