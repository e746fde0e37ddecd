#include "expect.h"

#include <cstdio>

namespace {
int count = 0;
}  // namespace

void expect_below(const char* what, double value, double limit) {
    const bool fine = value < limit;
    std::printf("%-64s %.3e %s %.3e\n", what, value, fine ? "<" : "NOT <", limit);
    if (!fine) ++count;
}

void expect(const char* what, bool holds) {
    if (holds) return;
    std::printf("NOT: %s\n", what);
    ++count;
}

void expect_ok(const char* what, const polhode::Trajectory& trajectory) {
    if (trajectory.status == polhode::Status::ok) return;
    std::printf("%s: %s: %s\n", what, polhode::name_of(trajectory.status), trajectory.message.c_str());
    ++count;
}

int faults() { return count; }
