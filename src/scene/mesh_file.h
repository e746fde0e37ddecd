// Surfaces from OBJ and STL files.
//
// Packaged readers do not fit: tinyobjloader parses decimals to a few ulp and takes what it cannot read for zero,
// Assimp reads into binary32. A scene's number is the binary64 nearest to the decimal written.
#pragma once

#include <string>
#include <string_view>

#include "body/mesh.h"

namespace polhode {

/// A surface and the hash of the bytes it was read from.
struct MeshFile {
    Mesh mesh;
    std::string hash;
};

/// Reads a closed surface: OBJ (vertices and faces; polygons become fans of triangles; normals, textures, groups and
/// materials are read past) or STL, text or binary, told by the name's ending. Triangles that all face inward are
/// turned round. Throws InputError ("FILE: line 3: FAULT; REMEDY"): what cannot be read or is cut short, an index
/// without a vertex, a surface that mesh_fault() faults or that encloses no volume.
MeshFile read_mesh(const std::string& path);

/// The same of a file that a file in `folder` names, under the rules of read_named_text().
MeshFile read_mesh(const std::string& folder, const std::string& name);

/// The surface in the bytes of a file, read as by read_mesh(); `path` is named in errors and tells the format.
Mesh parse_mesh(std::string_view bytes, const std::string& path);

}  // namespace polhode
