// SPDX-License-Identifier: Apache-2.0
#include "aircraft/ac3d/ac_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "aircraft/model/raw_model.h"
#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::ac3d {
namespace {

// A bound for untrusted files, far above any name.
constexpr std::size_t kMaxNameBytes = 4096;
constexpr std::size_t kQuotedBytes = 40;  // the part of a faulty word that a message repeats

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

std::string quoted_word(std::string_view word) {
  return word.empty() ? "the end of the file" : quoted_excerpt(word, kQuotedBytes);
}

// Like from_chars, but accepts a leading plus and reads a number too small for the type as zero.
bool parse_float(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* end = word.data() + word.size();
  float single = 0;
  const auto as_float = std::from_chars(word.data(), end, single);
  value = static_cast<double>(single);
  if (as_float.ec == std::errc()) return as_float.ptr == end;
  if (as_float.ec != std::errc::result_out_of_range || as_float.ptr != end) return false;
  const auto as_double = std::from_chars(word.data(), end, value);
  if (as_double.ec == std::errc()) return true;
  value = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
              ? 0
              : HUGE_VAL;
  return true;
}

// Words and numbers of a text, with the line where they stand.
class AcTokens {
 public:
  AcTokens(std::string_view text, std::filesystem::path name)
      : text_(text), name_(std::move(name)) {}

  // The next word; empty at the end of the text.
  std::string_view word() {
    skip_space();
    line_ = line_at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  // The next word or, between quotes, the next words.
  std::string string() {
    skip_space();
    line_ = line_at_;
    std::string_view found;
    if (at_ < text_.size() && text_[at_] == '"') {
      const auto close = text_.find('"', at_ + 1);
      if (close == std::string_view::npos) fail("has a quoted name without its second quote");
      found = text_.substr(at_ + 1, close - at_ - 1);
      at_ = close + 1;
      line_at_ += static_cast<int>(std::count(found.begin(), found.end(), '\n'));
    } else {
      found = word();
    }
    if (found.size() > kMaxNameBytes)
      fail(fmt::format("has a name of {} bytes; expected at most {}", found.size(), kMaxNameBytes));
    return std::string(found);
  }

  // A number of magnitude up to `largest`.
  float number(const char* what, double largest) {
    const std::string_view text = word();
    double value = 0;
    if (text.empty() || !parse_float(text, value))
      fail(fmt::format("{} is {}; expected a number", what, quoted_word(text)));
    if (!(std::abs(value) <= largest))
      fail(fmt::format(
          "{} is {}; expected at most {:g} either way", what, quoted_word(text), largest));
    return static_cast<float>(value);
  }

  // A whole number up to `largest`; decimal, or hexadecimal after 0x.
  std::uint32_t count(const char* what, std::uint64_t largest) {
    const std::string_view text = word();
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    const std::string_view digits = hexadecimal ? text.substr(2) : text;
    std::uint64_t value = 0;
    const char* end = digits.data() + digits.size();
    const auto [rest, failed] = std::from_chars(digits.data(), end, value, hexadecimal ? 16 : 10);
    if (digits.empty() || failed != std::errc() || rest != end || value > largest)
      fail(fmt::format(
          "{} is {}; expected a whole number up to {}", what, quoted_word(text), largest));
    return static_cast<std::uint32_t>(value);
  }

  void expect(std::string_view wanted) {
    const std::string_view found = word();
    if (found != wanted)
      fail(fmt::format("has {} where '{}' is expected", quoted_word(found), wanted));
  }

  void skip_line() {
    const auto end = text_.find('\n', at_);
    at_ = end == std::string_view::npos ? text_.size() : end;
  }

  void skip_bytes(std::size_t bytes) {
    const std::size_t end = at_ + std::min(bytes, bytes_left());
    line_at_ += static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                            text_.begin() + static_cast<std::ptrdiff_t>(end),
                                            '\n'));
    at_ = end;
  }

