// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>
#include <variant>

#include <airtruth/calibration.h>

// What a measurement returns: a value with its standard error, or the reason why the clip does not
// show it. A measurement that is not possible is never an error.
//
// Example: a clip of still pictures has no motion blur, so
//
//   const Measured<Estimate> share = blur.share();
//   share            -> false
//   share.why()      -> "too few frames in fast motion have a neighbour at rest"
//
// and of a clip that shows it, *share is {0.5, 0.02}: half of the frame interval, +- 2 % of it.
namespace airtruth::measured {

// One estimate per channel: red, green, blue of linear light.
using ColourEstimate = std::array<Estimate, 3>;

// The reason why a quantity is not measured, as part of a sentence for the user.
struct NotMeasured {
  std::string why;
};

// A `Value`, or the reason why there is none. Reading the value of one without is undefined.
template <typename Value>
class Measured {
 public:
  Measured(Value value) : held_(std::move(value)) {}
  Measured(NotMeasured reason) : held_(std::move(reason)) {}

  explicit operator bool() const { return std::holds_alternative<Value>(held_); }
  const Value& operator*() const { return *std::get_if<Value>(&held_); }
  const Value* operator->() const { return std::get_if<Value>(&held_); }
  // Empty if there is a value.
  std::string why() const {
    const auto* reason = std::get_if<NotMeasured>(&held_);
    return reason != nullptr ? reason->why : std::string();
  }

 private:
  std::variant<Value, NotMeasured> held_;
};

}  // namespace airtruth::measured
