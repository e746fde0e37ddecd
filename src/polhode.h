// All that a program needs to pose a scene and solve it: #include <polhode/polhode.h>, link polhode::polhode.
#pragma once

#include "integrators/method.h"
#include "integrators/own/ensemble.h"
#include "integrators/run/march.h"
#include "measure/errors.h"
#include "motion/problem.h"
#include "motion/trajectory.h"
#include "scene/scene.h"
#include "scene/scene_file.h"
