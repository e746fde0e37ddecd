// Included models of SDFormat: resolves the file of an <include> and reads its elements with their origin.
#include <fmt/format.h>

#include <filesystem>

#include "scene/scene_limits.h"
#include "scene/sdf_tree.h"
#include "text/message.h"

namespace polhode {
namespace {

constexpr std::size_t most_included_bytes = 4 * largest_robot_file;
constexpr std::size_t most_includes = 2000;

void set_origin(XMLElement& at, const std::string& path, std::deque<RobotOrigin>& origins) {
    origins.push_back({path, at.GetLineNum()});
    at.SetUserData(&origins.back());
    for (XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement())
        set_origin(*one, path, origins);
}

bool is_folder(const std::string& name) {
    const std::string ending = std::filesystem::path(name).extension().string();
    return ending != ".sdf" && ending != ".xml" && ending != ".world" && ending != ".model" && ending != ".urdf";
}

// The file of the newest supported version listed in a model.config.
std::string listed_model(const std::string& text, const std::string& path) {
    tinyxml2::XMLDocument document;
    const XMLElement& root = parse_robot_xml(document, text, path);
    std::string best;
    int newest = -1;
    for (const XMLElement* at = root.FirstChildElement("sdf"); at; at = at->NextSiblingElement("sdf")) {
        const char* version = at->Attribute("version");
        int minor = 0;
        for (int i = oldest_sdf_version; version && i <= newest_sdf_version; ++i)
            if (std::string_view(version) == fmt::format("1.{}", i)) minor = i;
        if (minor > newest && !sdf_text(*at).empty()) newest = minor, best = sdf_text(*at);
    }
    return best;
}

// The model file in a folder, or nothing if there is none.
std::string model_in(const std::string& folder, const RobotFiles& files) {
    for (const char* config : {"model.config", "manifest.xml"}) {
        const std::string name = fmt::format("{}/{}", folder, config);
        if (!files.has(name)) continue;
        const std::string model = listed_model(files.text(name), files.path(name));
        if (!model.empty()) return fmt::format("{}/{}", folder, model);
    }
    const std::string name = folder + "/model.sdf";
    return files.has(name) ? name : "";
}

}  // namespace

std::string find_sdf_include(const RobotXml& xml, const XMLElement& at, const std::string& uri,
                             const RobotFiles& files) {
    const std::size_t colon = uri.find("://");
    const std::string scheme = colon == std::string::npos ? "" : uri.substr(0, colon);
    std::string name = colon == std::string::npos ? uri : uri.substr(colon + 3);
    while (name.size() > 1 && name.ends_with('/')) name.pop_back();
    if (!scheme.empty() && scheme != "model" && scheme != "file")
        xml.fail(at, fmt::format("is \"{}\", which is not a file", one_line(uri, 80)),
                 "download the model and include it by a relative path or model://");
    std::vector<std::string> tried = {name};
    if (scheme != "file")
        for (const char* around : {"models/", "../", "../models/", "../../models/", "../../"})
            tried.push_back(around + name);
    for (const std::string& one : tried) {
        std::string found = is_folder(one) ? model_in(one, files) : files.has(one) ? one : "";
        if (!found.empty()) return found;
    }
    xml.fail(at, fmt::format("is \"{}\", and there is no such model", one_line(uri, 80)),
             is_folder(name)
                 ? "give a folder with a model.config or model.sdf, inside the scene's folder unless outside "
                   "files are allowed"
                 : "give a file inside the scene's folder, or allow outside files");
}

std::optional<SdfTree::Included> SdfTree::read_include(const XMLElement& at, std::size_t scope) {
    if (documents_.size() >= most_includes)
        xml_.fail(at, fmt::format("is beyond {} included files", most_includes), "include fewer models");
    const XMLElement& uri = xml_.child(at, "uri");
    const RobotFiles& files = scopes_[scope].files;
    const std::string wanted = sdf_child_text(xml_, at, "uri", "the path of a model");
    std::string name;
    try {
        name = find_sdf_include(xml_, uri, wanted, files);
    } catch (const InputError&) {
        // most often scenery beside other models; a joint that refers to the missing model is still refused
        const XMLElement& around = *at.Parent()->ToElement();
        const XMLElement* first = around.FirstChildElement("include");
        const bool is_alone = !around.FirstChildElement("model") && first == &at && !at.NextSiblingElement("include");
        if (std::string_view(around.Name()) != "world" || is_alone) throw;
        omitted_["included models of the world that are not there"].push_back(one_line(wanted, 80));
        return {};
    }
    const std::string text = files.text(name), path = files.path(name);
    included_bytes_ += text.size();
    if (included_bytes_ > most_included_bytes)
        xml_.fail(at, fmt::format("brings the included files to more than {} bytes", most_included_bytes),
                  "include fewer models");
    documents_.emplace_back();
    tinyxml2::XMLDocument& document = documents_.back();
    parse_robot_xml(document, text, path);
    XMLElement& root = *document.RootElement();
    set_origin(root, path, origins_);
    if (std::string_view(root.Name()) != "sdf")
        xml_.fail(root, "is included and is not SDFormat", "convert it to SDFormat, for example by gz sdf -p");
    Included included;
    included.version = sdf_version(xml_, root, assumed_), included.files = files.relative_to(name);
    included.model = root.FirstChildElement("model");
    if (!included.model) {
        if (root.FirstChildElement("light") || root.FirstChildElement("actor")) return {};
        xml_.fail(root, "is included and has no <model>", "include a file with one model");
    }
    if (const XMLElement* second = included.model->NextSiblingElement("model"))
        xml_.fail(*second, "is a second model of an included file", "include a file with one model");
    survey_robot(xml_, root, sdf_constructs(), omitted_);
    return included;
}

}  // namespace polhode
