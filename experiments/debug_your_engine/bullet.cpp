// The scene t_handle in Bullet with default settings at 240 Hz. An argument sets the flag of the gyroscopic term.
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstdlib>
int main(int count, char** arguments) {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    btSphereShape shape(0.05);
    btRigidBody body(0.45, nullptr, &shape, {2.2375e-4, 3.75e-4, 5.7625e-4});
    if (count > 1) body.setFlags(std::atoi(arguments[1]));
    world.setGravity({0, 0, 0}), world.addRigidBody(&body), body.setAngularVelocity({0.01, 15, 0.02});
    std::puts("t,qw,qx,qy,qz,wx,wy,wz");
    for (int n = 0; n <= 480; world.stepSimulation(1 / 240.0, 0), ++n) {
        const btQuaternion q = body.getOrientation();
        const btVector3 w = body.getAngularVelocity();
        std::printf("%.17g,%.17g,%.17g,%.17g,%.17g,", n / 240.0, q.w(), q.x(), q.y(), q.z());
        std::printf("%.17g,%.17g,%.17g\n", w.x(), w.y(), w.z());
    }
    world.removeRigidBody(&body);
}
