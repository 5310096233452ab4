// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "labels/exchange/exchange.h"

// The writers and readers of the single formats. Only exchange.cpp uses this header.
namespace airtruth::exchange {

// A writer whose picture names depend on the picture's index in the clip.
class IndexedWriter : public Writer {
 public:
  std::vector<fs::path> images(const Clip& clip, const std::string& part) const final;

 private:
  virtual fs::path image(const Clip& clip, const std::string& part, std::size_t i) const = 0;
};

std::unique_ptr<Writer> coco_writer(const fs::path& root, const WriteOptions& options);
std::unique_ptr<Writer> yolo_writer(const fs::path& root, const WriteOptions& options);
std::unique_ptr<Writer> mot_writer(const fs::path& root, const WriteOptions& options);
std::unique_ptr<Writer> voc_writer(const fs::path& root, const WriteOptions& options);
std::unique_ptr<Writer> cvat_writer(const fs::path& root, const WriteOptions& options);
std::unique_ptr<Writer> aot_writer(const fs::path& root, const WriteOptions& options);
std::unique_ptr<Writer> single_object_writer(Format format,
                                             const fs::path& root,
                                             const WriteOptions& options);

using Clips = std::vector<Clip>;
Clips read_coco(const fs::path& source, const ReadOptions& options, const Warn& warn);
Clips read_yolo(const fs::path& source, const ReadOptions& options, const Warn& warn);
Clips read_mot(const fs::path& source, const ReadOptions& options, const Warn& warn);
Clips read_voc(const fs::path& source, const ReadOptions& options, const Warn& warn);
Clips read_cvat(const fs::path& source, const ReadOptions& options, const Warn& warn);
Clips read_aot(const fs::path& source, const ReadOptions& options, const Warn& warn);
Clips read_single_object(Format format,
                         const fs::path& source,
                         const ReadOptions& options,
                         const Warn& warn);
Clips read_evision(const fs::path& source, const ReadOptions& options);
Clips read_csv(const fs::path& source, const ReadOptions& options);

}  // namespace airtruth::exchange
