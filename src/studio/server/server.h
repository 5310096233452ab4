// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "studio/session/session.h"

// The studio's page over HTTP and its messages over a WebSocket, on the loopback interface alone.
//
// Whoever has the address may edit the scene, so the address holds a token of 128 random bits. A
// hostile page in the same browser has no token, and what it sends is refused before the token
// counts as well: by the Host that a rebound name gives itself away with, and by the Origin that a
// browser states for a page of another site.
//
//   GET /?token=T              the page; /studio.js and /studio.css of it
//   GET /thumb?token=T&frame=K&width=160
//   GET /aircraft.jpg?token=T&name=...
//   GET /film?token=T&which=original|rendered, with ranges
//   WebSocket /ws?token=T      messages/request.h
//
// No part of a request names a file. Messages, headers, connections and what waits to be sent are
// bounded.
namespace airtruth::server {

// 128 bits of the kernel's randomness as 32 hexadecimal digits. Throws Error where it has none.
std::string new_token();

// Takes the same time wherever the texts differ.
bool is_same(std::string_view a, std::string_view b);

struct Options {
  std::uint16_t port = 0;  // 0: any that is free
  // A folder with index.html, studio.js and studio.css in place of those in the program, read at
  // each request; for work on the page.
  std::optional<std::filesystem::path> page;
};

class Server {
 public:
  // Binds the port. Throws Error where that is not possible.
  explicit Server(Options options);
  ~Server();

  // "http://127.0.0.1:PORT/?token=..."
  std::string address() const;
  // How a session answers; to be made before run().
  session::Ways ways();
  // Serves the session until `stop`.
  void run(session::Session& session, const std::stop_token& stop);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::server
