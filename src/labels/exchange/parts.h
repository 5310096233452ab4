// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "labels/exchange/exchange.h"
#include "labels/exchange/text.h"

// The writers and readers of the single formats. Only their own files and exchange.cpp use this
// header.
namespace airtruth::exchange {

struct Writing {
  Format format;
  const fs::path& root;
  const WriteOptions& options;
};

// What the writers of most formats have in common.
class FolderWriter : public Writer {
 public:
  explicit FolderWriter(const Writing& to)
      : format_(to.format), root_(to.root), options_(to.options) {}
  std::vector<fs::path> images(const Clip& clip, const std::string& part) const override;
  void finish() override {}

 protected:
  // The path of the i-th picture of a clip.
  virtual fs::path image(const Clip& clip, const std::string& part, std::size_t i) const = 0;
  // The number of a category, counted from 0.
  std::size_t class_of(const std::string& category) const;

  Format format_;
  fs::path root_;
  WriteOptions options_;
  // By part: the lines of the file that lists its clips or pictures.
  std::map<std::string, std::string> lists_;
};

// "NAME_000012": the picture, without its extension.
std::string numbered_stem(const Clip& clip, std::size_t i);

using MakeWriter = std::unique_ptr<Writer>(const Writing& to);
MakeWriter coco_writer, yolo_writer, mot_writer, voc_writer, cvat_writer, aot_writer,
    single_object_writer, webdataset_writer, table_writer;

using Clips = std::vector<Clip>;

// The most frames and boxes of an import that its files need not state one by one: frames up to a
// number, boxes between CVAT's key frames. Chosen: 4 GB or so of memory, and 20 clips of
// kMaxFrames.
constexpr std::size_t kMostFilled = 10'000'000;

struct Reading {
  Format format;
  const fs::path& source;
  const ReadOptions& options;
  const Warn& warn;
  LeftOut& left_out;
  // Filled by the reader: the classes that the set itself states for its categories, by name. Such
  // a class counts where the name states none.
  std::map<std::string, std::string>& classes;
  // The frames and boxes so far that kMostFilled bounds.
  std::size_t& filled;

  // Counts `more` of them in the clip of that name. Throws Error where they are too many.
  void fill(std::size_t more, const std::string& name) const;
};

// The class of a category by the options, or else by its name; empty where neither states one.
std::string stated_class(const std::string& category, const ReadOptions& options);

using ReadFormat = Clips(const Reading& in);
ReadFormat read_coco, read_yolo, read_mot, read_voc, read_cvat, read_aot, read_single_object,
    read_evision, read_csv, read_webdataset;

// The frame of that number in a clip that has its frames from 0 on; frames that are missing up to
// it are added.
LabelledFrame& frame_at(Clip& clip, std::size_t number, const Reading& in);

// Adds a label to those of a picture, whose size is that of the clip or the LabelledPicture (0:
// unknown); `place` says where a label stands that is left out.
template <typename Sized>
void add_label(std::vector<Label>& labels,
               Label label,
               const Sized& of,
               LeftOut& left_out,
               const std::string& place) {
  if (is_in_picture(label.box_px, of.width, of.height))
    labels.push_back(std::move(label));
  else
    left_out.add(kOutside, place);
}

// A label has this track until number_tracks() where the set states none.
inline constexpr std::int64_t kNoTrack = -1;
// What a reader warns of behind the file's name, where number_tracks() found such labels.
inline constexpr const char* kTracksCounted =
    ": holds boxes without a track; in each frame they count as the tracks from 1 on that no other "
    "box has";

// Gives the labels of a frame whose track is below 0 the numbers from 1 on that no other label of
// the frame has, in their order. True where there are such labels.
bool number_tracks(std::vector<Label>& labels);

// The source where it is a file; of a folder the files that were found in it. Throws Error where
// these are none: "holds no ...".
std::vector<fs::path> files_of(const fs::path& source,
                               std::vector<fs::path> found,
                               const std::string& what);

void append(Clips& clips, Clips more);

// The folder itself, what it holds, and what that holds, each folder before its content.
std::vector<fs::path> two_levels(const fs::path& folder);

}  // namespace airtruth::exchange
