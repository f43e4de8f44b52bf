// Vectors as arrays of three, quaternions as x, y, z, w, matrices of sixteen by
// columns, as WebGL takes them. Lengths are metres, angles radians.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a) => Math.hypot(a[0], a[1], a[2]);

export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function normalised(a) {
  const length = norm(a);
  return length > 0 ? scaled(a, 1 / length) : [0, 0, 1];
}

// A vector turned by a unit quaternion.
export function turned(q, v) {
  const t = scaled(cross(q, v), 2);
  return add(add(v, scaled(t, q[3])), cross(q, t));
}

// The same the other way round.
export const turnedBack = (q, v) => turned([-q[0], -q[1], -q[2], q[3]], v);

export function product(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

// What an eye sees; depth goes from -1 at `near` to 1 at `far`.
export function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  const out = new Float32Array(16);
  out[0] = f / aspect;
  out[5] = f;
  out[10] = (far + near) / (near - far);
  out[11] = -1;
  out[14] = (2 * far * near) / (near - far);
  return out;
}

// What parallel light sees within `reach` of its middle.
export function parallel(reach, near, far) {
  const out = new Float32Array(16);
  out[0] = 1 / reach;
  out[5] = 1 / reach;
  out[10] = 2 / (near - far);
  out[14] = (far + near) / (near - far);
  out[15] = 1;
  return out;
}

export function lookingAt(eye, target, up) {
  const back = normalised(subtract(eye, target));
  const right = normalised(cross(up, back));
  const above = cross(back, right);
  return new Float32Array([
    right[0], above[0], back[0], 0,
    right[1], above[1], back[1], 0,
    right[2], above[2], back[2], 0,
    -dot(right, eye), -dot(above, eye), -dot(back, eye), 1,
  ]);
}

// Where a point comes to lie, after division by its depth.
export function projected(matrix, p) {
  const row = (k) => matrix[k] * p[0] + matrix[4 + k] * p[1] + matrix[8 + k] * p[2] + matrix[12 + k];
  const w = row(3);
  return [row(0) / w, row(1) / w, row(2) / w];
}
