// Tries all that a user of the installed library may want; exit 1 where a result is off.
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
