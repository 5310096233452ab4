// SPDX-License-Identifier: Apache-2.0
#include "studio/server/server.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "studio/messages/request.h"
#include "support/flight_file.h"
#include "support/temporary_folder.h"

namespace airtruth::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
// A connection as anyone on the machine can make one, with bytes of any kind.
class Socket {
 public:
  explicit Socket(std::uint16_t port) : file_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval limit{20, 0};
    ::setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    EXPECT_EQ(::connect(file_, reinterpret_cast<sockaddr*>(&place), sizeof place), 0);
  }
  ~Socket() { ::close(file_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void send(const std::string& bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t sent = ::send(file_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) return;  // the server has closed it
      done += static_cast<std::size_t>(sent);
    }
  }
  // At least `count` bytes, or all until the end.
  bool fill(std::size_t count) {
    std::array<char, 65536> some;
    while (bytes.size() < count) {
      const ssize_t got = ::recv(file_, some.data(), some.size(), 0);
      if (got <= 0) return false;
      bytes.append(some.data(), static_cast<std::size_t>(got));
    }
    return true;
  }
  std::string until(const std::string& end) {
    while (bytes.find(end) == std::string::npos)
      if (!fill(bytes.size() + 1)) return std::exchange(bytes, "");
    const std::size_t size = bytes.find(end) + end.size();
    std::string result = bytes.substr(0, size);
    bytes.erase(0, size);
    return result;
  }

  std::string bytes;

 private:
  int file_;
};

class OfAServer : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test_support::TemporaryFolder();
    test_support::write_flight(*folder_ / "flight.mp4", 160, 120, 4);
    write_file(*folder_ / "secret.txt", "the secret");
  }
  static void TearDownTestSuite() { delete folder_; }

  void SetUp() override {
    write_file(*folder_ / "s.toml",
               "[background]\nvideo = \"flight.mp4\"\n[lens]\nvertical_fov_deg = 60\n");
    session::Options options;
    options.pipeline.cache = *folder_ / "cache";
    options.out = *folder_ / "out";
    session_ = std::make_unique<session::Session>(
        std::make_unique<document::Document>(*folder_ / "s.toml", std::nullopt, Warn()),
        options,
        server_.ways());
    thread_ = std::jthread([this](const std::stop_token& stop) { server_.run(*session_, stop); });
    const std::string address = server_.address();  // http://127.0.0.1:PORT/?token=T
    port_ = static_cast<std::uint16_t>(std::stoi(address.substr(17)));
    token_ = address.substr(address.find("token=") + 6);
  }
  void TearDown() override {
    thread_.request_stop();
    thread_.join();
    session_.reset();
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }

  // The whole answer to a request with these headers.
  std::string answer(const std::string& line, const std::string& headers) const {
    Socket socket(port_);
    socket.send(line + " HTTP/1.1\r\n" + headers + "Connection: close\r\n\r\n");
    while (socket.fill(socket.bytes.size() + 1)) {
    }
    return socket.bytes;
  }
  std::string get(const std::string& target, const std::string& headers = "") const {
    return answer("GET " + target, "Host: " + host() + "\r\n" + headers);
  }
  std::string with_token(const std::string& target) const {
    return target + (target.find('?') == std::string::npos ? "?" : "&") + "token=" + token_;
  }
  static std::string upgrade(const std::string& headers) {
    return "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: "
           "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           headers;
  }
  // The head of the answer to a page that wants a WebSocket.
  std::string open_page(Socket& socket,
                        const std::string& target,
                        const std::string& headers) const {
    socket.send("GET " + target + " HTTP/1.1\r\n" + upgrade(headers) + "\r\n");
    return socket.until("\r\n\r\n");
  }
  std::string open_own_page(Socket& socket) const {
    return open_page(
        socket, with_token("/ws"), "Host: " + host() + "\r\nOrigin: http://" + host() + "\r\n");
  }

  // One message, masked with zeros; `code` is its kind.
  static std::string message(const std::string& text, int code = 0x81) {
    std::string bytes;
    bytes += static_cast<char>(code);
    if (text.size() < 126) {
      bytes += static_cast<char>(0x80U | text.size());
    } else {
      const bool is_long = text.size() > 0xFFFF;
      bytes += static_cast<char>(is_long ? 0xFF : 0xFE);
      for (int shift = is_long ? 56 : 8; shift >= 0; shift -= 8)
        bytes += static_cast<char>((std::uint64_t{text.size()} >> shift) & 0xFFU);
    }
    return bytes + std::string(4, '\0') + text;
  }
  // The next text of the server; empty at the end.
  static std::optional<std::string> next(Socket& socket) {
    for (;;) {
      if (!socket.fill(2)) return std::nullopt;
      const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(socket.bytes[i]); };
      std::size_t size = byte(1);
      std::size_t head = 2;
      const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
      if (!socket.fill(head + more)) return std::nullopt;
      if (more > 0) size = 0;
      for (std::size_t i = 0; i < more; ++i) size = size << 8 | byte(head + i);
      head += more;
      if (!socket.fill(head + size)) return std::nullopt;
      const int code = byte(0);
      std::string text = socket.bytes.substr(head, size);
      socket.bytes.erase(0, head + size);
      if (code == 0x88) return std::nullopt;
      if (code == 0x81) return text;
    }
  }
  std::optional<std::string> say(Socket& socket, const std::string& text) const {
    socket.send(message(text));
    return next(socket);
  }
  // Whether the server still does its work.
  void expect_alive() const {
    Socket socket(port_);
    EXPECT_THAT(open_own_page(socket), StartsWith("HTTP/1.1 101"));
    const auto opened = say(socket, R"({"id":1,"do":"open"})");
    ASSERT_TRUE(opened);
    EXPECT_THAT(*opened, HasSubstr("\"frames\":4"));
  }

  static inline test_support::TemporaryFolder* folder_ = nullptr;
  Server server_{Options{}};
  std::unique_ptr<session::Session> session_;
  std::jthread thread_;
  std::uint16_t port_ = 0;
  std::string token_;
};

