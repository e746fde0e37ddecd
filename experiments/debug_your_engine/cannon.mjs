// The scene t_handle in cannon-es with default settings at 240 Hz.
import * as CANNON from 'cannon-es';
const world = new CANNON.World(), body = new CANNON.Body({mass: 0.45, angularVelocity: new CANNON.Vec3(0.01, 15, 0.02)});
body.updateMassProperties = () => {};  // the engine would derive the moments from shapes
body.invInertia.set(1 / 2.2375e-4, 1 / 3.75e-4, 1 / 5.7625e-4);
body.updateInertiaWorld(true);
world.addBody(body);
console.log('t,qw,qx,qy,qz,wx,wy,wz');
for (let n = 0; n <= 480; world.step(1 / 240), ++n) {
  const q = body.quaternion, w = body.angularVelocity;
  console.log([n / 240, q.w, q.x, q.y, q.z, w.x, w.y, w.z].join());
}
