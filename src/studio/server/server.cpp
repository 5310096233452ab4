// SPDX-License-Identifier: Apache-2.0
#include "studio/server/server.h"

#include <array>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <string_view>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <sys/random.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "studio/messages/request.h"
#include "studio/page/page.h"

namespace airtruth::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Fault = boost::system::error_code;
using messages::ByteRange;
using messages::range_from;
using messages::Target;
using messages::target_from;
using tcp = asio::ip::tcp;

// Bounds. A page has one WebSocket and the six connections that browsers open to one server.
constexpr std::size_t kMostConnections = 64;
constexpr std::size_t kMostPages = 8;
constexpr std::uint32_t kMostHeaderBytes = 16 << 10;
constexpr std::uint64_t kMostBodyBytes = 1 << 10;
constexpr std::size_t kMostUnsentBytes = std::size_t{64} << 20;
constexpr std::uint64_t kMostRangeBytes = 4 << 20;
constexpr auto kRequestTime = std::chrono::seconds(30);
constexpr auto kTick = std::chrono::milliseconds(250);

using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

std::string new_token() {
  std::array<std::uint8_t, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error("the kernel gives no random numbers for the page's token");
  std::string token;
  for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differs |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return differs == 0;
}

class Server::Impl {
 public:
  explicit Impl(Options options)
      : options_(std::move(options)), acceptor_(io_), tick_(io_), token_(new_token()) {
    try {
      const tcp::endpoint place(asio::ip::address_v4::loopback(), options_.port);
      acceptor_.open(place.protocol());
      acceptor_.set_option(tcp::acceptor::reuse_address(true));
      acceptor_.bind(place);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw Error(
          fmt::format("port {} of 127.0.0.1 cannot be used: {}; expected a free one, or "
                      "none",
                      options_.port,
                      error.code().message()));
    }
    host_ = fmt::format("127.0.0.1:{}", acceptor_.local_endpoint().port());
    other_host_ = fmt::format("localhost:{}", acceptor_.local_endpoint().port());
  }

  std::string address() const { return "http://" + host_ + "/?token=" + token_; }

  session::Ways ways();
  void run(session::Session& session, const std::stop_token& stop);

  session::Session& session() { return *session_; }
  const std::string& token() const { return token_; }

  // True where the request is for this server by its own name, and from its own page or none.
  bool is_from_here(const Request& request) const {
    const std::string_view host = view(request[http::field::host]);
    if (host != host_ && host != other_host_) return false;
    const std::string_view origin = view(request[http::field::origin]);
    if (request.count(http::field::origin) > 0 && origin != "http://" + std::string(host))
      return false;
    return view(request["Sec-Fetch-Site"]) != "cross-site";
  }

  // "/", "/studio.js" or "/studio.css", with its type; empty for others.
  std::optional<std::pair<std::string, const char*>> page_file(const std::string& path) const {
    const auto file = [&](const char* name, std::string_view inside) {
      return options_.page ? read_file(*options_.page / name) : std::string(inside);
    };
    if (path == "/") return {{file("index.html", page::index_html()), "text/html; charset=utf-8"}};
    if (path == "/studio.js")
      return {{file("studio.js", page::studio_js()), "text/javascript; charset=utf-8"}};
    if (path == "/studio.css")
      return {{file("studio.css", page::studio_css()), "text/css; charset=utf-8"}};
    return std::nullopt;
  }

  session::Client next_client() { return ++last_client_; }

  // One that is open.
  class Page;
  class Connection;
  std::size_t connections = 0;
  std::map<session::Client, std::shared_ptr<Page>> pages;

 private:
  void accept();
  void tick();

  Options options_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer tick_;
  std::string token_;
  std::string host_, other_host_;
  session::Session* session_ = nullptr;
  session::Client last_client_ = 0;
};

namespace {

Response response(const Request& request, http::status status, const char* type, std::string body) {
  Response response{status, request.version()};
  response.set(http::field::content_type, type);
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("X-Frame-Options", "DENY");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.keep_alive(request.keep_alive());
  response.body() = std::move(body);
  response.prepare_payload();
  return response;
}

Response refusal(const Request& request, http::status status, const char* line) {
  Response refused =
      response(request, status, "text/plain; charset=utf-8", std::string(line) + "\n");
  refused.keep_alive(false);
  return refused;
}

const char* type_of(const std::filesystem::path& film) {
  const std::string ending = film.extension().string();
  if (ending == ".mp4" || ending == ".m4v") return "video/mp4";
  if (ending == ".mov") return "video/quicktime";
  if (ending == ".webm") return "video/webm";
  if (ending == ".mkv") return "video/x-matroska";
  return "application/octet-stream";
}

}  // namespace

// The WebSocket of a page. It sends its messages one after the other.
class Server::Impl::Page : public std::enable_shared_from_this<Page> {
 public:
  Page(Impl& server, session::Client client, tcp::socket socket)
      : server_(server), client_(client), socket_(std::move(socket)) {}

