// A golden test of Bullet: compares the scene t_handle with the truth exported by polhode. The argument is the number
// of steps per sample.
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstdlib>

#include "t_handle.hpp"

namespace golden = polhode_t_handle;

int main(int, char** arguments) {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    btSphereShape shape(0.05);
    btRigidBody body(golden::mass, nullptr, &shape,
                     {golden::inertia[0][0], golden::inertia[1][1], golden::inertia[2][2]});
    body.setActivationState(DISABLE_DEACTIVATION);
    world.setGravity({0, 0, 0}), world.addRigidBody(&body);
    body.setAngularVelocity({golden::w[0][0], golden::w[0][1], golden::w[0][2]});
    const int steps = std::atoi(arguments[1]);
    int failed = 0;
    for (int k = 1; k < golden::samples && failed == 0; ++k) {
        for (int n = 0; n < steps; ++n) world.stepSimulation((golden::t[k] - golden::t[k - 1]) / steps, 0);
        const btQuaternion r = body.getOrientation();
        const double q[] = {r.w(), r.x(), r.y(), r.z()};
        const std::string fault = golden::compare(k, q);
        if (!fault.empty()) std::puts(fault.c_str()), failed = 1;
    }
    world.removeRigidBody(&body);
    return failed;
}
