// SPDX-License-Identifier: Apache-2.0
// The house plan of src/: includes go strictly downward (src/LAYERS gives each module its rank),
// and modules are small, named as their folders, with a header for each source.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/source_folder.h"

namespace {

namespace fs = std::filesystem;
const fs::path kSource = airtruth::test_support::source_folder() / "src";

struct Layer {
  std::string wing;
  std::string module;
  int rank = 0;  // higher wings and higher ranks within a wing have higher numbers
};

// src/LAYERS from the lowest module to the highest.
std::vector<Layer> layers() {
  std::vector<Layer> result;
  std::ifstream file(kSource / "LAYERS");
  int rank = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string wing;
    words >> wing;
    wing.pop_back();  // the colon
    ++rank;
    for (std::string word; words >> word;) {
      if (word == "<")
        ++rank;
      else
        result.push_back({wing, word, rank});
    }
  }
  return result;
}

// The rank of every module, "wing/module", or "cli" for a wing that is one module.
std::map<std::string, int> ranks() {
  std::map<std::string, int> result;
  for (const Layer& layer : layers()) {
    const bool is_whole_wing =
        layer.module == layer.wing && fs::exists(kSource / layer.wing / "main.cpp");
    result[is_whole_wing ? layer.wing : layer.wing + "/" + layer.module] = layer.rank;
  }
  return result;
}

// The module of a path relative to src/.
std::string module_of(const fs::path& path) {
  auto part = path.begin();
  const std::string wing = part->string();
  const fs::path next = *++part;
  return next == path.filename() ? wing : wing + "/" + next.string();
}

bool is_source(const fs::path& path) {
  const std::string name = path.filename().string();
  return (name.ends_with(".h") || name.ends_with(".cpp")) && !name.ends_with("_test.cpp");
}

