// SPDX-License-Identifier: Apache-2.0
// The tracker's side of the TraX protocol (versions 3 and 4) in one header that needs the C++17
// standard library and POSIX sockets alone. A tracker says hello, waits for requests and answers
// each with where its object is:
//
//   airtruth_trax::Server server("mine");
//   while (auto request = server.wait()) {
//     if (request->begins) start(request->image, request->region);
//     server.reply(track(request->image));
//   }
//
//   airtruth track DIR --tracker "trax:./mine" --out results
//
// Messages go over standard input and output, over the file descriptors TRAX_IN and TRAX_OUT, or
// over a connection to 127.0.0.1 at the port TRAX_SOCKET, as the environment says. Print nothing to
// standard output that begins with "@@TRAX:"; all else that is printed is kept in a log.
#pragma once

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

namespace airtruth_trax {

// Top-left corner and size; the first pixel covers [0, 1).
struct Region {
  double x = 0, y = 0, width = 0, height = 0;
};

// Keys of letters, digits, '.' and '_', at most 64 of them.
using Properties = std::map<std::string, std::string>;

// A picture in the form in which it was sent. Nothing is decoded here.
struct Image {
  enum class Kind { kPath, kMemory, kData, kUrl };
  Kind kind = Kind::kPath;
  std::string path;                  // of a file; of kUrl the URL
  std::string format;                // kMemory: rgb, gray8, gray16; kData: image/png, image/jpeg
  int width = 0, height = 0;         // of kMemory
  std::vector<unsigned char> bytes;  // kMemory: rows of samples, of gray16 the low byte first;
                                     // kData: the PNG's or JPEG's
};

struct Object {
  Region region;
  Properties properties;
};

struct Request {
  bool begins = false;          // what was followed is let go: `objects` holds all that there is
  std::string image;            // a file's path; of another kind the whole text (see picture())
  Region region;                // of the first new object
  std::vector<Object> objects;  // new ones, which come after those that are followed already
  Properties properties;

  Image picture() const;  // std::runtime_error where the text is none
};

struct Answer {
  std::optional<Region> region;  // empty: the tracker does not know where its object is
  double confidence = 1;
  Properties properties;
};

namespace detail {

inline std::vector<unsigned char> from_base64(const std::string& text, std::size_t at) {
  std::vector<unsigned char> bytes;
  bytes.reserve((text.size() - at) / 4 * 3);
  unsigned bits = 0;
  int held = 0;
  for (; at < text.size() && text[at] != '='; ++at) {
    const char c = text[at];
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (value < 0) throw std::runtime_error("TraX: a picture is no base64");
    bits = (bits << 6 | static_cast<unsigned>(value)) & 0xffffff;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<unsigned char>(bits >> held & 255));
  }
  return bytes;
}

inline bool begins_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

// "image:WIDTH;HEIGHT;FORMAT;BASE64".
inline Image memory_image(const std::string& text) {
  Image image;
  image.kind = Image::Kind::kMemory;
  char format[8] = {};
  int start = 0;
  const int found = std::sscanf(
      text.c_str(), "image:%d;%d;%7[a-z0-9];%n", &image.width, &image.height, format, &start);
  image.format = format;
  const std::size_t each = image.format == "rgb"      ? 3
                           : image.format == "gray16" ? 2
                           : image.format == "gray8"  ? 1
                                                      : 0;
  if (found != 3 || start == 0 || each == 0 || image.width < 1 || image.height < 1)
    throw std::runtime_error("TraX: no picture in memory: " + text.substr(0, 40));
  image.bytes = from_base64(text, static_cast<std::size_t>(start));
  if (image.bytes.size() !=
      each * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw std::runtime_error("TraX: a picture has not as many samples as its size says");
  return image;
}

// "data:TYPE;BASE64"; also "data:TYPE;base64,BASE64" and "data:TYPE;base64;BASE64".
inline Image data_image(const std::string& text) {
  Image image;
  image.kind = Image::Kind::kData;
  std::size_t at = text.find(';');
  if (at == std::string::npos)
    throw std::runtime_error("TraX: no picture's data: " + text.substr(0, 40));
  image.format = text.substr(5, at - 5);
  ++at;
  if (text.compare(at, 7, "base64,") == 0 || text.compare(at, 7, "base64;") == 0) at += 7;
  image.bytes = from_base64(text, at);
  return image;
}

inline bool is_url(const std::string& text) {
  const std::size_t colon = text.find(':');
  return colon != std::string::npos && colon > 0 && colon < 16 &&
         std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
           return (c >= 'a' && c <= 'z') || c == '+' || c == '.' || c == '-';
         });
}

