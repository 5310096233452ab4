// SPDX-License-Identifier: Apache-2.0
// The detector's side of airtruth's protocol for detectors (docs/detector-protocol.md) in one
// header that needs the C++17 standard library and POSIX alone. A detector says hello, waits for
// frames and answers each with what it sees:
//
//   airtruth_detector::Server server(airtruth_detector::Samples::kGray);
//   while (auto frame = server.wait()) server.reply(find(*frame));
//
//   airtruth detect DIR --detector "mine=exec:./mine" --out results
//
// Print nothing to standard output that begins a line with '{'; all else that is printed is kept in
// a log.
#pragma once

#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace airtruth_detector {

// Of a pixel: red, green and blue, or its luma.
enum class Samples { kRgb, kGray };
// How frames come: over standard input, or in memory that both programs see.
enum class Frames { kPipe, kSharedMemory };

// Top-left corner and size in pixels; the first pixel covers [0, 1).
struct Detection {
  double x = 0, y = 0, width = 0, height = 0;
  double score = 0;
  std::string category = "aircraft";
  // The same number for the same object throughout the sequence, from 0; below 0: none.
  long long track = -1;
};

struct Frame {
  std::string sequence;
  int width = 0, height = 0;
  double frame_rate_hz = 0;
  long long index = 0;  // in the sequence, from 0
  double time_s = 0;
  // Rows from the top without padding. Valid until the next wait().
  const unsigned char* samples = nullptr;
  // Rotation (w, x, y, z) of a direction in the camera of the frame before into this frame's
  // (x right, y down, z forward); empty where it is not known.
  std::vector<double> this_from_previous;
};

class ProtocolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A JSON value, as far as the protocol's messages need it.
class Json {
 public:
  static Json parse(const std::string& text) {
    std::size_t at = 0;
    Json json = value(text, at, 0);
    blanks(text, at);
    if (at != text.size()) throw ProtocolError("text after a message");
    return json;
  }
  const Json* find(const std::string& key) const {
    const auto found = members_.find(key);
    return found == members_.end() ? nullptr : &found->second;
  }
  const Json& at(const std::string& key) const {
    if (const Json* found = find(key)) return *found;
    throw ProtocolError("a message without " + key);
  }
  double number() const { return number_; }
  const std::string& text() const { return text_; }
  const std::vector<Json>& items() const { return items_; }

 private:
  static void blanks(const std::string& text, std::size_t& at) {
    while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at]))) ++at;
  }
  static bool takes(const std::string& text, std::size_t& at, char c) {
    blanks(text, at);
    if (at >= text.size() || text[at] != c) return false;
    ++at;
    return true;
  }
  static std::string quoted(const std::string& text, std::size_t& at) {
    if (!takes(text, at, '"')) throw ProtocolError("a message that is no JSON");
    std::string result;
    while (at < text.size() && text[at] != '"') {
      char c = text[at++];
      if (c == '\\' && at < text.size()) {
        c = text[at++];
        if (c == 'u') {  // a control character in a name: not kept
          at += 4;
          c = '?';
        } else {
          c = c == 'n' ? '\n' : c == 't' ? '\t' : c;
        }
      }
      result += c;
    }
    if (at++ >= text.size()) throw ProtocolError("a message that ends early");
    return result;
  }
  static Json value(const std::string& text, std::size_t& at, int depth) {
    if (depth > 20) throw ProtocolError("a message that is nested too deep");
    Json json;
    blanks(text, at);
    if (at < text.size() && text[at] == '"') {
      json.text_ = quoted(text, at);
    } else if (takes(text, at, '{')) {
      while (!takes(text, at, '}')) {
        const std::string key = (blanks(text, at), quoted(text, at));
        if (!takes(text, at, ':')) throw ProtocolError("a message that is no JSON");
        json.members_.emplace(key, value(text, at, depth + 1));
        takes(text, at, ',');
      }
    } else if (takes(text, at, '[')) {
      while (!takes(text, at, ']')) {
        json.items_.push_back(value(text, at, depth + 1));
        takes(text, at, ',');
      }
    } else {
      const std::size_t end = text.find_first_of(",]} \t\r\n", at);
      const std::string word = text.substr(at, end == std::string::npos ? end : end - at);
      if (word.empty()) throw ProtocolError("a message that is no JSON");
      json.number_ = word == "true" ? 1 : std::atof(word.c_str());
      at += word.size();
    }
    return json;
  }

  double number_ = 0;
  std::string text_;
  std::vector<Json> items_;
  std::map<std::string, Json> members_;
};

