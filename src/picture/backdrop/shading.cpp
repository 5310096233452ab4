// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/shading.h"

#include <osg/BlendFunc>
#include <osg/Depth>
#include <osg/Program>
#include <osg/Texture>

#include "picture/backdrop/osg_adapter.h"

namespace airtruth::backdrop {
namespace {

using model::kOpaque;

constexpr const char* kVertexShader = R"(#version 120
varying vec3 p_in_part;
centroid varying vec3 p_in_eye;
centroid varying vec3 normal_in_eye;
centroid varying vec2 uv;
void main() {
  p_in_part = gl_Vertex.xyz;
  p_in_eye = (gl_ModelViewMatrix * gl_Vertex).xyz;
  normal_in_eye = gl_NormalMatrix * gl_Normal;
  uv = gl_MultiTexCoord0.xy;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

// The light equals the ray tracer's except for its shadows and what materials emit: Lambert for the
// sun, a hemisphere from ground to zenith colour, and Blinn-Phong (Blinn 1977) for the glint.
// Surfaces are two-sided by the visible side of the flat face. Texels are linear and premultiplied.
constexpr const char* kFragmentShader = R"(#version 120
varying vec3 p_in_part;
centroid varying vec3 p_in_eye;
centroid varying vec3 normal_in_eye;
centroid varying vec2 uv;
uniform vec3 to_sun_in_eye;
uniform vec3 up_in_eye;
uniform vec3 sun;
uniform vec3 sky;
uniform vec3 ground;
uniform bool encode;
uniform vec3 diffuse;
uniform vec3 emission;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
uniform bool textured;
uniform bool opaque_pass;
uniform sampler2D texels;

vec3 srgb_from_linear(vec3 linear) {
  vec3 l = clamp(linear, 0.0, 1.0);
  return mix(12.92 * l, 1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, l));
}

void main() {
  vec4 texel = textured ? texture2D(texels, uv) : vec4(1.0);
  float alpha = texel.a * opacity;
  bool is_opaque = alpha >= 0.996;
  if (is_opaque != opaque_pass || alpha <= 0.0) discard;
  vec3 to_viewer = -normalize(p_in_eye);
  vec3 face = gl_NormalMatrix * cross(dFdx(p_in_part), dFdy(p_in_part));
  face = length(face) > 0.0 ? normalize(face) : to_viewer;
  if (dot(face, to_viewer) < 0.0) face = -face;
  vec3 n = length(normal_in_eye) > 1e-6 ? normalize(normal_in_eye) : face;
  if (dot(n, face) < 0.0) n = -n;
  float cosine = dot(face, to_sun_in_eye) > 0.0 ? max(0.0, dot(n, to_sun_in_eye)) : 0.0;
  vec3 light = sun * cosine + mix(ground, sky, 0.5 + 0.5 * dot(n, up_in_eye));
  vec3 straight = diffuse * light * (texel.rgb / texel.a) + emission;
  if (cosine > 0.0 && shininess > 0.0) {
    float exponent = clamp(shininess, 4.0, 128.0);
    float halfway = max(0.0, dot(n, normalize(to_sun_in_eye + to_viewer)));
    straight += 0.08 * specular * sun * cosine * (exponent + 8.0) / 25.0 * pow(halfway, exponent);
  }
  if (encode) straight = srgb_from_linear(straight);
  if (is_opaque) alpha = 1.0;
  gl_FragColor = vec4(straight * alpha, alpha);
}
)";

osg::Vec3f osg_from_rgb(const std::array<float, 3>& rgb) { return {rgb[0], rgb[1], rgb[2]}; }

}  // namespace

Shading::Shading() : state_(new osg::StateSet) {
  osg::ref_ptr<osg::Program> program = new osg::Program;
  program->addShader(new osg::Shader(osg::Shader::VERTEX, kVertexShader));
  program->addShader(new osg::Shader(osg::Shader::FRAGMENT, kFragmentShader));
  state_->setAttributeAndModes(program, osg::StateAttribute::ON);
  state_->setMode(GL_CULL_FACE, osg::StateAttribute::OFF);
  state_->setMode(GL_LIGHTING, osg::StateAttribute::OFF);
  state_->addUniform(new osg::Uniform("texels", 0));
}

void Shading::set(const char* name, const osg::Vec3f& value) {
  state_->getOrCreateUniform(name, osg::Uniform::FLOAT_VEC3)->set(value);
}

void Shading::set_light(const shade::Light& light, const Rigid& cam_from_world) {
  const Vector3 up_in_world{0, 0, -1};
  set("to_sun_in_eye", eye_direction_from_world(cam_from_world, light.to_sun_in_world));
  set("up_in_eye", eye_direction_from_world(cam_from_world, up_in_world));
  set("sun", osg_from_rgb(light.sun));
  set("sky", osg_from_rgb(light.sky));
  set("ground", osg_from_rgb(light.ground));
}

void Shading::set_encoding(Encoding encoding) {
  state_->getOrCreateUniform("encode", osg::Uniform::BOOL)->set(encoding == Encoding::kSrgb);
}

bool is_drawn_in(Pass pass, const model::Material& material, const model::Mesh& mesh) {
  if (pass == Pass::kOpaque) return material.opacity >= kOpaque;
  return material.opacity < kOpaque || mesh.has_translucent_texels(material);
}

osg::ref_ptr<osg::StateSet> material_state(Pass pass,
                                           const model::Material& material,
                                           osg::Texture* texture) {
  osg::ref_ptr<osg::StateSet> state = new osg::StateSet;
  state->addUniform(new osg::Uniform("diffuse", osg_from_rgb(material.diffuse)));
  state->addUniform(new osg::Uniform("emission", osg_from_rgb(material.emission)));
  state->addUniform(new osg::Uniform("specular", osg_from_rgb(material.specular)));
  state->addUniform(new osg::Uniform("shininess", material.shininess));
  state->addUniform(new osg::Uniform("opacity", material.opacity));
  state->addUniform(new osg::Uniform("textured", texture != nullptr));
  state->addUniform(new osg::Uniform("opaque_pass", pass == Pass::kOpaque));
  if (texture != nullptr) state->setTextureAttribute(0, texture);
  const bool writes_depth = pass == Pass::kOpaque;
  state->setAttributeAndModes(new osg::Depth(osg::Depth::LESS, 0, 1, writes_depth),
                              osg::StateAttribute::ON);
  if (pass == Pass::kTranslucent) {
    state->setAttributeAndModes(new osg::BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA),
                                osg::StateAttribute::ON);
    state->setRenderBinDetails(10, "DepthSortedBin");
  }
  return state;
}

}  // namespace airtruth::backdrop
