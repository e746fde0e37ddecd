#include "other_process.h"

#include "expect.h"
#include "parts.h"

using namespace polhode;

std::shared_ptr<const Method> shell_script() {
    EngineCommand command;
    command.arguments = {CONSUMER_DIRECTORY "/engine.sh", "{samples}"};
    return external_method({.name = "shell_script",
                            .documentation = "A shell script that rotates a body about its z axis.",
                            .source = "engine.sh"},
                           command);
}

Scene spinning_body() {
    Scene scene;
    scene.name = "spinning_body";
    scene.duration = 10;
    scene.body.inertia_B = diagonal(Vector3<double>(1, 2, 2.5));
    scene.initial.angular_velocity = {0, 0, 0.75};
    return scene;
}