  void begin(const Request& request) {
    socket_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    socket_.read_message_max(messages::kMostRequestBytes);
    socket_.async_accept(request, [self = shared_from_this()](Fault fault) {
      if (fault) return self->end();
      self->is_open_ = true;
      self->write();
      self->read();
    });
  }

  void send(std::string bytes, bool is_text) {
    unsent_ += bytes.size();
    // It does not read what it asks for.
    if (unsent_ > kMostUnsentBytes) return end();
    waiting_.push_back({std::move(bytes), is_text});
    if (is_open_ && !is_writing_) write();
  }

  void end() {
    if (std::exchange(is_over_, true)) return;
    Fault ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
    server_.session().leave(client_);
    // Not while the server goes through its pages.
    asio::post(socket_.get_executor(),
               [self = shared_from_this()] { self->server_.pages.erase(self->client_); });
  }

 private:
  struct Message {
    std::string bytes;
    bool is_text = true;
  };

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Fault fault, std::size_t) {
      if (fault || self->is_over_) return self->end();
      const std::string message = beast::buffers_to_string(self->buffer_.data());
      const bool is_text = self->socket_.got_text();
      self->buffer_.consume(self->buffer_.size());
      if (is_text) self->server_.session().take(self->client_, message);
      self->read();
    });
  }

  void write() {
    if (waiting_.empty() || is_over_) return;
    is_writing_ = true;
    socket_.text(waiting_.front().is_text);
    socket_.async_write(asio::buffer(waiting_.front().bytes),
                        [self = shared_from_this()](Fault fault, std::size_t) {
                          self->is_writing_ = false;
                          if (fault) return self->end();
                          self->unsent_ -= self->waiting_.front().bytes.size();
                          self->waiting_.pop_front();
                          self->write();
                        });
  }

  Impl& server_;
  const session::Client client_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  std::deque<Message> waiting_;
  std::size_t unsent_ = 0;
  bool is_open_ = false;
  bool is_writing_ = false;
  bool is_over_ = false;
};

