// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace airtruth::aircraft {

namespace fs = std::filesystem;

// The only files that a model is read from: those below one folder. A path is relative to that
// folder; one that leaves it ("..", absolute, through a symbolic link) names nothing.
class ModelFiles {
 public:
  enum class Kind { kNone, kFile, kFolder };

  virtual ~ModelFiles() = default;
  ModelFiles(const ModelFiles&) = delete;
  ModelFiles& operator=(const ModelFiles&) = delete;

  // What lies there. `path` in normal form or not; it may go up and down again.
  Kind kind(const fs::path& path);
  // The whole file. Throws Error with its shown name: it lies outside, is no file, is larger than
  // max_bytes, or more files are read than a model can need.
  std::string read(const fs::path& path, std::size_t max_bytes);

  // How a path below the folder is called in messages.
  fs::path shown(const fs::path& path) const;
  const fs::path& shown_folder() const { return shown_folder_; }
  // Where the folder lies below FlightGear's data root ("AI/Aircraft/738"); empty: at the root, or
  // unknown.
  const fs::path& in_data_root() const { return in_data_root_; }

 protected:
  ModelFiles(fs::path shown_folder, fs::path in_data_root);
  // `path` is in normal form and does not go up.
  virtual Kind kind_below(const fs::path& path) = 0;
  virtual std::string read_below(const fs::path& path, std::size_t max_bytes) = 0;

 private:
  fs::path shown_folder_;
  fs::path in_data_root_;
  std::size_t reads_ = 0;
};

// Files on the disk. Remembers what was asked for, with the answers' SHA-256.
class DiskFiles : public ModelFiles {
 public:
  struct Asked {
    std::string path;    // below the folder
    std::string answer;  // "none", "file", "folder", or the SHA-256 of what was read
    bool operator==(const Asked&) const = default;
  };

  // `folder` as the user gave it; empty: the working folder. With `hashes`, asked() is kept.
  DiskFiles(const fs::path& folder, const fs::path& in_data_root, bool hashes = false);

  // Every file read, as shown, in the order of reading.
  const std::vector<fs::path>& sources() const { return sources_; }
  const std::vector<Asked>& asked() const { return asked_; }

 protected:
  Kind kind_below(const fs::path& path) override;
  std::string read_below(const fs::path& path, std::size_t max_bytes) override;

 private:
  fs::path resolved(const fs::path& path) const;

  fs::path folder_;  // absolute, without symbolic links
  bool hashes_;
  std::vector<fs::path> sources_;
  std::vector<Asked> asked_;
};

// The folder's place below a FlightGear data root, from its own absolute path: what begins with
// AI/Aircraft. Empty: it has no such part.
fs::path place_in_data_root(const fs::path& folder);

// The file of that name, or of its bare file name, in the first folder that holds it; empty path:
// nowhere.
fs::path find_texture(ModelFiles& files,
                      const std::string& name,
                      const std::vector<fs::path>& folders);

}  // namespace airtruth::aircraft
