/** One actor of the mesh view: a surface, points or lines, with its positions in a float texture. */
import { BasisDeformer, Net, PatchDeformer } from "./gl_deform.js";
import { Normals } from "./gl_normals.js";
import { texture } from "./gl_program.js";
import { floats, integers, octets, transform } from "./linalg.js";

export const SURFACE = 0;
export const POINTS = 1;
export const LINES = 2;
const KINDS = { surface: SURFACE, points: POINTS, lines: LINES };

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

export class Actor {
  /**
   * @param {import("./gl_scene.js").Scene} scene
   * @param {object} spec as made by workbench.views.scene_actors
   */
  constructor(scene, spec) {
    const { gl } = scene;
    this.gl = gl;
    this.name = spec.name;
    this.spec = spec;
    this.kind = KINDS[spec.kind];
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
    this.bounds = extent(points, spec.matrix);
    this.rest = this.keep(texture(gl, gl.RGBA32F, this.width, this.height, this.staged));
    this.current = this.rest;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    if (spec.colours?.byteLength) this.uploadColours(octets(spec.colours));
    if (this.kind !== POINTS) this.uploadCells(integers(spec.cells));
    gl.bindVertexArray(null);
    this.setScalars(spec.scalars);
    this.deformer = this.makeDeformer(scene, spec);
    this.normals = this.kind === SURFACE ? new Normals(gl, scene.programs, this) : null;
  }

  keep(made) {
    this.textures.push(made);
    return made;
  }

  makeDeformer(scene, { basis, patches }) {
    const { gl, n } = this;
    if (basis?.byteLength) return new BasisDeformer(gl, scene.programs, this, floats(basis), n);
    if (!patches) return null;
    const shared = scene.actors.get(patches.of)?.deformer?.net;
    if (!shared && !patches.rest) throw new Error(`${this.name} has no patches`);
    const net = shared ?? new Net(gl, patches);
    return new PatchDeformer(gl, scene.programs, this, net, !shared, floats(patches.attached));
  }

  uploadColours(colours) {
    this.fill(0, this.buffer(), 4, this.gl.UNSIGNED_BYTE, colours);
    this.coloured = true;
  }

  /**
   * Colour by numbers, or no longer.
   * @param {?{values, range: number[], table, title: string}} scalars float32 bytes, a value a vertex; RGBA
   *   bytes of the table
   */
  setScalars(scalars) {
    const { gl } = this;
    this.scalars = scalars ?? null;
    gl.deleteTexture(this.table ?? null);
    this.table = null;
    if (!scalars) return;
    const table = octets(scalars.table);
    this.table = texture(gl, gl.RGBA8, table.length / 4, 1, table);
    this.scalarBuffer ??= this.buffer();
    gl.bindVertexArray(this.array);
    this.fill(1, this.scalarBuffer, 1, gl.FLOAT, floats(scalars.values));
    gl.bindVertexArray(null);
  }

  buffer() {
    const made = this.gl.createBuffer();
    this.buffers.push(made);
    return made;
  }

  /** Let an attribute of the vertices read these numbers. */
  fill(location, buffer, size, type, values) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, type === gl.UNSIGNED_BYTE, 0, 0);
  }

  uploadCells(cells) {
    const { gl } = this;
    this.corners = cells.length;
    this.cells = cells;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, cells, gl.STATIC_DRAW);
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
    this.setCurrent(this.rest, true);
  }

  /**
   * Deform on the GPU.
   * @param {Float32Array} displacement (k, 3), mm, of the markers from rest
   * @param {number} stamp another number for every other displacement
   */
  move(displacement, stamp) {
    if (this.deformer?.k * 3 !== displacement.length) return;
    this.deformer.move(displacement, stamp);
    this.setCurrent(this.deformer.moved, true);
  }

  /** Which positions are drawn; `changed` when the numbers in them are others than before. */
  setCurrent(positions, changed = false) {
    if (this.normals && (changed || this.current !== positions)) this.normals.fresh = false;
    this.current = positions;
  }

  /** From the actor to the scene: its own place, then its motion; 16 numbers or null. */
  place(multiply) {
    const own = this.spec.matrix ?? null;
    return own && this.rigid ? multiply(own, this.rigid) : (this.rigid ?? own);
  }

  /** Back to where the actor stands when nothing moves it. */
  reset() {
    this.setCurrent(this.rest);
    this.rigid = null;
  }

  /** Positions as the GPU has them now, without rigid motion: (n, 3) floats. */
  positions() {
    const texels = this.current === this.rest ? this.staged : this.deformer.read();
    const out = new Float32Array(3 * this.n);
    for (let i = 0, j = 0; i < out.length; i += 3, j += 4) out.set(texels.subarray(j, j + 3), i);
    return out;
  }

  dispose() {
    const { gl } = this;
    for (const made of this.textures) gl.deleteTexture(made);
    for (const made of this.buffers) gl.deleteBuffer(made);
    gl.deleteTexture(this.table);
    gl.deleteVertexArray(this.array);
    this.deformer?.dispose();
    this.normals?.dispose();
  }
}

/** Lowest and highest corner of points, where the actor's own matrix puts them. */
function extent(points, matrix) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 3) {
    const point = points.subarray(i, i + 3);
    const placed = matrix ? transform(matrix, point) : point;
    for (let axis = 0; axis < 3; axis += 1) {
      if (placed[axis] < low[axis]) low[axis] = placed[axis];
      if (placed[axis] > high[axis]) high[axis] = placed[axis];
    }
  }
  return [low, high];
}
