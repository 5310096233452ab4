// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include <airtruth/error.h>
#include <airtruth/version.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

void raise_error(const std::string& message) {
  const py::object type = py::module_::import("airtruth._error").attr("Error");
  PyErr_SetObject(type.ptr(), line_of_text(message).ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    raise_error(error.what());
  } catch (const Interrupted& interrupted) {
    raise_error(interrupted.what());
  } catch (const std::filesystem::filesystem_error& error) {
    raise_error(error.path1().string().substr(0, 80) + ": " + error.code().message());
  } catch (const py::cast_error& error) {
    PyErr_SetString(PyExc_TypeError, error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_core, core) {
  py::register_exception_translator(&translate);
  core.attr("version") = kVersion;
  watch_end_of_interpreter();
  bind_lens(core);
  bind_pictures(core);
  bind_dataset(core);
  bind_evaluate(core);
  bind_clips(core);
  bind_detectors(core);
  bind_flights(core);
}

}  // namespace airtruth::python