TEST_F(OfAServer, ThePageNeedsTheTokenAndItsPartsNone) {
  EXPECT_EQ(token_.size(), 32u);
  EXPECT_THAT(get(with_token("/")), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get(with_token("/")), HasSubstr("Content-Security-Policy: default-src 'self'"));
  EXPECT_THAT(get("/studio.js"), HasSubstr("text/javascript"));
  EXPECT_THAT(get("/studio.css"), HasSubstr("text/css"));
  for (const char* wrong : {"/",
                            "/?token=",
                            "/?token=00000000000000000000000000000000",
                            "/?Token=x",
                            "/thumb?frame=0&width=160",
                            "/aircraft.jpg?name=bird",
                            "/film?which=original",
                            "/nothing"})
    EXPECT_THAT(get(wrong), StartsWith("HTTP/1.1 403")) << wrong;
  EXPECT_THAT(get("/?token=" + token_.substr(0, 31)), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/?token=" + token_ + "0"), StartsWith("HTTP/1.1 403"));
}

TEST_F(OfAServer, AReboundNameIsRefusedByItsHost) {
  for (const std::string& wrong : {std::string("evil.example"),
                                   "evil.example:" + std::to_string(port_),
                                   std::string("127.0.0.1"),
                                   "127.0.0.1:" + std::to_string(port_ - 1),
                                   "[::1]:" + std::to_string(port_),
                                   host() + ".evil.example",
                                   std::string("")}) {
    EXPECT_THAT(answer("GET " + with_token("/"), "Host: " + wrong + "\r\n"),
                StartsWith("HTTP/1.1 403"))
        << wrong;
    EXPECT_THAT(answer("GET /studio.js", "Host: " + wrong + "\r\n"), StartsWith("HTTP/1.1 403"));
    Socket socket(port_);
    EXPECT_THAT(
        open_page(
            socket, with_token("/ws"), "Host: " + wrong + "\r\nOrigin: http://" + wrong + "\r\n"),
        StartsWith("HTTP/1.1 403"));
  }
  EXPECT_THAT(answer("GET " + with_token("/"), ""), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answer("GET " + with_token("/"), "Host: localhost:" + std::to_string(port_) + "\r\n"),
              StartsWith("HTTP/1.1 200"));
}

TEST_F(OfAServer, AnotherSitesPageIsRefusedByItsOrigin) {
  for (const std::string& wrong : {std::string("http://evil.example"),
                                   std::string("null"),
                                   "https://" + host(),
                                   "http://localhost:" + std::to_string(port_),
                                   "http://" + host() + ".evil.example",
                                   std::string("http://127.0.0.1:1"),
                                   std::string("")}) {
    Socket socket(port_);
    EXPECT_THAT(
        open_page(socket, with_token("/ws"), "Host: " + host() + "\r\nOrigin: " + wrong + "\r\n"),
        StartsWith("HTTP/1.1 403"))
        << wrong;
    EXPECT_THAT(get(with_token("/"), "Origin: " + wrong + "\r\n"), StartsWith("HTTP/1.1 403"));
  }
  EXPECT_THAT(get(with_token("/film?which=original"), "Sec-Fetch-Site: cross-site\r\n"),
              StartsWith("HTTP/1.1 403"));
  Socket without(port_);
  EXPECT_THAT(
      open_page(without, "/ws", "Host: " + host() + "\r\nOrigin: http://" + host() + "\r\n"),
      StartsWith("HTTP/1.1 403"));
  Socket elsewhere(port_);
  EXPECT_THAT(open_page(elsewhere, with_token("/"), "Host: " + host() + "\r\n"),
              StartsWith("HTTP/1.1 404"));
  expect_alive();
}

TEST_F(OfAServer, FormsAndOtherMethodsAreRefused) {
  const std::string form = "Host: " + host() +
                           "\r\nContent-Type: application/x-www-form-urlencoded\r\n"
                           "Content-Length: 3\r\n";
  Socket socket(port_);
  socket.send("POST " + with_token("/") + " HTTP/1.1\r\n" + form + "\r\na=b");
  EXPECT_THAT(socket.until("\r\n"), StartsWith("HTTP/1.1 405"));
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "HEAD", "TRACE"})
    EXPECT_THAT(answer(std::string(method) + " " + with_token("/"), "Host: " + host() + "\r\n"),
                StartsWith("HTTP/1.1 405"))
        << method;
  EXPECT_EQ(
      answer("POST " + with_token("/"), "Host: " + host() + "\r\nContent-Length: 100000000\r\n"),
      "");
  EXPECT_EQ(get(with_token("/"), "X: " + std::string(20'000, 'a') + "\r\n"), "");
  expect_alive();
}

TEST_F(OfAServer, NoRequestNamesAFile) {
  for (const char* target : {"/secret.txt",
                             "/../secret.txt",
                             "/%2e%2e/secret.txt",
                             "/studio.js/../secret.txt",
                             "//etc/passwd",
                             "/film?which=../secret.txt",
                             "/film?which=/etc/passwd",
                             "/film?which=",
                             "/film?which=rendered",
                             "/aircraft.jpg?name=../../../etc/passwd",
                             "/aircraft.jpg?name=%2Fetc%2Fpasswd",
                             "/aircraft.jpg?name=secret.txt",
                             "/index.html"}) {
    const std::string got = get(with_token(target));
    EXPECT_THAT(got, StartsWith("HTTP/1.1 404")) << target;
    EXPECT_EQ(got.find("the secret"), std::string::npos) << target;
  }
  for (const char* target : {"/thumb?frame=-1&width=160",
                             "/thumb?frame=0&width=100000",
                             "/thumb?frame=0",
                             "/thumb?frame=x&width=160"})
    EXPECT_THAT(get(with_token(target)), StartsWith("HTTP/1.1 400")) << target;
  EXPECT_THAT(get("/?a=%zz"), StartsWith("HTTP/1.1 400"));
}

TEST_F(OfAServer, PicturesAndTheFilmAreServed) {
  const std::string thumbnail = get(with_token("/thumb?frame=2&width=64"));
  EXPECT_THAT(thumbnail, HasSubstr("image/jpeg"));
  EXPECT_NE(thumbnail.find("\xFF\xD8\xFF"), std::string::npos);
  EXPECT_THAT(get(with_token("/aircraft.jpg?name=balloon")), HasSubstr("image/jpeg"));
  const std::string film = read_file(*folder_ / "flight.mp4");
  const std::string whole = get(with_token("/film?which=original"));
  EXPECT_THAT(whole, StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(whole.substr(whole.find("\r\n\r\n") + 4), film);
  const std::string part = get(with_token("/film?which=original"), "Range: bytes=10-19\r\n");
  EXPECT_THAT(part, StartsWith("HTTP/1.1 206"));
  EXPECT_THAT(part, HasSubstr("Content-Range: bytes 10-19/" + std::to_string(film.size())));
  EXPECT_EQ(part.substr(part.find("\r\n\r\n") + 4), film.substr(10, 10));
}

TEST_F(OfAServer, MessagesOfAnyKindAreAnsweredOrEndTheirOwnPageAlone) {
  Socket good(port_);
  open_own_page(good);
  EXPECT_THAT(say(good, "").value_or("-"), HasSubstr("no JSON object"));
  EXPECT_THAT(say(good, R"({"id":3,"do":"save","path":"/etc/passwd"})").value_or("-"),
              HasSubstr("{\"id\":3,\"error\":"));
  EXPECT_THAT(say(good, std::string(60'000, '[')).value_or("-"), HasSubstr("nested too deep"));
  EXPECT_THAT(say(good, R"({"id":4,"do":"undo"})").value_or("-"), HasSubstr("nothing to undo"));
  // As an edit with a path of thousands of waypoints is.
  EXPECT_THAT(say(good, R"({"id":7,"do":"undo"})" + std::string(150'000, ' ')).value_or("-"),
              HasSubstr("{\"id\":7,"));
  // Not UTF-8, too long, no mask, an unknown kind, a length beyond all bounds, a part of a message.
  const std::vector<std::string> hostile = {
      message("\xFF\xFE\xFD"),
      message(std::string(messages::kMostRequestBytes + 1, 'a')),
      std::string("\x81\x02hi", 4),
      message("x", 0x8F),
      message("x", 0xF1),
      std::string("\x81\xFF\x7F\xFF\xFF\xFF\xFF\xFF\xFF\xFF\0\0\0\0", 14),
      message("x", 0x80),
  };
  for (const std::string& bytes : hostile) {
    Socket socket(port_);
    EXPECT_THAT(open_own_page(socket), StartsWith("HTTP/1.1 101"));
    socket.send(bytes);
    EXPECT_FALSE(next(socket)) << testing::PrintToString(bytes.substr(0, 20));
  }
  // Binary messages are for the other way.
  good.send(message(R"({"id":5,"do":"undo"})", 0x82));
  EXPECT_THAT(say(good, R"({"id":6,"do":"undo"})").value_or("-"), HasSubstr("{\"id\":6,"));
  expect_alive();
}

TEST_F(OfAServer, NoiseInPlaceOfARequestEndsTheConnection) {
  for (const std::string& noise : {std::string("\r\n\r\n\r\n"),
                                   std::string(1000, '\0') + "\r\n\r\n",
                                   std::string("GET\r\n\r\n"),
                                   std::string("\x16\x03\x01\x02\x00\x01", 6) + "\r\n\r\n",
                                   std::string("GET / HTTP/9.9\r\n\r\n")}) {
    Socket socket(port_);
    socket.send(noise);
    EXPECT_EQ(socket.until("\r\n\r\n").find("200 OK"), std::string::npos);
  }
  expect_alive();
}

TEST_F(OfAServer, PagesAndConnectionsAreCounted) {
  std::vector<std::unique_ptr<Socket>> pages;
  for (int i = 0; i < 8; ++i) {
    pages.push_back(std::make_unique<Socket>(port_));
    EXPECT_THAT(open_own_page(*pages.back()), StartsWith("HTTP/1.1 101"));
    say(*pages.back(), R"({"id":1,"do":"undo"})");
  }
  {
    Socket ninth(port_);
    EXPECT_THAT(open_own_page(ninth), StartsWith("HTTP/1.1 503"));
  }
  pages.clear();
  std::vector<std::unique_ptr<Socket>> silent;
  for (int i = 0; i < 100; ++i) silent.push_back(std::make_unique<Socket>(port_));
  EXPECT_FALSE(silent.back()->fill(1));  // closed at once
  silent.clear();
  for (int i = 0; i < 50; ++i) {
    Socket again(port_);
    if (open_own_page(again).starts_with("HTTP/1.1 101")) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  expect_alive();
}

TEST_F(OfAServer, AChangeReachesAllPagesAndTheFile) {
  Socket first(port_), second(port_);
  open_own_page(first);
  open_own_page(second);
  say(second, R"({"id":1,"do":"undo"})");
  const auto answer =
      say(first, R"({"id":2,"do":"edit","changes":[{"set":["lens","vertical_fov_deg"],"to":50}]})");
  EXPECT_THAT(answer.value_or("-"), HasSubstr("vertical_fov_deg = 50"));
  EXPECT_THAT(next(second).value_or("-"), HasSubstr("vertical_fov_deg = 50"));
  next(first);  // the same event
  say(first, R"({"id":3,"do":"save"})");
  EXPECT_THAT(read_file(*folder_ / "s.toml"), HasSubstr("vertical_fov_deg = 50"));
  // Another program's change comes by itself.
  next(second);
  write_file(*folder_ / "s.toml",
             "[background]\nvideo = \"flight.mp4\"\n[lens]\nvertical_fov_deg = 41\n");
  EXPECT_THAT(next(second).value_or("-"), HasSubstr("vertical_fov_deg = 41"));
}

TEST(OfAPort, ThatIsTakenIsSaid) {
  const Server server{Options{}};
  const auto port = static_cast<std::uint16_t>(std::stoi(server.address().substr(17)));
  Options same;
  same.port = port;
  EXPECT_THROW(Server{same}, Error);
}

TEST(Token, IsNewEachTimeAndComparedWhole) {
  EXPECT_NE(new_token(), new_token());
  EXPECT_TRUE(is_same("abc", "abc"));
  EXPECT_FALSE(is_same("abc", "abd"));
  EXPECT_FALSE(is_same("abc", "ab"));
  EXPECT_FALSE(is_same("", "a"));
}

}  // namespace
}  // namespace airtruth::server
