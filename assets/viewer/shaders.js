// The programs of the graphics card (GLSL of WebGL 2).

// Texels in a row of the texture of bodies; a body has three: position and
// whether it is seen, quaternion, colour and whether it is picked.
export const ROW = 1024;

const BODY = `
uniform highp sampler2D bodies;
vec4 texel(int n) { return texelFetch(bodies, ivec2(n % ${ROW}, n / ${ROW}), 0); }
vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

export const BODY_VERTEX = `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 edge_and_body;
uniform mat4 view;
out vec3 world;
out vec3 facing;
out float edge;
flat out vec4 paint;
${BODY}
void main() {
  int n = 3 * int(edge_and_body.y);
  vec4 place = texel(n), turn = texel(n + 1);
  paint = texel(n + 2);
  world = place.xyz + turned(turn, corner);
  facing = turned(turn, normal);
  edge = edge_and_body.x;
  // What is not seen goes where nothing is.
  gl_Position = place.w > 0.5 ? view * vec4(world, 1.0) : vec4(0.0, 0.0, 9.0, 1.0);
}`;

// Links: prisms between two points, each an instance.
export const LINK_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 start_and_radius;
layout(location = 2) in vec3 end;
layout(location = 3) in vec3 colour;
uniform mat4 view;
out vec3 world;
out vec3 facing;
out float edge;
flat out vec4 paint;
void main() {
  vec3 start = start_and_radius.xyz, along = end - start;
  vec3 axis = normalize(along + vec3(0.0, 0.0, 1e-9));
  vec3 one = normalize(cross(axis, abs(axis.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  vec3 other = cross(axis, one);
  facing = corner.x * one + corner.y * other;
  world = start + corner.z * along + start_and_radius.w * facing;
  edge = 1.0;
  paint = vec4(colour, 0.0);
  gl_Position = view * vec4(world, 1.0);
}`;

export const FRAGMENT = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
in vec3 world;
in vec3 facing;
in float edge;
flat in vec4 paint;
uniform vec4 cut;
uniform vec3 eye;
uniform vec3 sun;
uniform mat4 light;
uniform sampler2DShadow shadow;
uniform float opacity;
uniform float texel_m;
uniform int kind;
uniform vec3 line_colour;
uniform float grain_scale;
out vec4 colour;

float lit(vec3 normal) {
  vec4 at = light * vec4(world + normal * texel_m * 2.0, 1.0);
  vec3 place = at.xyz * 0.5 + 0.5;
  if (any(lessThan(place, vec3(0.0))) || any(greaterThan(place, vec3(1.0)))) return 1.0;
  float step = 1.0 / float(textureSize(shadow, 0).x), sum = 0.0;
  for (int i = -1; i <= 1; i++)
    for (int j = -1; j <= 1; j++)
      sum += texture(shadow, vec3(place.xy + vec2(i, j) * step, place.z - 0.0006));
  return sum / 9.0;
}

void main() {
  if (dot(cut.xyz, world) > cut.w) discard;
  vec3 normal = normalize(facing), towards = normalize(eye - world);
  bool inside = !gl_FrontFacing;
  // Pixels in metres here, among grains of the paper's size, for lines of even width.
  float from_edge = edge / grain_scale, pixel = max(fwidth(from_edge), 1e-7);
  float line = (1.0 - smoothstep(0.5 * pixel, 1.4 * pixel, from_edge)) * (1.0 - smoothstep(0.0003, 0.0012, pixel));
  vec3 base = paint.rgb;
  if (kind == 2) {
    // Glass: most is seen of it where one looks along it.
    float grazing = 1.0 - abs(dot(normal, towards));
    float alpha = opacity * (0.35 + 1.9 * grazing * grazing);
    colour = vec4(pow(mix(base, line_colour, 0.6 * line), vec3(1.0 / 2.2)), clamp(max(alpha, line * opacity * 5.5), 0.0, 0.9));
    return;
  }
  vec3 shade;
  if (inside) {
    // Seen only where a cut opens a body: its face in the cut, filled evenly.
    shade = kind == 1 ? base * 0.5 : base * 0.82;
  } else {
    float sky = 0.5 + 0.5 * normal.z;
    float direct = max(dot(normal, sun), 0.0) * lit(normal);
    float fill = max(dot(normal, towards), 0.0);
    vec3 light_here = mix(vec3(0.16, 0.15, 0.15), vec3(0.36, 0.39, 0.44), sky) + vec3(0.80, 0.76, 0.68) * direct + 0.14 * fill;
    shade = base * light_here;
    if (kind == 0) shade = mix(shade, shade * 0.25, 0.75 * line);
  }
  if (paint.a > 0.5) {
    float rim = 1.0 - abs(dot(normal, towards));
    shade = mix(shade, vec3(1.0, 0.16, 0.10), 0.5 + 0.5 * rim);
    if (line > 0.3) shade = vec3(1.0);
  }
  colour = vec4(pow(clamp(shade, 0.0, 1.0), vec3(1.0 / 2.2)), opacity);
}`;

// What the sun sees: depth alone.
export const SHADOW_FRAGMENT = `#version 300 es
precision highp float;
in vec3 world;
in vec3 facing;
in float edge;
flat in vec4 paint;
uniform vec4 cut;
void main() {
  if (dot(cut.xyz, world) > cut.w) discard;
}`;
