// SPDX-License-Identifier: Apache-2.0
#include <set>

#include <airtruth/labels.h>

#include "foundation/base/error.h"
#include "labels/exchange/exchange.h"

namespace airtruth::exchange {
namespace {

WriteOptions options_of(std::span<const Part> parts) {
  WriteOptions options;
  options.with_images = false;
  std::set<std::string> categories;
  for (const Part& part : parts) {
    options.parts.push_back(part.name);
    for (const Clip& clip : part.clips)
      for (const LabelledFrame& frame : clip.frames)
        for (const Label& label : frame.labels) categories.insert(label.category);
  }
  options.categories = {categories.begin(), categories.end()};
  return options;
}

}  // namespace

void write_clips(Format format, const fs::path& folder, std::span<const Part> parts) {
  if (fs::exists(folder) && (!fs::is_directory(folder) || !fs::is_empty(folder)))
    throw Error("exists and is not empty; expected a new folder", {folder.string()});
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error("cannot create: " + failed.message(), {folder.string()});
  const auto writer = make_writer(format, folder, options_of(parts));
  for (const Part& part : parts)
    for (const Clip& clip : part.clips)
      for (const Clip& one : arranged(format, clip))
        // Single-object toolkits refuse a sequence of one frame: they read its truth as four
        // numbers and not as a table.
        if (!is_single_object(format) || one.frames.size() > 1) writer->add(one, part.name);
  writer->finish();
}

}  // namespace airtruth::exchange
