// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>

#include "aircraft/wrapper/model_files.h"

namespace airtruth::model_reader {

// The file system that assimp sees: the model's files, complete and read-only. The class records
// the requested files that do not exist.
class AssimpFiles : public Assimp::IOSystem {
 public:
  explicit AssimpFiles(aircraft::ModelFiles& files) : files_(files) {}

  bool Exists(const char* path) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

  const std::set<std::string>& missing() const { return missing_; }

 private:
  aircraft::ModelFiles& files_;
  std::set<std::string> missing_;
};

}  // namespace airtruth::model_reader
