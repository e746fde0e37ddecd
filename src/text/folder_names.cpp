#include "text/folder_names.h"

#include <algorithm>
#include <filesystem>

namespace polhode {

std::vector<std::string> names_in(const std::string& folder, std::error_code& fault) {
    std::vector<std::string> names;
    fault.clear();
    try {
        // not by increment(fault), which ends the program where memory is short: it may throw nothing, and allocates
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            names.push_back(entry.path().filename().string());
    } catch (const std::filesystem::filesystem_error& error) {
        fault = error.code();
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace polhode
