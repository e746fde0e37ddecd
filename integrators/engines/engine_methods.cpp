// Engines as methods: reading of engine files, registration, and the solve functions.
//
// parse_engines() reads entries (EngineEntry) and makes one method per setting. EngineContext sends a request for one
// body or for a mechanism through the shared EngineSession and reads the answer. An entry with `by_step` is a program
// that is started for each trajectory instead (external_method.h).
#include "integrators/engines/engine_methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <variant>

#include "integrators/engines/engine_mechanism.h"
#include "integrators/engines/engine_session.h"
#include "integrators/engines/external_method.h"
#include "integrators/run/march.h"
#include "motion/mechanism.h"
#include "scene/scene_file.h"
#include "scene/scene_formulas.h"
#include "text/json_document.h"
#include "text/message.h"

namespace polhode {
namespace {

/// The entry of an engine in a file.
struct EngineEntry {
    std::string name, about, source, needs;
    std::vector<std::string> command, settings;
    std::vector<std::string> by_step;  ///< for a program that is started for each trajectory
    Precision precision = Precision::binary64;
    bool planes = false;
};

// The scene in the engines' terms. Throws std::invalid_argument if an engine cannot represent it.
std::variant<EngineScene, EngineMechanism> engine_bodies(const Problem& problem) {
    if (is_mechanism(problem.scene)) return engine_mechanism(problem);
    return engine_scene(problem);
}

std::string engine_refusal(const Problem& problem) {
    if (std::holds_alternative<UserSystem>(problem.system) && !has_formula_loads(problem.scene))
        return "engines do not support user-defined systems";
    if (std::string why = body_without_inertia(problem.scene); !why.empty()) return why;
    try {
        engine_bodies(problem);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

// Number of steps per sample interval; 0 if the total exceeds the limit of steps.
long steps_per_interval(const Problem& problem, const Settings& settings) {
    const long steps = steps_per_sample(problem.scene.duration / static_cast<double>(settings.samples), *settings.step);
    return steps > settings.max_steps / settings.samples ? 0 : steps;
}

/// Data of an engine's method.
struct EngineContext {
    EngineEntry entry;
    std::string setting;
    std::shared_ptr<EngineSession> session;

    EngineAnswer answer(const Problem& problem, const Settings& settings) const {
        EngineAnswer result;
        Trajectory& trajectory = result.trajectory;
        trajectory.status = Status::failed;
        const long steps = steps_per_interval(problem, settings);
        if (steps == 0) {
            trajectory.message = fmt::format("needs more than the limit of {} steps", settings.max_steps);
            trajectory.limit_reached = true;
            return result;
        }
        std::visit([&](const auto& bodies) { solve_bodies(bodies, problem, settings, steps, result); },
                   engine_bodies(problem));
        return result;
    }

  private:
    void solve_bodies(const EngineScene& scene, const Problem& problem, const Settings& settings, long steps,
                      EngineAnswer& result) const {
        EngineHello hello;
        if (!scene.planes.empty() || scene.formulas) {
            if (!check_answer(session->request_hello(hello), hello, result.trajectory)) return;
            const std::string why = scene.formulas && !hello.formulas ? no_formulas
                                    : scene.planes.empty()            ? ""
                                                                      : shapes_refusal(scene.shapes, hello.shapes);
            if (!why.empty()) {
                result.trajectory = unsupported(fmt::format("{}: {}", entry.name, why));
                return;
            }
        }
        const LineAnswer reply =
            session->send(engine_request(scene, setting, settings, steps), settings.seconds_limit, hello);
        if (!check_answer(reply, hello, result.trajectory)) return;
        result = read_answer(reply.line, problem, scene, settings, steps);
        prefix_message(result.trajectory);
    }
    void solve_bodies(const EngineMechanism& mechanism, const Problem& problem, const Settings& settings, long steps,
                      EngineAnswer& result) const {
        Trajectory& trajectory = result.trajectory;
        EngineHello hello;
        if (!check_answer(session->request_hello(hello), hello, trajectory)) return;
        if (const std::string why = joints_refusal(mechanism, hello); !why.empty()) {
            trajectory = unsupported(fmt::format("{}: {}", entry.name, why));
            return;
        }
        const LineAnswer reply =
            session->send(mechanism_request(mechanism, setting, problem.scene.duration, settings, steps),
                          settings.seconds_limit, hello);
        if (!check_answer(reply, hello, trajectory)) return;
        trajectory = read_mechanism_answer(reply.line, problem, mechanism, settings, steps);
        prefix_message(trajectory);
    }
    // Returns whether there is an answer to read; otherwise sets the trajectory's status and message.
    bool check_answer(const LineAnswer& reply, const EngineHello& hello, Trajectory& trajectory) const {
        if (reply.not_found || !hello.missing.empty()) {
            trajectory = unsupported(fmt::format("{} is not available: {}", entry.name,
                                                 hello.missing.empty() ? "it needs " + entry.needs : hello.missing));
            return false;
        }
        trajectory.message = reply.fault, trajectory.limit_reached = reply.timed_out;
        return reply.fault.empty();
    }
    void prefix_message(Trajectory& trajectory) const {
        if (trajectory.status != Status::ok && trajectory.status != Status::diverged)
            trajectory.message = fmt::format("{}: {}", entry.name, trajectory.message);
    }
};

std::vector<std::string> read_words(const JsonNode& node) {
    std::vector<std::string> all;
    for (const JsonNode* element : node.elements()) all.push_back(element->string());
    if (all.empty()) node.fail("is empty", "give at least one");
    return all;
}

// These names become part of method names, which appear in tables and file names.
void require_name(const JsonNode& node) {
    const std::string& name = node.string();
    const bool is_name = !name.empty() && std::ranges::all_of(name, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    });
    if (!is_name) node.fail(node.describe(), "letters, digits and _");
}

EngineEntry read_entry(const JsonNode& node, const std::string& directory) {
    node.require_known_keys(
        {"name", "command", "by_step", "settings", "precision", "planes", "about", "source", "needs"});
    EngineEntry entry;
    const JsonNode& name = node.require_member("name", "the engine's name");
    require_name(name);
    entry.name = name.string();
    entry.command = read_words(node.require_member("command", "the program and its arguments"));
    for (std::string& word : entry.command)
        for (std::size_t at = 0; (at = word.find("{here}", at)) != std::string::npos; at += directory.size())
            word.replace(at, 6, directory);
    entry.settings = {"default"};
    if (const JsonNode* settings = node.find("settings")) {
        entry.settings = read_words(*settings);
        for (const JsonNode* setting : settings->elements()) require_name(*setting);
    }
    if (const JsonNode* by_step = node.find("by_step")) {
        entry.by_step = read_words(*by_step);
        if (entry.settings.size() > 1)
            node.find("settings")->fail(node.find("settings")->describe(), "give one setting only with by_step");
    }
    if (const JsonNode* precision = node.find("precision")) {
        if (precision->string() != "binary32" && precision->string() != "binary64")
            precision->fail(precision->describe(), "\"binary32\" or \"binary64\"");
        if (precision->string() == "binary32") entry.precision = Precision::binary32;
    }
    if (const JsonNode* planes = node.find("planes")) entry.planes = planes->boolean();
    for (const auto& [key, text] :
         {std::pair{"about", &entry.about}, {"source", &entry.source}, {"needs", &entry.needs}})
        if (const JsonNode* found = node.find(key)) *text = found->string();
    if (entry.needs.empty()) entry.needs = entry.command.front();
    return entry;
}

/// Requests the shortest possible run: two samples, one step.
EngineReport inspect(const EngineContext& context, const Problem* problem) {
    EngineReport report;
    const LineAnswer reply = context.session->request_hello(report.hello);
    report.fault = reply.not_found       ? "it needs " + context.entry.needs
                   : reply.fault.empty() ? report.hello.missing
                                         : reply.fault;
    if (!problem || !report.fault.empty()) return report;
    if (report.fault = engine_refusal(*problem); !report.fault.empty()) return report;
    Problem brief = *problem;
    brief.scene.duration = 1e-3;
    Settings settings;
    settings.step = 1e-3, settings.samples = 1, settings.seconds_limit = 10;
    const EngineAnswer answer = context.answer(brief, settings);
    if (answer.trajectory.status == Status::ok)
        report.difference = readback_difference(engine_scene(brief), answer.readback);
    else
        report.fault = answer.trajectory.message;
    return report;
}

// A program that reads a scene and prints a trajectory, started for each trajectory.
EngineMethod make_external_engine(const EngineEntry& entry, const Method& description) {
    const EngineCommand command{.arguments = entry.command, .by_step = entry.by_step};
    // such a program provides no information about itself
    const auto inspect_nothing = [](const Problem*) { return EngineReport(); };
    return {entry.name, entry.settings.front(), external_method(description, command), inspect_nothing};
}

struct Registry {
    std::vector<std::string> unread_files;
    std::vector<EngineMethod> engines;
};
Registry& engine_registry() {
    static Registry registry;
    return registry;
}

}  // namespace

std::vector<EngineMethod> read_engines(const std::string& path) { return parse_engines(read_text(path), path); }

std::vector<EngineMethod> parse_engines(std::string_view text, const std::string& path) {
    const std::string directory = std::filesystem::absolute(path).parent_path().string();
    const JsonDocument document(text, path);
    document.root().require_known_keys({"engines"});
    std::vector<EngineMethod> all;
    for (const JsonNode* node : document.root().require_member("engines", "a list of engines").elements()) {
        const EngineEntry entry = read_entry(*node, directory);
        const auto session = std::make_shared<EngineSession>(entry.command);
        for (const std::string& setting : entry.settings) {
            const std::string name = entry.name + ":" + setting;
            for (const EngineMethod& other : all)
                if (other.method->name == name)
                    node->find("name")->fail("\"" + name + "\" is listed twice", "give each engine a unique name");
            const Method description{.name = name,
                                     .documentation = entry.about,
                                     .source = entry.source,
                                     .conserves = "not specified",
                                     .control = Control::fixed_step,
                                     .planes = entry.planes,
                                     .family = Family::engine,
                                     .library = entry.name,
                                     .precision = entry.precision};
            if (!entry.by_step.empty()) {
                all.push_back(make_external_engine(entry, description));
                continue;
            }
            const auto context = std::make_shared<const EngineContext>(EngineContext{entry, setting, session});
            Method method = description;
            method.refusal = engine_refusal;
            method.general_systems = true;
            all.push_back({entry.name, setting,
                           make_method(method,
                                       [context](const Problem& problem, const Settings& settings) {
                                           return context->answer(problem, settings).trajectory;
                                       }),
                           [context](const Problem* problem) { return inspect(*context, problem); }});
        }
    }
    return all;
}

void add_engines(const std::string& path) { engine_registry().unread_files.push_back(path); }

const std::vector<EngineMethod>& engines() {
    Registry& registry = engine_registry();
    while (!registry.unread_files.empty()) {
        const std::string path = registry.unread_files.front();
        for (EngineMethod& engine : read_engines(path)) {
            if (std::ranges::find(registry.engines, engine.method->name, [](const EngineMethod& other) {
                    return other.method->name;
                }) != registry.engines.end())
                throw InputError(path, "/engines",
                                 fmt::format("an engine named {} exists already", engine.method->name),
                                 "choose another name");
            registry.engines.push_back(std::move(engine));
        }
        registry.unread_files.erase(registry.unread_files.begin());
    }
    return registry.engines;
}

const EngineMethod* find_engine(std::string_view name) {
    for (const EngineMethod& engine : engines())
        if (engine.method->name == name || engine.engine == name) return &engine;
    return nullptr;
}

const EngineMethod* engine_of(const Method& method) {
    for (const EngineMethod& engine : engines())
        if (engine.method.get() == &method) return &engine;
    return nullptr;
}

}  // namespace polhode
