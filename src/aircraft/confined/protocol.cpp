// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/protocol.h"

#include "aircraft/ac3d/ac_file.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxTextBytes = 65536;

template <int kRows>
void put_vectors(WireWriter& out, const std::vector<Eigen::Matrix<float, kRows, 1>>& vectors) {
  static_assert(sizeof(Eigen::Matrix<float, kRows, 1>) == kRows * sizeof(float));
  out.put(static_cast<std::uint64_t>(vectors.size()));
  out.put_raw(vectors.data(), vectors.size() * kRows * sizeof(float));
}

template <int kRows>
std::vector<Eigen::Matrix<float, kRows, 1>> get_vectors(WireReader& in) {
  std::vector<Eigen::Matrix<float, kRows, 1>> vectors(
      in.get_count(kMaxCorners, kRows * sizeof(float)));
  in.get_raw(vectors.data(), vectors.size() * kRows * sizeof(float));
  return vectors;
}

void put_floats(WireWriter& out, const std::array<float, 3>& values) {
  for (const float value : values) out.put(value);
}

std::array<float, 3> get_floats(WireReader& in) {
  std::array<float, 3> values{};
  for (float& value : values) value = in.get<float>();
  return values;
}

void put_material(WireWriter& out, const Material& material) {
  put_floats(out, material.diffuse);
  put_floats(out, material.emission);
  put_floats(out, material.specular);
  out.put(material.shininess);
  out.put(material.opacity);
  out.put(static_cast<std::int32_t>(material.texture));
  out.put(static_cast<std::uint8_t>(material.finish));
}

Material get_material(WireReader& in) {
  Material material;
  material.diffuse = get_floats(in);
  material.emission = get_floats(in);
  material.specular = get_floats(in);
  material.shininess = in.get<float>();
  material.opacity = in.get<float>();
  material.texture = in.get<std::int32_t>();
  material.finish = static_cast<Finish>(in.get<std::uint8_t>());
  return material;
}

constexpr std::size_t kMaterialBytes = 12 * 4 + 1;

static_assert(sizeof(Triangle) == 4 * sizeof(std::uint32_t));

void put_part(WireWriter& out, const Part& part) {
  out.put_text(part.name.substr(0, kMaxTextBytes));
  out.put(static_cast<std::uint8_t>(part.spins));
  put_floats(out, {part.axis_in_body.x(), part.axis_in_body.y(), part.axis_in_body.z()});
  put_floats(out, {part.centre_in_body.x(), part.centre_in_body.y(), part.centre_in_body.z()});
  out.put(part.revolutions_per_s);
  out.put(static_cast<std::uint64_t>(part.triangles.size()));
  out.put_raw(part.triangles.data(), part.triangles.size() * sizeof(Triangle));
}

Part get_part(WireReader& in) {
  Part part;
  part.name = in.get_text(kMaxTextBytes);
  part.spins = in.get<std::uint8_t>() != 0;
  const auto axis = get_floats(in);
  const auto centre = get_floats(in);
  part.axis_in_body = {axis[0], axis[1], axis[2]};
  part.centre_in_body = {centre[0], centre[1], centre[2]};
  part.revolutions_per_s = in.get<double>();
  part.triangles.resize(in.get_count(kMaxTriangles, sizeof(Triangle)));
  in.get_raw(part.triangles.data(), part.triangles.size() * sizeof(Triangle));
  return part;
}

void put_picture(WireWriter& out, const RawPicture& raw) {
  out.put(static_cast<std::int32_t>(raw.picture.width));
  out.put(static_cast<std::int32_t>(raw.picture.height));
  out.put(static_cast<std::uint8_t>(raw.repeat_u));
  out.put(static_cast<std::uint8_t>(raw.repeat_v));
  out.put(static_cast<std::uint64_t>(raw.picture.rgba.size()));
  out.put_raw(raw.picture.rgba.data(), raw.picture.rgba.size());
}

RawPicture get_picture(WireReader& in) {
  RawPicture raw;
  raw.picture.width = in.get<std::int32_t>();
  raw.picture.height = in.get<std::int32_t>();
  raw.repeat_u = in.get<std::uint8_t>() != 0;
  raw.repeat_v = in.get<std::uint8_t>() != 0;
  raw.picture.rgba.resize(in.get_count(4 * kMaxPixels, 1));
  in.get_raw(raw.picture.rgba.data(), raw.picture.rgba.size());
  return raw;
}

}  // namespace

std::string bytes_of(const RawModel& model) {
  WireWriter out;
  put_vectors(out, model.mesh.positions);
  put_vectors(out, model.mesh.normals);
  put_vectors(out, model.mesh.uvs);
  out.put(static_cast<std::uint64_t>(model.mesh.materials.size()));
  for (const Material& material : model.mesh.materials) put_material(out, material);
  out.put(static_cast<std::uint64_t>(model.mesh.parts.size()));
  for (const Part& part : model.mesh.parts) put_part(out, part);
  out.put(static_cast<std::uint64_t>(model.pictures.size()));
  for (const RawPicture& picture : model.pictures) put_picture(out, picture);
  out.put(static_cast<std::uint64_t>(model.warnings.size()));
  for (const std::string& warning : model.warnings) out.put_text(warning.substr(0, kMaxTextBytes));
  return out.take();
}

RawModel model_from_bytes(std::string_view bytes) {
  WireReader in(bytes);
  RawModel model;
  model.mesh.positions = get_vectors<3>(in);
  model.mesh.normals = get_vectors<3>(in);
  model.mesh.uvs = get_vectors<2>(in);
  model.mesh.materials.resize(in.get_count(kMaxMaterials, kMaterialBytes));
  for (Material& material : model.mesh.materials) material = get_material(in);
  model.mesh.parts.resize(in.get_count(kMaxParts, 1));
  for (Part& part : model.mesh.parts) part = get_part(in);
  model.pictures.resize(in.get_count(kMaxPictures, 1));
  for (RawPicture& picture : model.pictures) picture = get_picture(in);
  model.warnings.resize(in.get_count(kMaxWarnings, 1));
  for (std::string& warning : model.warnings) warning = in.get_text(kMaxTextBytes);
  in.expect_end();
  check_model(model);
  return model;
}

std::string bytes_of(const ReaderJob& job) {
  WireWriter out;
  out.put_text(job.file);
  out.put_text(job.shown_folder);
  out.put_text(job.in_data_root);
  out.put(job.options.airspeed_kt);
  out.put(job.options.altitude_agl_ft);
  out.put(static_cast<std::uint8_t>(job.options.axes.has_value()));
  const ModelAxes axes = job.options.axes.value_or(ModelAxes{});
  out.put_text(axes.forward);
  out.put_text(axes.up);
  out.put(axes.scale);
  return out.take();
}

ReaderJob job_from_bytes(std::string_view bytes) {
  WireReader in(bytes);
  ReaderJob job;
  job.file = in.get_text(kMaxTextBytes);
  job.shown_folder = in.get_text(kMaxTextBytes);
  job.in_data_root = in.get_text(kMaxTextBytes);
  job.options.airspeed_kt = in.get<double>();
  job.options.altitude_agl_ft = in.get<double>();
  const bool has_axes = in.get<std::uint8_t>() != 0;
  ModelAxes axes;
  axes.forward = in.get_text(kMaxTextBytes);
  axes.up = in.get_text(kMaxTextBytes);
  axes.scale = in.get<double>();
  if (has_axes) job.options.axes = axes;
  in.expect_end();
  return job;
}

}  // namespace airtruth::aircraft
