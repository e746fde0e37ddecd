// The examples, one per file.
#pragma once

void solve_by_the_library();
void add_a_torque();
void add_a_method();
void add_a_system();
void make_a_table();