// Every .h and .cpp of src/, tests included, relative to it.
std::vector<fs::path> all_sources() {
  std::vector<fs::path> result;
  for (const auto& entry : fs::recursive_directory_iterator(kSource)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && (name.ends_with(".h") || name.ends_with(".cpp")))
      result.push_back(fs::relative(entry.path(), kSource));
  }
  return result;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(kSource / path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// "wing/module" of every row of the table in docs/architecture.md, whose first column is empty
// where the wing is that of the row above.
std::vector<std::string> described_modules() {
  std::vector<std::string> result;
  std::ifstream file(airtruth::test_support::source_folder() / "docs" / "architecture.md");
  const std::regex row(R"re(^\| (`([a-z_0-9]+)`)? ?\| `([a-z_0-9]+)` \|.*)re");
  std::string wing;
  std::smatch match;
  for (std::string line; std::getline(file, line);) {
    if (!std::regex_match(line, match, row)) continue;
    if (match[2].matched) wing = match[2].str();
    result.push_back(wing + "/" + match[3].str());
  }
  return result;
}

// The wings of a list of modules, in its order.
std::vector<std::string> wings_of(const std::vector<std::string>& modules) {
  std::vector<std::string> result;
  for (const std::string& module : modules) {
    const std::string wing = module.substr(0, module.find('/'));
    if (result.empty() || result.back() != wing) result.push_back(wing);
  }
  return result;
}

TEST(Layers, ArchitectureDescribesTheSameModules) {
  std::vector<std::string> ranked;
  for (const Layer& layer : layers()) ranked.push_back(layer.wing + "/" + layer.module);
  const std::vector<std::string> described = described_modules();
  const std::set<std::string> in_layers(ranked.begin(), ranked.end());
  const std::set<std::string> in_page(described.begin(), described.end());
  for (const std::string& module : in_layers)
    EXPECT_TRUE(in_page.contains(module)) << "docs/architecture.md has no row for " << module;
  for (const std::string& module : in_page)
    EXPECT_TRUE(in_layers.contains(module))
        << "docs/architecture.md has a row for " << module << ", which src/LAYERS does not name";
  EXPECT_EQ(described.size(), in_page.size()) << "docs/architecture.md has two rows for one module";
  EXPECT_EQ(wings_of(described), wings_of(ranked)) << "the order of the wings differs";
}

TEST(Layers, EveryModuleHasARank) {
  const auto rank_of = ranks();
  for (const fs::path& path : all_sources()) {
    if (!is_source(path)) continue;
    EXPECT_TRUE(rank_of.contains(module_of(path))) << path;
  }
}

TEST(Layers, IncludesGoStrictlyDownward) {
  const auto rank_of = ranks();
  ASSERT_FALSE(rank_of.empty());
  const std::regex include(R"re(^\s*#\s*include\s+"([a-z_0-9/]+\.h)")re");
  int checked = 0;
  for (const fs::path& path : all_sources()) {
    if (!is_source(path)) continue;
    const std::string module = module_of(path);
    ASSERT_TRUE(rank_of.contains(module)) << path;
    std::ifstream file(kSource / path);
    int number = 0;
    for (std::string line; std::getline(file, line);) {
      ++number;
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      const std::string other = module_of(match[1].str());
      ++checked;
      ASSERT_TRUE(rank_of.contains(other)) << path << ":" << number << ": unknown module " << other;
      if (other == module) continue;
      EXPECT_GT(rank_of.at(module), rank_of.at(other))
          << path << ":" << number << " includes " << match[1];
    }
  }
  EXPECT_GT(checked, 1000);
}

// The words after a keyword of an add_module call, up to the next keyword.
std::vector<std::string> words_after(const std::string& keyword, const std::string& call) {
  std::vector<std::string> result;
  std::istringstream words(call);
  const std::regex is_keyword("[A-Z_]{5,}");
  bool is_asked = false;
  for (std::string word; words >> word;) {
    if (std::regex_match(word, is_keyword))
      is_asked = word == keyword;
    else if (is_asked)
      result.push_back(word);
  }
  return result;
}

// Each name that a CMakeLists.txt gives to add_module: its "wing/module", and what it depends on.
struct Built {
  std::string module;
  std::vector<std::string> depends;
};

std::map<std::string, Built> built_modules() {
  std::map<std::string, Built> result;
  const std::regex call(R"re(\badd_module\(\s*([a-z_0-9]+)([^)]*)\))re");
  for (const auto& entry : fs::recursive_directory_iterator(kSource)) {
    if (entry.path().filename() != "CMakeLists.txt") continue;
    const fs::path path = fs::relative(entry.path(), kSource);
    const std::string text = text_of(path);
    for (std::sregex_iterator match(text.begin(), text.end(), call), end; match != end; ++match)
      result[(*match)[1].str()] = {module_of(path), words_after("DEPENDS", (*match)[2].str())};
  }
  return result;
}

using Modules = std::set<std::string>;

// The modules with a source X.cpp that includes a header <airtruth/X.h>, of each such header.
std::map<std::string, Modules> implementers() {
  std::map<std::string, Modules> result;
  for (const fs::path& path : all_sources()) {
    if (path.extension() != ".cpp" || !is_source(path)) continue;
    const std::string header = "airtruth/" + path.stem().string() + ".h";
    if (text_of(path).find("#include <" + header + ">") != std::string::npos)
      result[header].insert(module_of(path));
  }
  return result;
}

// What the sources of each module include: modules, and those that implement a public header.
struct Included {
  Modules modules;
  Modules behind_public_headers;
};

std::map<std::string, Included> included_modules() {
  std::map<std::string, Included> result;
  const auto behind = implementers();
  const std::regex include(R"re(\n#include ["<]([a-z_0-9/]+\.h)[">])re");
  for (const fs::path& path : all_sources()) {
    if (!is_source(path)) continue;
    const std::string text = "\n" + text_of(path);
    Included& of_module = result[module_of(path)];
    for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end;
         ++match) {
      const std::string header = (*match)[1].str();
      if (fs::exists(kSource / header)) of_module.modules.insert(module_of(header));
      if (const auto found = behind.find(header); found != behind.end())
        of_module.behind_public_headers.insert(found->second.begin(), found->second.end());
    }
  }
  return result;
}

// What a module states is what is built for it: a dependency that no source includes makes a
// program of a few modules wait for others.
TEST(Modules, StateTheModulesThatTheyInclude) {
  const auto built = built_modules();
  EXPECT_GT(built.size(), 80U);
  std::map<std::string, Modules> stated;
  for (const auto& [name, one] : built) {
    Modules& of_module = stated[one.module];  // also where nothing is stated
    for (const std::string& other : one.depends) {
      ASSERT_TRUE(built.contains(other)) << name << " depends on " << other;
      of_module.insert(built.at(other).module);
    }
  }
  auto included = included_modules();
  for (const auto& [module, others] : stated) {
    const Included& of_module = included[module];
    for (const std::string& other : others) {
      EXPECT_TRUE(of_module.modules.contains(other) ||
                  of_module.behind_public_headers.contains(other) || other == module)
          << module << " states that it depends on " << other << ", which no source of it includes";
    }
    for (const std::string& other : of_module.modules)
      EXPECT_TRUE(others.contains(other) || other == module)
          << module << " includes " << other << " and does not state it";
  }
}

