/** The texts of the WebGL2 programs of the mesh view: deform vertices, find their normals, draw, pick. */

export const MAX_LIGHTS = 8;

/** Points and lines stand out of the surface they lie on by about 0.4 % of the distance. */
const LIFT = 0.00016;

/** One triangle over the whole target: every fragment is one vertex of the mesh. */
export const PASS_VERTEX = `#version 300 es
void main() {
  vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}`;

/** rest + sum over k of basis[k] * displacement[k]; four coefficients to a texel, one layer for each four. */
export const BASIS_FRAGMENT = `#version 300 es
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

/**
 * A vertex on a cubic Bezier triangle (paper A, equation 3): the point, both tangents and the normal of the
 * patch by de Casteljau, the vertex's offsets along them, and how much of that it follows. Row y of `net` has
 * the ten control points of patch y: 300, and, told from it, 210 201 120 111 102 030 021 012 003.
 */
export const PATCH_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
uniform sampler2D rest, net;
uniform sampler2DArray attached;  // (patch, l0, l1, weight), (along u, along v, along the normal, -)
out vec4 position;
const float PARALLEL = 1e-10;  // square of an area, mm^4
void main() {
  ivec2 vertex = ivec2(gl_FragCoord.xy);
  vec3 still = texelFetch(rest, vertex, 0).xyz;
  vec4 on = texelFetch(attached, ivec3(vertex, 0), 0);
  position = vec4(still, 1.0);
  if (on.w == 0.0) return;
  vec3 off = texelFetch(attached, ivec3(vertex, 1), 0).xyz;
  vec3 l = vec3(on.yz, 1.0 - on.y - on.z);
  int row = int(on.x + 0.5);
  vec3 b[10];
  for (int i = 1; i < 10; i++) b[i] = texelFetch(net, ivec2(i, row), 0).xyz;
  b[0] = vec3(0.0);
  vec3 origin = texelFetch(net, ivec2(0, row), 0).xyz;
  vec3 c200 = l.x * b[0] + l.y * b[1] + l.z * b[2];
  vec3 c110 = l.x * b[1] + l.y * b[3] + l.z * b[4];
  vec3 c101 = l.x * b[2] + l.y * b[4] + l.z * b[5];
  vec3 c020 = l.x * b[3] + l.y * b[6] + l.z * b[7];
  vec3 c011 = l.x * b[4] + l.y * b[7] + l.z * b[8];
  vec3 c002 = l.x * b[5] + l.y * b[8] + l.z * b[9];
  vec3 x = l.x * c200 + l.y * c110 + l.z * c101;
  vec3 y = l.x * c110 + l.y * c020 + l.z * c011;
  vec3 z = l.x * c101 + l.y * c011 + l.z * c002;
  vec3 u = 3.0 * (x - z);
  vec3 v = 3.0 * (y - z);
  vec3 n = cross(u, v);
  float square = dot(n, n);
  n *= square > PARALLEL ? inversesqrt(square) : 0.0;
  vec3 moved = l.x * x + l.y * y + l.z * z + off.x * u + off.y * v + off.z * n;
  position.xyz = mix(still, origin + moved, on.w);
}`;