  std::size_t bytes_left() const { return text_.size() - at_; }
  int line() const { return line_; }  // of the last word
  // An Error at the line of the last word.
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(message, {name_.string(), line_});
  }

 private:
  void skip_space() {
    while (at_ < text_.size() && is_space(text_[at_])) {
      if (text_[at_] == '\n') ++line_at_;
      ++at_;
    }
  }

  std::string_view text_;
  std::filesystem::path name_;
  std::size_t at_ = 0;
  int line_at_ = 1;  // where the next character stands
  int line_ = 1;
};

// Bounds for untrusted files, far above those of any aircraft: numbers of objects, of levels of
// nested ones, and of corners.
constexpr std::size_t kMaxAcObjects = 100'000;
constexpr int kMaxKidsDepth = 64;
constexpr std::uint32_t kMaxCornersOfSurface = 10'000;
// The largest crease angle that is used. The 179 degrees of many models would smooth wing edges and
// leave normals that oppose their face; 60 is chosen by judgement.
constexpr float kLargestCreaseDeg = 60;
constexpr double kLargestUv = 1e5;       // texture coordinates, in repetitions of the texture
constexpr std::uint32_t kLineKinds = 3;  // surface flags: a closed or an open line
// Surface flags: smooth normals, and a surface with two sides.
constexpr std::uint32_t kSmooth = 1u << 4;
constexpr std::uint32_t kTwoSided = 1u << 5;
constexpr std::uint64_t kAnyFlags = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kBytesOfVertex = 6;   // "0 0 0\n"
constexpr std::size_t kBytesOfSurface = 6;  // "SURF 0"
constexpr std::size_t kBytesOfCorner = 6;   // "0 0 0\n"

// file = turn * local + shift. The sums are written out, so that every compiler adds in the same
// order and the result is the same.
struct Placement {
  Matrix3 turn = Matrix3::Identity();
  Vector3 shift = Vector3::Zero();

  Vector3 turned(const Vector3& v) const {
    return turn.col(0) * v.x() + turn.col(1) * v.y() + turn.col(2) * v.z();
  }
  Vector3 placed(const Vector3& v) const { return turned(v) + shift; }
  Placement operator*(const Placement& inner) const {
    Placement result;
    for (int i = 0; i < 3; ++i) result.turn.col(i) = turned(inner.turn.col(i));
    result.shift = placed(inner.shift);
    return result;
  }
};

class AcParser {
 public:
  AcParser(std::string_view text, const fs::path& name) : tokens_(text, name), name_(name) {}

  AcFile parse() {
    const std::string_view head = without_mark(tokens_.word());
    if (head.empty()) throw Error("is empty; expected a 3D model", {name_.string()});
    if (!head.starts_with("AC3D"))
      throw Error("is no AC3D file (it does not begin with AC3D)", {name_.string(), 1});
    read_object({}, {}, -1, 0);
    return std::move(file_);
  }

 private:
  struct Texture {
    std::string name;
    int line = 0;
  };
  struct State {
    Placement outer_from_own;
    Texture texture;
    std::array<float, 2> repeat{1, 1};
    std::array<float, 2> offset{0, 0};
  };

  AcObject& object(std::size_t index) { return file_.objects[index]; }

  // Reads one OBJECT with its kids. The materials come before the first one.
  void read_object(const Placement& file_from_outer,
                   const Texture& texture,
                   int parent,
                   int depth) {
    if (depth > kMaxKidsDepth)
      tokens_.fail(fmt::format("nests objects more than {} deep", kMaxKidsDepth));
    if (file_.objects.size() >= kMaxAcObjects)
      tokens_.fail(fmt::format("holds more than {} objects", kMaxAcObjects));
    const std::size_t index = file_.objects.size();
    file_.objects.emplace_back().parent = parent;
    State state;
    state.texture = texture;
    bool is_begun = false;
    for (;;) {
      const std::string_view word = tokens_.word();
      if (word.empty()) return at_the_end(depth, is_begun);
      is_begun = true;
      if (word == "kids")
        return read_kids(file_from_outer * state.outer_from_own, state, index, depth);
      read_line(word, file_from_outer, state, index);
    }
  }

