// Reads experiment files and makes plans. parse_experiment() checks each key of the file. make_plan() resolves names
// and patterns of scenes and methods, applies all combinations of `vary` to the canonical JSON of each scene, and lists
// the curves. Limits (plan_limits.h) are checked before the variants are made.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "experiment/plan/experiment.h"
#include "experiment/plan/experiment_keys.h"
#include "experiment/plan/pattern.h"
#include "experiment/plan/plan_limits.h"
#include "integrators/engines/engine_methods.h"
#include "scene/body_source.h"
#include "scene/builtin.h"
#include "scene/json_values.h"
#include "scene/scene_file.h"
#include "scene/scene_limits.h"
#include "text/content_hash.h"
#include "text/message.h"
#include "text/named_file.h"
#include "text/printable.h"

namespace polhode {
namespace {

using nlohmann::ordered_json;

// takes some tens of milliseconds
constexpr long quick_evaluations = 100000;

long positive_count(const JsonNode& node, long most) {
    const long value = node.whole_number();
    if (value < 1 || value > most) node.fail(node.describe(), fmt::format("give 1 to {}", most));
    return value;
}

std::vector<std::string> strings(const JsonNode& node) {
    std::vector<std::string> result;
    if (node.elements().size() > most_entries)
        node.fail(node.describe(), fmt::format("give at most {} entries", most_entries));
    for (const JsonNode* element : node.elements()) result.push_back(element->string());
    if (result.empty()) node.fail("is empty", "give at least one name");
    return result;
}

// Rounds to 12 digits, so that decades of a range are exact powers of ten.
double round_to_12_digits(double value) {
    const std::string decimal = fmt::format("{:.12g}", value);
    double rounded = value;
    std::from_chars(decimal.data(), decimal.data() + decimal.size(), rounded);
    return rounded;
}

// Parses a list, or {"from", "to", "count"} with logarithmic spacing. Returns the values from coarse to fine.
std::vector<double> read_settings(const JsonNode& node, const char* what) {
    std::vector<double> values;
    if (node.is_object()) {
        node.require_known_keys(keys_of(experiment_keys(), "range"));
        const double from = positive(node.require_member("from", "the first value"), what);
        const double to = positive(node.require_member("to", "the last value"), what);
        const long count = positive_count(node.require_member("count", "the number of values"), most_range_values);
        // if the ratio overflows or underflows binary64, use two powers
        const bool in_one = std::isfinite(to / from) && to / from > 0;
        for (long i = 0; i < count; ++i) {
            const double along = count == 1 ? 0 : static_cast<double>(i) / static_cast<double>(count - 1);
            const double value =
                in_one ? from * std::pow(to / from, along) : std::pow(from, 1 - along) * std::pow(to, along);
            const bool end = i == 0 || i == count - 1;
            values.push_back(end ? (i == 0 ? from : to) : round_to_12_digits(value));
        }
    } else {
        for (const JsonNode* element : node.elements()) values.push_back(positive(*element, what));
        if (values.empty()) node.fail("is empty", "give at least one value, or remove the key");
    }
    std::sort(values.begin(), values.end(), std::greater<>());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

const ExperimentKind* read_kind(const JsonNode& node) {
    if (const ExperimentKind* kind = find_kind(node.string())) return kind;
    std::vector<std::string> names;
    for (const ExperimentKind& kind : kinds()) names.emplace_back(kind.name);
    node.fail(node.describe(), "give one of " + join_with_commas(names));
}

std::optional<Pattern> parse_pattern(const std::string& entry, const std::string& file, const std::string& place) {
    if (entry.size() < 2 || entry.front() != '/' || entry.back() != '/') return {};
    try {
        if (entry.size() == 2) throw std::invalid_argument("it must not be empty");
        return Pattern(entry.substr(1, entry.size() - 2));
    } catch (const std::invalid_argument& error) {
        throw InputError(file, place, "is not a valid regular expression: " + one_line(error.what(), 100),
                         "give a POSIX extended regular expression between slashes");
    }
}

// The remedy for an unknown name of `polhode list KEY`.
std::string suggest_names(const std::string& name, const std::vector<std::string>& known, const char* key) {
    const std::string near = did_you_mean(name, known);
    return fmt::format("{}{}`polhode list {}` prints all names", near, near.empty() ? "" : " ", key);
}

// Whether an entry is a name ENGINE:SETTING, or a pattern for such names.
bool names_engine(const std::string& entry) { return entry.find(':') != std::string::npos; }

std::vector<std::string> resolve_names(const std::vector<std::string>& entries, const std::vector<std::string>& known,
                                       const std::string& file, const char* key, bool paths) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::string place = fmt::format("/{}/{}", key, i);
        // /../ cannot be the path of a scene, because a path that ends in a slash is a directory
        if (const auto pattern = parse_pattern(entries[i], file, place)) {
            const std::size_t before = names.size();
            bool any = false;
            for (const std::string& name : known)
                if (pattern->matches(name) && names_engine(name) <= names_engine(entries[i])) add(name), any = true;
            if (!any && names.size() == before)
                throw InputError(file, place, one_line(entries[i], 80) + " matches no name",
                                 "give a pattern that matches one of " + join_with_commas(known));
        } else if (paths || std::find(known.begin(), known.end(), entries[i]) != known.end()) {
            add(entries[i]);
        } else {
            throw InputError(file, place, one_line(entries[i], 80) + " is an unknown name",
                             suggest_names(entries[i], known, key));
        }
    }
    return names;
}

// Resolves names and patterns of methods. Engines, which run other programs, are included only if an entry has a colon.
std::vector<const Method*> resolve_methods(const std::vector<std::string>& entries, const std::string& file) {
    std::vector<const Method*> known(methods().begin(), methods().end());
    if (std::ranges::any_of(entries, names_engine))
        for (const EngineMethod& engine : engines()) known.push_back(engine.method.get());
    std::vector<std::string> names;
    for (const Method* method : known) names.emplace_back(method->name);
    std::vector<const Method*> planned;
    for (const std::string& name : resolve_names(entries, names, file, "methods", false))
        planned.push_back(*std::ranges::find(known, name, &Method::name));
    return planned;
}

// A scene's name for tables and terminals: control characters are escaped. A name that is too long is shortened, and a
// hash is appended to keep it unique.
std::string escape_label(const std::string& label) {
    std::string shown = one_line(label, 6 * label.size() + 16);
    if (shown.size() <= longest_label) return shown;
    return fmt::format("{}{{{}}}", one_line(shown, longest_label - 20), content_hash(label).substr(0, 16));
}

// Approximate memory of the meshes of a body, in bytes.
std::size_t mesh_bytes(const BodySource& source) {
    if (const auto* mesh = std::get_if<MeshBody>(&source.definition))
        return mesh->mesh.vertices.size() * sizeof(Vector3<double>) + mesh->mesh.triangles.size() * 3 * sizeof(int);
    std::size_t bytes = 0;
    if (const auto* parts = std::get_if<PartsBody>(&source.definition))
        for (const PartsBody::Part& part : parts->parts) bytes += mesh_bytes(*part.body);
    return bytes;
}

// Approximate memory of the texts and meshes of all variants of a scene, in bytes.
double variant_bytes(const PlannedScene& base, const std::vector<Variation>& vary, double variants) {
    std::size_t bytes = base.canonical.size();
    if (base.scene.body.source) bytes += mesh_bytes(*base.scene.body.source);
    for (const NamedBody& one : base.scene.bodies)
        if (one.body.source) bytes += mesh_bytes(*one.body.source);
    for (const Variation& variation : vary) {
        std::size_t longest = 0;
        for (const std::string& value : variation.values) longest = std::max(longest, value.size());
        bytes += variation.pointer.size() + longest;
    }
    return variants * static_cast<double>(bytes);
}

using Changes = std::vector<std::pair<std::string, std::string>>;  // JSON pointers and their values

PlannedScene apply_changes(const PlannedScene& base, const Changes& changes, const std::string& file) {
    if (changes.empty()) return base;
    ordered_json json = ordered_json::parse(base.canonical, nullptr, true, true);
    std::string label;
    for (const auto& [pointer, value] : changes) {
        try {
            // may add a key to an existing object, but not an element to a list
            const ordered_json::json_pointer place(pointer);
            const ordered_json& parent = json.at(place.parent_pointer());
            (place.empty() || parent.is_object() ? json[place] : json.at(place)) = ordered_json::parse(value);
        } catch (const nlohmann::json::exception& error) {
            throw InputError(file, "/vary", one_line(pointer, 80) + " does not point to a value of " + base.label,
                             one_line(error.what(), 160));
        }
        label += fmt::format("{}{}={}", label.empty() ? "" : ",", pointer, value);
    }
    PlannedScene scene;
    scene.label = escape_label(base.label + "{" + label + "}");
    try {
        scene.scene = parse_scene(json.dump(), scene.label, base.scene.directory);
    } catch (const InputError& error) {
        throw InputError(file, "/vary", error);
    }
    scene.canonical = write_scene(scene.scene);
    return scene;
}

// Whether a name is 1 to 64 letters, digits, _ or -. It must not start with -, because it names files that commands
// would take for options.
bool is_file_name(const std::string& name) {
    return !name.empty() && name.size() <= 64 && name.front() != '-' &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                      c == '-';
           });
}

