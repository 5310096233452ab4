// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/exchange/exchange.h"
#include "support/error_of.h"

// What the tests of formats have in common.
namespace airtruth::exchange {

// The formats that are written and read.
inline constexpr Format kWritten[] = {Format::kCoco,
                                      Format::kYolo,
                                      Format::kMot,
                                      Format::kVoc,
                                      Format::kCvat,
                                      Format::kAot,
                                      Format::kOtb,
                                      Format::kGot10k,
                                      Format::kVot,
                                      Format::kWebdataset};

// A folder that is removed at the end.
class Folder {
 public:
  Folder()
      : path_(fs::temp_directory_path() /
              ("airtruth_exchange_" + std::to_string(std::random_device{}()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }
  fs::path file(const std::string& name, const std::string& text) const {
    fs::create_directories((path_ / name).parent_path());
    write_file(path_ / name, text);
    return path_ / name;
  }

 private:
  fs::path path_;
};

// The message of what reading throws.
inline std::string error_of(Format format, const fs::path& source) {
  return test_support::error_of([&] { read_clips(format, source, {}, {}); });
}

}  // namespace airtruth::exchange
