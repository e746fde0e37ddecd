const h = 1 / 240, times = (a, b) => ({  // the scene t_handle with its initial angular velocity, constant in world axes
  w: a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, x: a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
  y: a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, z: a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w});
let q = {x: 0, y: 0, z: 0, w: 1}, w = {x: 0.01, y: 15, z: 0.02};
console.log("time,rotation.x,rotation.y,rotation.z,rotation.w,omega.x,omega.y,omega.z");
for (let n = 0; n <= 480; ++n) {
  console.log([n * h, q.x, q.y, q.z, q.w, w.x, w.y, w.z].join(","));
  const speed = Math.hypot(w.x, w.y, w.z), s = Math.sin(h * speed / 2) / speed;
  q = times({w: Math.cos(h * speed / 2), x: s * w.x, y: s * w.y, z: s * w.z}, q);
}