std::string read_about(const JsonNode& node) {
    const std::string& about = node.string();
    if (about.size() > longest_experiment_about)
        node.fail(fmt::format("has {} bytes", about.size()),
                  fmt::format("give at most {} bytes", longest_experiment_about));
    if (first_unprintable(about) != std::string::npos)
        node.fail("contains control characters", "use printable characters and line breaks");
    return about;
}

// Reads a built-in scene or a scene file. A relative path is resolved against the directory of the experiment's file,
// then against the working directory. Files outside the directory of the experiment's file are refused by default.
Scene read_planned_scene(const std::string& name, const std::string& file, NamedFiles which) {
    if (!builtin_scene_text(name).empty() || which == NamedFiles::anywhere) return find_scene(name);
    const std::size_t slash = file.rfind('/');
    const std::string folder = slash == file.npos ? "" : file.substr(0, std::max<std::size_t>(slash, 1));
    std::error_code none;
    const std::string beside = path_in(folder, name);
    const bool is_beside = !folder.empty() && std::filesystem::exists(beside, none);
    if (!is_beside && !std::filesystem::exists(name, none)) return find_scene(name);  // throws with suggestions
    const std::string path = is_beside ? beside : name;
    require_inside(folder, path);
    return read_scene(path);
}

std::vector<double> take_every_third(const std::vector<double>& values) {
    std::vector<double> result;
    for (std::size_t i = 0; i < values.size(); i += 3) result.push_back(values[i]);
    return result;
}

