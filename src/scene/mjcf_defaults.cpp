// Evaluates MJCF's <default>: writes the attribute values of each class into the elements that use it.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scene/mjcf_model.h"
#include "text/message.h"

namespace polhode {
namespace {

// Kinds of elements whose defaults matter, by their tags inside <default>.
constexpr std::array<std::string_view, 6> kinds{"joint", "geom", "mesh", "equality", "tendon", "actuator"};
// all types of actuators share one set of defaults
constexpr std::array<std::string_view, 5> drives{"general", "motor", "position", "velocity", "damper"};

using Attributes = std::map<std::string, std::string>;
using MjcfClass = std::array<Attributes, kinds.size()>;

std::size_t kind_of(std::string_view tag) {
    if (std::ranges::find(drives, tag) != drives.end()) tag = "actuator";
    std::size_t i = 0;
    while (i < kinds.size() && kinds[i] != tag) ++i;
    return i;
}

bool is_alternative(const std::string& name) {
    return name == "euler" || name == "axisangle" || name == "xyaxes" || name == "zaxis";
}

bool has_alternative(const Attributes& attributes) {
    for (const auto& [name, value] : attributes)
        if (is_alternative(name)) return true;
    return false;
}

class MjcfDefaults {
  public:
    explicit MjcfDefaults(const RobotXml& xml) : xml_(xml) {}

    void read(XMLElement& root) {
        for (XMLElement* at = root.FirstChildElement("default"); at; at = at->NextSiblingElement("default")) {
            // the name of a top-level class is an alias of "main"; all top-level <default> elements add to it
            const char* name = at->Attribute("class");
            if (name && *name) main_names_.insert(name);
            read_class(*at, "main");
        }
    }

    void apply(XMLElement& root) const {
        for (XMLElement* at = root.FirstChildElement(); at; at = at->NextSiblingElement()) {
            const std::string_view section = at->Name();
            if (section == "worldbody") apply_to_bodies(*at, "main");
            for (XMLElement* one = at->FirstChildElement(); one; one = one->NextSiblingElement()) {
                if (section == "asset" && std::string_view(one->Name()) == "mesh") complete(*one, "mesh", "main");
                if (section == "equality") complete(*one, "equality", "main");
                if (section == "tendon") complete(*one, "tendon", "main");
                if (section == "actuator") complete(*one, one->Name(), "main");
            }
        }
    }

  private:
    void read_class(XMLElement& at, const std::string& name) {
        MjcfClass& values = classes_[name];
        for (XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement()) {
            const std::size_t kind = kind_of(one->Name());
            if (std::string_view(one->Name()) == "default") continue;
            while (const tinyxml2::XMLAttribute* a = one->FirstAttribute()) {
                if (kind < kinds.size()) set(values[kind], a->Name(), a->Value());
                one->DeleteAttribute(a->Name());
            }
        }
        for (XMLElement* one = at.FirstChildElement("default"); one; one = one->NextSiblingElement("default")) {
            const std::string inner = xml_.name(*one, "class", "the class's name");
            if (classes_.contains(inner))
                xml_.fail(*one, fmt::format("is a second class \"{}\"", one_line(inner, 60)),
                          "give each class a unique name");
            classes_[inner] = values;
            read_class(*one, inner);
        }
    }

    // MuJoCo stores a quaternion and one alternative orientation; the alternative takes precedence
    static void set(Attributes& values, const std::string& name, const std::string& value) {
        if (is_alternative(name)) std::erase_if(values, [](const auto& one) { return is_alternative(one.first); });
        values[name] = value;
    }

    void apply_to_bodies(XMLElement& body, std::string child_class) const {
        if (const char* given = body.Attribute("childclass")) child_class = given;
        for (XMLElement* one = body.FirstChildElement(); one; one = one->NextSiblingElement()) {
            const std::string_view tag = one->Name();
            if (tag == "joint" || tag == "geom") complete(*one, tag, child_class);
            if (tag == "body" || tag == "frame" || tag == "replicate") apply_to_bodies(*one, child_class);
        }
    }

    // Sets missing attributes to the values of the class.
    void complete(XMLElement& at, std::string_view kind, const std::string& child_class) const {
        const char* own = at.Attribute("class");
        const std::string name = own ? own : child_class;
        if (kind_of(kind) == kinds.size()) return;
        const auto found = classes_.find(main_names_.contains(name) ? "main" : name);
        if (found == classes_.end()) {
            if (name == "main") return;
            xml_.fail(at, fmt::format("has the class \"{}\", which no <default> defines", one_line(name, 40)),
                      "define the class, or give another");
        }
        const Attributes& values = found->second[kind_of(kind)];
        const bool spans = at.Attribute("fromto");
        bool alternative = false;
        for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a; a = a->Next())
            alternative = alternative || is_alternative(a->Name());
        if (!alternative && has_alternative(values)) at.DeleteAttribute("quat");
        for (const auto& [key, value] : values) {
            const bool turns = key == "quat" || is_alternative(key);
            if (at.Attribute(key.c_str()) || key == "class" || key == "name") continue;
            if (turns && (alternative || spans || (key == "quat" && has_alternative(values)))) continue;
            at.SetAttribute(key.c_str(), value.c_str());
        }
    }

    const RobotXml& xml_;
    std::map<std::string, MjcfClass> classes_;
    std::set<std::string, std::less<>> main_names_;
};

}  // namespace

void apply_mjcf_defaults(const RobotXml& xml, XMLElement& root) {
    MjcfDefaults defaults(xml);
    defaults.read(root);
    defaults.apply(root);
}

}  // namespace polhode
