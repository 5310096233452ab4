// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <tuple>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/base/file_state.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"
#include "sequence/setup/world.h"

// Inputs that sequences of one process have in common, each read and prepared once: aircraft with
// their textures, BVHs and silhouettes, and the SHA-256 of files. A sequence has the same bytes
// with and without them, in any order.
namespace airtruth::setup {

class SharedInputs {
 public:
  // Aircraft that no sequence is using are kept up to this size together: ten airliners with a
  // texture of 1024x1024, the usual size. A larger one (4096x4096: 700 MiB) is kept until another
  // is loaded.
  static constexpr std::size_t kMaxKeptBytes = std::size_t{512} << 20;

  // `occlusion_cache`: the folder that keeps the ambient occlusion of aircraft
  // (picture/render/renderer.h); empty: none.
  explicit SharedInputs(std::filesystem::path occlusion_cache = {},
                        std::size_t max_kept_bytes = kMaxKeptBytes)
      : occlusion_cache_(std::move(occlusion_cache)), max_kept_bytes_(max_kept_bytes) {}

  // The intruder's aircraft in its configuration (load_options()). Two that come out as the same
  // mesh, such as one type at two cruising speeds, share it with its BVH. A file that has changed
  // since is read again. Passes the reader's warnings to `warn` at each call. Throws Error
  // as load_aircraft does, and Interrupted on stop. Threads may call it at the same time; of those
  // that want one aircraft one loads it, and the others wait.
  std::shared_ptr<const Type> type_of(const scene::Intruder& intruder,
                                      const trajectory::Path& path,
                                      const Warn& warn,
                                      const std::stop_token& stop);

  // As video::read_mask; a file is read again only where its stamp has changed.
  std::shared_ptr<const image::Mask> mask_of(const std::filesystem::path& file,
                                             const lens::ImageSize& size);

  // As airtruth::sha256_of_file; a file is read again only where its stamp has changed. Threads
  // that ask for the same file read it once.
  std::string sha256_of_file(const std::filesystem::path& file);

  // The number of aircraft that are kept now.
  std::size_t kept() const;
  // The number of keys (aircraft in their configurations, and distractors) that it remembers: of
  // those that are kept or that are being loaded.
  std::size_t remembered() const;

 private:
  struct Slot {
    std::mutex loading;
    // Guarded by SharedInputs::mutex_.
    std::shared_ptr<const Type> type;
    std::vector<FileStamp> stamps;  // of the aircraft's sources
    std::uint64_t last_use = 0;
  };
  struct Hashed {
    std::mutex reading;
    FileStamp stamp;
    std::string sha256;
  };

  std::string type_key(const scene::Intruder& intruder, const trajectory::Path& path);
  std::string configuration_of(const std::string& aircraft, const model::LoadOptions& options);
  struct ReadMask {
    FileStamp stamp;
    lens::ImageSize size;
    std::shared_ptr<const image::Mask> mask;
  };

  std::shared_ptr<Slot> slot_of(const std::string& key);
  std::shared_ptr<const Type> known(const Slot& slot) const;
  std::shared_ptr<const Type> twin_of(const fleet::Aircraft& loaded) const;
  void share_textures(model::Mesh& mesh) const;
  void keep(Slot& slot, std::shared_ptr<const Type> type);
  void drop_unused();

  const std::filesystem::path occlusion_cache_;
  const std::size_t max_kept_bytes_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Slot>> slots_;
  // By aircraft, airspeed in knots and height in feet.
  std::map<std::tuple<std::string, double, double>, std::string> configurations_;
  std::uint64_t uses_ = 0;
  std::map<std::string, Hashed> hashes_;
  std::map<std::string, ReadMask> masks_;
};

}  // namespace airtruth::setup
