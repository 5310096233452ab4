// SPDX-License-Identifier: Apache-2.0
// The tracker's side of the TraX protocol (version 3) in one header that needs the standard library
// alone. A tracker says hello, waits for requests and answers each with where its object is:
//
//   airtruth_trax::Server server("mine");
//   while (auto request = server.wait()) {
//     if (request->begins) start(request->image, request->region);
//     server.reply(track(request->image));
//   }
//
//   airtruth track DIR --tracker "trax:./mine" --out results
//
// Print nothing to standard output that begins with "@@TRAX:"; all else that is printed is kept in
// a log.
#pragma once

#include <cstddef>
#include <cstdio>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace airtruth_trax {

// Top-left corner and size; the first pixel covers [0, 1).
struct Region {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Request {
  bool begins = false;  // `region` holds the object to follow from here on
  std::string image;    // a file's path; with images = "memory": image:WIDTH;HEIGHT;rgb;BASE64
  Region region;
};

class Server {
 public:
  explicit Server(const std::string& name, const std::string& images = "path") {
    std::cout << "@@TRAX:hello \"trax.name=" << name << "\" \"trax.version=3\" \"trax.image="
              << images << ";\" \"trax.region=rectangle;\" \"trax.channels=color;\"" << std::endl;
  }

  // The next request; empty at the end.
  std::optional<Request> wait() {
    std::string line;
    while (std::getline(std::cin, line)) {
      if (line.rfind("@@TRAX:", 0) != 0) continue;
      const std::vector<std::string> words = words_of(line);
      if (words[0] == "@@TRAX:quit") break;
      Request request;
      request.begins = words[0] == "@@TRAX:initialize";
      if (words.size() < (request.begins ? 3u : 2u)) throw std::runtime_error("TraX: " + words[0]);
      request.image = words[1].rfind("file://", 0) == 0 ? words[1].substr(7) : words[1];
      Region& r = request.region;
      if (request.begins &&
          std::sscanf(words[2].c_str(), "%lf,%lf,%lf,%lf", &r.x, &r.y, &r.width, &r.height) != 4)
        throw std::runtime_error("TraX: no rectangle: " + words[2]);
      return request;
    }
    return std::nullopt;
  }

  void reply(const Region& r, double confidence = 1) {
    std::cout.precision(10);
    std::cout << "@@TRAX:state \"" << r.x << ',' << r.y << ',' << r.width << ',' << r.height
              << "\" \"confidence=" << confidence << '"' << std::endl;
  }
  // The tracker does not know where its object is.
  void reply_lost() { std::cout << "@@TRAX:state \"0\"" << std::endl; }

 private:
  // Words are bare or in quotes with \" \\ and \n.
  static std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    for (std::size_t i = 0; i < line.size();) {
      if (line[i] == ' ' || line[i] == '\r') {
        ++i;
        continue;
      }
      const bool is_quoted = line[i] == '"';
      std::string word;
      for (i += is_quoted ? 1 : 0; i < line.size() && line[i] != (is_quoted ? '"' : ' '); ++i) {
        const bool is_escape = line[i] == '\\' && i + 1 < line.size();
        if (is_escape) ++i;
        word += is_escape && line[i] == 'n' ? '\n' : line[i];
      }
      i += is_quoted ? 1 : 0;
      words.push_back(word);
    }
    return words;
  }
};

}  // namespace airtruth_trax
