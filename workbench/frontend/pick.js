/** What is under the pointer: a few pixels around it drawn once more, each saying which vertex it shows. */
import { SURFACE } from "./gl_actor.js";
import { oneRing } from "./gl_normals.js";
import { target, texture, useTexture } from "./gl_program.js";
import { multiply, transform } from "./linalg.js";

/** Side of the square that is looked at, px: points and lines are caught a little beside them. */
const SIDE = 7;

/** Clip space so that a square around a pixel fills it. */
function around(x, y, width, height) {
  const m = new Float32Array(16);
  m[0] = width / SIDE;
  m[5] = height / SIDE;
  m[10] = m[15] = 1;
  m[12] = (width - 2 * x) / SIDE;
  m[13] = (height - 2 * y) / SIDE;
  return m;
}

/** The texel that shows something and is nearest to the middle; -1: none does. */
function nearestTexel(texels) {
  let [best, least] = [-1, Infinity];
  const middle = (SIDE - 1) / 2;
  for (let i = 0; i < SIDE * SIDE; i += 1) {
    const far = ((i % SIDE) - middle) ** 2 + (Math.floor(i / SIDE) - middle) ** 2;
    if (texels[4 * i] && far < least) [best, least] = [i, far];
  }
  return best;
}

/**
 * Pick in a scene.
 * @param {import("./gl_scene.js").Scene} scene
 * @param {object} camera
 * @param {number} x pixels of the canvas from its left
 * @param {number} y pixels of the canvas from its bottom
 * @returns {?{name: string, index: number, position: number[], value: ?number}} actor, nearest vertex, where
 *   in the scene the surface was hit, and the scalar there
 */
export function pick(scene, camera, x, y) {
  const { gl } = scene;
  const made = texture(gl, gl.RGBA32UI, SIDE, SIDE, null);
  const into = target(gl, made);
  const depth = gl.createRenderbuffer();
  gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, SIDE, SIDE);
  gl.bindFramebuffer(gl.FRAMEBUFFER, into);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
  const shown = scene.shown().filter((actor) => actor.spec.pickable !== false);
  const { view, projection } = scene.matrices(camera);
  const zoomed = multiply(around(x, y, gl.drawingBufferWidth, gl.drawingBufferHeight), projection);
  const texels = drawIds(scene, shown, multiply(zoomed, view));
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(into);
  gl.deleteRenderbuffer(depth);
  gl.deleteTexture(made);
  const at = nearestTexel(texels);
  if (at < 0) return null;
  const actor = shown[(texels[4 * at] >>> 24) - 1];
  const position = [...new Float32Array(texels.slice(4 * at + 1, 4 * at + 4).buffer)];
  const index = nearestVertex(actor, texels[4 * at] & 0xffffff, position);
  const values = actor.scalars && new Float32Array(actor.scalars.values.slice(0));
  return { name: actor.name, index, position, value: values ? values[index] : null };
}

/** Draw numbers in place of colours into what is bound, and read them. */
function drawIds(scene, shown, toClip) {
  const { gl } = scene;
  const { program, at } = scene.programs.get("pick");
  gl.viewport(0, 0, SIDE, SIDE);
  gl.colorMask(true, true, true, true);
  gl.disable(gl.BLEND);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
  gl.clearBufferfv(gl.DEPTH, 0, [1]);
  gl.useProgram(program);
  shown.forEach((actor, i) => {
    const place = actor.place(multiply) ?? IDENTITY;
    gl.bindVertexArray(actor.array);
    gl.uniformMatrix4fv(at.toScene, false, place);
    gl.uniformMatrix4fv(at.toClip, false, multiply(toClip, place));
    gl.uniform1i(at.kind, actor.kind);
    gl.uniform1i(at.width, actor.width);
    gl.uniform1ui(at.actor, i + 1);
    gl.uniform1f(at.pointSize, actor.spec.size * (globalThis.devicePixelRatio || 1));
    useTexture(gl, 0, gl.TEXTURE_2D, actor.current, at.positions);
    scene.drawCells(actor);
  });
  gl.bindVertexArray(null);
  const texels = new Uint32Array(4 * SIDE * SIDE);
  gl.readPixels(0, 0, SIDE, SIDE, gl.RGBA_INTEGER, gl.UNSIGNED_INT, texels);
  return texels;
}

const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

/** Of a vertex and those it shares a triangle (or line) with, the one nearest to a place in the scene. */
function nearestVertex(actor, vertex, place) {
  if (!actor.cells) return vertex;
  const points = actor.positions();
  const matrix = actor.place(multiply) ?? IDENTITY;
  let [best, least] = [vertex, Infinity];
  for (const v of neighbours(actor, vertex)) {
    const p = transform(matrix, points.subarray(3 * v, 3 * v + 3));
    const far = Math.hypot(p[0] - place[0], p[1] - place[1], p[2] - place[2]);
    if (far < least) [best, least] = [v, far];
  }
  return best;
}

function neighbours(actor, vertex) {
  const found = new Set([vertex]);
  if (actor.kind === SURFACE) {
    const { start, pairs } = (actor.oneRing ??= oneRing(actor.cells, actor.n));
    const first = 2 * start[2 * vertex];
    for (let i = 0; i < 2 * start[2 * vertex + 1]; i += 1) found.add(pairs[first + i]);
    return found;
  }
  for (let i = 0; i < actor.cells.length; i += 2) {
    const [a, b] = [actor.cells[i], actor.cells[i + 1]];
    if (a === vertex || b === vertex) found.add(a).add(b);
  }
  return found;
}
