// All that a program needs to pose a scene and solve it: #include <polhode/polhode.h>, link polhode::polhode.
#pragma once

#include "integrators/ensemble.h"
#include "integrators/march.h"
#include "integrators/method.h"
#include "measure/errors.h"
#include "motion/problem.h"
#include "motion/trajectory.h"
#include "scene/scene.h"
#include "scene/scene_file.h"
