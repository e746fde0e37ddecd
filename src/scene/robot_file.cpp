#include "scene/robot_file.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "body/orientation.h"
#include "text/content_hash.h"
#include "text/decimal.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

using tinyxml2::XMLElement;

class Reader {
  public:
    Reader(const std::string& path, const std::string& link) : path_(path), link_(link) {}

    ImportedBody read(const XMLElement& root) {
        const std::string_view kind = root.Name();
        if (kind == "robot") return urdf(only_one(root, "link"));
        if (kind == "mujoco") return mjcf(root, only_one(root, "body"));
        if (kind == "sdf") return sdf(only_one(root, "link"));
        fail(root, "is the root of no known format", "give a URDF (<robot>), MJCF (<mujoco>) or SDFormat (<sdf>) file");
    }

  private:
    [[noreturn]] void fail(const XMLElement& at, const std::string& fault, const std::string& remedy) const {
        throw InputError(path_, fmt::format("line {}, <{}>", at.GetLineNum(), at.Name()), fault, remedy);
    }

    // links of that name, with the names of the models around them in front
    void find(const XMLElement& within, const char* kind, const std::string& scope,
              std::vector<const XMLElement*>& found, std::vector<std::string>& names) const {
        for (const XMLElement* one = within.FirstChildElement(); one; one = one->NextSiblingElement()) {
            const char* name = one->Attribute("name");
            const std::string own = name ? name : "";
            const bool scoped = std::string_view(one->Name()) == "model";
            if (std::string_view(one->Name()) == kind && name) {
                names.push_back(own);
                if (own == link_ || scope + own == link_) found.push_back(one);
            }
            find(*one, kind, scoped ? scope + own + "::" : scope, found, names);
        }
    }
    const XMLElement& only_one(const XMLElement& root, const char* kind) const {
        std::vector<const XMLElement*> found;
        std::vector<std::string> names;
        find(root, kind, "", found, names);
        if (found.empty()) {
            const std::string meant = did_you_mean(link_, names);
            throw InputError(path_, "", fmt::format("has no {} \"{}\"", kind, one_line(link_, 60)),
                             !meant.empty()  ? meant
                             : names.empty() ? fmt::format("give a file with a named {}", kind)
                                             : "give one of " + listed(names));
        }
        if (found.size() > 1)
            fail(*found[1], fmt::format("is a second {} \"{}\"", kind, one_line(link_, 60)),
                 "give \"model::link\", or each its own name");
        return *found.front();
    }

    const XMLElement& child(const XMLElement& of, const char* name) const {
        const XMLElement* one = of.FirstChildElement(name);
        if (!one) fail(of, fmt::format("has no <{}>", name), "give it: there is no default");
        if (const XMLElement* second = one->NextSiblingElement(name)) fail(*second, "stands there twice", "give one");
        return *one;
    }
    const XMLElement* optional_child(const XMLElement& of, const char* name) const {
        return of.FirstChildElement(name) ? &child(of, name) : nullptr;
    }

    // exactly or up to n numbers between spaces
    std::vector<double> numbers(const XMLElement& at, const char* what, std::string_view text, std::size_t n) const {
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
        if (values.size() != n)
            fail(at, fmt::format("has {} numbers in {}", values.size(), what), fmt::format("give {}", n));
        return values;
    }
    std::vector<double> attribute(const XMLElement& at, const char* name, std::size_t n) const {
        const char* text = at.Attribute(name);
        if (!text) fail(at, fmt::format("has no \"{}\"", name), "give it: there is no default");
        return numbers(at, name, text, n);
    }
    std::vector<double> content(const XMLElement& at, std::size_t n) const {
        return numbers(at, "it", at.GetText() ? at.GetText() : "", n);
    }
    static Vector3<double> vector(const std::vector<double>& v, std::size_t from = 0) {
        return {v[from], v[from + 1], v[from + 2]};
    }

