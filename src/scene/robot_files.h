// Files that a robot file names: included files, models and meshes.
#pragma once

#include <string>

#include "body/mesh.h"

namespace polhode {

/// Reads files relative to the folder of one robot file, under the rules of read_named_text(): only files inside the
/// scene's folder, unless outside files are allowed. A default-constructed object reads no files (for a robot given
/// as text).
class RobotFiles {
  public:
    RobotFiles() = default;
    /// `directory`: the scene's folder. `file`: the robot file as named in the scene.
    RobotFiles(std::string directory, std::string file) : directory_(std::move(directory)), file_(std::move(file)) {}

    /// The path of `name` for messages.
    std::string path(const std::string& name) const;
    /// Whether the file exists and may be read.
    bool has(const std::string& name) const;
    /// The text of a robot file. Throws InputError.
    std::string text(const std::string& name) const;
    /// The surface of an OBJ or STL file. Throws InputError.
    Mesh mesh(const std::string& name) const;
    /// Files relative to the folder of `name`.
    RobotFiles relative_to(const std::string& name) const { return {directory_, path(name)}; }

  private:
    std::string directory_, file_;
    void require_files(const std::string& name) const;
};

/// The text of a robot file named by a scene in `directory`. The directory of a built-in scene contains built-in
/// files. Throws InputError.
std::string robot_text(const std::string& directory, const std::string& file);

}  // namespace polhode
