//! The texts of the shaders. The first lines differ between OpenGL and OpenGL ES; variants
//! differ by definitions, because a software renderer computes both sides of a branch.

/// Preprocessor definition of the shader variant that revolves the outline of the part.
pub const PART: &str = "#define PART\n";
/// Preprocessor definition of the shader variant that smooths edges while it shows the picture.
pub const SMOOTH: &str = "#define SMOOTH\n";
/// Preprocessor definition of the shader variant with four samples of the shadow map.
pub const SOFT_SHADOW: &str = "#define SOFT_SHADOW\n";
/// Number of flat sides with which the part is revolved.
pub const PART_SIDES: u32 = 64;

/// Vertex shader of surfaces; its variant `PART` revolves the part from its outline.
pub const VERTEX: &str = "
uniform mat4 u_projection, u_model;
out vec3 v_position, v_normal;
out vec4 v_color, v_finish;
#ifdef PART
uniform highp sampler2D u_outline;
// Start and extent of the revolved angles, radians.
uniform vec2 u_sweep;
uniform float u_marks, u_metal;
// Colours of cut surfaces and of the skin.
uniform vec3 u_cut, u_skin;
in vec2 a_edge;
void main() {
  vec4 texel = texelFetch(u_outline, ivec2(int(a_edge.x), 0), 0);
  float angle = u_sweep.x + u_sweep.y * a_edge.y / 64.0;
  float c = cos(angle), s = sin(angle);
  vec3 p = vec3(texel.x, texel.y * c, texel.y * s);
  vec3 n = vec3(texel.z, texel.w * c, texel.w * s);
  bool skin = dot(n, n) > 2.0;
  // A chalk mark on the skin shows that the bar turns.
  bool mark = u_marks > 0.5 && (a_edge.y < 1.5 || a_edge.y > 63.5);
  v_color = skin ? vec4(mark ? vec3(0.78) : u_skin, 0.88) : vec4(u_cut, 0.95);
  // So does a dark line across a cut face.
  if (!skin && mark && abs(n.x) > 0.9) v_color.rgb = vec3(0.42, 0.44, 0.48);
  v_finish = skin ? vec4(0.55, 0.75 * u_metal, 0.0, 0.0) : vec4(0.44 - 0.20 * u_metal, u_metal, 1.0, 0.0);
#else
in vec3 a_position;
in vec4 a_normal, a_color, a_finish;
void main() {
  vec3 p = a_position, n = a_normal.xyz;
  v_color = a_color;
  v_finish = a_finish;
#endif
  vec4 world = u_model * vec4(p, 1.0);
  v_position = world.xyz;
  v_normal = mat3(u_model) * n;
  gl_Position = u_projection * world;
}
";

/// Vertex shader of lines: draws them before the surfaces in which they lie.
pub const LINE_VERTEX: &str = "
uniform mat4 u_projection, u_model;
in vec3 a_position;
in vec4 a_color;
out vec4 v_color;
void main() {
  v_color = a_color;
  gl_Position = u_projection * u_model * vec4(a_position, 1.0);
  gl_Position.z -= 0.0006 * gl_Position.w;
}
";

/// Fragment shader of lines, without lighting.
pub const LINE_FRAGMENT: &str = "
in vec4 v_color;
out vec4 o_color;
void main() { o_color = vec4(v_color.rgb, 1.0); }
";

/// Fragment shader that writes only depth.
pub const DEPTH_FRAGMENT: &str = "void main() {}\n";

/// Fragment shader that lights a surface: sky by exposure, a main light with shadow, a fill light,
/// gloss, and a studio of bright strips in the reflections.
pub const LIT_FRAGMENT: &str = "
in vec3 v_position, v_normal;
in vec4 v_color, v_finish;
out vec4 o_color;
uniform mat4 u_light_projection;
uniform vec3 u_eye, u_light, u_low, u_high, u_centre;
uniform vec2 u_fade;
uniform float u_alpha, u_rows, u_sky;
uniform highp sampler2DShadow u_shadow;
float lit() {
  vec3 s = (u_light_projection * vec4(v_position, 1.0)).xyz * 0.5 + 0.5;
  s.z -= 0.0014;
#ifdef SOFT_SHADOW
  float e = 1.2 / 1024.0;
  return 0.25 * (texture(u_shadow, s + vec3(-e, -e * 0.4, 0.0)) + texture(u_shadow, s + vec3(e * 0.4, -e, 0.0))
    + texture(u_shadow, s + vec3(e, e * 0.4, 0.0)) + texture(u_shadow, s + vec3(-e * 0.4, e, 0.0)));
#else
  return texture(u_shadow, s);
#endif
}
void main() {
  vec3 n = normalize(v_normal), v = normalize(u_eye - v_position);
  if (dot(n, v) < 0.0) n = -n;
  vec3 base = v_color.rgb * v_color.rgb;
  float exposure = v_color.a, rough = v_finish.x, metal = v_finish.y;
  float facing = max(dot(n, u_light), 0.0);
  float key = facing * lit();
  vec3 sky = mix(vec3(0.22, 0.215, 0.21), vec3(0.60, 0.64, 0.70), n.y * 0.5 + 0.5) * exposure * u_sky;
  float rings = v_finish.z * 0.10 * sin(v_position.x * 4.6) * sin(length(v_position.yz) * 5.2 + v_position.x);
  rough += rings * 0.5;
  base *= 1.0 + rings;
  vec3 r = reflect(-v, n);
  vec3 studio = mix(vec3(0.08, 0.08, 0.09), vec3(0.66, 0.71, 0.78), smoothstep(-0.35, 0.8, r.y));
  studio += 1.6 * smoothstep(0.70 - rough * 0.25, 0.80 + rough * 0.25, r.y) * smoothstep(0.55 + rough, 0.10, abs(r.z + 0.25));
  studio += 0.5 * smoothstep(0.25 + rough * 0.4, 0.0, abs(r.y - 0.18)) * smoothstep(0.2, 0.8, r.z);
  studio *= (0.55 + 0.45 * smoothstep(-0.9, 0.4, r.z + r.x * 0.4)) * u_sky;
  vec3 h = normalize(v + u_light);
  float power = exp2(10.0 * (1.0 - rough));
  float gloss = pow(max(dot(n, h), 0.0), power) * (power + 2.0) * 0.06;
  float rim = 1.0 - max(dot(n, v), 0.0);
  rim *= rim; rim *= rim;
  vec3 f0 = mix(vec3(0.04), base, metal);
  vec3 f = f0 + (1.0 - f0) * rim * (1.0 - rough) * 0.6;
  float fill = max(dot(n, vec3(-0.5, 0.25, 0.82)), 0.0) * 0.26 * u_sky;
  vec3 c = base * (1.0 - metal * 0.82) * (sky + (key * 1.45 + fill * exposure) * vec3(1.05, 1.0, 0.94))
    + f * (studio * mix(1.0, exposure, 0.85) * (1.0 - 0.35 * rough) + gloss * key * 1.3);
  c += base * v_finish.w * 1.3;
  c = c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14);
  c = sqrt(clamp(c, 0.0, 1.0));
  // The floor disappears in the background.
  float away = length(v_position.xz - u_centre.xz);
  c = mix(c, mix(u_low, u_high, gl_FragCoord.y / u_rows), smoothstep(u_fade.x, u_fade.y, away));
  float alpha = u_alpha < 1.0 ? u_alpha + 0.35 * pow(1.0 - abs(dot(n, v)), 3.0) : 1.0;
  o_color = vec4(c * alpha, alpha);
}
";

