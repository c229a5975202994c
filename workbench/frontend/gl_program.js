/** The two WebGL2 programs of the mesh view: one deforms vertices, one draws them. */

export const MAX_LIGHTS = 8;

/** Points are balls: their front stands out of the surface they lie on by about 0.4 % of the distance. */
const POINT_LIFT = 0.00016;

/** One triangle over the whole target: every fragment is one vertex of the mesh. */
const DEFORM_VERTEX = `#version 300 es
void main() {
  vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}`;

/** rest + sum over k of basis[k] * displacement[k]; four coefficients to a texel, one layer for each four. */
const DEFORM_FRAGMENT = `#version 300 es
precision highp float;
precision highp sampler2D;
precision highp sampler2DArray;
uniform sampler2D rest, displacement;
uniform sampler2DArray basis;
uniform int layers;
out vec4 position;
void main() {
  ivec2 vertex = ivec2(gl_FragCoord.xy);
  vec3 sum = vec3(0.0);
  for (int layer = 0; layer < layers; layer++) {
    vec4 b = texelFetch(basis, ivec3(vertex, layer), 0);
    ivec2 k = ivec2(4 * layer, 0);
    sum += b.x * texelFetch(displacement, k, 0).xyz;
    sum += b.y * texelFetch(displacement, k + ivec2(1, 0), 0).xyz;
    sum += b.z * texelFetch(displacement, k + ivec2(2, 0), 0).xyz;
    sum += b.w * texelFetch(displacement, k + ivec2(3, 0), 0).xyz;
  }
  position = vec4(texelFetch(rest, vertex, 0).xyz + sum, 1.0);
}`;

/** Positions from a texture; the normal is the sum of the cross products of the triangles around a vertex. */
const DRAW_VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D positions;
uniform usampler2D ring, ringStart;
uniform int width, ringWidth, kind;
uniform float pointSize;
uniform mat4 toEye, toClip;
layout(location = 0) in vec4 colour;
out vec3 normal, eye;
out vec4 shade;
vec3 at(int i) { return texelFetch(positions, ivec2(i % width, i / width), 0).xyz; }
void main() {
  vec3 p = at(gl_VertexID);
  vec3 sum = vec3(0.0);
  if (kind == 0) {
    uvec2 span = texelFetch(ringStart, ivec2(gl_VertexID % width, gl_VertexID / width), 0).xy;
    for (uint k = span.x; k < span.x + span.y; k++) {
      uvec2 pair = texelFetch(ring, ivec2(int(k) % ringWidth, int(k) / ringWidth), 0).xy;
      sum += cross(at(int(pair.x)) - p, at(int(pair.y)) - p);
    }
  }
  normal = mat3(toEye) * sum;
  eye = (toEye * vec4(p, 1.0)).xyz;
  shade = colour;
  gl_Position = toClip * vec4(p, 1.0);
  if (kind == 1) gl_Position.z -= ${POINT_LIFT} * gl_Position.w;
  gl_PointSize = pointSize;
}`;

/** Ambient, diffuse and Phong specular terms, lit from both sides, as VTK has them. */
const DRAW_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
in vec3 normal, eye;
in vec4 shade;
uniform vec4 tint;
uniform vec4 material;  // ambient, diffuse, specular, specular power
uniform int kind, lights;
uniform vec3 lightFrom[${MAX_LIGHTS}], lightColour[${MAX_LIGHTS}];
out vec4 pixel;
void main() {
  vec3 toEye = normalize(-eye);
  vec3 n = normalize(normal);
  if (kind == 1) {
    vec2 q = 2.0 * gl_PointCoord - 1.0;
    float r = dot(q, q);
    if (r > 1.0) discard;
    n = vec3(q.x, -q.y, sqrt(1.0 - r));
  }
  else if (!gl_FrontFacing) n = -n;
  vec4 base = shade * tint;
  vec3 diffuse = vec3(0.0), gloss = vec3(0.0);
  for (int i = 0; i < lights; i++) {
    float facing = max(dot(n, lightFrom[i]), 0.0);
    diffuse += facing * lightColour[i];
    if (facing > 0.0 && material.z > 0.0) {
      float mirror = max(dot(toEye, 2.0 * facing * n - lightFrom[i]), 0.0);
      gloss += pow(mirror, material.w) * lightColour[i];
    }
  }
  pixel = vec4(base.rgb * (material.x + material.y * diffuse) + material.z * gloss, base.a);
}`;

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

/** Both programs of a context. */
export function programs(gl) {
  return { deform: build(gl, DEFORM_VERTEX, DEFORM_FRAGMENT), draw: build(gl, DRAW_VERTEX, DRAW_FRAGMENT) };
}

/** A texture without filtering; an array texture when `layers` is given. */
export function texture(gl, format, width, height, data, layers = 0) {
  const [external, type] = {
    [gl.RGBA32F]: [gl.RGBA, gl.FLOAT],
    [gl.RG32UI]: [gl.RG_INTEGER, gl.UNSIGNED_INT],
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

/** Let a sampler read a texture. */
export function useTexture(gl, unit, target, made, location) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(target, made);
  gl.uniform1i(location, unit);
}
