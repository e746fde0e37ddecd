// Public header of the library: include <polhode/polhode.h>, link polhode::polhode.
//
//     const polhode::Scene scene = polhode::find_scene("lagrange_top");          // or read_scene, or built in code
//     polhode::Settings settings;
//     settings.tolerance = 1e-10;
//     const polhode::Trajectory motion = polhode::solve(scene, *polhode::find_method("cvode_adams"), settings);
//     const polhode::Reference truth = polhode::reference(scene, settings.samples);
//     const polhode::Errors off = polhode::errors(polhode::error_series(scene, motion, truth), motion, truth);
//     std::cout << polhode::trajectory_csv(motion) << *off["attitude"].max << " rad, truth to " << truth.bound;
//
// Quantities are in SI units and radians. Suffixes of names denote axes: _W the inertial world frame, _B the body
// frame. Functions throw InputError for invalid scenes and files, and std::invalid_argument for arguments out of range.
// A failed integration does not throw: Trajectory::status and message report it.
#pragma once

#include "integrators/engines/external_method.h"
#include "integrators/method.h"
#include "integrators/own/ensemble.h"
#include "integrators/run/march.h"
#include "integrators/truth/reference.h"
#include "measure/errors.h"
#include "motion/problem.h"
#include "motion/trajectory.h"
#include "motion/trajectory_csv.h"
#include "motion/user_system.h"
#include "scene/scene.h"
#include "scene/scene_file.h"
#include "table/table.h"
#include "text/named_file.h"
