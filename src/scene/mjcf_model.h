// MJCF models: a document with its included files and class defaults resolved.
//
// <include> is replaced by the children of the included file's root element, anywhere in the document, and repeated
// sections are merged. <default> is then evaluated in document order: a class inherits the values that its parent
// class has at that point. The values of an element's class are written into the element, so that all other readers
// see complete elements. Models that <asset><model> names for <attach> are loaded in the same way.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "scene/mjcf_values.h"
#include "text/message.h"

namespace polhode {

/// A model with its settings and assets.
struct MjcfModel {
    const XMLElement* root = nullptr;
    RobotFiles files;  ///< relative to the folder of the model's file
    MjcfCompiler compiler;
    std::map<std::string, const XMLElement*> meshes, height_fields, models;  ///< assets by name
    std::vector<const XMLElement*> unnamed_models;
};

/// Loads models and owns their documents. Inputs are untrusted: the number, total size and nesting depth of all files
/// are limited.
class MjcfLibrary {
  public:
    explicit MjcfLibrary(const RobotXml& xml) : xml_(xml) {}

    /// Loads the main file. Throws InputError.
    const MjcfModel& main(XMLElement& root);
    /// The model asset `name` of the model `of`; each is loaded once. `at` is named in errors. Throws InputError.
    const MjcfModel& attached(const XMLElement& at, const MjcfModel& of, const std::string& name);
    /// Whether files other than the main one were read.
    bool has_other_files() const { return files_read_ > 0; }
    /// The models loaded by attached().
    const std::map<std::string, std::unique_ptr<MjcfModel>>& attached_models() const { return attached_; }

  private:
    const MjcfModel& load(const XMLElement& asset, const MjcfModel& of);
    void prepare(XMLElement& root, const std::string& path, MjcfModel& model);
    void list_assets(MjcfModel& model) const;
    void expand(XMLElement& at, int depth, const RobotFiles& files, const std::string& folder,
                std::set<std::string>& included);
    std::vector<XMLElement*> splice(XMLElement& include, const RobotFiles& files, const std::string& folder,
                                    std::set<std::string>& included, std::string& inner_folder);
    std::string read(const XMLElement& at, const RobotFiles& files, const std::string& name);
    XMLElement* copy(const XMLElement& from, const std::string& path, tinyxml2::XMLDocument& into);
    void mark(XMLElement& at, const std::string& path);

    const RobotXml& xml_;
    std::unique_ptr<MjcfModel> main_;
    std::map<std::string, std::unique_ptr<MjcfModel>> attached_;  // by path
    std::deque<tinyxml2::XMLDocument> documents_;
    std::size_t files_read_ = 0, bytes_read_ = 0;
};

/// Rethrows the error of a file that an element names, at the element's place.
[[noreturn]] void fail_mjcf_file(const RobotXml& xml, const XMLElement& at, const InputError& error);

/// The name of an asset: its name attribute, or its file name without folders and extension.
std::string mjcf_asset_name(const XMLElement& asset);

/// Evaluates <default> and writes the values of each element's class into the joints, geoms, meshes, equality
/// constraints and tendons below `root`. The elements inside <default> lose their attributes.
void apply_mjcf_defaults(const RobotXml& xml, XMLElement& root);

}  // namespace polhode
