#include "text/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace polhode {

bool wants_color(int stream) {
    const char *const refused = std::getenv("NO_COLOR"), *const kind = std::getenv("TERM");
    if (refused != nullptr && *refused != 0) return false;
    return ::isatty(stream) == 1 && kind != nullptr && std::string_view(kind) != "dumb";
}

int terminal_width(int stream, int otherwise) {
    winsize size{};
    return ::isatty(stream) == 1 && ::ioctl(stream, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col
                                                                                               : otherwise;
}

}  // namespace polhode