/// Vertex shader of one triangle that covers the picture.
pub const COVER_VERTEX: &str = "
out vec2 v_at;
void main() {
  vec2 p = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  v_at = p;
  gl_Position = vec4(p * 2.0 - 1.0, 0.0, 1.0);
}
";

/// Fragment shader that shows a finished picture; its variant `SMOOTH` smooths edges.
pub const SHOW_FRAGMENT: &str = "
in vec2 v_at;
out vec4 o_color;
uniform sampler2D u_picture;
uniform vec2 u_texel;
float luma(vec3 c) { return dot(c, vec3(0.3, 0.59, 0.11)); }
vec3 at(vec2 by) { return texture(u_picture, v_at + u_texel * by).rgb; }
void main() {
  vec3 m = texture(u_picture, v_at).rgb;
#ifndef SMOOTH
  o_color = vec4(m, 1.0);
#else
  float a = luma(at(vec2(-0.5, -0.5))), b = luma(at(vec2(0.5, -0.5)));
  float c = luma(at(vec2(-0.5, 0.5))), d = luma(at(vec2(0.5, 0.5))), e = luma(m);
  float low = min(e, min(min(a, b), min(c, d))), high = max(e, max(max(a, b), max(c, d)));
  vec2 g = vec2(-((a + b) - (c + d)), (a + c) - (b + d));
  g = clamp(g / (min(abs(g.x), abs(g.y)) + 0.03), -6.0, 6.0);
  vec3 near = 0.5 * (at(g * (1.0 / 3.0 - 0.5)) + at(g * (2.0 / 3.0 - 0.5)));
  vec3 far = near * 0.5 + 0.25 * (at(g * -0.5) + at(g * 0.5));
  float q = luma(far);
  vec3 smooth_color = q < low || q > high ? near : far;
  o_color = vec4(high - low < max(0.04, high * 0.11) ? m : smooth_color, 1.0);
#endif
}
";

/// Fragment shader of the background: a vertical gradient.
pub const GROUND_FRAGMENT: &str = "
in vec2 v_at;
out vec4 o_color;
uniform vec3 u_low, u_high;
void main() { o_color = vec4(mix(u_low, u_high, v_at.y), 1.0); }
";
