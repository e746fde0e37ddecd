// A method that is another program.
#pragma once

#include <polhode/polhode.h>

#include <memory>

/// engine.sh as a method. The caller must keep the returned pointer as long as it uses the method.
std::shared_ptr<const polhode::Method> shell_script();

/// The scene that the script supports: a free body that rotates about its z axis.
polhode::Scene spinning_body();
