// SPDX-License-Identifier: Apache-2.0
#include "foundation/tar/tar.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::tar {
namespace {

constexpr std::size_t kBlock = 512;
constexpr std::uint64_t kLargestRead = std::uint64_t{256} << 20;
using Block = std::array<char, kBlock>;

// Where a field of a header stands.
struct Field {
  std::size_t at;
  std::size_t size;
};
constexpr Field kName{0, 100}, kMode{100, 8}, kUser{108, 8}, kGroup{116, 8}, kSize{124, 12},
    kTime{136, 12}, kChecksum{148, 8}, kType{156, 1}, kMagic{257, 8}, kPrefix{345, 155};

void put(Block& block, Field field, std::string_view text) {
  std::copy_n(text.begin(), std::min(text.size(), field.size), block.begin() + field.at);
}

void put_octal(Block& block, Field field, std::uint64_t value) {
  put(block, field, fmt::format("{:0{}o}", value, field.size - 1));
}

std::string_view text_of(const Block& block, Field field) {
  const std::string_view text(block.data() + field.at, field.size);
  return text.substr(0, text.find('\0'));
}

// The sum of a header's bytes, with blanks for the sum itself.
std::uint64_t checksum_of(Block block) {
  put(block, kChecksum, "        ");
  std::uint64_t sum = 0;
  for (const char byte : block) sum += static_cast<unsigned char>(byte);
  return sum;
}

// Blanks and zeros may stand around it; empty where it is no octal number.
std::optional<std::uint64_t> octal_of(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  text = first == std::string_view::npos ? "" : text.substr(first);
  text = text.substr(0, text.find(' '));
  std::uint64_t value = 0;
  for (const char digit : text) {
    if (digit < '0' || digit > '7') return std::nullopt;
    value = value * 8 + static_cast<std::uint64_t>(digit - '0');
  }
  return value;
}

std::size_t padding_of(std::uint64_t bytes) { return (kBlock - bytes % kBlock) % kBlock; }

// A record of a pax header: "LENGTH path=NAME\n", whose length counts itself.
std::string pax_record(const std::string& name) {
  const std::string rest = " path=" + name + "\n";
  std::size_t length = rest.size();
  while (length != rest.size() + std::to_string(length).size())
    length = rest.size() + std::to_string(length).size();
  return std::to_string(length) + rest;
}

// The path that a pax header states; empty where it states none.
std::string path_of_pax(std::string_view records) {
  while (!records.empty()) {
    std::size_t length = 0, digits = 0;
    while (digits < std::min<std::size_t>(records.size(), 9) && records[digits] >= '0' &&
           records[digits] <= '9')
      length = length * 10 + static_cast<std::size_t>(records[digits++] - '0');
    if (length <= digits + 1 || length > records.size()) return {};
    const std::string_view record = records.substr(digits + 1, length - digits - 2);
    if (record.starts_with("path=")) return std::string(record.substr(5));
    records.remove_prefix(length);
  }
  return {};
}

// Reads an archive from its beginning to its end.
class Reader {
 public:
  explicit Reader(const fs::path& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_ || !fs::is_regular_file(file)) throw Error("cannot be opened", {file.string()});
    size_ = fs::file_size(file);
  }

  // The next member, whose content is then skipped or read.
  struct Member {
    std::string name;
    char type = '0';
    std::uint64_t size = 0;
  };
  std::optional<Member> next() {
    Block block{};
    in_.seekg(static_cast<std::streamoff>(at_));
    if (at_ + kBlock > size_ || !in_.read(block.data(), kBlock))
      fail("ends without its last block");
    if (std::all_of(block.begin(), block.end(), [](char c) { return c == 0; })) return std::nullopt;
    const auto size = octal_of(text_of(block, kSize));
    if (octal_of(text_of(block, kChecksum)) != checksum_of(block) || !size)
      fail("is no tar archive");
    Member member{std::string(text_of(block, kName)), block[kType.at], *size};
    if (const auto prefix = text_of(block, kPrefix); !prefix.empty() &&
                                                     text_of(block, kMagic).starts_with("ustar") &&
                                                     block[kMagic.at + 5] == '\0')
      member.name = std::string(prefix) + "/" + member.name;
    content_ = at_ + kBlock;
    if (member.size > size_ - content_) fail("ends within " + member.name);
    at_ = content_ + member.size + padding_of(member.size);
    return member;
  }

  std::string content(const Member& member) {
    if (member.size > kLargestRead)
      fail(fmt::format(
          "holds {} of {} bytes; expected at most {}", member.name, member.size, kLargestRead));
    std::string bytes(member.size, '\0');
    in_.seekg(static_cast<std::streamoff>(content_));
    if (!in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail("cannot be read");
    return bytes;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(what, {file_.string()}); }

  const fs::path& file_;
  std::ifstream in_;
  std::uint64_t size_ = 0, at_ = 0, content_ = 0;
};

}  // namespace

Writer::Writer(const fs::path& file) : file_(file) {
  if (!file_.out()) throw Error("cannot be written", {file.string()});
}

void Writer::add(const std::string& name, std::string_view bytes) {
  check(bytes.size() < std::uint64_t{8} << 30, "ustar's sizes are of 11 octal digits");
  if (name.size() > kName.size) put("pax", pax_record(name), 'x');
  put(name, bytes, '0');
  file_.check_written();
}

void Writer::put(const std::string& name, std::string_view bytes, char type) {
  Block block{};
  tar::put(block, kName, name);
  put_octal(block, kMode, 0644);
  put_octal(block, kUser, 0);
  put_octal(block, kGroup, 0);
  put_octal(block, kSize, bytes.size());
  put_octal(block, kTime, 0);
  block[kType.at] = type;
  tar::put(block, kMagic, std::string_view("ustar\00000", 8));
  tar::put(block, kChecksum, fmt::format("{:06o}", checksum_of(block)) + '\0' + ' ');
  const std::string padding(padding_of(bytes.size()), '\0');
  file_.out().write(block.data(), kBlock);
  file_.out().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file_.out().write(padding.data(), static_cast<std::streamsize>(padding.size()));
  bytes_ += static_cast<std::int64_t>(kBlock + bytes.size() + padding.size());
}

void Writer::finish() {
  const std::string end(2 * kBlock, '\0');
  file_.out().write(end.data(), static_cast<std::streamsize>(end.size()));
  file_.finish();
}

void each_file(
    const fs::path& archive,
    std::string_view ending,
    const std::function<void(const std::string& name, const std::string& bytes)>& visit) {
  Reader reader(archive);
  std::string long_name;
  while (auto member = reader.next()) {
    if (member->type == 'x') {
      long_name = path_of_pax(reader.content(*member));
      continue;
    }
    if (member->type == 'L') {  // GNU tar's own form of a long name
      long_name = reader.content(*member);
      long_name.resize(std::min(long_name.find('\0'), long_name.size()));
      continue;
    }
    if (!long_name.empty()) member->name = std::exchange(long_name, {});
    const bool is_file = member->type == '0' || member->type == '\0';
    if (is_file && member->name.ends_with(ending)) visit(member->name, reader.content(*member));
  }
}

}  // namespace airtruth::tar