  // Aircraft of FlightGear (c172p.ac) state more kids than the file holds. Objects that have not
  // begun when the text ends are ignored.
  void at_the_end(int depth, bool is_begun) {
    if (depth > 0 && is_begun) tokens_.fail("ends inside an object");
    if (depth > 0) file_.objects.pop_back();
  }

  void read_kids(const Placement& file_from_own, const State& state, std::size_t index, int depth) {
    const std::uint32_t kids = tokens_.count("kids", kMaxAcObjects);
    for (std::uint32_t i = 0; i < kids && tokens_.bytes_left() > 0; ++i)
      read_object(file_from_own, state.texture, static_cast<int>(index), depth + 1);
  }

  void read_line(std::string_view word,
                 const Placement& file_from_outer,
                 State& state,
                 std::size_t index) {
    if (word == "MATERIAL") {
      read_material();
    } else if (word == "OBJECT") {
      tokens_.word();
    } else if (word == "name") {
      object(index).name = tokens_.string();
    } else if (word == "texture") {
      state.texture.name = tokens_.string();
      state.texture.line = tokens_.line();
    } else if (word == "texrep" || word == "texoff") {
      for (float& value : word == "texrep" ? state.repeat : state.offset)
        value = tokens_.number("a texture's repetition or offset", kLargestUv);
    } else if (word == "crease") {
      object(index).crease_deg =
          std::min(tokens_.number("crease", model::kLargestCoordinate), kLargestCreaseDeg);
    } else if (word == "rot") {
      // The rows are where x, y and z go, as OpenSceneGraph has it in FlightGear.
      for (int i = 0; i < 9; ++i)
        state.outer_from_own.turn(i % 3, i / 3) = tokens_.number("rot", model::kLargestCoordinate);
    } else if (word == "loc") {
      for (double& value : state.outer_from_own.shift)
        value = tokens_.number("loc", model::kLargestCoordinate);
    } else if (word == "data") {
      skip_data();
    } else if (word == "numvert") {
      read_vertices(file_from_outer * state.outer_from_own, object(index));
    } else if (word == "numsurf") {
      read_surfaces(state, object(index));
    } else {
      tokens_.skip_line();  // subdiv, url, hidden, locked, folded and extensions of editors
    }
  }

  void read_material() {
    if (file_.materials.size() >= model::kMaxMaterials)
      tokens_.fail(fmt::format("holds more than {} materials", model::kMaxMaterials));
    model::Material material;
    std::array<float, 3> ambient{};
    material.finish = model::finish_named(tokens_.string());
    const auto colour = [&](const char* what, std::array<float, 3>& value) {
      tokens_.expect(what);
      for (float& channel : value) channel = tokens_.number(what, model::kLargestCoordinate);
    };
    colour("rgb", material.diffuse);
    colour("amb", ambient);
    colour("emis", material.emission);
    colour("spec", material.specular);
    tokens_.expect("shi");
    material.shininess = std::clamp(tokens_.number("shi", model::kLargestCoordinate), 0.0f, 128.0f);
    tokens_.expect("trans");
    material.opacity =
        1 - std::clamp(tokens_.number("trans", model::kLargestCoordinate), 0.0f, 1.0f);
    file_.materials.push_back(material);
  }

  void skip_data() {
    const std::uint32_t bytes = tokens_.count("data", tokens_.bytes_left());
    tokens_.skip_line();
    tokens_.skip_bytes(std::size_t{bytes} + 1);
  }

  // A count of items, each of which takes at least `bytes_each` bytes of the text that is left.
  std::uint32_t count_of(const char* what, std::size_t bytes_each, std::uint64_t most) {
    const std::uint32_t count = tokens_.count(what, most);
    const std::uint64_t possible = (tokens_.bytes_left() + bytes_each) / bytes_each;
    if (count > possible)
      tokens_.fail(fmt::format(
          "{} is {}, but the rest of the file can hold {} at most", what, count, possible));
    return count;
  }

