// Public header of the program's library: runs the program with user-defined methods.
#pragma once

#include "app/laboratory.h"
