/** The normals of a surface, found anew when its positions have changed: one pass, a fragment a vertex. */
import { target, texture, useTexture } from "./gl_program.js";

/**
 * The two other corners of every triangle at a vertex, vertex after vertex.
 * @param {Uint32Array} faces three vertices each
 * @param {number} n vertices
 * @returns {{start: Uint32Array, pairs: Uint32Array}} first pair and number of pairs of each vertex; pairs
 */
export function oneRing(faces, n) {
  const start = new Uint32Array(2 * n);
  for (const v of faces) start[2 * v + 1] += 1;
  for (let v = 0, sum = 0; v < n; v += 1) {
    start[2 * v] = sum;
    sum += start[2 * v + 1];
  }
  const pairs = new Uint32Array(2 * faces.length);
  const filled = new Uint32Array(n);
  for (let i = 0; i < faces.length; i += 3) {
    for (let corner = 0; corner < 3; corner += 1) {
      const v = faces[i + corner];
      const k = 2 * (start[2 * v] + filled[v]);
      filled[v] += 1;
      pairs[k] = faces[i + ((corner + 1) % 3)];
      pairs[k + 1] = faces[i + ((corner + 2) % 3)];
    }
  }
  return { start, pairs };
}

function grown(values, size) {
  const out = new values.constructor(size);
  out.set(values);
  return out;
}

export class Normals {
  /**
   * @param {WebGL2RenderingContext} gl
   * @param {import("./gl_program.js").Programs} programs
   * @param {import("./gl_actor.js").Actor} actor a surface, its cells known
   */
  constructor(gl, programs, actor) {
    Object.assign(this, { gl, actor, program: programs.get("normals") });
    const { cells, n, width, height } = actor;
    const { start, pairs } = oneRing(cells, n);
    this.ringWidth = Math.max(1, Math.min(2048, cells.length));
    const rows = Math.max(1, Math.ceil(cells.length / this.ringWidth));
    const ring = grown(pairs, 2 * this.ringWidth * rows);
    this.ring = texture(gl, gl.RG32UI, this.ringWidth, rows, ring);
    this.start = texture(gl, gl.RG32UI, width, height, grown(start, 2 * width * height));
    /** What is drawn with. */
    this.texture = texture(gl, gl.RGBA32F, width, height, null);
    this.target = target(gl, this.texture);
    /** Whether they belong to the positions that the actor has now. */
    this.fresh = false;
  }

  /** Find them, unless nothing has moved. */
  refresh() {
    if (this.fresh) return;
    this.fresh = true;
    const { gl, actor } = this;
    const { program, at } = this.program;
    gl.useProgram(program);
    gl.bindVertexArray(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, actor.width, actor.height);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    gl.colorMask(true, true, true, true);
    useTexture(gl, 0, gl.TEXTURE_2D, actor.current, at.positions);
    useTexture(gl, 1, gl.TEXTURE_2D, this.ring, at.ring);
    useTexture(gl, 2, gl.TEXTURE_2D, this.start, at.ringStart);
    gl.uniform1i(at.width, actor.width);
    gl.uniform1i(at.ringWidth, this.ringWidth);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  dispose() {
    const { gl } = this;
    for (const made of [this.ring, this.start, this.texture]) gl.deleteTexture(made);
    gl.deleteFramebuffer(this.target);
  }
}