// --quick: every third setting, fewer repeats, and fewer evaluations.
void reduce_experiment(Experiment& e) {
    e.steps = take_every_third(e.steps), e.tolerances = take_every_third(e.tolerances);
    e.evaluations_per_revolution = take_every_third(e.evaluations_per_revolution);
    e.repeats = std::min(e.repeats, 3), e.max_evaluations = std::min(e.max_evaluations, quick_evaluations);
}

// The number of combinations of varied values.
double count_variants(const Experiment& e, const std::string& file) {
    double variants = 1;
    for (const Variation& variation : e.vary) variants *= static_cast<double>(variation.values.size());
    if (variants > most_variants)
        throw InputError(file, "/vary", fmt::format("makes {:.12g} variants of each scene", variants),
                         fmt::format("give at most {:.0f}; all combinations of values are run", most_variants));
    return variants;
}

void require_supported(const Scene& scene, const std::string& name, const Experiment& e, const std::string& file) {
    if (e.kind->one_body && is_mechanism(scene))
        throw InputError(file, "/scenes",
                         fmt::format("{} has several bodies; experiments of kind {} support only one",
                                     one_line(name, 80), e.kind->name),
                         "give scenes of one body, or another kind");
    if (static_cast<double>(e.samples) * static_cast<double>(body_count(scene)) > static_cast<double>(most_states))
        throw InputError(
            file, "/samples",
            fmt::format("is {}, for the {} bodies of {}", e.samples, scene.bodies.size(), one_line(name, 80)),
            fmt::format("samples times bodies must be at most {}", most_states));
}

