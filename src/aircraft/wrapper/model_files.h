// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/base/names.h"

namespace airtruth::wrapper {

// The files that a model may be read from: those below one folder. Paths are relative to that
// folder. A path that leaves it ("..", an absolute path, a symbolic link) counts as missing.
class ModelFiles {
 public:
  enum class Kind { kNone, kFile, kFolder };

  virtual ~ModelFiles() = default;
  ModelFiles(const ModelFiles&) = delete;
  ModelFiles& operator=(const ModelFiles&) = delete;

  // The kind of what lies at `path`, which need not be in normal form.
  Kind kind(const fs::path& path);
  // The content of a file. Throws Error with the shown name where the path lies outside the folder,
  // is no file or exceeds max_bytes, and where more files are read than a model can need.
  std::string read(const fs::path& path, std::size_t max_bytes);

  // The form in which messages name a path below the folder.
  fs::path shown(const fs::path& path) const;
  // The position of the folder below FlightGear's data root ("AI/Aircraft/738"); empty where it is
  // the root, or unknown.
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

// Files on the disk. With `hashes` it records each request and the SHA-256 of its answer.
class DiskFiles : public ModelFiles {
 public:
  struct Asked {
    std::string path;    // below the folder
    std::string answer;  // the number of its Kind, or the SHA-256 of what was read
    bool operator==(const Asked&) const = default;
  };

  // `folder` is as the user stated it; empty means the working folder. Where the case of letters is
  // ignored, a name that is not there stands for the only one that differs in it.
  DiskFiles(const fs::path& folder,
            const fs::path& in_data_root,
            bool hashes = false,
            LetterCase letter_case = LetterCase::kMatters);

  // Every file read, as shown, in the order of reading.
  const std::vector<fs::path>& sources() const { return sources_; }
  const std::vector<Asked>& asked() const { return asked_; }

 protected:
  Kind kind_below(const fs::path& path) override;
  std::string read_below(const fs::path& path, std::size_t max_bytes) override;

 private:
  fs::path whatever_case(const fs::path& path) const;
  fs::path resolved(const fs::path& path) const;

  fs::path folder_;  // absolute, without symbolic links
  bool hashes_;
  LetterCase letter_case_;
  std::vector<fs::path> sources_;
  std::vector<Asked> asked_;
};

// The position of a folder below a FlightGear data root: the part of its absolute path that begins
// with AI/Aircraft. Empty where it has no such part.
fs::path place_in_data_root(const fs::path& folder);

// The folder below which the files of a model may lie: that of its file, or, where that is called
// `meshes` beside `materials` as Gazebo has it, the one above.
fs::path folder_of_model(const fs::path& file);

// The file of that name, or of the last part of the name, in the first folder that holds it, or in
// Gazebo's materials/textures beside it; an empty path where no folder does.
fs::path find_texture(ModelFiles& files,
                      const std::string& name,
                      const std::vector<fs::path>& folders);

}  // namespace airtruth::wrapper
