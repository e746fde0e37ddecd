// polhode describe: all there is to know about a scene or a method.
#include "app/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "app/commands.h"
#include "app/lookup.h"
#include "scene/message.h"
#include "scene/scene_file.h"

namespace polhode {
namespace {

const char* text(Control control) {
    switch (control) {
        case Control::none:
            return "neither a step nor a tolerance";
        case Control::fixed_step:
            return "a fixed step (--step, --steps)";
        case Control::tolerance:
            return "a tolerance (--tolerance)";
        case Control::fixed_step_or_tolerance:
            break;
    }
    return "a fixed step (--step, --steps) or a tolerance (--tolerance)";
}

std::string describe(const std::string& name) {
    if (name == "auto") return "auto\n\n  The most accurate method for the scene, chosen from what it needs.\n";
    if (const Method* method = find_method(name)) return describe_method(*method);
    for (const MethodLeftOut& method : methods_left_out())
        if (method.name == name) return fmt::format("{}\n\n  Left out. {}\n", method.name, method.reason);
    try {
        return describe_scene(find_scene(name));
    } catch (const InputError&) {
        // a slip in a method's name is no scene file
        const std::string meant = did_you_mean(name, method_names());
        if (meant.empty() || !did_you_mean(name, builtin_scene_names()).empty()) throw;
        throw UsageError(fmt::format("{} is neither a scene nor a method; {}", name, meant));
    }
}

}  // namespace

std::string describe_method(const Method& method) {
    std::string description = fmt::format("{}\n\n  {}\n\n", method.name, method.documentation);
    const auto line = [&](const char* name, std::string_view value) {
        if (!value.empty()) description += fmt::format("  {:<10}  {}\n", name, value);
    };
    line("control", text(method.control));
    line("order", method.order > 0 ? std::to_string(method.order) : "variable, or none");
    line("conserves", method.conserves);
    line("source", method.source);
    return description;
}

void add_describe(CLI::App& program, int&) {
    CLI::App* command = program.add_subcommand(
        "describe",
        "Describes a scene (mass properties, system posed, what was left out, invariants, conditioning) or a method.");
    const auto name = std::make_shared<std::string>();
    command->add_option("NAME", *name, "A built-in scene, a scene file or a method")->required();
    command->callback([name] { write_output("", describe(*name)); });
}

}  // namespace polhode
