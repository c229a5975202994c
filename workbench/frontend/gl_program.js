/** WebGL2 programs, textures and targets of the mesh view. */
import {
  BASIS_FRAGMENT,
  DOTS_FRAGMENT,
  DRAW_FRAGMENT,
  DRAW_VERTEX,
  NORMAL_FRAGMENT,
  PASS_VERTEX,
  PATCH_FRAGMENT,
  PICK_FRAGMENT,
  PICK_VERTEX,
} from "./gl_shaders.js";

/** Name -> texts of the two shaders. */
const TEXTS = {
  basis: [PASS_VERTEX, BASIS_FRAGMENT],
  patch: [PASS_VERTEX, PATCH_FRAGMENT],
  normals: [PASS_VERTEX, NORMAL_FRAGMENT],
  draw: [DRAW_VERTEX, DRAW_FRAGMENT],
  dots: [DRAW_VERTEX, DOTS_FRAGMENT],
  pick: [PICK_VERTEX, PICK_FRAGMENT],
};

/**
 * Compile and link.
 * @param {WebGL2RenderingContext} gl
 * @returns {{program: WebGLProgram, at: Record<string, WebGLUniformLocation>}} program and its uniforms
 */
function build(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
    gl.deleteShader(shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const at = {};
  const n = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < n; i += 1) {
    const { name } = gl.getActiveUniform(program, i);
    at[name.replace("[0]", "")] = gl.getUniformLocation(program, name);
  }
  return { program, at };
}

/** The programs of a context, each compiled when it is first asked for. */
export class Programs {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    this.built = new Map();
  }

  /** @param {keyof TEXTS} name */
  get(name) {
    let found = this.built.get(name);
    if (!found) this.built.set(name, (found = build(this.gl, ...TEXTS[name])));
    return found;
  }

  dispose() {
    for (const { program } of this.built.values()) this.gl.deleteProgram(program);
    this.built.clear();
  }
}

/** A texture without filtering; an array texture when `layers` is given. */
export function texture(gl, format, width, height, data, layers = 0) {
  const [external, type] = {
    [gl.RGBA32F]: [gl.RGBA, gl.FLOAT],
    [gl.RGBA8]: [gl.RGBA, gl.UNSIGNED_BYTE],
    [gl.RG32UI]: [gl.RG_INTEGER, gl.UNSIGNED_INT],
    [gl.RGBA32UI]: [gl.RGBA_INTEGER, gl.UNSIGNED_INT],
  }[format];
  const target = layers ? gl.TEXTURE_2D_ARRAY : gl.TEXTURE_2D;
  const made = gl.createTexture();
  gl.bindTexture(target, made);
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  if (layers) gl.texImage3D(target, 0, format, width, height, layers, 0, external, type, data);
  else gl.texImage2D(target, 0, format, width, height, 0, external, type, data);
  return made;
}

/** A frame buffer that draws into a texture. */
export function target(gl, made) {
  const found = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, found);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, made, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return found;
}

/** Let a sampler read a texture. */
export function useTexture(gl, unit, kind, made, location) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(kind, made);
  gl.uniform1i(location, unit);
}
