#include "text/folder_names.h"

#include <dirent.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <new>

namespace polhode {

// Avoids std::filesystem::directory_iterator: GCC's version terminates the program when memory is short, because it
// allocates in a noexcept function.
std::vector<std::string> names_in(const std::string& folder, std::error_code& fault) {
    std::vector<std::string> names;
    fault.clear();
    errno = 0;
    const std::unique_ptr<DIR, int (*)(DIR*)> open(::opendir(folder.c_str()), &::closedir);
    if (!open && errno == ENOMEM) throw std::bad_alloc();
    while (open) {
        errno = 0;
        const dirent* entry = ::readdir(open.get());
        if (!entry) break;
        const std::string name(static_cast<const char*>(entry->d_name));
        if (name != "." && name != "..") names.push_back(name);
    }
    if (errno != 0) fault = std::error_code(errno, std::generic_category());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace polhode
