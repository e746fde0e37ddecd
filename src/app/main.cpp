#include <array>

#include "app/commands.h"

int main(int argc, char** argv) {
    using namespace polhode;
    const std::array commands{
        add_solve, add_truth, add_check, add_describe, add_run, add_list,
    };
    return run_program(argc, argv, commands);
}
