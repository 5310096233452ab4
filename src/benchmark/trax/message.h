// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// TraX, the protocol between a tracker and what evaluates it (Čehovin 2017, "TraX: The visual
// Tracking eXchange protocol and library", Neurocomputing 260; the wire as libtrax 4 has it). A
// message is a line: "@@TRAX:" type, then arguments and properties, each a bare word or in quotes
// with \" \\ and \n.
namespace airtruth::trax {

enum class Type { kHello, kInitialize, kFrame, kState, kQuit };

struct Message {
  Type type = Type::kQuit;
  std::vector<std::string> arguments;
  std::vector<std::pair<std::string, std::string>> properties;  // key=value; keys [A-Za-z0-9._]
  bool operator==(const Message&) const = default;

  // The value of a property; "" where there is none.
  std::string_view property(std::string_view key) const;
};

// What the other side did wrong, in one line.
class ProtocolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What every message begins with.
constexpr std::string_view kPrefix = "@@TRAX:";

// Longest line that is taken for a message.
constexpr std::size_t kMostBytes = std::size_t{64} << 20;

// A line without its end; empty for one that is no message but chatter. Throws ProtocolError for a
// message of no known type or with an open quote.
std::optional<Message> parse_line(std::string_view line);

// With its line end.
std::string line_of(const Message& message);

}  // namespace airtruth::trax
