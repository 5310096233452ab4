// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include <airtruth/lens.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

using Two = std::array<double, 2>;
using Coefficients = std::vector<double>;

// Each row of numbers through the lens; a row of NaN where it gives none. Other threads of Python
// run meanwhile, and signals are seen.
template <std::size_t From, std::size_t To, typename Map>
Doubles mapped(const py::handle& rows, const char* what, Map map) {
  constexpr py::ssize_t kAtATime = 20'000;
  const Doubles from = rows_of(rows, what, From);
  Doubles to(std::vector<py::ssize_t>{from.shape(0), To});
  const double* source = from.data();
  double* target = to.mutable_data();
  for (py::ssize_t begin = 0; begin < from.shape(0); begin += kAtATime) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    const GilReleased released;
    for (py::ssize_t i = begin; i < std::min(begin + kAtATime, from.shape(0)); ++i) {
      std::array<double, From> point;
      std::copy_n(source + i * py::ssize_t{From}, From, point.begin());
      const std::optional<std::array<double, To>> image = map(point);
      for (std::size_t k = 0; k < To; ++k)
        target[i * py::ssize_t{To} + static_cast<py::ssize_t>(k)] =
            image ? (*image)[k] : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return to;
}

Doubles pixels_of(const Lens& lens, const py::object& points) {
  return mapped<3, 2>(points, "points", [&](const auto& p) { return lens.pixel_from_cam(p); });
}

Doubles rays_of(const Lens& lens, const py::object& pixels) {
  return mapped<2, 3>(pixels, "pixels", [&](const auto& p) { return lens.ray_from_pixel(p); });
}

Lens pinhole(const Two& focal_px, const Two& centre_px, const py::object& w, const py::object& h) {
  return Lens::pinhole(focal_px, centre_px, size_of(w, "width"), size_of(h, "height"));
}

Lens pinhole_of_view(double fov_deg, const py::object& w, const py::object& h) {
  return Lens::pinhole_from_vertical_fov(fov_deg, size_of(w, "width"), size_of(h, "height"));
}

Lens brown_conrady(const Two& focal_px,
                   const Two& centre_px,
                   const Coefficients& k,
                   const py::object& w,
                   const py::object& h) {
  return Lens::brown_conrady(focal_px, centre_px, k, size_of(w, "width"), size_of(h, "height"));
}

Lens fisheye(const Two& focal_px,
             const Two& centre_px,
             const Coefficients& k,
             const py::object& w,
             const py::object& h,
             double max_angle_rad) {
  return Lens::fisheye(
      focal_px, centre_px, k, size_of(w, "width"), size_of(h, "height"), max_angle_rad);
}

Lens from_file(const std::filesystem::path& file, const py::object& w, const py::object& h) {
  return Lens::from_file(file, size_of(w, "width"), size_of(h, "height"));
}

}  // namespace

void bind_lens(py::module_& core) {
  py::class_<Lens>(core, "Lens")
      .def_static("pinhole", named(&pinhole, "focal_px", "principal_point_px", "width", "height"))
      .def_static("pinhole_from_vertical_fov",
                  named(&pinhole_of_view, "vertical_fov_deg", "width", "height"))
      .def_static(
          "brown_conrady",
          named(&brown_conrady, "focal_px", "principal_point_px", "distortion", "width", "height"))
      .def_static("fisheye",
                  named(&fisheye,
                        "focal_px",
                        "principal_point_px",
                        "distortion",
                        "width",
                        "height",
                        "max_angle_rad"))
      .def_static("from_file", named(&from_file, "calibration", "width", "height"))
      .def("pixel_from_cam", &pixels_of)
      .def("ray_from_pixel", &rays_of)
      .def_property_readonly("width", &Lens::width)
      .def_property_readonly("height", &Lens::height)
      .def_property_readonly("model", &Lens::model)
      .def_property_readonly("focal_px", [](const Lens& l) { return python_of(l.focal_px()); })
      .def_property_readonly("principal_point_px",
                             [](const Lens& l) { return python_of(l.principal_point_px()); })
      .def_property_readonly("distortion", [](const Lens& l) { return python_of(l.distortion()); })
      .def_property_readonly("max_angle_rad", &Lens::max_angle_rad)
      .def_property_readonly("horizontal_fov_deg", &Lens::horizontal_fov_deg)
      .def_property_readonly("vertical_fov_deg", &Lens::vertical_fov_deg);
}

}  // namespace airtruth::python
