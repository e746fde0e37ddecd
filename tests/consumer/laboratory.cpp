// polhode's program with a method of one's own in it: `laboratory run heun.json` measures it beside the others.
#include <polhode/laboratory.h>

#include "own_method.h"

int main(int argc, char** argv) { return polhode::run_laboratory(argc, argv, {&heun, 1}); }