// The scenes of the experiment before their values are varied.
std::vector<PlannedScene> read_scenes(const Experiment& e, const std::string& file, double variants, NamedFiles which) {
    std::vector<PlannedScene> bases;
    double bytes = 0;
    for (const std::string& name : resolve_names(e.scenes, builtin_scene_names(), file, "scenes", true)) {
        Scene scene;
        try {
            scene = read_planned_scene(name, file, which);
        } catch (const InputError& error) {
            throw InputError(file, "/scenes", error);
        }
        require_supported(scene, name, e, file);
        bases.push_back({scene.name, scene, write_scene(scene)});
        bytes += variant_bytes(bases.back(), e.vary, variants);
        if (bytes > largest_plan)
            throw InputError(file, "/vary", fmt::format("makes {:.3g} bytes of scenes and meshes", bytes),
                             fmt::format("give fewer values or smaller meshes: at most {:.0f} bytes", largest_plan));
    }
    return bases;
}

// Adds the curves of a method: one per kind of setting, and per formulation if the experiment compares them.
void add_curves(Plan& plan, const Method& method, const std::string& file) {
    const Experiment& e = plan.experiment;
    const std::string name(method.name);
    const MethodStyle style = method_style(method);
    const std::size_t before = plan.curves.size();
    const bool calibrated = e.kind->calibrated;
    const auto add = [&](SettingKind kind, const std::vector<double>& settings) {
        if (settings.empty()) return;
        plan.curves.push_back({&method, style, kind, settings, Formulation::reduced, calibrated});
        if (!e.kind->all_formulations) return;
        for (const Formulation formulation : {Formulation::full_principal, Formulation::full})
            plan.curves.push_back({&method, style, kind, settings, formulation, false});
    };
    if (takes_step(method))
        add(SettingKind::step, calibrated              ? e.evaluations_per_revolution
                               : e.kind->chooses_steps ? std::vector{std::nan("")}
                                                       : e.steps);
    if (takes_tolerance(method)) add(SettingKind::tolerance, calibrated ? e.evaluations_per_revolution : e.tolerances);
    if (method.control == Control::none) add(SettingKind::none, {std::nan("")});
    const bool named = std::find(e.methods.begin(), e.methods.end(), name) != e.methods.end();
    if (plan.curves.size() == before && named)
        throw InputError(file, "/settings", "has no setting for " + name,
                         calibrated           ? "give evaluations_per_revolution"
                         : takes_step(method) ? "give steps"
                                              : "give tolerances");
}

void require_few_cases(const Plan& plan, double scenes, const std::string& file) {
    double cases = 0;
    for (const PlannedCurve& curve : plan.curves) cases += static_cast<double>(curve.settings.size());
    // at least one case per scene, because every scene is read and posed
    cases = std::max(1.0, cases) * scenes;
    if (cases > most_cases)
        throw InputError(file, "", fmt::format("makes {:.12g} cases", cases),
                         fmt::format("give at most {:.0f} cases", most_cases));
}

// All combinations of the varied values.
std::vector<Changes> combine_values(const std::vector<Variation>& vary) {
    std::vector<Changes> combinations{{}};
    for (const Variation& variation : vary) {
        std::vector<Changes> next;
        for (const Changes& combination : combinations)
            for (const std::string& value : variation.values) {
                next.push_back(combination);
                next.back().emplace_back(variation.pointer, value);
            }
        combinations = std::move(next);
    }
    return combinations;
}

}  // namespace

const char* name_of(SettingKind kind) {
    return kind == SettingKind::step ? "step" : kind == SettingKind::tolerance ? "tolerance" : "none";
}

