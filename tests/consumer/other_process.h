// A method that is another program.
#pragma once

#include <polhode/polhode.h>

#include <memory>

/// engine.sh as a method. Whoever keeps a pointer to the method keeps the result as well.
std::shared_ptr<const polhode::Method> shell_script();

/// The scene that the script can solve: a free body that turns about its own z axis.
polhode::Scene spinning_body();
