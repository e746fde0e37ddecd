#include "app/scene_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "integrators/truth/reference.h"
#include "motion/formula_mechanism.h"
#include "motion/mechanism.h"
#include "motion/problem.h"
#include "scene/joint_file.h"
#include "scene/scene_family.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "table/table.h"
#include "text/decimal.h"
#include "text/message.h"

namespace polhode {
namespace {

// rounds to four digits
std::string short_number(double value) { return shortest_decimal(std::stod(fmt::format("{:.3e}", value))); }

std::string body_of(const Problem& problem) {
    const Vector3<double>& I = problem.body.principal.moments;
    const char* symmetry = problem.needs.symmetry == Symmetry::spherical   ? "spherical"
                           : problem.needs.symmetry == Symmetry::symmetric ? "symmetric"
                                                                           : "asymmetric";
    return fmt::format("{}: {}, {}, {}", symmetry, short_number(I[0]), short_number(I[1]), short_number(I[2]));
}

struct LoadName {
    const char* operator()(const Gravity&) const { return "gravity"; }
    const char* operator()(const Torque&) const { return "torque"; }
    const char* operator()(const Force&) const { return "force"; }
    const char* operator()(const Impulse&) const { return "impulse"; }
    const char* operator()(const Drag&) const { return "drag"; }
    const char* operator()(const Spring&) const { return "spring"; }
    const char* operator()(const UserTorque&) const { return "user-defined torque"; }
    const char* operator()(const Motor&) const { return "motor"; }
    const char* operator()(const PointSpring&) const { return "spring between points"; }
    const char* operator()(const FormulaLoad&) const { return "formula"; }
};

// Lists each kind of load once, in file order.
std::string loads_of(const Scene& scene) {
    std::vector<std::string> names;
    for (const Load& load : scene.loads) {
        const std::string name = std::visit(LoadName{}, load);
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    if (!scene.planes.empty()) names.emplace_back(scene.planes.size() == 1 ? "a plane" : "planes");
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

Table make_scene_table(const std::vector<std::string>& names) {
    Table table{{"name", "about", "duration (s)", "principal moments (kg m^2)", "about point", "loads", "system posed",
                 "variables", "truth", "source"},
                {}};
    for (const std::string& name : names) {
        const Scene scene = find_scene(name);
        const Problem problem = pose(scene);
        table.rows.push_back({name, scene.about, short_number(scene.duration), body_of(problem),
                              std::string(scene.pivot ? "pivot" : "centre of mass"), loads_of(scene),
                              std::string(has_formula_loads(scene) ? "formula loads" : name_of(problem.needs.system)),
                              long(problem.needs.dimension), std::string(truth_method(problem)), scene.source});
    }
    return table;
}

// Lists each type once, in file order, with counts: "2 revolute, universal"
template <class Parts>
std::string types_of(const Parts& parts) {
    std::vector<std::pair<std::string, int>> types;
    for (const auto& part : parts) {
        const std::string type = name_of(part.type);
        const auto at = std::find_if(types.begin(), types.end(), [&](const auto& t) { return t.first == type; });
        if (at == types.end())
            types.emplace_back(type, 1);
        else
            ++at->second;
    }
    std::vector<std::string> words;
    for (const auto& [type, count] : types) words.push_back(count == 1 ? type : fmt::format("{} {}", count, type));
    return words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

// The table of scenes of several bodies. Loop equations that are implied by the others count as redundant.
Table mechanism_rows_of(const std::vector<std::string>& names) {
    Table table{{"name", "about", "duration (s)", "bodies", "joints", "loops", "degrees of freedom", "loop equations",
                 "redundant", "loads", "variables", "truth", "source"},
                {}};
    for (const std::string& name : names) {
        const Scene scene = find_scene(name);
        const Problem problem = pose(scene);
        const Tree<double>& tree = tree_of(problem);
        const long equations = long(tree.loop_rows()), independent = long(tree.independent_loop_rows());
        table.rows.push_back({name, scene.about, short_number(scene.duration), long(scene.bodies.size()),
                              types_of(scene.joints), types_of(scene.loops), long(tree.links().rates) - independent,
                              equations, equations - independent, loads_of(scene), long(problem.needs.dimension),
                              std::string(truth_method(problem)), scene.source});
    }
    return table;
}

}  // namespace

std::string scene_index() {
    std::vector<std::string> plain;
    std::map<std::string, std::vector<std::string>> mechanisms;  // by directory
    std::map<std::string, std::vector<std::string>> kinds;       // by directory: formulas, contact
    std::map<std::string, std::set<std::string>> families;       // by directory
    for (const std::string& name : builtin_scene_names()) {
        const FamilyMember member = family_member(name);
        if (is_mechanism(find_scene(name)))
            mechanisms[member.folder].push_back(name);
        else if (member.folder.empty())
            plain.push_back(name);
        else if (member.parameter.empty())
            kinds[member.folder].push_back(name);
        else
            families[member.folder].insert(member.family);
    }
    std::string page = markdown(make_scene_table(plain));
    for (const auto& [folder, names] : mechanisms)
        page += fmt::format("\n## {}\n\n{}",
                            folder.empty()           ? "several bodies"
                            : kinds.contains(folder) ? folder + " of several bodies"
                                                     : folder,
                            markdown(mechanism_rows_of(names)));
    for (const auto& [folder, names] : kinds)
        page += fmt::format("\n## {}\n\n{}", folder, markdown(make_scene_table(names)));
    for (const auto& [folder, names] : families) {
        page += fmt::format("\n## {}\n", folder);
        for (const std::string& family : names)
            page += fmt::format("\n### {}\n\n{}", family, markdown(make_scene_table(scene_family(folder, family))));
    }
    return page;
}

}  // namespace polhode
