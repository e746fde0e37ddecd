#include "app/laboratory.h"

int main(int argc, char** argv) { return polhode::run_laboratory(argc, argv); }
