// What stands in a folder.
#pragma once

#include <string>
#include <system_error>
#include <vector>

namespace polhode {

/// The names of a folder's entries, in order; as many as could be read, and `fault` set, where it cannot be read
/// through.
std::vector<std::string> names_in(const std::string& folder, std::error_code& fault);

}  // namespace polhode
