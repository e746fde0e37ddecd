#include "experiment/run/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace polhode {

Progress::Progress(long total, bool quiet) : total_(total), shown_(!quiet && total > 0 && isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::advance(const std::string& what) {
    ++done_;
    show(what);
}

void Progress::report(const std::string& what) { show(what); }

void Progress::show(const std::string& what) const {
    if (!shown_) return;
    constexpr long width = 30;
    const long filled = std::min(width, width * done_ / std::max(1L, total_));
    fmt::print(stderr, "\r\x1b[K[{:#<{}}{:.<{}}] {}/{} {:.70}", "", filled, "", width - filled, done_, total_, what);
    static_cast<void>(std::fflush(stderr));  // a failure could not be reported
}

}  // namespace polhode
