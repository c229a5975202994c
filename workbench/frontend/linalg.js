/** Vectors as arrays of three, matrices as 16 numbers column by column (the way WebGL takes them). */

/** @returns {number[]} a - b */
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @returns {number[]} a + b */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @returns {number[]} a * s */
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
/** @returns {number} */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @returns {number} */
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
/** @returns {number[]} */
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
/** @returns {number[]} a at length 1; a null vector stays as it is */
export const unit = (a) => scale(a, 1 / (length(a) || 1));

/** Turn v about the unit axis by an angle in radians (Rodrigues). */
export function rotate(v, axis, angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return add(add(scale(v, c), scale(cross(axis, v), s)), scale(axis, dot(axis, v) * (1 - c)));
}

/** @returns {Float32Array} the product a b */
export function multiply(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column += 1) {
    for (let row = 0; row < 4; row += 1) {
      let sum = 0;
      for (let k = 0; k < 4; k += 1) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/** Where a matrix puts a point. @returns {number[]} */
export const transform = (m, p) =>
  [0, 1, 2].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);

/** From the world to the eye: the eye looks along -z, x to the right, y up. */
export function viewMatrix(camera) {
  const z = unit(subtract(camera.position, camera.focal_point));
  const x = unit(cross(camera.view_up, z));
  const y = cross(z, x);
  const e = camera.position;
  return new Float32Array([
    ...[x[0], y[0], z[0], 0],
    ...[x[1], y[1], z[1], 0],
    ...[x[2], y[2], z[2], 0],
    ...[-dot(x, e), -dot(y, e), -dot(z, e), 1],
  ]);
}

/**
 * From the eye to clip space.
 * @param {number} angle vertical opening, degrees
 * @param {number} aspect width / height
 * @param {number} near
 * @param {number} far
 */
export function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan((angle * Math.PI) / 360);
  const m = new Float32Array(16);
  m[0] = f / aspect;
  m[5] = f;
  m[10] = (far + near) / (near - far);
  m[11] = -1;
  m[14] = (2 * far * near) / (near - far);
  return m;
}

/** As `perspective`, without vanishing point; `height` is what the picture shows from its middle to its edge. */
export function parallel(height, aspect, near, far) {
  const m = new Float32Array(16);
  m[0] = 1 / (height * aspect);
  m[5] = 1 / height;
  m[10] = 2 / (near - far);
  m[14] = (far + near) / (near - far);
  m[15] = 1;
  return m;
}

/** View a buffer that came over the wire as floats. */
export function floats(bytes) {
  if (!bytes?.byteLength) return new Float32Array(0);
  return new Float32Array(bytes instanceof ArrayBuffer ? bytes : bytes.slice().buffer);
}

/** View a buffer that came over the wire as whole numbers. */
export function integers(bytes) {
  if (!bytes?.byteLength) return new Uint32Array(0);
  return new Uint32Array(bytes instanceof ArrayBuffer ? bytes : bytes.slice().buffer);
}

/** View a buffer that came over the wire as bytes. */
export function octets(bytes) {
  if (!bytes?.byteLength) return new Uint8Array(0);
  return new Uint8Array(bytes instanceof ArrayBuffer ? bytes : bytes.slice().buffer);
}