class Server {
 public:
  // Says hello at once.
  explicit Server(Samples samples = Samples::kRgb, Frames frames = Frames::kPipe)
      : bytes_per_pixel_(samples == Samples::kRgb ? 3 : 1) {
    say(std::string("{\"hello\":{\"protocol\":1,\"samples\":\"") +
        (samples == Samples::kRgb ? "rgb" : "gray") + "\",\"frames\":\"" +
        (frames == Frames::kPipe ? "pipe" : "shared_memory") + "\"}}");
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() {
    if (shared_ != nullptr) ::munmap(shared_, shared_size_);
  }

  // The next frame; empty at the end. Throws ProtocolError.
  std::optional<Frame> wait() {
    while (const auto line = read_line()) {
      const Json message = Json::parse(*line);
      if (message.find("quit") != nullptr) return std::nullopt;
      if (const Json* begin = message.find("begin")) {
        take(*begin);
      } else {
        return frame_of(message);
      }
    }
    return std::nullopt;
  }

  void reply(const std::vector<Detection>& detections) {
    if (!is_asked_) throw ProtocolError("a reply without a frame");
    is_asked_ = false;
    std::string text = "{\"frame\":" + std::to_string(frame_.index) + ",\"detections\":[";
    for (std::size_t i = 0; i < detections.size(); ++i) {
      const Detection& d = detections[i];
      text += (i > 0 ? ",{\"box\":[" : "{\"box\":[") + number(d.x) + ',' + number(d.y) + ',' +
              number(d.width) + ',' + number(d.height) + "],\"score\":" + number(d.score);
      if (d.category != "aircraft") text += ",\"category\":" + quoted(d.category);
      if (d.track >= 0) text += ",\"track\":" + std::to_string(d.track);
      text += '}';
    }
    say(text + "]}");
  }

 private:
  static std::string number(double value) {
    if (!std::isfinite(value)) throw ProtocolError("a number that is not finite");
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
  }
  static std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
      if (static_cast<unsigned char>(c) < 32) continue;
      if (c == '"' || c == '\\') result += '\\';
      result += c;
    }
    return result + '"';
  }
  static void say(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fputc('\n', stdout);
    std::fflush(stdout);
  }
  static std::optional<std::string> read_line() {
    std::string line;
    for (int c = std::getchar(); c != EOF; c = std::getchar()) {
      if (c == '\n') return line;
      line += static_cast<char>(c);
    }
    return std::nullopt;
  }

  void take(const Json& begin) {
    frame_.sequence = begin.at("sequence").text();
    frame_.width = static_cast<int>(begin.at("width").number());
    frame_.height = static_cast<int>(begin.at("height").number());
    frame_.frame_rate_hz = begin.at("frame_rate_hz").number();
    const std::size_t count = size();
    const Json* path = begin.find("shared_memory");
    if (path == nullptr) {
      samples_.resize(count);
      return;
    }
    const int file = ::open(path->text().c_str(), O_RDONLY | O_CLOEXEC);
    void* memory = file < 0 ? MAP_FAILED : ::mmap(nullptr, count, PROT_READ, MAP_SHARED, file, 0);
    if (file >= 0) ::close(file);
    if (memory == MAP_FAILED) throw ProtocolError("shared memory that cannot be opened");
    shared_ = memory;
    shared_size_ = count;
  }

  Frame frame_of(const Json& message) {
    frame_.index = static_cast<long long>(message.at("frame").number());
    frame_.time_s = message.at("time_s").number();
    frame_.this_from_previous.clear();
    if (const Json* turn = message.find("this_from_previous"))
      for (const Json& item : turn->items()) frame_.this_from_previous.push_back(item.number());
    if (message.at("bytes").number() != static_cast<double>(size()) || size() == 0)
      throw ProtocolError("a frame of another size than its sequence has");
    if (shared_ == nullptr && std::fread(samples_.data(), 1, size(), stdin) != size())
      throw ProtocolError("a frame that ends early");
    frame_.samples =
        shared_ != nullptr ? static_cast<const unsigned char*>(shared_) : samples_.data();
    is_asked_ = true;
    return frame_;
  }

  std::size_t size() const {
    return static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height) *
           static_cast<std::size_t>(bytes_per_pixel_);
  }

  int bytes_per_pixel_;
  Frame frame_;
  bool is_asked_ = false;
  std::vector<unsigned char> samples_;
  void* shared_ = nullptr;
  std::size_t shared_size_ = 0;
};

}  // namespace airtruth_detector