/** The normal at every vertex: the sum of the cross products of the triangles around it. */
export const NORMAL_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D positions;
uniform usampler2D ring, ringStart;
uniform int width, ringWidth;
out vec4 normal;
vec3 at(int i) { return texelFetch(positions, ivec2(i % width, i / width), 0).xyz; }
void main() {
  ivec2 vertex = ivec2(gl_FragCoord.xy);
  vec3 p = texelFetch(positions, vertex, 0).xyz;
  vec3 sum = vec3(0.0);
  uvec2 span = texelFetch(ringStart, vertex, 0).xy;
  for (uint k = span.x; k < span.x + span.y; k++) {
    uvec2 pair = texelFetch(ring, ivec2(int(k) % ringWidth, int(k) / ringWidth), 0).xy;
    sum += cross(at(int(pair.x)) - p, at(int(pair.y)) - p);
  }
  normal = vec4(sum, 0.0);
}`;

/** Positions and normals from textures. */
export const DRAW_VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D positions, normals;
uniform int width, kind;
uniform float pointSize;
uniform mat4 toEye, toClip;
layout(location = 0) in vec4 colour;
layout(location = 1) in float scalar;
out vec3 normal, eye;
out vec4 shade;
out float value;
void main() {
  ivec2 texel = ivec2(gl_VertexID % width, gl_VertexID / width);
  vec3 p = texelFetch(positions, texel, 0).xyz;
  normal = kind == 0 ? mat3(toEye) * texelFetch(normals, texel, 0).xyz : vec3(0.0);
  eye = (toEye * vec4(p, 1.0)).xyz;
  shade = colour;
  value = scalar;
  gl_Position = toClip * vec4(p, 1.0);
  if (kind != 0) gl_Position.z -= ${LIFT} * gl_Position.w;
  gl_PointSize = pointSize;
}`;

/** A point is drawn as a ball. */
const ROUND = `vec2 q = 2.0 * gl_PointCoord - 1.0;
  float r = dot(q, q);
  if (r > 1.0) discard;
  n = vec3(q.x, -q.y, sqrt(1.0 - r));`;

/**
 * Ambient, diffuse and Phong specular terms, lit from both sides, as VTK has them; lines are not lit. Scalars
 * are mapped pixel by pixel; `table` holds the colour below, those of the range, the one above, and of NaN.
 * Only round points leave pixels out: a program that may do so for surfaces shades what is hidden, too.
 */
const shading = (round) => `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
in vec3 normal, eye;
in vec4 shade;
in float value;
uniform vec4 tint;
uniform vec4 material;  // ambient, diffuse, specular, specular power
uniform int kind, lights, colours;
uniform sampler2D table;
uniform vec2 range;
uniform vec3 lightFrom[${MAX_LIGHTS}], lightColour[${MAX_LIGHTS}];
out vec4 pixel;
vec4 mapped(float s) {
  if (isnan(s) || s != s) return texelFetch(table, ivec2(colours + 2, 0), 0);
  if (s < range.x) return texelFetch(table, ivec2(0, 0), 0);
  if (s > range.y) return texelFetch(table, ivec2(colours + 1, 0), 0);
  float share = range.y > range.x ? (s - range.x) / (range.y - range.x) : 0.5;
  return texelFetch(table, ivec2(1 + min(int(share * float(colours)), colours - 1), 0), 0);
}
void main() {
  vec4 base = shade * tint;
  if (colours > 0) base = mapped(value) * vec4(1.0, 1.0, 1.0, tint.a);
  if (kind == 2) {
    pixel = base;
    return;
  }
  vec3 toEye = normalize(-eye);
  vec3 n = normalize(normal);
  ${round ? ROUND : "if (!gl_FrontFacing) n = -n;"}
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

export const DRAW_FRAGMENT = shading(false);
export const DOTS_FRAGMENT = shading(true);

/** Which vertex of a triangle, point or line is drawn here, and where in the scene. */
export const PICK_VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D positions;
uniform int width, kind;
uniform float pointSize;
uniform mat4 toScene, toClip;
flat out int vertex;
out vec3 place;
void main() {
  vec4 p = vec4(texelFetch(positions, ivec2(gl_VertexID % width, gl_VertexID / width), 0).xyz, 1.0);
  vertex = gl_VertexID;
  place = (toScene * p).xyz;
  gl_Position = toClip * p;
  if (kind != 0) gl_Position.z -= ${LIFT} * gl_Position.w;
  gl_PointSize = pointSize;
}`;

/** One more than the actor, 8 bits, and the vertex, 24 bits; then the bits of the place. */
export const PICK_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
flat in int vertex;
in vec3 place;
uniform int kind;
uniform uint actor;
out uvec4 found;
void main() {
  if (kind == 1) {
    vec2 q = 2.0 * gl_PointCoord - 1.0;
    if (dot(q, q) > 1.0) discard;
  }
  found = uvec4(actor << 24u | uint(vertex), floatBitsToUint(place));
}`;
