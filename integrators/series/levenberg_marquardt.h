// Eigen's Levenberg-Marquardt iteration, with the same bits for every instruction set: the header of matrices, included
// first, sets the width of Eigen's vectors.
#pragma once

#include "integrators/series/linear_algebra.h"
// after it
#include <unsupported/Eigen/LevenbergMarquardt>
