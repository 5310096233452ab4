// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <pugixml.hpp>

// Reads XML from users' files. Every fault is an Error that names the file and the line.
namespace airtruth::exchange {

class XmlFile {
 public:
  explicit XmlFile(const std::filesystem::path& file);
  // The top element; Error where its name differs.
  pugi::xml_node top(const char* name) const;

  pugi::xml_node child(const pugi::xml_node& node, const char* name) const;
  double number(const pugi::xml_node& node, const char* child) const;
  double attribute(const pugi::xml_node& node, const char* name) const;
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& what) const;

 private:
  std::filesystem::path file_;
  std::string text_;
  pugi::xml_document document_;
};

// Appends an element that holds a text, and returns it.
pugi::xml_node add_text(pugi::xml_node node, const char* name, const std::string& text);

std::string text_of(const pugi::xml_document& document,
                    const char* indent = "  ",
                    unsigned flags = pugi::format_default);

}  // namespace airtruth::exchange
