// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/shared_inputs.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/shapes/shapes.h"
#include "foundation/base/files.h"
#include "picture/video/still.h"

namespace airtruth::setup {
namespace {

// Of a triangle: its share of vertices, its BVH, and the ambient occlusion of its sides.
constexpr std::size_t kBytesOfATriangle = 400;

std::size_t bytes_of(const model::Texture& texture) {
  std::size_t bytes = texture.finest.rgba.size();
  for (const model::Texture::Level& level : texture.coarser)
    bytes += level.texels.size() * sizeof(model::Texel);
  return bytes;
}

// Of memory, about. A texture that several types share counts once.
std::size_t bytes_of(const std::map<const Type*, long>& types) {
  std::size_t bytes = 0;
  std::set<const model::Texture*> textures;
  for (const auto& [type, slots] : types) {
    const model::Mesh& mesh = type->aircraft->mesh;
    bytes += mesh.triangle_count() * kBytesOfATriangle;
    for (const model::SharedTexture& texture : mesh.textures)
      if (textures.insert(texture.get()).second) bytes += bytes_of(*texture);
  }
  return bytes;
}

std::vector<FileStamp> stamps_of(const fleet::Aircraft& aircraft) {
  std::vector<FileStamp> stamps;
  for (const auto& source : aircraft.sources) stamps.push_back(file_stamp(source));
  return stamps;
}

std::shared_ptr<const Type> prepared(std::shared_ptr<const fleet::Aircraft> aircraft,
                                     std::vector<std::string> warnings,
                                     const std::filesystem::path& occlusion_cache,
                                     const Type* same_shape) {
  auto type = std::make_shared<Type>();
  // The model shares the mesh within the aircraft.
  const std::shared_ptr<const model::Mesh> mesh(aircraft, &aircraft->mesh);
  type->model = same_shape != nullptr
                    ? std::make_shared<const shade::Model>(mesh, *same_shape->model)
                    : std::make_shared<const shade::Model>(mesh, occlusion_cache);
  type->silhouette = {&aircraft->mesh, model::silhouette_points(aircraft->mesh)};
  type->aircraft = std::move(aircraft);
  type->warnings = std::move(warnings);
  return type;
}

// The same with the distractor of its shape that has the usual colours and wing beats and is one
// metre large, or half a metre where it stands on legs as small multirotors do.
scene::Intruder with_plain_distractor(scene::Intruder intruder) {
  if (intruder.distractor) {
    scene::Distractor plain;
    plain.kind = intruder.distractor->kind;
    if (plain.kind == scene::DistractorKind::kMultirotor &&
        intruder.distractor->size_m < shapes::kLeastWithSkidsM)
      plain.size_m = 0.5;
    plain.plumage = intruder.distractor->plumage;
    plain.aspect_ratio = intruder.distractor->aspect_ratio;
    plain.rotors = intruder.distractor->rotors;
    intruder.distractor = plain;
  }
  return intruder;
}

}  // namespace

// What decides how an intruder's aircraft is loaded.
std::string SharedInputs::type_key(const scene::Intruder& intruder, const trajectory::Path& path) {
  if (intruder.distractor) {
    const scene::Distractor& one = *intruder.distractor;
    return fmt::format("{}|{}|{}|{}|{}|{}|{}|{}|{}|{}",
                       enum_name(one.kind),
                       one.size_m,
                       enum_name(one.plumage),
                       one.aspect_ratio,
                       one.flap_hz,
                       one.flap_phase,
                       one.glide,
                       one.rotors,
                       fmt::join(one.colour, ","),
                       fmt::join(one.arm_colour, ","));
  }
  const model::LoadOptions options = load_options(intruder, path);
  std::string key = intruder.aircraft + '|' + configuration_of(intruder.aircraft, options);
  if (options.catalogue_scale) key += fmt::format("*{}", *options.catalogue_scale);
  if (options.axes)
    key += fmt::format("|{}{}{}", options.axes->forward, options.axes->up, options.axes->scale);
  return key;
}

// A wrapper is read once for each state. Where its files change, the aircraft is loaded again all
// the same, since its sources have.
std::string SharedInputs::configuration_of(const std::string& aircraft,
                                           const model::LoadOptions& options) {
  const auto state = std::tuple(aircraft, options.airspeed_kt, options.altitude_agl_ft);
  {
    const std::lock_guard lock(mutex_);
    const auto found = configurations_.find(state);
    if (found != configurations_.end()) return found->second;
  }
  std::string configuration = fleet::configuration_of(aircraft, options);
  const std::lock_guard lock(mutex_);
  return configurations_.emplace(state, std::move(configuration)).first->second;
}

std::shared_ptr<const Type> SharedInputs::type_of(const scene::Intruder& intruder,
                                                  const trajectory::Path& path,
                                                  const Warn& warn,
                                                  const std::stop_token& stop) {
  // A missing file is an error at the scene's line.
  if (is_aircraft(intruder)) fleet::aircraft_file(intruder.aircraft);
  const std::shared_ptr<Slot> slot = slot_of(type_key(intruder, path));
  const std::lock_guard lock(slot->loading);
  std::shared_ptr<const Type> type = known(*slot);
  if (!type) {
    std::vector<std::string> warnings;
    const auto collect = [&](const std::string& text) { warnings.push_back(text); };
    auto read = std::make_shared<fleet::Aircraft>(aircraft_of(intruder, path, collect, stop));
    share_textures(read->mesh);
    const std::shared_ptr<const fleet::Aircraft> loaded = std::move(read);
    type = twin_of(*loaded);
    if (!type || type->warnings != warnings) {
      // The ambient occlusion of a distractor is found faster than it is read. Those that a stream
      // draws are all different, but of few shapes.
      const auto kept = is_aircraft(intruder) ? occlusion_cache_ : std::filesystem::path();
      std::shared_ptr<const Type> same_shape;
      const scene::Intruder plain = with_plain_distractor(intruder);
      if (plain.distractor != intruder.distractor) same_shape = type_of(plain, path, warn, stop);
      type = prepared(loaded, warnings, kept, same_shape.get());
    }
    keep(*slot, type);
  }
  for (const std::string& text : type->warnings) airtruth::warn(warn, text);
  return type;
}

std::shared_ptr<const image::Mask> SharedInputs::mask_of(const std::filesystem::path& file,
                                                         const lens::ImageSize& size) {
  const FileStamp stamp = file_stamp(file);
  {
    const std::lock_guard lock(mutex_);
    const auto found = masks_.find(file.string());
    if (found != masks_.end() && found->second.stamp == stamp && found->second.size == size)
      return found->second.mask;
  }
  auto mask = std::make_shared<const image::Mask>(video::read_mask(file, size.width, size.height));
  const std::lock_guard lock(mutex_);
  masks_[file.string()] = {stamp, size, mask};
  return mask;
}

std::string SharedInputs::sha256_of_file(const std::filesystem::path& file) {
  Hashed& one = [&]() -> Hashed& {
    const std::lock_guard lock(mutex_);
    return hashes_[file.string()];
  }();
  const std::lock_guard lock(one.reading);
  if (const FileStamp stamp = file_stamp(file); one.sha256.empty() || one.stamp != stamp) {
    one.sha256 = airtruth::sha256_of_file(file);
    one.stamp = stamp;
  }
  return one.sha256;
}

std::size_t SharedInputs::kept() const {
  const std::lock_guard lock(mutex_);
  std::set<const Type*> types;
  for (const auto& [key, slot] : slots_)
    if (slot->type) types.insert(slot->type.get());
  return types.size();
}

std::size_t SharedInputs::remembered() const {
  const std::lock_guard lock(mutex_);
  return slots_.size();
}

std::shared_ptr<SharedInputs::Slot> SharedInputs::slot_of(const std::string& key) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Slot>& slot = slots_[key];
  if (!slot) slot = std::make_shared<Slot>();
  slot->last_use = ++uses_;
  return slot;
}

