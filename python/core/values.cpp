// SPDX-License-Identifier: Apache-2.0
#include "values.h"

#include <cmath>
#include <cstring>

namespace airtruth::python {
namespace {

// As NumPy makes an array of it. Exceptions that are not about the value (KeyboardInterrupt) pass.
py::array array_from(const py::handle& value, const std::string& what) {
  try {
    return py::array(py::reinterpret_borrow<py::object>(value));
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    throw py::type_error(what + " is no array of numbers");
  }
}

// An array of any shape whose elements are whole or real numbers.
Doubles numbers_of(const py::handle& value, const std::string& what) {
  const py::array array = array_from(value, what);
  if (array.size() > 0 && std::strchr("biuf", array.dtype().kind()) == nullptr)
    throw py::type_error(what + " has the dtype " + std::string(py::str(array.dtype())) +
                         "; expected whole or real numbers");
  return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

}  // namespace

Doubles rows_of(const py::handle& value, const std::string& what, py::ssize_t columns) {
  Doubles doubles = numbers_of(value, what);
  if (doubles.size() == 0 && (doubles.ndim() == 1 || doubles.shape(doubles.ndim() - 1) == columns))
    return Doubles(std::vector<py::ssize_t>{0, columns});
  if (doubles.ndim() != 2 || doubles.shape(1) != columns)
    throw py::value_error(what + " has the shape " +
                          std::string(py::str(py::object(doubles.attr("shape")))) +
                          "; expected (n, " + std::to_string(columns) + ")");
  return doubles;
}

std::vector<double> list_of(const py::handle& value, const std::string& what) {
  const Doubles doubles = numbers_of(value, what);
  if (doubles.ndim() != 1)
    throw py::value_error(what + " has " + std::to_string(doubles.ndim()) +
                          " dimensions; expected 1");
  return {doubles.data(), doubles.data() + doubles.size()};
}

std::vector<std::optional<Box>> boxes_of(const py::handle& value, const std::string& what) {
  const Doubles rows = rows_of(value, what, 4);
  std::vector<std::optional<Box>> boxes(static_cast<std::size_t>(rows.shape(0)));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const double* row = rows.data(static_cast<py::ssize_t>(i), 0);
    const Box box{row[0], row[1], row[2], row[3]};
    if (std::isnan(box.x + box.y + box.width + box.height)) continue;
    if (!std::isfinite(box.right() + box.bottom()) || box.width < 0 || box.height < 0)
      throw py::value_error("row " + std::to_string(i) + " of " + what +
                            " is no box; expected x, y, width, height, finite, with sizes of 0 or "
                            "more, or NaN for no box");
    boxes[i] = box;
  }
  return boxes;
}

void expect_finite(const std::vector<double>& numbers, std::size_t i, const std::string& what) {
  if (!std::isfinite(numbers[i]))
    throw py::value_error("number " + std::to_string(i) + " of " + what +
                          " is infinite or NaN; expected finite numbers");
}

std::vector<double> finite_list_of(const py::handle& value, const std::string& what) {
  std::vector<double> values = list_of(value, what);
  for (std::size_t i = 0; i < values.size(); ++i) expect_finite(values, i, what);
  return values;
}

void expect_equal(std::size_t a, std::size_t b, const char* what) {
  if (a != b)
    throw py::value_error(std::string(what) + ": " + std::to_string(a) + " and " +
                          std::to_string(b) + " rows; expected as many");
}

void refuse_type(const py::handle& value, const std::string& what, const char* kind) {
  throw py::type_error(what + " is of the type " +
                       std::string(py::str(py::type::handle_of(value).attr("__name__"))) +
                       "; expected " + kind);
}

py::int_ index_of(const py::handle& value, const std::string& what) {
  if (PyIndex_Check(value.ptr()) == 0) refuse_type(value, what, "a whole number");
  PyObject* number = PyNumber_Index(value.ptr());
  if (number == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::int_>(number);
}

int size_of(const py::handle& value, const char* what) {
  return whole_of<int>(value, what, 1, 65536);
}

py::str text(const std::string& bytes) {
  PyObject* decoded = PyUnicode_DecodeUTF8(bytes.data(), std::ssize(bytes), "backslashreplace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

py::str line_of_text(const std::string& message) {
  std::string line;
  for (const char c : message) {
    if (c == '\n')
      line += "\\n";
    else
      line += static_cast<unsigned char>(c) < ' ' || c == 0x7f ? '?' : c;
  }
  return text(line);
}

}  // namespace airtruth::python
