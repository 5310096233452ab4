// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <airtruth/labels.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/picture_series/series.h"

// Pictures with labels become clips. A picture is known by its file name, and labels belong to the
// picture that they name; the order of a file and the numbers in it join nothing.
namespace airtruth::exchange {

using picture_series::pictures_in;

struct LabelledPicture {
  // As the set states it, relative to its folder of pictures.
  std::string name;
  // The folder in which `name` exists; empty where the picture is not found.
  fs::path folder;
  // 0: unknown.
  int width = 0;
  int height = 0;
  // The number of the frame that the set states.
  std::optional<std::int64_t> number;
  std::optional<std::int64_t> image_id;
  std::optional<double> time_s;
  std::vector<Label> labels;
};

// Throws Error for a picture's name that leads out of its set's folder: an absolute path, or one
// with "..". `where` names it.
void expect_inside(const std::string& name, const Where& where);

// The first of the folders that holds a file of that name; empty: none. Throws Error as
// expect_inside() does.
fs::path folder_of_picture(std::span<const fs::path> folders,
                           const std::string& name,
                           const Where& where);

// The clip of pictures that are one video by the set's own word. They are ordered by their stated
// numbers where all have one, else by name. A frame has its stated number, or else the last number
// of its name where these ascend, or its place; numbers that begin with 1 are one more than the
// frame. Throws Error for a name that is there twice. Warns where pictures are missing or differ in
// size: the clip is then without media.
Clip clip_of_pictures(const std::string& name,
                      std::vector<LabelledPicture> pictures,
                      const fs::path& source,
                      const Warn& warn);

// The clips of pictures of which the set states no video: one for each series of each folder
// (foundation/picture_series/series.h). A clip has the name of its folder; where the folder holds
// several series or has no name, what the pictures' names have in common, or else `otherwise`.
std::vector<Clip> clips_of_pictures(std::vector<LabelledPicture> pictures,
                                    const std::string& otherwise,
                                    const fs::path& source,
                                    const Warn& warn);

// Gives a clip the folder of the pictures that its frames name. The clip has no media, with a
// warning, where a frame names none that is there.
void join_by_name(Clip& clip, const fs::path& folder, const Warn& warn);

// Gives the frames of a clip the pictures of a folder by their numbers: frame 0 has the picture
// whose name ends in first_number, and so on. The clip has no media, with a warning, where a frame
// has no picture or two have one.
void join_by_number(Clip& clip,
                    const fs::path& folder,
                    std::int64_t first_number,
                    const Warn& warn);

// Gives the frames of a clip the pictures of a folder in the order of their names. The clip has no
// media, with a warning, where there is not one picture for each frame.
void join_in_order(Clip& clip, const fs::path& folder, const Warn& warn);

}  // namespace airtruth::exchange
