#include "scene/robot_files.h"

#include <filesystem>

#include "scene/builtin.h"
#include "scene/mesh_file.h"
#include "scene/scene_limits.h"
#include "text/message.h"
#include "text/named_file.h"

namespace polhode {

void RobotFiles::require_files(const std::string& name) const {
    if (file_.empty())
        throw InputError(name, "", "is referenced by a robot description given as text",
                         "read the description from a file");
}

std::string RobotFiles::path(const std::string& name) const {
    if (name.starts_with('/')) return name;
    return (std::filesystem::path(file_).parent_path() / name).lexically_normal().generic_string();
}

bool RobotFiles::has(const std::string& name) const {
    if (file_.empty()) return false;
    if (directory_.starts_with(builtin_directory)) {
        try {
            return !text(name).empty();
        } catch (const InputError&) {
            return false;
        }
    }
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path_in(directory_, path(name)), ignored)) return false;
    try {
        path_inside(directory_, path(name));
        return true;
    } catch (const InputError&) {
        return false;
    }
}

std::string RobotFiles::text(const std::string& name) const {
    require_files(name);
    return robot_text(directory_, path(name));
}

Mesh RobotFiles::mesh(const std::string& name) const {
    require_files(name);
    return read_mesh(directory_, path(name)).mesh;
}

std::string robot_text(const std::string& directory, const std::string& file) {
    if (!directory.starts_with(builtin_directory) || file.starts_with('/'))
        return read_named_text(directory, file, largest_robot_file, "a URDF, MJCF or SDFormat file");
    const std::string folder = directory.substr(builtin_directory.size());
    const std::string name = (std::filesystem::path(folder) / file).lexically_normal().generic_string();
    const std::string_view text = builtin_robot_text(name);
    if (text.empty())
        throw InputError(name, "", "is not a built-in file", "give one of " + join_with_commas(builtin_robot_names()));
    return std::string(text);
}

}  // namespace polhode
