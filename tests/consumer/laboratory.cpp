// The polhode program with a user-defined method: `laboratory run heun.json` compares it with a built-in method.
#include <polhode/laboratory.h>

#include "own_method.h"

int main(int argc, char** argv) { return polhode::run_laboratory(argc, argv, {&heun, 1}); }
