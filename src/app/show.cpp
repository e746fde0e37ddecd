// polhode show: prints the JSON of a scene verbatim.
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands.h"
#include "scene/scene_file.h"
#include "text/json_document.h"

namespace polhode {

void add_show(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("show", "Prints the JSON of a scene verbatim, including comments.");
    command->footer(
        "Examples:\n"
        "  polhode show lagrange_top > mine.json\n");
    const auto scene = std::make_shared<std::string>();
    command->add_option("SCENE", *scene, "A built-in scene (polhode list scenes) or a scene file")->required();
    add_outside_option(*command);
    command->callback([scene, &exit_code] {
        // throws if the file is not a valid scene
        find_scene(*scene);
        const std::string_view builtin = builtin_scene_text(*scene);
        std::string text = builtin.empty() ? read_text(*scene) : std::string(builtin);
        if (!text.ends_with('\n')) text += '\n';
        write_output("", text);
        exit_code = 0;
    });
}

}  // namespace polhode
