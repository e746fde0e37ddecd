// The laboratory's public face: the program with methods of one's own.
#pragma once

#include "app/laboratory.h"
