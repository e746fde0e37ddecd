#include "scene/robot_file.h"

#include <fmt/format.h>

#include <vector>

#include "scene/robot_xml.h"
#include "text/content_hash.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

class Reader {
  public:
    Reader(const std::string& path, const std::string& link) : xml_(path), link_(link) {}

    ImportedBody read(const XMLElement& root) {
        const std::string_view kind = root.Name();
        const auto inertial = [&](const char* link) -> const XMLElement& {
            return xml_.child(only_one(root, link), "inertial");
        };
        if (kind == "robot") return urdf_inertial(xml_, inertial("link"));
        if (kind == "mujoco") {
            const XMLElement& found = inertial("body");
            return mjcf_inertial(xml_, found, mjcf_compiler(xml_, root));
        }
        if (kind == "sdf") return sdf_inertial(xml_, inertial("link"));
        xml_.fail(root, "is the root of no known format",
                  "give a URDF (<robot>), MJCF (<mujoco>) or SDFormat (<sdf>) file");
    }

  private:
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
            throw InputError(xml_.path(), "", fmt::format("has no {} \"{}\"", kind, one_line(link_, 60)),
                             !meant.empty()  ? meant
                             : names.empty() ? fmt::format("give a file with a named {}", kind)
                                             : "give one of " + listed(names));
        }
        if (found.size() > 1)
            xml_.fail(*found[1], fmt::format("is a second {} \"{}\"", kind, one_line(link_, 60)),
                      "give \"model::link\", or each its own name");
        return *found.front();
    }

    const RobotXml xml_;
    const std::string& link_;
};

}  // namespace

ImportedBody parse_robot_body(std::string_view text, const std::string& path, const std::string& link) {
    tinyxml2::XMLDocument document;
    ImportedBody body = Reader(path, link).read(parse_robot_xml(document, text, path));
    body.hash = content_hash(text);
    return body;
}

ImportedBody read_robot_body(const std::string& path, const std::string& link) {
    return parse_robot_body(robot_text("", path), path, link);
}

}  // namespace polhode