// One connection: requests one after the other, until it becomes a WebSocket.
class Server::Impl::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Impl& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {
    ++server_.connections;
  }
  ~Connection() { --server_.connections; }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMostHeaderBytes);
    parser_->body_limit(kMostBodyBytes);
    stream_.expires_after(kRequestTime);
    http::async_read(
        stream_, buffer_, *parser_, [self = shared_from_this()](Fault fault, std::size_t) {
          if (!fault) self->answer();
        });
  }

 private:
  void answer() {
    request_ = parser_->release();
    if (!server_.is_from_here(request_))
      return refuse(http::status::forbidden, "expected a request of the studio's own page");
    const auto target = target_from(view(request_.target()));
    if (!target) return refuse(http::status::bad_request, "the address cannot be read");
    const bool is_upgrade = websocket::is_upgrade(request_);
    if (!is_upgrade && request_.method() != http::verb::get)
      return refuse(http::status::method_not_allowed, "expected GET");
    const bool is_asset = target->path == "/studio.js" || target->path == "/studio.css";
    if (!is_asset && !is_same(target->value("token"), server_.token()))
      return refuse(http::status::forbidden,
                    "the address has no token, or a wrong one; expected the address that the "
                    "studio printed");
    if (is_upgrade) return open_page(*target);
    serve(*target);
  }

  void open_page(const Target& target) {
    if (target.path != "/ws") return refuse(http::status::not_found, "there is nothing here");
    if (server_.pages.size() >= kMostPages)
      return refuse(http::status::service_unavailable, "too many pages of this studio are open");
    stream_.expires_never();
    const session::Client client = server_.next_client();
    const auto page = std::make_shared<Page>(server_, client, stream_.release_socket());
    server_.pages[client] = page;
    page->begin(request_);
  }

  void serve(const Target& target) {
    if (auto file = page_file(target.path)) return write(std::move(*file));
    if (target.path == "/thumb") {
      const auto frame = target.whole("frame", 0, 100'000'000);
      const auto width = target.whole("width", 16, 640);
      if (!frame || !width)
        return refuse(http::status::bad_request, "expected frame, and width from 16 to 640");
      return server_.session().thumbnail(*frame, static_cast<int>(*width), jpeg());
    }
    if (target.path == "/aircraft.jpg")
      return server_.session().aircraft_picture(target.value("name"), jpeg());
    if (target.path == "/film") return film(target.value("which"));
    refuse(http::status::not_found, "there is nothing here");
  }

  std::optional<Response> page_file(const std::string& path) const {
    try {
      auto file = server_.page_file(path);
      if (!file) return std::nullopt;
      Response made = response(request_, http::status::ok, file->second, std::move(file->first));
      made.set("Content-Security-Policy",
               fmt::format("default-src 'self'; connect-src 'self' ws://{0}; img-src 'self' blob: "
                           "data:; style-src 'self' 'unsafe-inline'; media-src 'self' blob:; "
                           "frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
                           std::string(view(request_[http::field::host]))));
      return made;
    } catch (const Error& error) {
      return refusal(request_, http::status::not_found, error.what());
    }
  }

  session::Session::Done jpeg() {
    stream_.expires_never();
    return [self = shared_from_this()](std::optional<std::string> bytes) {
      if (!bytes) return self->refuse(http::status::not_found, "there is no such picture");
      Response made = response(self->request_, http::status::ok, "image/jpeg", std::move(*bytes));
      made.set(http::field::cache_control, "private, max-age=3600");
      self->write(std::move(made));
    };
  }

  void film(const std::string& which) {
    const auto file = which == "original"   ? server_.session().original_film()
                      : which == "rendered" ? server_.session().rendered_film()
                                            : std::nullopt;
    if (!file) return refuse(http::status::not_found, "there is no such film");
    http::file_body::value_type body;
    Fault fault;
    body.open(file->c_str(), beast::file_mode::scan, fault);
    if (fault) return refuse(http::status::not_found, "the film cannot be read");
    const std::uint64_t size = body.size();
    if (const auto range = range_from(view(request_[http::field::range]), size, kMostRangeBytes))
      return write_range(body.file(), *range, size, type_of(*file));
    auto whole = std::make_shared<http::response<http::file_body>>();
    whole->base() = response(request_, http::status::ok, type_of(*file), "").base();
    whole->set(http::field::accept_ranges, "bytes");
    whole->body() = std::move(body);
    whole->prepare_payload();
    stream_.expires_never();
    http::async_write(
        stream_, *whole, [self = shared_from_this(), whole](Fault failed, std::size_t) {
          self->written(failed, whole->need_eof());
        });
  }

  void write_range(beast::file& file,
                   const ByteRange& range,
                   std::uint64_t size,
                   const char* type) {
    std::string bytes(range.last - range.first + 1, '\0');
    Fault fault;
    file.seek(range.first, fault);
    std::size_t done = 0;
    while (!fault && done < bytes.size()) {
      const std::size_t read = file.read(bytes.data() + done, bytes.size() - done, fault);
      if (read == 0) break;
      done += read;
    }
    if (done < bytes.size()) return refuse(http::status::not_found, "the film cannot be read");
    Response made = response(request_, http::status::partial_content, type, std::move(bytes));
    made.set(http::field::accept_ranges, "bytes");
    made.set(http::field::content_range,
             fmt::format("bytes {}-{}/{}", range.first, range.last, size));
    write(std::move(made));
  }

  void refuse(http::status status, const char* line) { write(refusal(request_, status, line)); }

  void write(Response made) {
    const auto kept = std::make_shared<Response>(std::move(made));
    stream_.expires_after(kRequestTime);
    http::async_write(stream_, *kept, [self = shared_from_this(), kept](Fault fault, std::size_t) {
      self->written(fault, kept->need_eof());
    });
  }
  void written(Fault fault, bool is_last) {
    if (fault) return;
    if (!is_last) return read();
    Fault ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  Impl& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMostHeaderBytes + kMostBodyBytes};
  std::optional<http::request_parser<http::string_body>> parser_;
  Request request_;
};

void Server::Impl::accept() {
  acceptor_.async_accept([this](Fault fault, tcp::socket socket) {
    if (fault == asio::error::operation_aborted) return;
    Fault ignored;
    if (!fault && connections < kMostConnections) {
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<Connection>(*this, std::move(socket))->read();
    }
    accept();
  });
}

void Server::Impl::tick() {
  tick_.expires_after(kTick);
  tick_.async_wait([this](Fault fault) {
    if (fault) return;
    session_->tick();
    tick();
  });
}

session::Ways Server::Impl::ways() {
  return {[this](std::function<void()> run) { asio::post(io_, std::move(run)); },
          [this](session::Client client, std::string json) {
            if (const auto page = pages.find(client); page != pages.end())
              page->second->send(std::move(json), true);
          },
          [this](session::Client client, std::string bytes) {
            if (const auto page = pages.find(client); page != pages.end())
              page->second->send(std::move(bytes), false);
          },
          [this](const std::string& json) {
            for (const auto& [client, page] : pages) page->send(json, true);
          }};
}

void Server::Impl::run(session::Session& session, const std::stop_token& stop) {
  session_ = &session;
  const std::stop_callback ends(stop, [this] { io_.stop(); });
  accept();
  tick();
  io_.run();
  session_->tick();
  pages.clear();
}

Server::Server(Options options) : impl_(std::make_unique<Impl>(std::move(options))) {}
Server::~Server() = default;
std::string Server::address() const { return impl_->address(); }
session::Ways Server::ways() { return impl_->ways(); }
void Server::run(session::Session& session, const std::stop_token& stop) {
  impl_->run(session, stop);
}

}  // namespace airtruth::server