Experiment parse_experiment(std::string_view text, const std::string& file) {
    const JsonDocument document(text, file);
    const JsonNode& root = document.root();
    root.require_known_keys(keys_of(experiment_keys(), "experiment"));
    Experiment e;
    e.text = text;
    e.name = root.require_member("name", "the experiment's name").string();
    if (!is_file_name(e.name))
        root.find("name")->fail(root.find("name")->describe(),
                                "give 1 to 64 letters, digits, _ or -; the first must not be -");
    if (const JsonNode* node = root.find("about")) e.about = read_about(*node);
    if (const JsonNode* node = root.find("kind")) e.kind = read_kind(*node);
    std::vector<std::string_view> keys = {"name", "about", "kind"};
    keys.insert(keys.end(), e.kind->reads.begin(), e.kind->reads.end());
    root.require_known_keys(keys);
    for (const auto& [key, list] : {std::pair{"scenes", &e.scenes}, std::pair{"methods", &e.methods}})
        if (e.kind->conclude || root.find(key))
            *list = strings(root.require_member(key, fmt::format("a list of {}", key)));
    if (const JsonNode* node = root.find("settings")) {
        node->require_known_keys(keys_of(experiment_keys(), "settings"));
        if (const JsonNode* list = node->find("steps")) e.steps = read_settings(*list, "a step");
        if (const JsonNode* list = node->find("tolerances")) e.tolerances = read_settings(*list, "a tolerance");
        if (const JsonNode* list = node->find("evaluations_per_revolution")) {
            if (!e.kind->calibrated)
                list->fail("is a key of experiments of kind conservation", "give steps or tolerances");
            e.evaluations_per_revolution = read_settings(*list, "a number of evaluations per revolution");
            std::reverse(e.evaluations_per_revolution.begin(), e.evaluations_per_revolution.end());
        }
    }
    if (const JsonNode* node = root.find("vary")) {
        const ordered_json raw = ordered_json::parse(text, nullptr, true, true).at("vary");
        for (const JsonNode* member : node->members()) {
            Variation variation{member->key(), {}};
            if (member->elements().empty()) member->fail("is empty", "give at least one value");
            for (const ordered_json& value : raw.at(member->key())) variation.values.push_back(value.dump());
            if (e.vary.size() == most_varied)
                member->fail("exceeds the largest number of JSON pointers",
                             fmt::format("give at most {} pointers", most_varied));
            e.vary.push_back(std::move(variation));
        }
    }
    if (const JsonNode* node = root.find("samples")) e.samples = positive_count(*node, most_experiment_samples);
    if (const JsonNode* node = root.find("repeats")) e.repeats = static_cast<int>(positive_count(*node, most_repeats));
    if (const JsonNode* node = root.find("seconds_per_run")) {
        e.seconds_per_run = positive(*node, "a time");
        if (e.seconds_per_run > most_seconds_per_run)
            node->fail(node->describe(), fmt::format("give at most {:.0f} s", most_seconds_per_run));
    }
    if (const JsonNode* node = root.find("max_steps")) e.max_steps = positive_count(*node, 1L << 53);
    if (const JsonNode* node = root.find("max_evaluations")) e.max_evaluations = positive_count(*node, 1L << 53);
    return e;
}

Experiment find_experiment(const std::string& name_or_path) {
    const std::vector<std::string> names = builtin_experiment_names();
    if (const std::string_view text = builtin_experiment_text(name_or_path); !text.empty())
        return parse_experiment(text, name_or_path);
    // symlink_status: for a dangling or cyclic link read_text() reports the reason
    if (std::error_code none; std::filesystem::exists(std::filesystem::symlink_status(name_or_path, none)))
        return parse_experiment(read_text(name_or_path), name_or_path);
    throw InputError(one_line(name_or_path, 200), "experiment", "is neither a built-in experiment nor a file",
                     suggest_names(name_or_path, names, "experiments"));
}

bool has_source_descriptions(const Plan& plan) {
    return std::any_of(plan.curves.begin(), plan.curves.end(),
                       [](const PlannedCurve& c) { return !c.method->origin.empty(); });
}

Plan make_plan(const Experiment& experiment, const std::string& file, bool quick, NamedFiles which) {
    Plan plan{experiment, {}, {}, quick, file};
    if (quick) reduce_experiment(plan.experiment);
    const double variants = count_variants(plan.experiment, file);
    const std::vector<PlannedScene> bases = read_scenes(plan.experiment, file, variants, which);
    for (const Method* method : resolve_methods(plan.experiment.methods, file)) add_curves(plan, *method, file);
    require_few_cases(plan, static_cast<double>(bases.size()) * variants, file);
    const std::vector<Changes> combinations = combine_values(plan.experiment.vary);
    for (const PlannedScene& base : bases)
        for (const Changes& changes : combinations) plan.scenes.push_back(apply_changes(base, changes, file));
    return plan;
}

}  // namespace polhode
