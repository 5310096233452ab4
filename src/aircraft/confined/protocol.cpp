// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/protocol.h"

#include <type_traits>

namespace airtruth::confined {
namespace {

// A bound for texts of untrusted files.
constexpr std::size_t kMaxTextBytes = 65536;

// Puts the fields of a record into bytes. Put and Get have the same functions, so that one
// description of a record serves both directions.
struct Put {
  WireWriter out;

  void number(const auto& value) { out.put(value); }
  void flag(bool value) { out.put(std::uint8_t{value}); }
  void text(const std::string& value) { out.put_text(value.substr(0, kMaxTextBytes)); }
  // Values without padding, as they are in memory.
  template <typename Value>
  void raw(const std::vector<Value>& values, std::size_t) {
    out.put(std::uint64_t{values.size()});
    out.put_raw(values.data(), values.size() * sizeof(Value));
  }
  void list(const auto& values, std::size_t, const auto& each) {
    out.put(std::uint64_t{values.size()});
    for (const auto& value : values) each(value);
  }
};

// Gets the fields of a record from bytes. Throws Error where a list has more than `most` values.
struct Get {
  WireReader in;

  template <typename Value>
  void number(Value& value) {
    value = in.get<Value>();
  }
  void flag(bool& value) { value = in.get<std::uint8_t>() != 0; }
  void text(std::string& value) { value = in.get_text(kMaxTextBytes); }
  template <typename Value>
  void raw(std::vector<Value>& values, std::size_t most) {
    values.resize(in.get_count(most, sizeof(Value)));
    in.get_raw(values.data(), values.size() * sizeof(Value));
  }
  void list(auto& values, std::size_t most, const auto& each) {
    values.resize(in.get_count(most, 1));
    for (auto& value : values) each(value);
  }
};

static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(Eigen::Vector2f) == 8);
static_assert(sizeof(model::Triangle) == 16 && sizeof(model::Finish) == 1);

void material_fields(auto& wire, auto& material) {
  for (auto* colour : {&material.diffuse, &material.emission, &material.specular})
    for (auto& channel : *colour) wire.number(channel);
  wire.number(material.shininess);
  wire.number(material.opacity);
  wire.number(material.texture);
  auto finish = static_cast<std::uint8_t>(material.finish);
  wire.number(finish);
  if constexpr (std::is_same_v<std::remove_reference_t<decltype(wire)>, Get>)
    material.finish = static_cast<model::Finish>(finish);
}

void part_fields(auto& wire, auto& part) {
  wire.text(part.name);
  wire.flag(part.spins);
  for (auto* vector : {&part.axis_in_body, &part.centre_in_body})
    for (auto& value : *vector) wire.number(value);
  wire.number(part.revolutions_per_s);
  wire.raw(part.triangles, model::kMaxTriangles);
}

void picture_fields(auto& wire, auto& raw) {
  wire.number(raw.picture.width);
  wire.number(raw.picture.height);
  wire.flag(raw.repeat_u);
  wire.flag(raw.repeat_v);
  wire.raw(raw.picture.rgba, 4 * model::kMaxPixels);
}

void model_fields(auto& wire, auto& model) {
  wire.raw(model.mesh.positions, model::kMaxCorners);
  wire.raw(model.mesh.normals, model::kMaxCorners);
  wire.raw(model.mesh.uvs, model::kMaxCorners);
  wire.list(model.mesh.materials, model::kMaxMaterials, [&](auto& m) { material_fields(wire, m); });
  wire.list(model.mesh.parts, model::kMaxParts, [&](auto& part) { part_fields(wire, part); });
  wire.list(model.pictures, model::kMaxPictures, [&](auto& raw) { picture_fields(wire, raw); });
  wire.list(model.warnings, model::kMaxWarnings, [&](auto& warning) { wire.text(warning); });
}

void job_fields(auto& wire, auto& job, auto& axes) {
  wire.text(job.file);
  wire.text(job.shown_folder);
  wire.text(job.in_data_root);
  wire.number(job.options.airspeed_kt);
  wire.number(job.options.altitude_agl_ft);
  wire.text(axes.forward);
  wire.text(axes.up);
  wire.number(axes.scale);
}

}  // namespace

std::string bytes_of(const model::RawModel& model) {
  Put put;
  model_fields(put, model);
  return put.out.take();
}

model::RawModel model_from_bytes(std::string_view bytes) {
  Get get{WireReader(bytes)};
  model::RawModel model;
  model_fields(get, model);
  get.in.expect_end();
  model::check_model(model);
  return model;
}

std::string bytes_of(const ReaderJob& job) {
  Put put;
  put.flag(job.options.axes.has_value());
  const model::ModelAxes axes = job.options.axes.value_or(model::ModelAxes{});
  job_fields(put, job, axes);
  return put.out.take();
}

ReaderJob job_from_bytes(std::string_view bytes) {
  Get get{WireReader(bytes)};
  ReaderJob job;
  model::ModelAxes axes;
  bool has_axes = false;
  get.flag(has_axes);
  job_fields(get, job, axes);
  if (has_axes) job.options.axes = axes;
  get.in.expect_end();
  return job;
}

}  // namespace airtruth::confined