  void read_vertices(const Placement& file_from_own, AcObject& target) {
    const std::uint32_t count = count_of("numvert", kBytesOfVertex, model::kMaxCorners);
    target.vertices.reserve(target.vertices.size() + count);
    for (std::uint32_t i = 0; i < count; ++i) {
      Vector3 own;
      for (double& value : own) value = tokens_.number("a coordinate", model::kLargestCoordinate);
      const Vector3 vertex = file_from_own.placed(own);
      for (const double value : vertex)
        if (!(std::abs(value) <= model::kLargestCoordinate))
          tokens_.fail(fmt::format("rot and loc put a vertex at {:g}; expected at most {:g}",
                                   value,
                                   model::kLargestCoordinate));
      target.vertices.push_back(vertex.cast<float>());
    }
  }

  void read_surfaces(const State& state, AcObject& target) {
    const std::uint32_t count = count_of("numsurf", kBytesOfSurface, model::kMaxTriangles);
    target.texture = state.texture.name;
    target.texture_line = state.texture.line;
    target.surfaces.reserve(target.surfaces.size() + count);
    for (std::uint32_t i = 0; i < count; ++i) read_surface(state, target);
  }

  void read_surface(const State& state, AcObject& target) {
    tokens_.expect("SURF");
    const std::uint32_t flags = tokens_.count("SURF", kAnyFlags);
    tokens_.expect("mat");
    const std::uint32_t material = tokens_.count("mat", model::kMaxMaterials);
    if (material >= file_.materials.size())
      tokens_.fail(fmt::format(
          "mat is {}, but the file has {} materials", material, file_.materials.size()));
    tokens_.expect("refs");
    const std::uint32_t count = count_of("refs", kBytesOfCorner, kMaxCornersOfSurface);
    const auto first = static_cast<std::uint32_t>(target.corners.size());
    for (std::uint32_t i = 0; i < count; ++i) target.corners.push_back(corner(state, target));
    corners_ += count;
    if (corners_ > model::kMaxCorners)
      tokens_.fail(fmt::format("holds surfaces of more than {} corners", model::kMaxCorners));
    if ((flags & kLineKinds) != 0 || count < 3) {
      target.corners.resize(first);
      return;
    }
    triangles_ += count - 2;
    if (triangles_ > model::kMaxTriangles)
      tokens_.fail(fmt::format("holds more than {} triangles", model::kMaxTriangles));
    target.surfaces.push_back(
        {(flags & kSmooth) != 0, (flags & kTwoSided) != 0, material, first, count});
  }

  AcCorner corner(const State& state, const AcObject& target) {
    AcCorner result;
    result.vertex = tokens_.count("a vertex's index", kAnyFlags);
    if (result.vertex >= target.vertices.size())
      tokens_.fail(fmt::format("names the vertex {}, but its object has {} (they count from 0)",
                               result.vertex,
                               target.vertices.size()));
    const float u = tokens_.number("a texture coordinate", kLargestUv);
    const float v = tokens_.number("a texture coordinate", kLargestUv);
    result.u = state.offset[0] + u * state.repeat[0];
    result.v = state.offset[1] + v * state.repeat[1];
    if (!(std::abs(result.u) <= kLargestUv && std::abs(result.v) <= kLargestUv))
      tokens_.fail("texrep makes a texture coordinate too large");
    return result;
  }

  AcTokens tokens_;
  fs::path name_;
  AcFile file_;
  std::size_t corners_ = 0;
  std::size_t triangles_ = 0;
};

}  // namespace

AcFile parse_ac(std::string_view text, const fs::path& name) {
  return AcParser(text, name).parse();
}

std::vector<std::string> names_of(const AcFile& file, std::size_t object) {
  std::vector<std::string> names;
  for (int at = static_cast<int>(object); at >= 0;
       at = file.objects[static_cast<std::size_t>(at)].parent) {
    const AcObject& here = file.objects[static_cast<std::size_t>(at)];
    if (here.parent < 0) {
      names.emplace_back("World");
    } else if (!here.name.empty()) {
      names.push_back(here.name);
    }
  }
  std::reverse(names.begin(), names.end());
  return names;
}

}  // namespace airtruth::ac3d
