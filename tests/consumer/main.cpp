// Runs all examples. Exits with 1 if a result is wrong.
#include "expect.h"
#include "parts.h"

int main() {
    solve_by_the_library();
    add_a_torque();
    add_a_method();
    add_a_system();
    make_a_table();
    return faults() == 0 ? 0 : 1;
}
