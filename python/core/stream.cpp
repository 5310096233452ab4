// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <airtruth/stream.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

namespace fs = std::filesystem;

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

void bind_stream(py::module_& core) {
  py::class_<PyStream>(core, "Stream")
      .def(py::init<py::object, fs::path, py::object, py::object, py::object>())
      .def("sample", &PyStream::sample)
      .def("scene", &PyStream::scene)
      .def_property_readonly("is_stopped", &PyStream::is_stopped);
  core.def("in_crop", &in_crop_rows);
}

}  // namespace airtruth::python
