// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <airtruth/renderer.h>
#include <airtruth/stream.h>
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

py::dict info_dict(const VideoInfo& info) {
  return py::dict("width"_a = info.width,
                  "height"_a = info.height,
                  "frame_rate_hz"_a = info.frame_rate_hz,
                  "frame_count_estimate"_a = info.frame_count_estimate,
                  "codec"_a = text(info.codec),
                  "pixel_format"_a = text(info.pixel_format));
}

// (planes, pixel_format, matrix, is_full_range); the planes' samples are moved into the arrays.
py::tuple picture_tuple(FramePicture picture) {
  py::list planes;
  for (SamplePlane& plane : picture.planes)
    planes.append(array_of(std::move(plane.samples), {plane.height, plane.width}));
  return py::make_tuple(
      py::tuple(planes), picture.pixel_format, picture.matrix, picture.is_full_range);
}

// The frames of a scene. A thread of its own makes them (Worker), as OpenGL's context needs.
class PyRenderer {
 public:
  PyRenderer(const py::object& scene,
             const fs::path& folder,
             const py::object& threads,
             const py::object& cache) {
    RenderOptions options;
    options.threads = checked_threads(threads);
    take_cache(cache, options);
    options.warn = warnings_.taker();
    options.stop = worker_->stop();
    try {
      open(scene, folder, options);
    } catch (...) {
      close();  // an interrupted renderer ends on the thread that made it
      throw;
    }
  }
  // A process that was forked off has neither the worker's thread nor those of the renderer: both
  // are left as they are.
  ~PyRenderer() {
    close();
    static_cast<void>(worker_.release());
    static_cast<void>(renderer_.release());
  }

  // (picture, truth), or None after the last frame.
  py::object next() {
    expect_open();
    std::optional<RenderedFrame> frame;
    run([&] { frame = renderer_->next(); });
    if (!frame) return py::none();
    return py::make_tuple(picture_tuple(std::move(frame->picture)), truth_dict(frame->truth));
  }

  py::dict info() {
    expect_open();
    return info_dict(renderer_->info());
  }
  Lens lens() {
    expect_open();
    return renderer_->lens();
  }

  void close() {
    if (worker_ == nullptr || !process_.is_this()) return;
    worker_->run_to_the_end([&] { renderer_.reset(); });
    worker_.reset();
  }

 private:
  void open(const py::object& scene, const fs::path& folder, const RenderOptions& options) {
    if (py::isinstance<py::str>(scene)) {
      const auto words = scene.cast<std::string>();
      run([&] {
        renderer_ = std::make_unique<Renderer>(Renderer::from_text(words, folder, options));
      });
    } else {
      const auto file = scene.cast<fs::path>();
      run([&] { renderer_ = std::make_unique<Renderer>(file, options); });
    }
  }

  void run(const std::function<void()>& work) {
    worker_->run(work);
    warnings_.hand_over();
  }

  void expect_open() const {
    process_.expect_this("the rendering");
    if (worker_ == nullptr || !renderer_) throw Error("the rendering is closed");
    if (worker_->is_stopped()) throw Error("the rendering was interrupted; begin it anew");
  }

  Process process_;
  Warnings warnings_;
  std::unique_ptr<Worker> worker_ = std::make_unique<Worker>();
  std::unique_ptr<Renderer> renderer_;
};

// The frames of a video. One thread at a time.
class PyVideoReader {
 public:
  PyVideoReader(const fs::path& video, const py::object& first_frame) {
    const auto first = whole_of<std::int64_t>(
        first_frame, "first_frame", 0, std::numeric_limits<std::int64_t>::max());
    reader_ = left_alone([=, warn = warnings_.taker()] {
      return std::make_unique<VideoReader>(video, first, warn);
    });
    warnings_.hand_over();
  }
  // The decoder's threads do not exist in a process that was forked off.
  ~PyVideoReader() {
    if (!process_.is_this()) static_cast<void>(reader_.release());
  }

  py::object next() {
    const Use use(*this);
    std::optional<VideoFrame> frame;
    {
      const GilReleased released;
      frame = reader_->next();
    }
    warnings_.hand_over();
    if (!frame) return py::none();
    return py::make_tuple(
        picture_tuple(std::move(frame->picture)), frame->index, frame->time_s, frame->damaged);
  }

  py::dict info() {
    const Use use(*this);
    return info_dict(reader_->info());
  }

  void close() {
    if (!process_.is_this() || !reader_) return;
    const Use use(*this);
    reader_.reset();
  }

 private:
  // One call at a time.
  class Use {
   public:
    explicit Use(PyVideoReader& reader) : reader_(reader) {
      reader.process_.expect_this("the reader");
      if (!reader.reader_) throw Error("the reader is closed");
      if (reader.is_used_) throw Error("another thread is in a call of this reader");
      reader.is_used_ = true;
    }
    ~Use() { reader_.is_used_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    PyVideoReader& reader_;
  };

  Process process_;
  Warnings warnings_;
  std::unique_ptr<VideoReader> reader_;
  // Changes with the GIL held.
  bool is_used_ = false;
};

bool is_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  const py::object main = threading.attr("main_thread")().attr("ident");
  return main.equal(py::object(threading.attr("get_ident")()));
}

// n x height x width, or None where the catalogue asks for none.
py::object masks_of(const StreamSample& sample, std::size_t frame) {
  if (sample.masks.empty()) return py::none();
  std::vector<std::uint8_t> samples;
  for (const SamplePlane& mask : sample.masks[frame])
    samples.insert(samples.end(), mask.samples.begin(), mask.samples.end());
  return array_of(std::move(samples),
                  {std::ssize(sample.masks[frame]), sample.crop.height, sample.crop.width});
}

