// Lists the entries of a folder.
#pragma once

#include <string>
#include <system_error>
#include <vector>

namespace polhode {

/// The sorted names of the folder's entries. If the folder cannot be read to its end, returns the names read so far
/// and sets `fault`.
std::vector<std::string> names_in(const std::string& folder, std::error_code& fault);

}  // namespace polhode
