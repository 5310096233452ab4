// SPDX-License-Identifier: Apache-2.0
#include <airtruth/labels.h>
#include <airtruth/video.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

namespace fs = std::filesystem;
using namespace py::literals;
using exchange::Clip;

py::object mask_dict(const std::optional<exchange::PixelMask>& mask) {
  if (!mask) return py::none();
  return py::dict("size"_a = py::make_tuple(mask->height, mask->width),
                  "counts"_a = text(mask->counts));
}

py::dict label_dict(const exchange::Label& label) {
  py::dict dict;
  const IntoDict into{dict};
  into("track", label.track);
  into("category", label.category);
  into("box_px", label.box_px);
  into("visible", label.visible);
  into("occluded", label.occluded);
  into("truncated", label.truncated);
  into("range_m", label.range_m);
  into("above_horizon", label.above_horizon);
  into("contrast_to_noise", label.contrast_to_noise);
  into("area_px", label.area_px);
  into("object_class", label.object_class);
  dict["mask"] = mask_dict(label.mask);
  return dict;
}

// Clips as Python holds them: the library's own, which it can write again.
struct PyClips {
  std::vector<Clip> clips;
};

std::pair<int, int> size_of_picture(const fs::path& picture) {
  const VideoInfo info = VideoReader(picture).info();
  return {info.width, info.height};
}

PyClips clips_in(const std::string& format,
                 const fs::path& source,
                 const std::optional<std::pair<py::object, py::object>>& size,
                 const std::string& category) {
  if (format == "airtruth") return {{exchange::read_labels(source)}};
  exchange::ReadOptions options;
  if (size) options.size = {size_of(size->first, "width"), size_of(size->second, "height")};
  options.category = category;
  options.size_of_picture = &size_of_picture;
  Warnings warnings;
  PyClips found{left_alone([=, warn = warnings.taker()] {
    return exchange::read_clips(exchange::format_from_name(format), source, options, warn);
  })};
  warnings.hand_over();
  return found;
}

void write(const std::string& format,
           const fs::path& folder,
           const std::string& part,
           const py::object& clips) {
  const exchange::Part written{part, clips.cast<const PyClips&>().clips};
  const GilReleased released;
  exchange::write_clips(exchange::format_from_name(format), folder, {&written, 1});
}

py::list dicts(const PyClips& clips) {
  py::list result;
  for (const Clip& clip : clips.clips) result.append(clip_dict(clip));
  return result;
}

}  // namespace

py::dict clip_dict(const Clip& clip) {
  py::list frames;
  for (const exchange::LabelledFrame& frame : clip.frames) {
    py::dict one;
    const IntoDict into{one};
    into("frame", frame.frame);
    into("time_s", frame.time_s);
    into("picture", frame.picture);
    py::list labels;
    for (const exchange::Label& label : frame.labels) labels.append(label_dict(label));
    one["labels"] = labels;
    frames.append(one);
  }
  return py::dict("name"_a = text(clip.name),
                  "width"_a = clip.width,
                  "height"_a = clip.height,
                  "frame_rate_hz"_a = clip.frame_rate_hz,
                  "media"_a = clip.media,
                  "frames"_a = frames);
}

void bind_labels(py::module_& core) {
  py::class_<PyClips>(core, "Clips").def("dicts", &dicts);
  core.def("read_clips", named(&clips_in, "format", "source", "size", "category"));
  core.def("write_clips", named(&write, "format", "folder", "part", "clips"));
}

}  // namespace airtruth::python
