// Reads surfaces from OBJ and STL files.
//
// Existing libraries are not exact enough: tinyobjloader parses decimals to a few ulp and reads unparsable numbers as
// zero, and Assimp reads into binary32. A scene's number is the binary64 nearest to the decimal written.
#pragma once

#include <string>
#include <string_view>

#include "body/mesh.h"

namespace polhode {

/// A surface and the hash of its file's bytes.
struct MeshFile {
    Mesh mesh;
    std::string hash;
};

/// Reads a closed surface. The file name extension selects the format: OBJ (vertices and faces; polygons become fans
/// of triangles; normals, textures, groups and materials are ignored) or STL (text or binary). A surface whose
/// triangles all face inward is reversed. Throws InputError ("FILE: line 3: FAULT; REMEDY") if the file is unreadable
/// or truncated, an index has no vertex, mesh_fault() reports a fault, or the surface encloses no volume.
MeshFile read_mesh(const std::string& path);

/// Reads the surface `name`, named by a file in `folder`, under the rules of read_named_text().
MeshFile read_mesh(const std::string& folder, const std::string& name);

/// Parses the bytes of a surface file under the rules of read_mesh(). `path` selects the format and is named in
/// errors.
Mesh parse_mesh(std::string_view bytes, const std::string& path);

}  // namespace polhode