// A stream whose samples are made by a thread of its own for Python's main thread, which sees
// signals meanwhile, and by the callers themselves for all other threads.
class PyStream {
 public:
  PyStream(const py::object& catalogue,
           const fs::path& folder,
           const py::object& seed,
           const py::object& threads,
           const py::object& cache) {
    StreamOptions options;
    options.seed = argument<std::uint64_t>(seed, "seed");
    options.threads = checked_threads(threads);
    take_cache(cache, options);
    options.warn = warnings_.taker();
    options.stop = worker_->stop();
    stream_ = std::make_unique<Stream>(
        py::isinstance<py::str>(catalogue)
            ? Stream::from_text(catalogue.cast<std::string>(), folder, options)
            : Stream(catalogue.cast<fs::path>(), options));
    warnings_.hand_over();
  }
  // A process that was forked off has none of the threads: all is left as it is.
  ~PyStream() {
    if (process_.is_this()) return;
    static_cast<void>(worker_.release());
    static_cast<void>(stream_.release());
  }

  // (background, first_frame, weight, crop, [(picture, truth, masks, covered)])
  py::tuple sample(std::int64_t index) {
    StreamSample sample;
    run([&] { sample = stream_->sample(index); });
    py::list frames;
    for (std::size_t k = 0; k < sample.frames.size(); ++k) {
      RenderedFrame& frame = sample.frames[k];
      frames.append(py::make_tuple(picture_tuple(std::move(frame.picture)),
                                   truth_dict(frame.truth),
                                   masks_of(sample, k),
                                   column(sample.covered[k], &row_of<PixelBox>)));
    }
    return py::make_tuple(
        text(sample.background), sample.first_frame, sample.weight, python_of(sample.crop), frames);
  }

  py::str scene(std::int64_t index) {
    std::string scene;
    run([&] { scene = stream_->scene(index); });
    return text(scene);
  }

  bool is_stopped() const { return worker_->is_stopped(); }

 private:
  void run(const std::function<void()>& work) {
    process_.expect_this("the stream");
    if (is_main_thread()) {
      worker_->run(work);
    } else {
      const GilReleased released;
      work();
    }
    warnings_.hand_over();
  }

  Process process_;
  Warnings warnings_;
  std::unique_ptr<Worker> worker_ = std::make_unique<Worker>();
  std::unique_ptr<Stream> stream_;
};

// Planes of Python as a picture; rgb_of() checks the rest.
FramePicture picture_of(const py::sequence& planes,
                        const std::string& pixel_format,
                        const std::string& matrix,
                        bool is_full_range) {
  FramePicture picture{0, 0, pixel_format, matrix, is_full_range, {}};
  for (const py::handle& item : planes) {
    if (!py::isinstance<py::array_t<std::uint8_t>>(item))
      throw py::type_error("a plane is no array of uint8");
    const auto plane = py::array_t<std::uint8_t, py::array::c_style>::ensure(item);
    if (plane.ndim() != 2) throw py::value_error("a plane has not 2 dimensions");
    const int height = size_of(py::int_(plane.shape(0)), "a plane's height");
    const int width = size_of(py::int_(plane.shape(1)), "a plane's width");
    picture.planes.push_back({width, height, {plane.data(), plane.data() + plane.size()}});
  }
  if (picture.planes.empty()) throw py::value_error("there is no plane");
  picture.width = picture.planes[0].width;
  picture.height = picture.planes[0].height;
  return picture;
}

py::array rgb(const py::sequence& planes,
              const std::string& pixel_format,
              const std::string& matrix,
              bool is_full_range) {
  const FramePicture picture = picture_of(planes, pixel_format, matrix, is_full_range);
  std::vector<std::uint8_t> samples;
  {
    const GilReleased released;
    samples = rgb_of(picture);
  }
  return array_of(std::move(samples), {picture.height, picture.width, 3});
}

py::object in_crop_rows(const py::object& boxes, const py::object& crop) {
  const auto whole = boxes_of(boxes, "boxes");
  const std::vector<double> part = list_of(crop, "crop");
  constexpr double kMost = 1e6;
  for (const double number : part)
    if (!(std::abs(number) <= kMost)) throw py::value_error("crop holds a number beyond 1000000");
  if (part.size() != 4) throw py::value_error("crop is not x, y, width, height");
  const auto whole_number = [&](std::size_t i) { return static_cast<int>(part[i]); };
  const PixelBox pixels{whole_number(0), whole_number(1), whole_number(2), whole_number(3)};
  return column(whole, [&](const std::optional<Box>& box) {
    return row_of(box ? in_crop(*box, pixels) : std::nullopt);
  });
}

}  // namespace

void bind_pictures(py::module_& core) {
  py::class_<PyRenderer>(core, "Renderer")
      .def(py::init<py::object, fs::path, py::object, py::object>())
      .def("next", &PyRenderer::next)
      .def("info", &PyRenderer::info)
      .def("lens", &PyRenderer::lens)
      .def("close", &PyRenderer::close);
  py::class_<PyVideoReader>(core, "VideoReader")
      .def(py::init<const fs::path&, const py::object&>())
      .def("next", &PyVideoReader::next)
      .def("info", &PyVideoReader::info)
      .def("close", &PyVideoReader::close);
  py::class_<PyStream>(core, "Stream")
      .def(py::init<py::object, fs::path, py::object, py::object, py::object>())
      .def("sample", &PyStream::sample)
      .def("scene", &PyStream::scene)
      .def_property_readonly("is_stopped", &PyStream::is_stopped);
  core.def("rgb", named(&rgb, "planes", "pixel_format", "matrix", "is_full_range"));
  core.def("in_crop", &in_crop_rows);
}

}  // namespace airtruth::python
