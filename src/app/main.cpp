#include "app/commands.h"
#include "app/laboratory.h"

namespace {

// Constructed before all other static objects of the program, some of which allocate memory.
struct MemoryHandlers {
    MemoryHandlers() noexcept { polhode::set_memory_handlers(); }
};
[[gnu::init_priority(101)]] const MemoryHandlers memory_handlers;

}  // namespace

int main(int argc, char** argv) { return polhode::run_laboratory(argc, argv); }
