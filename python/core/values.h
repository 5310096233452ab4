// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/statistics.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

// Values of the library as those of Python and NumPy, and numbers from Python with their checks.
namespace airtruth::python {

namespace py = pybind11;
using Doubles = py::array_t<double, py::array::c_style>;

// Numbers of Python as n x columns doubles. Throws TypeError where they are no real numbers, and
// ValueError for another shape; `what` names them in the message.
Doubles rows_of(const py::handle& value, const std::string& what, py::ssize_t columns);
// The same for a list of n numbers.
std::vector<double> list_of(const py::handle& value, const std::string& what);

// Boxes as rows x, y, width, height. Throws ValueError for a number that is infinite and for a
// negative size; a row that holds a NaN is no box.
std::vector<std::optional<Box>> boxes_of(const py::handle& value, const std::string& what);

// ValueError where number i of an argument is infinite or NaN.
void expect_finite(const std::vector<double>& numbers, std::size_t i, const std::string& what);
// As list_of(), of finite numbers.
std::vector<double> finite_list_of(const py::handle& value, const std::string& what);

// ValueError where two arguments differ in their number of rows.
void expect_equal(std::size_t a, std::size_t b, const char* what);

// A whole number as a Python int. Throws TypeError where the value is none; `what` names it.
py::int_ index_of(const py::handle& value, const std::string& what);

// A whole number from `least` to `most`; ValueError for any other, however large, and TypeError for
// what is no whole number.
template <typename Whole>
Whole whole_of(const py::handle& value, const std::string& what, Whole least, Whole most) {
  const py::int_ number = index_of(value, what);
  if (number < py::int_(least) || number > py::int_(most))
    throw py::value_error(what + " is " + std::string(py::str(py::handle(number))) + "; expected " +
                          std::to_string(least) + " to " + std::to_string(most));
  return number.cast<Whole>();
}

// A size in pixels, 1 to 65536; ValueError for any other.
int size_of(const py::handle& value, const char* what);

// Throws the TypeError of one line that says that an argument is of another type than expected.
[[noreturn]] void refuse_type(const py::handle& value, const std::string& what, const char* kind);

template <typename T>
constexpr const char* kind_of() {
  if constexpr (std::is_same_v<T, double>) return "a number";
  if constexpr (std::is_same_v<T, std::string>) return "a text";
  if constexpr (std::is_same_v<T, std::filesystem::path>) return "a path";
  if constexpr (std::is_same_v<T, std::array<double, 2>>) return "two numbers";
  if constexpr (std::is_same_v<T, std::pair<py::object, py::object>>) return "two numbers";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "numbers";
  return "another type";
}

// An argument as a type of C++, with the errors of whole_of() and refuse_type().
template <typename T>
T argument(const py::object& value, const char* what) {
  if constexpr (std::is_same_v<T, py::object>) {
    return value;
  } else if constexpr (requires(T optional) { optional.has_value(); }) {
    if (value.is_none()) return std::nullopt;
    return argument<typename T::value_type>(value, what);
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    return whole_of<T>(value, what, std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
  } else {
    try {
      return value.cast<T>();
    } catch (const py::cast_error&) {
      refuse_type(value, what, kind_of<T>());
    }
  }
}

// A function as pybind11 takes it, whose arguments have names for errors: pybind11's own error of
// an argument that does not fit has many lines, of the types of C++.
template <typename T>
struct ObjectFor {
  using Type = py::object;
};
template <typename Result, typename... Arguments, typename... Name>
auto named(Result (*function)(Arguments...), Name... names) {
  static_assert(sizeof...(Arguments) == sizeof...(Name), "each argument has a name");
  return [=](const typename ObjectFor<Arguments>::Type&... values) {
    return function(argument<std::remove_cvref_t<Arguments>>(values, names)...);
  };
}

// A text of the library, whose bytes need not be UTF-8 (names of files).
py::str text(const std::string& bytes);
// A message as one line without control characters, whatever bytes a name in it has.
py::str line_of_text(const std::string& message);

// An array that owns the values: they are not copied.
template <typename T>
py::array array_of(std::vector<T> values, const std::vector<py::ssize_t>& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const T* data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  kept.release();
  return py::array_t<T>(shape, data, owner);
}

// x, y, width, height; NaN for no box.
template <typename AnyBox>
std::array<double, 4> row_of(const std::optional<AnyBox>& box) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!box) return {kNone, kNone, kNone, kNone};
  return {double(box->x), double(box->y), double(box->width), double(box->height)};
}

inline py::object python_of(bool value) { return py::bool_(value); }
inline py::object python_of(double value) { return py::float_(value); }
inline py::object python_of(int value) { return py::int_(value); }
inline py::object python_of(std::int64_t value) { return py::int_(value); }
inline py::object python_of(const std::string& value) { return text(value); }
inline py::object python_of(const Box& box) {
  return array_of<double>({box.x, box.y, box.width, box.height}, {4});
}
inline py::object python_of(const PixelBox& box) {
  return array_of<std::int64_t>({box.x, box.y, box.width, box.height}, {4});
}
inline py::object python_of(const evaluation::Interval& interval) {
  return py::make_tuple(interval.low, interval.high);
}
template <std::size_t N>
py::object python_of(const std::array<double, N>& values) {
  return array_of(std::vector<double>(values.begin(), values.end()), {py::ssize_t{N}});
}
// An array of n numbers, or n x N; a list of n texts.
template <typename T>
py::object python_of(std::vector<T> values) {
  const py::ssize_t count = std::ssize(values);
  return array_of(std::move(values), {count});
}
template <std::size_t N>
py::object python_of(const std::vector<std::array<double, N>>& rows) {
  std::vector<double> values;
  values.reserve(N * rows.size());
  for (const std::array<double, N>& row : rows) values.insert(values.end(), row.begin(), row.end());
  return array_of(std::move(values), {std::ssize(rows), py::ssize_t{N}});
}
inline py::object python_of(const std::vector<bool>& flags) {
  py::array_t<bool> array(std::ssize(flags));
  for (std::size_t i = 0; i < flags.size(); ++i)
    array.mutable_at(static_cast<py::ssize_t>(i)) = flags[i];
  return array;
}
inline py::object python_of(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& one : texts) list.append(text(one));
  return list;
}
template <typename T>
py::object python_of(const std::optional<T>& value) {
  return value ? python_of(*value) : py::object(py::none());
}

// What `member` is of each row, as python_of() has it.
template <typename Row, typename Member>
py::object column(const std::vector<Row>& rows, Member member) {
  std::vector<std::remove_cvref_t<std::invoke_result_t<Member, const Row&>>> values;
  values.reserve(rows.size());
  for (const Row& row : rows) values.push_back(std::invoke(member, row));
  return python_of(std::move(values));
}

// Reads keyword arguments, with the errors of argument(): take(name, value).
struct FromKeywords {
  const py::kwargs& given;
  template <typename T>
  void operator()(const char* name, T& value) const {
    value = argument<T>(given[name], name);
  }
};

}  // namespace airtruth::python
