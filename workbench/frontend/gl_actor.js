/** One actor of the mesh view: a surface or a set of points, with its positions in a float texture. */
import { texture, useTexture } from "./gl_program.js";
import { floats, integers, octets } from "./linalg.js";

const SURFACE = 0;
const POINTS = 1;

/** Texels of four floats from rows of three, padded to width x height. */
function padded(rows, width, height) {
  const out = new Float32Array(4 * width * height);
  for (let i = 0, j = 0; i < rows.length; i += 3, j += 4) {
    out[j] = rows[i];
    out[j + 1] = rows[i + 1];
    out[j + 2] = rows[i + 2];
  }
  return out;
}

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

export class Actor {
  /**
   * @param {WebGL2RenderingContext} gl
   * @param {object} spec as made by workbench.views.scene_actors
   */
  constructor(gl, spec) {
    this.gl = gl;
    this.name = spec.name;
    this.spec = spec;
    this.kind = spec.kind === "points" ? POINTS : SURFACE;
    this.visible = spec.visible;
    this.opacity = spec.opacity;
    /** 16 numbers or null: rigid motion, on top of the actor's own place. */
    this.rigid = null;
    const points = floats(spec.points);
    this.n = points.length / 3;
    this.width = Math.max(1, Math.min(1024, Math.ceil(Math.sqrt(this.n))));
    this.height = Math.max(1, Math.ceil(this.n / this.width));
    this.textures = [];
    this.buffers = [];
    this.staged = padded(points, this.width, this.height);
    this.bounds = extent(points);
    this.rest = this.keep(texture(gl, gl.RGBA32F, this.width, this.height, this.staged));
    this.current = this.rest;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    if (spec.colours?.byteLength) this.uploadColours(octets(spec.colours));
    if (this.kind === SURFACE) this.uploadFaces(integers(spec.faces));
    gl.bindVertexArray(null);
    if (spec.basis?.byteLength) this.uploadBasis(floats(spec.basis));
  }

  keep(made) {
    this.textures.push(made);
    return made;
  }

  uploadColours(colours) {
    const { gl } = this;
    const buffer = gl.createBuffer();
    this.buffers.push(buffer);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, colours, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    this.coloured = true;
  }

  uploadFaces(faces) {
    const { gl } = this;
    this.corners = faces.length;
    const { start, pairs } = oneRing(faces, this.n);
    this.ringWidth = Math.max(1, Math.min(2048, faces.length));
    const rows = Math.max(1, Math.ceil(faces.length / this.ringWidth));
    const ring = grown(pairs, 2 * this.ringWidth * rows);
    this.ring = this.keep(texture(gl, gl.RG32UI, this.ringWidth, rows, ring));
    const starts = grown(start, 2 * this.width * this.height);
    this.ringStart = this.keep(texture(gl, gl.RG32UI, this.width, this.height, starts));
    const buffer = gl.createBuffer();
    this.buffers.push(buffer);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
  }

  /** Basis rows (vertex after vertex) into layers of four coefficients. */
  uploadBasis(basis) {
    const { gl, n, width, height } = this;
    this.k = basis.length / n;
    this.layers = Math.ceil(this.k / 4);
    const layer = 4 * width * height;
    const packed = new Float32Array(layer * this.layers);
    for (let v = 0; v < n; v += 1) {
      for (let k = 0; k < this.k; k += 1) packed[(k >> 2) * layer + 4 * v + (k & 3)] = basis[v * this.k + k];
    }
    this.basis = this.keep(texture(gl, gl.RGBA32F, width, height, packed, this.layers));
    this.shift = new Float32Array(16 * this.layers);
    this.shiftTexture = this.keep(texture(gl, gl.RGBA32F, 4 * this.layers, 1, this.shift));
    this.deformed = this.keep(texture(gl, gl.RGBA32F, width, height, null));
    this.target = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.deformed, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Replace all positions: (n, 3) floats. */
  setPoints(points) {
    const { gl } = this;
    if (points.length !== 3 * this.n) {
      throw new Error(`${this.name} has ${this.n} points, ${points.length / 3} came`);
    }
    this.staged = padded(points, this.width, this.height);
    gl.bindTexture(gl.TEXTURE_2D, this.rest);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, this.width, this.height, gl.RGBA, gl.FLOAT, this.staged);
    this.current = this.rest;
  }

  /**
   * Deform: rest + basis * displacement, on the GPU.
   * @param {{program: WebGLProgram, at: object}} deform
   * @param {Float32Array} displacement (k, 3), mm
   */
  setDisplacement(deform, displacement) {
    const { gl } = this;
    for (let i = 0, j = 0; i < 3 * this.k; i += 3, j += 4) {
      this.shift[j] = displacement[i];
      this.shift[j + 1] = displacement[i + 1];
      this.shift[j + 2] = displacement[i + 2];
    }
    gl.bindTexture(gl.TEXTURE_2D, this.shiftTexture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 4 * this.layers, 1, gl.RGBA, gl.FLOAT, this.shift);
    gl.useProgram(deform.program);
    gl.bindVertexArray(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, this.width, this.height);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    useTexture(gl, 0, gl.TEXTURE_2D, this.rest, deform.at.rest);
    useTexture(gl, 1, gl.TEXTURE_2D, this.shiftTexture, deform.at.displacement);
    useTexture(gl, 2, gl.TEXTURE_2D_ARRAY, this.basis, deform.at.basis);
    gl.uniform1i(deform.at.layers, this.layers);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.current = this.deformed;
  }

  /** Back to where the actor stands when nothing moves it. */
  reset() {
    this.current = this.rest;
    this.rigid = null;
  }

  /** Positions as the GPU has them now, without rigid motion: (n, 3) floats. */
  positions() {
    const { gl } = this;
    let texels = this.staged;
    if (this.current === this.deformed) {
      texels = new Float32Array(4 * this.width * this.height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
      gl.readPixels(0, 0, this.width, this.height, gl.RGBA, gl.FLOAT, texels);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    }
    const out = new Float32Array(3 * this.n);
    for (let i = 0, j = 0; i < out.length; i += 3, j += 4) out.set(texels.subarray(j, j + 3), i);
    return out;
  }

  dispose() {
    const { gl } = this;
    for (const made of this.textures) gl.deleteTexture(made);
    for (const made of this.buffers) gl.deleteBuffer(made);
    gl.deleteVertexArray(this.array);
    if (this.target) gl.deleteFramebuffer(this.target);
  }
}

/** Lowest and highest corner of points. */
function extent(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 1) {
    const axis = i % 3;
    if (points[i] < low[axis]) low[axis] = points[i];
    if (points[i] > high[axis]) high[axis] = points[i];
  }
  return [low, high];
}