// The slot's aircraft; none where it is not loaded, or where a file of it has changed.
std::shared_ptr<const Type> SharedInputs::known(const Slot& slot) const {
  const std::lock_guard lock(mutex_);
  return slot.type && slot.stamps == stamps_of(*slot.type->aircraft) ? slot.type : nullptr;
}

// Exchanges textures for equal ones of kept aircraft: the configurations of a type, of which there
// are tens where its propellers turn by the airspeed, and its liveries have most in common.
void SharedInputs::share_textures(model::Mesh& mesh) const {
  const std::lock_guard lock(mutex_);
  for (model::SharedTexture& texture : mesh.textures)
    for (const auto& [key, slot] : slots_) {
      if (!slot->type) continue;
      const auto& kept = slot->type->aircraft->mesh.textures;
      const auto same = std::find(kept.begin(), kept.end(), texture);
      if (same == kept.end()) continue;
      texture = *same;
      break;
    }
}

// A kept aircraft that equals the loaded one in all that a sequence and its record contain.
std::shared_ptr<const Type> SharedInputs::twin_of(const fleet::Aircraft& loaded) const {
  std::vector<std::shared_ptr<const Type>> candidates;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, slot] : slots_)
      if (slot->type && slot->type->aircraft->name == loaded.name) candidates.push_back(slot->type);
  }
  for (const auto& candidate : candidates) {
    const fleet::Aircraft& other = *candidate->aircraft;
    if (other.catalogue_scale == loaded.catalogue_scale && other.sources == loaded.sources &&
        other.mesh == loaded.mesh)
      return candidate;
  }
  return nullptr;
}

void SharedInputs::keep(Slot& slot, std::shared_ptr<const Type> type) {
  std::vector<FileStamp> stamps = stamps_of(*type->aircraft);
  const std::lock_guard lock(mutex_);
  slot.type = std::move(type);
  slot.stamps = std::move(stamps);
  drop_unused();
}

// Drops the aircraft whose last use is longest ago until the limit holds, but none that a sequence
// is using: dropping it would free nothing. Forgets the keys of what is not kept: drawn distractors
// are all different, and a stream draws them without end.
void SharedInputs::drop_unused() {
  std::map<const Type*, long> holders;
  for (const auto& [key, slot] : slots_)
    if (slot->type) ++holders[slot->type.get()];
  while (bytes_of(holders) > max_kept_bytes_) {
    Slot* oldest = nullptr;
    for (const auto& [key, slot] : slots_)
      if (slot->type && slot->type.use_count() == holders[slot->type.get()] &&
          (oldest == nullptr || slot->last_use < oldest->last_use))
        oldest = slot.get();
    if (oldest == nullptr) break;
    const std::shared_ptr<const Type> dropped = oldest->type;
    holders.erase(dropped.get());
    for (const auto& [key, slot] : slots_)
      if (slot->type == dropped) slot->type.reset();
  }
  // A thread that loads an aircraft or waits for it holds its slot.
  std::erase_if(slots_, [](const auto& entry) {
    return !entry.second->type && entry.second.use_count() == 1;
  });
}

}  // namespace airtruth::setup