inline std::string path_of(const std::string& text) {
  if (begins_with(text, "file://")) return text.substr(7);
  return begins_with(text, "file:") ? text.substr(5) : text;
}

struct Message {
  std::string type;
  std::vector<std::string> arguments;
  Properties properties;
};

inline bool is_key(const std::string& text) {
  return !text.empty() && text.size() <= 64 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '.' || c == '_';
         });
}

// Words are bare or in quotes with \" \\ and \n; key=value is a property.
inline Message message_of(const std::string& line) {
  Message message;
  bool is_type = true;
  for (std::size_t i = 7; i < line.size();) {
    if (line[i] == ' ' || line[i] == '\r') {
      ++i;
      continue;
    }
    const bool is_quoted = line[i] == '"';
    std::string word;
    for (i += is_quoted ? 1 : 0; i < line.size() && line[i] != (is_quoted ? '"' : ' '); ++i) {
      const bool is_escape = line[i] == '\\' && i + 1 < line.size();
      if (is_escape) ++i;
      if (!is_quoted && line[i] == '\r') continue;
      word += is_escape && line[i] == 'n' ? '\n' : line[i];
    }
    i += is_quoted ? 1 : 0;
    const std::size_t equals = word.find('=');
    if (is_type)
      for (const char c : word)
        message.type += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (equals != std::string::npos && is_key(word.substr(0, equals)))
      message.properties[word.substr(0, equals)] = word.substr(equals + 1);
    else
      message.arguments.push_back(std::move(word));
    is_type = false;
  }
  return message;
}

inline std::string quoted(const std::string& text) {
  std::string result = " \"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return result + "\"";
}

inline std::string text_of(const Properties& properties) {
  std::string text;
  for (const auto& [key, value] : properties) text += quoted(key + "=" + value);
  return text;
}

// The two ends of the connection to the evaluator.
class Stream {
 public:
  Stream() {
    if (const char* port = std::getenv("TRAX_SOCKET")) {
      in_ = out_ = connected(std::atoi(port));
      return;
    }
    if (const char* in = std::getenv("TRAX_IN")) in_ = std::atoi(in);
    if (const char* out = std::getenv("TRAX_OUT")) out_ = std::atoi(out);
  }

  // A line without its end; false at the end of all.
  bool read_line(std::string& line) {
    while (true) {
      const std::size_t end = held_.find('\n', searched_);
      if (end != std::string::npos) {
        line = held_.substr(0, end);
        held_.erase(0, end + 1);
        searched_ = 0;
        return true;
      }
      searched_ = held_.size();
      char block[1 << 16];
      const ssize_t count = ::read(in_, block, sizeof block);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      held_.append(block, static_cast<std::size_t>(count));
    }
  }

  void write(const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count = ::write(out_, text.data() + done, text.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw std::runtime_error("TraX: the evaluator reads no more");
      done += static_cast<std::size_t>(count);
    }
  }

 private:
  static int connected(int port) {
    const int file = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (file < 0 || ::connect(file, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0)
      throw std::runtime_error("TraX: nobody listens at TRAX_SOCKET, port " + std::to_string(port));
    const int yes = 1;
    ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    return file;
  }

  int in_ = 0;
  int out_ = 1;
  std::string held_;
  std::size_t searched_ = 0;
};

}  // namespace detail

inline Image Request::picture() const {
  if (detail::begins_with(image, "image:")) return detail::memory_image(image);
  if (detail::begins_with(image, "data:")) return detail::data_image(image);
  Image result;
  result.path = image;
  if (detail::is_url(image)) result.kind = Image::Kind::kUrl;
  return result;
}

