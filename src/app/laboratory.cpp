#include "app/laboratory.h"

#include <fcntl.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>

#include "app/commands.h"
#include "integrators/engines/engine_methods.h"
#include "integrators/truth/memory.h"
#include "integrators/user_methods.h"

namespace polhode {
namespace {

// Opens /dev/null for each closed standard stream, so that the next opened file does not take its place. The mode
// forbids reading stdin and writing stdout and stderr.
void reserve_standard_streams() {
    for (int stream = 0; stream < 3; ++stream)
        if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY);
}

// Reads the list of engines that is installed next to the program.
void add_engines_of_program() {
    std::error_code fault;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", fault);
    const auto list = program.parent_path() / "engines" / "engines.json";
    if (!fault && std::filesystem::exists(list, fault)) add_engines(list.string());
}

// Ends the process like run_program() does, for functions that cannot throw.
[[noreturn]] void end_without_memory() { std::_Exit(print_memory_error()); }

std::atomic<bool> was_short_of_memory{false};
std::terminate_handler usual_end = nullptr;

// Copies in the JSON library and directory iterators of the standard library allocate in noexcept functions, which then
// call std::terminate(). This handler reports that memory is exhausted if that was the cause.
void end_by_terminate() {
    if (was_short_of_memory) end_without_memory();
    if (usual_end) usual_end();
    std::abort();
}

void throw_out_of_memory() {
    was_short_of_memory = true;
    throw std::bad_alloc();
}

}  // namespace

void set_memory_handlers() noexcept {
    std::set_new_handler(throw_out_of_memory);
    if (std::get_terminate() != end_by_terminate) usual_end = std::set_terminate(end_by_terminate);
}

int run_laboratory(int argc, const char* const* argv, std::span<const Method> own) {
    reserve_standard_streams();
    // exceeding the file size limit fails the write instead of ending the process
    std::signal(SIGXFSZ, SIG_IGN);
    truth::set_out_of_memory_handler(end_without_memory);
    set_memory_handlers();
    try {
        add_methods(own);
        add_engines_of_program();
    } catch (const std::bad_alloc&) {
        end_without_memory();
    }
    const std::array commands{
        add_solve,  add_truth, add_check,  add_plot,     add_describe, add_show, add_run,     add_merge,
        add_submit, add_list,  add_export, add_ensemble, add_report,   add_fit,  add_animate,
    };
    return run_program(argc, argv, commands);
}

}  // namespace polhode
