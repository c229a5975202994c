/** How the GPU moves the vertices of an actor with its markers: by a linear basis, or by Bezier patches. */
import { target, texture, useTexture } from "./gl_program.js";
import { floats, integers } from "./linalg.js";

/** What both have: one pass over a float texture, a fragment for every vertex. */
class Deformer {
  /**
   * @param {WebGL2RenderingContext} gl
   * @param {import("./gl_program.js").Programs} programs
   * @param {string} program
   * @param {{width: number, height: number, rest: WebGLTexture}} grid of the actor
   */
  constructor(gl, programs, program, grid) {
    this.gl = gl;
    this.program = programs.get(program);
    this.grid = grid;
    this.textures = [];
    this.moved = this.keep(texture(gl, gl.RGBA32F, grid.width, grid.height, null));
    this.target = target(gl, this.moved);
  }

  keep(made) {
    this.textures.push(made);
    return made;
  }

  /** Run the pass; `bind` hands over what is special to the program. */
  pass(bind) {
    const { gl, grid, program } = this;
    gl.useProgram(program.program);
    gl.bindVertexArray(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, grid.width, grid.height);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    gl.colorMask(true, true, true, true);
    useTexture(gl, 0, gl.TEXTURE_2D, grid.rest, program.at.rest);
    bind(program.at);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Four floats a vertex, as the pass has left them. */
  read() {
    const { gl, grid } = this;
    const texels = new Float32Array(4 * grid.width * grid.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.readPixels(0, 0, grid.width, grid.height, gl.RGBA, gl.FLOAT, texels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return texels;
  }

  dispose() {
    for (const made of this.textures) this.gl.deleteTexture(made);
    this.gl.deleteFramebuffer(this.target);
  }
}

/** Vertices = rest + basis * displacement. */
export class BasisDeformer extends Deformer {
  /** @param {Float32Array} basis rows of k coefficients, vertex after vertex */
  constructor(gl, programs, grid, basis, n) {
    super(gl, programs, "basis", grid);
    this.k = basis.length / n;
    this.layers = Math.ceil(this.k / 4);
    const layer = 4 * grid.width * grid.height;
    const packed = new Float32Array(layer * this.layers);
    for (let v = 0; v < n; v += 1) {
      for (let k = 0; k < this.k; k += 1) packed[(k >> 2) * layer + 4 * v + (k & 3)] = basis[v * this.k + k];
    }
    this.basis = this.keep(texture(gl, gl.RGBA32F, grid.width, grid.height, packed, this.layers));
    this.shift = new Float32Array(16 * this.layers);
    this.shiftTexture = this.keep(texture(gl, gl.RGBA32F, 4 * this.layers, 1, this.shift));
  }

  /** @param {Float32Array} displacement (k, 3), mm */
  move(displacement) {
    const { gl, shift } = this;
    for (let i = 0, j = 0; i < 3 * this.k; i += 3, j += 4) {
      shift[j] = displacement[i];
      shift[j + 1] = displacement[i + 1];
      shift[j + 2] = displacement[i + 2];
    }
    gl.bindTexture(gl.TEXTURE_2D, this.shiftTexture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 4 * this.layers, 1, gl.RGBA, gl.FLOAT, shift);
    this.pass((at) => {
      useTexture(gl, 1, gl.TEXTURE_2D, this.shiftTexture, at.displacement);
      useTexture(gl, 2, gl.TEXTURE_2D_ARRAY, this.basis, at.basis);
      gl.uniform1i(at.layers, this.layers);
    });
  }
}

/** The control points of all patches: those at rest, and sparse rows of markers that move each. */
export class Net {
  /** @param {{k: number, rest, start, index, weight}} spec as of workbench.views.patches */
  constructor(gl, spec) {
    this.gl = gl;
    this.k = spec.k;
    this.rest = floats(spec.rest);
    this.start = integers(spec.start);
    this.index = integers(spec.index);
    this.weight = floats(spec.weight);
    this.n = this.rest.length / 3;
    this.texels = new Float32Array(4 * this.n);
    this.texture = texture(gl, gl.RGBA32F, 10, this.n / 10, this.texels);
    this.stamp = -1;
  }

  /** Where the control points are under a displacement; once for all actors that share the net. */
  move(displacement, stamp) {
    if (stamp === this.stamp) return;
    this.stamp = stamp;
    const { gl, rest, start, index, weight, texels } = this;
    for (let row = 0; row < this.n; row += 1) {
      let [x, y, z] = [rest[3 * row], rest[3 * row + 1], rest[3 * row + 2]];
      for (let e = start[row]; e < start[row + 1]; e += 1) {
        const [w, m] = [weight[e], 3 * index[e]];
        x += w * displacement[m];
        y += w * displacement[m + 1];
        z += w * displacement[m + 2];
      }
      texels[4 * row] = x;
      texels[4 * row + 1] = y;
      texels[4 * row + 2] = z;
    }
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 10, this.n / 10, gl.RGBA, gl.FLOAT, texels);
  }

  dispose() {
    this.gl.deleteTexture(this.texture);
  }
}

/** Vertices attached to cubic Bezier triangles. */
export class PatchDeformer extends Deformer {
  /**
   * @param {Net} net that of this actor, or of the one whose patches it shares
   * @param {boolean} own whether the net goes with this actor
   * @param {Float32Array} attached (n, 8): patch, l0, l1, weight, along u, v and the normal, 0
   */
  constructor(gl, programs, grid, net, own, attached) {
    super(gl, programs, "patch", grid);
    Object.assign(this, { net, own, k: net.k });
    const layer = 4 * grid.width * grid.height;
    const packed = new Float32Array(2 * layer);
    for (let i = 0, j = 0; i < attached.length; i += 8, j += 4) {
      packed.set(attached.subarray(i, i + 4), j);
      packed.set(attached.subarray(i + 4, i + 8), layer + j);
    }
    this.attached = this.keep(texture(gl, gl.RGBA32F, grid.width, grid.height, packed, 2));
  }

  move(displacement, stamp) {
    const { gl, net } = this;
    net.move(displacement, stamp);
    this.pass((at) => {
      useTexture(gl, 1, gl.TEXTURE_2D, net.texture, at.net);
      useTexture(gl, 2, gl.TEXTURE_2D_ARRAY, this.attached, at.attached);
    });
  }

  dispose() {
    super.dispose();
    if (this.own) this.net.dispose();
  }
}