    double checked_mass(const XMLElement& at, double mass) const {
        if (!(mass > 0)) fail(at, fmt::format("has the mass {}", shortest_decimal(mass)), "the mass in kg must be > 0");
        return mass;
    }
    // xx yy zz xy xz yz: the tensor itself
    Matrix3<double> tensor(const XMLElement& at, const std::vector<double>& v) const {
        Matrix3<double> m;
        m[0] = {v[0], v[3], v[4]}, m[1] = {v[3], v[1], v[5]}, m[2] = {v[4], v[5], v[2]};
        if (const std::string fault = tensor_fault(m); !fault.empty())
            fail(at, fault, "give the tensor of some distribution of mass");
        return m;
    }

    // roll, pitch, yaw about the fixed axes x, y, z
    static EulerTurn roll_pitch_yaw(const Vector3<double>& angles, bool in_degrees) {
        return {{0, 1, 2}, angles, in_degrees, false};
    }

    ImportedBody urdf(const XMLElement& link) const {
        const XMLElement& inertial = child(link, "inertial");
        ImportedBody body;
        if (const XMLElement* origin = optional_child(inertial, "origin")) {
            if (origin->Attribute("xyz")) body.center_of_mass = vector(attribute(*origin, "xyz", 3));
            if (origin->Attribute("rpy"))
                body.orientation = roll_pitch_yaw(vector(attribute(*origin, "rpy", 3)), false);
        }
        const XMLElement& mass = child(inertial, "mass");
        body.mass = checked_mass(mass, attribute(mass, "value", 1)[0]);
        const XMLElement& inertia = child(inertial, "inertia");
        std::vector<double> entries;
        for (const char* name : {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"})
            entries.push_back(attribute(inertia, name, 1)[0]);
        body.inertia = tensor(inertia, entries);
        return body;
    }

    ImportedBody sdf(const XMLElement& link) const {
        const XMLElement& inertial = child(link, "inertial");
        ImportedBody body;
        if (const XMLElement* pose = optional_child(inertial, "pose")) {
            const char* relative = pose->Attribute("relative_to");
            if (relative && *relative) fail(*pose, "is relative to another frame", "give it relative to the link");
            const char* format = pose->Attribute("rotation_format");
            const char* degrees = pose->Attribute("degrees");
            if (format && std::string_view(format) == "quat_xyzw") {
                const std::vector<double> v = content(*pose, 7);
                body.center_of_mass = vector(v);
                body.orientation = unit(*pose, {v[6], v[3], v[4], v[5]});
            } else {
                if (format && std::string_view(format) != "euler_rpy")
                    fail(*pose, fmt::format("has the rotation_format \"{}\"", one_line(format, 40)),
                         "give euler_rpy or quat_xyzw");
                const std::vector<double> v = content(*pose, 6);
                const bool in_degrees =
                    degrees && (std::string_view(degrees) == "true" || std::string_view(degrees) == "1");
                body.center_of_mass = vector(v);
                body.orientation = roll_pitch_yaw(vector(v, 3), in_degrees);
            }
        }
        const XMLElement& mass = child(inertial, "mass");
        body.mass = checked_mass(mass, content(mass, 1)[0]);
        const XMLElement& inertia = child(inertial, "inertia");
        std::vector<double> entries;
        for (const char* name : {"ixx", "iyy", "izz"}) entries.push_back(content(child(inertia, name), 1)[0]);
        for (const char* name : {"ixy", "ixz", "iyz"}) {
            const XMLElement* product = optional_child(inertia, name);
            entries.push_back(product ? content(*product, 1)[0] : 0);
        }
        body.inertia = tensor(inertia, entries);
        return body;
    }

    std::variant<Quaternion<double>, EulerTurn> unit(const XMLElement& at, const Quaternion<double>& q) const {
        const double length = norm(q);
        if (!(length > 1e-100 && length < 1e100))
            fail(at, "has a quaternion without direction", "give one of length 1");
        return q;
    }

    ImportedBody mjcf(const XMLElement& root, const XMLElement& link) const {
        const XMLElement& inertial = child(link, "inertial");
        ImportedBody body;
        body.center_of_mass = vector(attribute(inertial, "pos", 3));
        for (const char* name : {"axisangle", "xyaxes", "zaxis"})
            if (inertial.Attribute(name))
                fail(inertial, fmt::format("has an orientation by \"{}\"", name), "give it as quat or euler");
        if (inertial.Attribute("quat") && inertial.Attribute("euler"))
            fail(inertial, "has two orientations", "give quat or euler, not both");
        if (inertial.Attribute("quat")) {
            const std::vector<double> v = attribute(inertial, "quat", 4);
            body.orientation = unit(inertial, {v[0], v[1], v[2], v[3]});
        } else if (inertial.Attribute("euler")) {
            body.orientation = euler(root, inertial);
        }
        body.mass = checked_mass(inertial, attribute(inertial, "mass", 1)[0]);
        if (inertial.Attribute("fullinertia")) {
            if (inertial.Attribute("diaginertia"))
                fail(inertial, "has both diaginertia and fullinertia", "give one of them");
            body.inertia = tensor(inertial, attribute(inertial, "fullinertia", 6));
        } else {
            const std::vector<double> v = attribute(inertial, "diaginertia", 3);
            body.inertia = tensor(inertial, {v[0], v[1], v[2], 0, 0, 0});
        }
        return body;
    }
    // by <compiler angle="degree|radian" eulerseq="xyz">: lower case turns with the body, upper case is fixed
    EulerTurn euler(const XMLElement& root, const XMLElement& inertial) const {
        EulerTurn turn{{0, 1, 2}, vector(attribute(inertial, "euler", 3)), true, true};
        for (const XMLElement* c = root.FirstChildElement("compiler"); c; c = c->NextSiblingElement("compiler")) {
            if (const char* angle = c->Attribute("angle")) {
                if (std::string_view(angle) != "degree" && std::string_view(angle) != "radian")
                    fail(*c, fmt::format("has the angle \"{}\"", one_line(angle, 40)), "give degree or radian");
                turn.in_degrees = std::string_view(angle) == "degree";
            }
            const char* sequence = c->Attribute("eulerseq");
            if (!sequence) continue;
            const std::string_view letters = sequence;
            const bool turned = letters.find_first_not_of("xyz") == letters.npos;
            if (letters.size() != 3 || (!turned && letters.find_first_not_of("XYZ") != letters.npos))
                fail(*c, fmt::format("has the eulerseq \"{}\"", one_line(letters, 40)),
                     "give three of xyz (turned axes) or of XYZ (fixed axes)");
            turn.about_turned_axes = turned;
            for (std::size_t i = 0; i < 3; ++i) turn.axes[i] = letters[i] - (turned ? 'x' : 'X');
        }
        return turn;
    }

    const std::string& path_;
    const std::string& link_;
};

}  // namespace

ImportedBody parse_robot_body(std::string_view text, const std::string& path, const std::string& link) {
    tinyxml2::XMLDocument document;
    document.Parse(text.data(), text.size());
    if (document.Error())
        throw InputError(path, fmt::format("line {}", document.ErrorLineNum()),
                         fmt::format("is not XML: {}", tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID())),
                         "give a URDF, MJCF or SDFormat file");
    const XMLElement* root = document.RootElement();
    if (!root) throw InputError(path, "", "has no element", "give a URDF, MJCF or SDFormat file");
    ImportedBody body = Reader(path, link).read(*root);
    body.hash = content_hash(text);
    return body;
}

ImportedBody read_robot_body(const std::string& path, const std::string& link) {
    return parse_robot_body(read_text(path, std::size_t{64} << 20, "a URDF, MJCF or SDFormat file"), path, link);
}

}  // namespace polhode