TEST(Modules, HaveAtMost25Files) {
  std::map<std::string, int> files;
  for (const fs::path& path : all_sources()) ++files[module_of(path)];
  for (const auto& [module, count] : files) EXPECT_LE(count, 25) << module;
}

// Two modules of one name would share a namespace.
TEST(Modules, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Layer& layer : layers())
    EXPECT_TRUE(names.insert(layer.module).second) << layer.module;
}

// What everything speaks in, and what implements the public library, is in `airtruth` itself.
std::string expected_namespace(const std::string& module) {
  const std::set<std::string> in_airtruth = {"foundation/base",
                                             "foundation/geometry",
                                             "foundation/json",
                                             "foundation/run_files",
                                             "library/clips",
                                             "library/flights",
                                             "library/pictures",
                                             "library/records"};
  return in_airtruth.contains(module) ? "" : module.substr(module.find('/') + 1);
}

// A file may add to a namespace of a public header, or to that of a template that it specialises.
TEST(Modules, HaveTheNamespaceOfTheirFolder) {
  const std::regex opened(R"re(\nnamespace airtruth(::([a-z_0-9:]+))? \{)re");
  for (const fs::path& path : all_sources()) {
    if (!is_source(path)) continue;
    const std::string expected = expected_namespace(module_of(path));
    const std::string text = text_of(path);
    std::set<std::string> names;
    for (std::sregex_iterator match(text.begin(), text.end(), opened), end; match != end; ++match)
      names.insert((*match)[2].str());
    const bool implements_public_header = names.contains("evaluation");
    EXPECT_TRUE(names.empty() || names.contains(expected) || implements_public_header)
        << path << " has namespace " << *names.begin() << "; expected " << expected;
  }
}

// Sources of these modules are the implementations of one interface, which one header declares: a
// command, a format, a method.
TEST(Modules, HaveAHeaderForEachSource) {
  const std::multimap<std::string, std::string> interfaces = {
      {"camera/lens", "calibration.h"},
      {"camera/motion", "follower.h"},
      {"cli", "commands.h"},
      {"encounter/tracks_file", "formats.h"},
      {"labels/exchange", "parts.h"},
      {"picture/backdrop", "backdrop.h"},
      {"scene/flight_log", "flight_log.h"},
      {"scene/flight_log", "formats.h"},
      {"scene/scene", "scene.h"},
      {"scene/scene", "tables.h"},
      {"scene/trajectory", "path"},
      {"show/drawing", "pictures.h"},
      {"runners/classical", "classical.h"},
      {"runners/detector", "detector.h"},
      {"runners/network", "inference.h"},
      {"runners/results", "results_folder.h"},
      {"runners/tracking", "tracker.h"}};
  const std::regex entry_point(R"re(\n(int main\(|extern "C"))re");
  for (const fs::path& path : all_sources()) {
    if (path.extension() != ".cpp" || !is_source(path)) continue;
    fs::path header = path;
    header.replace_extension(".h");
    if (fs::exists(kSource / header)) continue;
    if (fs::exists(kSource / "../include/airtruth" / header.filename())) continue;
    if (std::regex_search(text_of(path), entry_point)) continue;
    const std::string text = text_of(path);
    EXPECT_TRUE(std::ranges::any_of(interfaces,
                                    [&](const auto& interface) {
                                      const auto& [module, header_name] = interface;
                                      return module == module_of(path) &&
                                             text.find(module + "/" + header_name) !=
                                                 std::string::npos;
                                    }))
        << path << " has no header of its name";
  }
}

// What a user of the library includes brings nothing else along.
TEST(Layers, PublicHeadersIncludeOnlyEachOtherAndTheStandardLibrary) {
  const fs::path folder = airtruth::test_support::source_folder() / "include" / "airtruth";
  const std::regex include(R"re(^\s*#\s*include\s+(.*))re");
  const std::regex allowed(R"re(<(airtruth/[a-z_]+\.h|[a-z_]+)>)re");
  int checked = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, include)) continue;
      ++checked;
      EXPECT_TRUE(std::regex_match(match[1].str(), allowed)) << entry.path() << ": " << line;
    }
  }
  EXPECT_GT(checked, 30);
}

// OpenSceneGraph chooses a plugin, which may run code, by a file's name: it draws, and reads
// nothing.
TEST(Layers, NoSourceReadsFilesThroughOpenSceneGraph) {
  int checked = 0;
  for (const fs::path& path : all_sources()) {
    if (!is_source(path)) continue;
    EXPECT_EQ(text_of(path).find("<osgDB"), std::string::npos) << path;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
