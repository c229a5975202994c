/** The scene of a mesh view: its actors, its lights, and how it is drawn. */
import { Actor, LINES, POINTS, SURFACE } from "./gl_actor.js";
import { Programs, useTexture } from "./gl_program.js";
import { MAX_LIGHTS } from "./gl_shaders.js";
import { CoarsePicture, PlainPicture, SmoothEdges, drawnInSoftware } from "./gl_smooth.js";
import { length, multiply, parallel, perspective, subtract, unit, viewMatrix } from "./linalg.js";

const NEAR = 0.02;
const FAR = 8;
const FIT_ANGLE = 30;

/** Actors drawn by WebGL2; throws a sentence where that is not possible. */
export class Scene {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!gl) throw new Error("this browser offers no WebGL2");
    if (!gl.getExtension("EXT_color_buffer_float")) {
      throw new Error("this browser's WebGL2 cannot draw into float textures");
    }
    this.gl = gl;
    this.programs = new Programs(gl);
    /** The processor draws: pixels cost much while something moves. */
    this.slow = drawnInSoftware(gl);
    this.smooth = new SmoothEdges(gl);
    this.quick = this.slow ? new CoarsePicture(gl) : new PlainPicture(gl);
    /** @type {Map<string, Actor>} */
    this.actors = new Map();
  }

  /** Replace all actors. */
  setActors(specs) {
    this.clear();
    for (const spec of specs) this.add(spec);
  }

  /** One more actor; those whose patches it shares must be there. */
  add(spec) {
    this.remove(spec.name);
    this.actors.set(spec.name, new Actor(this, spec));
  }

  remove(name) {
    this.actors.get(name)?.dispose();
    this.actors.delete(name);
  }

  /** Actors that have anything to show. */
  shown() {
    return [...this.actors.values()].filter((a) => a.visible && a.opacity > 0 && a.n);
  }

  /** A camera that looks at everything from the front. */
  fit() {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const { bounds } of this.actors.values()) {
      for (let k = 0; k < 3; k += 1) {
        low[k] = Math.min(low[k], bounds[0][k]);
        high[k] = Math.max(high[k], bounds[1][k]);
      }
    }
    const centre = low.map((v, k) => (Number.isFinite(v) ? 0.5 * (v + high[k]) : 0));
    const radius = Number.isFinite(low[0]) ? 0.5 * length(subtract(high, low)) || 1 : 1;
    const distance = radius / Math.sin((0.5 * FIT_ANGLE * Math.PI) / 180);
    return {
      position: [centre[0], centre[1], centre[2] + distance],
      focal_point: centre,
      view_up: [0, 1, 0],
      view_angle: FIT_ANGLE,
      parallel_scale: 0,
    };
  }

  matrices(camera) {
    const { drawingBufferWidth: w, drawingBufferHeight: h } = this.gl;
    const distance = length(subtract(camera.position, camera.focal_point)) || 1;
    const range = [w / h, NEAR * distance, FAR * distance];
    const projection = camera.parallel_scale
      ? parallel(camera.parallel_scale, ...range)
      : perspective(camera.view_angle, ...range);
    return { view: viewMatrix(camera), projection };
  }

  /**
   * Draw everything: what is opaque first, then what is not, its nearest layer only.
   * @param {object} camera position, focal_point, view_up, view_angle (degrees), parallel_scale (0: perspective)
   * @param {{direction: number[], colour: number[], eye: boolean}[]} lights
   * @param {number[]} ground red, green, blue
   * @param {boolean} smooth with smooth edges; without, coarsely where the processor draws
   */
  draw(camera, lights, ground, smooth = true) {
    const { gl } = this;
    const { view, projection } = this.matrices(camera);
    const shown = this.shown();
    for (const { normals } of shown) normals?.refresh();
    const picture = smooth ? this.smooth : this.quick;
    const fine = picture.begin();
    gl.viewport(0, 0, Math.round(fine * gl.drawingBufferWidth), Math.round(fine * gl.drawingBufferHeight));
    gl.clearColor(ground[0], ground[1], ground[2], 1);
    gl.colorMask(true, true, true, true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.disable(gl.BLEND);
    this.lit = { lights, view, fine, programs: new Set() };
    for (const actor of shown) if (actor.opacity >= 1) this.drawActor(actor, view, projection);
    for (const actor of shown) {
      if (actor.opacity >= 1) continue;
      gl.colorMask(false, false, false, false);
      this.drawActor(actor, view, projection);
      gl.colorMask(true, true, true, true);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      this.drawActor(actor, view, projection);
      gl.disable(gl.BLEND);
    }
    gl.bindVertexArray(null);
    picture.end();
  }

  /** Take up the program of a kind of actor; with its lights, once a picture. */
  use(kind) {
    const { gl, lit } = this;
    const found = this.programs.get(kind === POINTS ? "dots" : "draw");
    gl.useProgram(found.program);
    if (!lit.programs.has(found)) this.setLights(found.at, lit.lights, lit.view);
    lit.programs.add(found);
    return found.at;
  }

  setLights(at, lights, view) {
    const { gl } = this;
    const from = new Float32Array(3 * MAX_LIGHTS);
    const colour = new Float32Array(3 * MAX_LIGHTS);
    lights.slice(0, MAX_LIGHTS).forEach((light, i) => {
      const d = light.direction;
      const turned = light.eye
        ? d
        : [0, 1, 2].map((row) => view[row] * d[0] + view[4 + row] * d[1] + view[8 + row] * d[2]);
      from.set(unit(turned), 3 * i);
      colour.set(light.colour, 3 * i);
    });
    gl.uniform1i(at.lights, Math.min(lights.length, MAX_LIGHTS));
    gl.uniform3fv(at.lightFrom, from);
    gl.uniform3fv(at.lightColour, colour);
  }

  drawActor(actor, view, projection) {
    const { gl } = this;
    const at = this.use(actor.kind);
    const { spec } = actor;
    const place = actor.place(multiply);
    const toEye = place ? multiply(view, place) : view;
    gl.bindVertexArray(actor.array);
    if (!actor.coloured) gl.vertexAttrib4f(0, 1, 1, 1, 1);
    const tint = actor.coloured ? [1, 1, 1] : spec.colour;
    gl.uniform4f(at.tint, ...tint, actor.opacity);
    gl.uniform4f(at.material, ...spec.material);
    gl.uniformMatrix4fv(at.toEye, false, toEye);
    gl.uniformMatrix4fv(at.toClip, false, multiply(projection, toEye));
    gl.uniform1i(at.kind, actor.kind);
    gl.uniform1i(at.width, actor.width);
    gl.uniform1f(at.pointSize, this.lit.fine * spec.size * (globalThis.devicePixelRatio || 1));
    useTexture(gl, 0, gl.TEXTURE_2D, actor.current, at.positions);
    useTexture(gl, 3, gl.TEXTURE_2D, actor.normals?.texture ?? null, at.normals);
    useTexture(gl, 5, gl.TEXTURE_2D, actor.table, at.table);
    gl.uniform1i(at.colours, actor.table ? actor.scalars.table.byteLength / 4 - 3 : 0);
    if (actor.table) gl.uniform2f(at.range, ...actor.scalars.range);
    this.drawCells(actor);
  }

  /** The draw call alone: what is bound says how. */
  drawCells({ kind, corners, n }) {
    const { gl } = this;
    if (kind === SURFACE) gl.drawElements(gl.TRIANGLES, corners, gl.UNSIGNED_INT, 0);
    if (kind === LINES) gl.drawElements(gl.LINES, corners, gl.UNSIGNED_INT, 0);
    if (kind === POINTS) gl.drawArrays(gl.POINTS, 0, n);
  }

  /** Red, green, blue, opacity of every pixel that was just drawn, from the lower left on. */
  pixels() {
    const { gl } = this;
    const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const out = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, out);
    return out;
  }

  /** Wait until everything asked for is drawn. */
  finish() {
    const { gl } = this;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  clear() {
    for (const actor of this.actors.values()) actor.dispose();
    this.actors.clear();
  }

  /** Give everything back, the context too: a browser has only so many. */
  dispose() {
    this.clear();
    this.smooth.dispose();
    this.quick.dispose();
    this.programs.dispose();
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