class Server {
 public:
  // images: what the tracker takes, best first, of "path", "memory", "buffer" (a PNG's or JPEG's
  // bytes) and "url", with ';' between. Version 4 is for several objects at a time.
  explicit Server(const std::string& name,
                  const std::string& images = "path",
                  bool takes_several = false)
      : takes_several_(takes_several) {
    stream_.write(
        "@@TRAX:hello" + detail::quoted("trax.name=" + name) +
        (takes_several ? " \"trax.version=4\" \"trax.multiobject=1\"" : " \"trax.version=3\"") +
        detail::quoted("trax.image=" + images + ";") +
        " \"trax.region=rectangle;\" \"trax.channels=color;\"\n");
  }

  // The next request; empty at the end. std::runtime_error, which the evaluator is told, for what
  // the protocol does not allow.
  std::optional<Request> wait() {
    Request request;
    std::string line;
    while (stream_.read_line(line)) {
      if (!detail::begins_with(line, "@@TRAX:")) continue;
      const detail::Message message = detail::message_of(line);
      if (message.type == "quit") return std::nullopt;
      const std::size_t count = message.arguments.size();
      const bool initializes = message.type == "initialize";
      if (!(initializes && count <= 2) && !(message.type == "frame" && count == 1))
        fail(message.type + " with " + std::to_string(count) + " arguments");
      if (initializes && count != 1) {  // all is let go: by version 3's, or by an empty one
        request.begins = true;
        request.objects.clear();
        followed_ = 0;
      }
      if (initializes && count > 0) add(message, request);
      if (initializes && count < 2) continue;  // version 4: the picture follows
      finish(message, request);
      return request;
    }
    return std::nullopt;
  }

  // One answer for each object that is followed, in the order in which they came.
  void reply(const std::vector<Answer>& answers) {
    if (answers.size() != followed_)
      throw std::logic_error("TraX: " + std::to_string(answers.size()) + " answers for " +
                             std::to_string(followed_) + " objects");
    std::string text;
    for (const Answer& answer : answers) {
      Properties properties = answer.properties;
      if (answer.region) properties.emplace("confidence", number(answer.confidence));
      text += "@@TRAX:state" + detail::quoted(answer.region ? text_of(*answer.region) : "0") +
              detail::text_of(properties) + "\n";
    }
    stream_.write(text);
  }
  void reply(const Region& region, double confidence = 1) {
    reply({Answer{region, confidence, {}}});
  }
  // The tracker does not know where its object is.
  void reply_lost() { reply({Answer{}}); }

  // The tracker cannot go on. Of several calls the first counts.
  void quit(const std::string& reason) {
    if (!std::exchange(has_quit_, true))
      stream_.write("@@TRAX:quit" + detail::quoted("trax.reason=" + reason) + "\n");
  }

 private:
  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
  }
  static std::string text_of(const Region& r) {
    return number(r.x) + "," + number(r.y) + "," + number(r.width) + "," + number(r.height);
  }

  [[noreturn]] void fail(const std::string& what) {
    quit(what);
    throw std::runtime_error("TraX: " + what);
  }

  void add(const detail::Message& message, Request& request) {
    Object object;
    Region& r = object.region;
    const std::string& text = message.arguments.back();
    int end = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf%n", &r.x, &r.y, &r.width, &r.height, &end) !=
            4 ||
        static_cast<std::size_t>(end) != text.size())
      fail("no rectangle: " + text.substr(0, 40));
    if (message.arguments.size() == 1) object.properties = message.properties;
    request.begins = request.begins || followed_ == 0;
    request.objects.push_back(std::move(object));
    if (++followed_ > 1 && !takes_several_) fail("a second object");
  }

  void finish(const detail::Message& message, Request& request) {
    if (followed_ == 0) fail("a picture before any object");
    request.image = detail::path_of(message.arguments.front());
    request.properties = message.properties;
    if (!request.objects.empty()) request.region = request.objects.front().region;
  }

  detail::Stream stream_;
  bool takes_several_ = false;
  std::size_t followed_ = 0;
  bool has_quit_ = false;
};

}  // namespace airtruth_trax
