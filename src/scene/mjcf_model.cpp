// Loads MJCF models with the files that they include or attach.
#include "scene/mjcf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "scene/robot_parts.h"
#include "scene/scene_limits.h"
#include "text/message.h"

namespace polhode {
namespace {

using tinyxml2::XMLNode;

constexpr std::size_t most_files = 1000;                       // files included or attached by one robot
constexpr std::size_t largest_total = 4 * largest_robot_file;  // bytes in all these files
constexpr int deepest = 300;                                   // nesting of elements, with included files

std::string normal_path(const std::string& path) { return std::filesystem::path(path).lexically_normal().string(); }

}  // namespace

void fail_mjcf_file(const RobotXml& xml, const XMLElement& at, const InputError& error) {
    const auto* origin = static_cast<const RobotOrigin*>(at.GetUserData());
    throw InputError(origin ? origin->path : xml.path(),
                     fmt::format("line {}, <{}>", origin ? origin->line : at.GetLineNum(), one_line(at.Name(), 40)),
                     error);
}

std::string mjcf_asset_name(const XMLElement& asset) {
    const char *name = asset.Attribute("name"), *file = asset.Attribute("file");
    return name ? name : file ? std::filesystem::path(file).stem().string() : "";
}

const MjcfModel& MjcfLibrary::main(XMLElement& root) {
    main_ = std::make_unique<MjcfModel>();
    main_->files = xml_.files();
    prepare(root, xml_.path(), *main_);
    return *main_;
}

const MjcfModel& MjcfLibrary::attached(const XMLElement& at, const MjcfModel& of, const std::string& name) {
    const auto asset = of.models.find(name);
    if (asset != of.models.end()) return load(*asset->second, of);
    // a model asset without a name has that of its root element
    for (const XMLElement* one : of.unnamed_models) {
        const MjcfModel& model = load(*one, of);
        if (const char* own = model.root->Attribute("model"); own && own == name) return model;
    }
    std::vector<std::string> known;
    for (const auto& [one, element] : of.models) known.push_back(one);
    xml_.fail(at, fmt::format("attaches the model \"{}\", which no <asset><model> defines", one_line(name, 60)),
              known.empty() ? "define it by <asset><model>" : "give one of " + join_with_commas(known));
}

const MjcfModel& MjcfLibrary::load(const XMLElement& asset, const MjcfModel& of) {
    const std::string file = xml_.name(asset, "file", "the model's file");
    const std::string path = normal_path(of.files.path(file));
    if (const auto known = attached_.find(path); known != attached_.end()) return *known->second;
    auto model = std::make_unique<MjcfModel>();
    const std::string text = read(asset, of.files, file);
    tinyxml2::XMLDocument& document = documents_.emplace_back();
    parse_robot_xml(document, text, path);
    XMLElement& root = *document.RootElement();
    mark(root, path);
    if (std::string_view(root.Name()) != "mujoco")
        xml_.fail(root, "is the root of an attached model", "attach only MJCF files (<mujoco>)");
    model->files = of.files.relative_to(file);
    prepare(root, path, *model);
    return *attached_.emplace(path, std::move(model)).first->second;
}

void MjcfLibrary::prepare(XMLElement& root, const std::string& path, MjcfModel& model) {
    std::set<std::string> included{normal_path(path)};
    expand(root, 0, model.files, "", included);
    apply_mjcf_defaults(xml_, root);
    model.root = &root;
    model.compiler = mjcf_compiler(xml_, root);
    list_assets(model);
}

void MjcfLibrary::list_assets(MjcfModel& model) const {
    for (const XMLElement* asset = model.root->FirstChildElement("asset"); asset;
         asset = asset->NextSiblingElement("asset"))
        for (const XMLElement* one = asset->FirstChildElement(); one; one = one->NextSiblingElement()) {
            const std::string_view tag = one->Name();
            auto* list = tag == "mesh"     ? &model.meshes
                         : tag == "hfield" ? &model.height_fields
                         : tag == "model"  ? &model.models
                                           : nullptr;
            if (!list) continue;
            if (tag == "model" && !one->Attribute("name")) {
                model.unnamed_models.push_back(one);
                continue;
            }
            const std::string name = mjcf_asset_name(*one);
            if (!list->emplace(name, one).second)
                xml_.fail(*one, fmt::format("is a second {} \"{}\"", tag, one_line(name, 60)),
                          "give each asset a unique name");
        }
}

// Replaces an <include>, or every <include> below another element. `folder`: folder of the included file that
// contains the element. File names are looked up in the main file's folder first (MuJoCo's rule), then in `folder`.
void MjcfLibrary::expand(XMLElement& at, int depth, const RobotFiles& files, const std::string& folder,
                         std::set<std::string>& included) {
    if (depth > deepest)
        xml_.fail(at, fmt::format("is nested more than {} elements deep", deepest), "reduce the nesting");
    if (std::string_view(at.Name()) == "include") {
        std::string inner_folder;
        for (XMLElement* one : splice(at, files, folder, included, inner_folder))
            expand(*one, depth, files, inner_folder, included);
        return;
    }
    for (XMLElement *one = at.FirstChildElement(), *next = nullptr; one; one = next) {
        next = one->NextSiblingElement();
        expand(*one, depth + 1, files, folder, included);
    }
}

// Replaces `include` by the children of the included file's root. Returns them.
std::vector<XMLElement*> MjcfLibrary::splice(XMLElement& include, const RobotFiles& files, const std::string& folder,
                                             std::set<std::string>& included, std::string& inner_folder) {
    if (include.FirstChildElement()) xml_.fail(include, "has elements inside", "an <include> must be empty");
    const std::string given = xml_.name(include, "file", "the included file");
    const std::string beside = folder + given;
    const std::string file = !files.has(given) && !folder.empty() && files.has(beside) ? beside : given;
    const std::string path = normal_path(files.path(file));
    if (!included.insert(path).second)
        xml_.fail(include, fmt::format("includes \"{}\" a second time", one_line(given, 60)),
                  "MuJoCo includes a file only once: copy it, or attach it as a model");
    const std::string text = read(include, files, file);
    tinyxml2::XMLDocument document;
    parse_robot_xml(document, text, path);
    inner_folder = std::filesystem::path(file).parent_path().string();
    if (!inner_folder.empty()) inner_folder += '/';
    std::vector<XMLElement*> parts;
    XMLNode* last = &include;
    for (const XMLElement* one = document.RootElement()->FirstChildElement(); one; one = one->NextSiblingElement()) {
        XMLElement* added = copy(*one, path, *include.GetDocument());
        include.Parent()->InsertAfterChild(last, added);
        last = added;
        parts.push_back(added);
    }
    include.Parent()->DeleteChild(&include);
    return parts;
}

std::string MjcfLibrary::read(const XMLElement& at, const RobotFiles& files, const std::string& name) {
    if (++files_read_ > most_files)
        xml_.fail(at, fmt::format("is more than the {}th file of one robot", most_files), "give fewer files");
    std::string text;
    try {
        text = files.text(name);
    } catch (const InputError& error) {
        fail_mjcf_file(xml_, at, error);
    }
    bytes_read_ += text.size();
    if (bytes_read_ > largest_total)
        xml_.fail(at, fmt::format("makes the files of one robot exceed {} bytes in total", largest_total),
                  "give smaller files");
    return text;
}

// Needed because tinyxml2's copy drops line numbers and user data.
XMLElement* MjcfLibrary::copy(const XMLElement& from, const std::string& path, tinyxml2::XMLDocument& into) {
    XMLElement* element = into.NewElement(from.Name());
    for (const tinyxml2::XMLAttribute* a = from.FirstAttribute(); a; a = a->Next())
        element->SetAttribute(a->Name(), a->Value());
    if (const char* text = from.GetText()) element->SetText(text);
    element->SetUserData(xml_.keep({path, from.GetLineNum()}));
    for (const XMLElement* one = from.FirstChildElement(); one; one = one->NextSiblingElement())
        element->InsertEndChild(copy(*one, path, into));
    return element;
}

void MjcfLibrary::mark(XMLElement& at, const std::string& path) {
    at.SetUserData(xml_.keep({path, at.GetLineNum()}));
    for (XMLElement* one = at.FirstChildElement(); one; one = one->NextSiblingElement()) mark(*one, path);
}

}  // namespace polhode
