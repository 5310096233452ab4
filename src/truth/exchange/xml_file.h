// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <pugixml.hpp>

// XML as users bring it: faults are Errors that name the file and the line.
namespace airtruth::exchange {

class XmlFile {
 public:
  explicit XmlFile(const std::filesystem::path& file);
  // The element at the top; Error where it is another.
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

// As a number, where it is one.
std::optional<double> number_in(const std::string& text);

// The document, indented by two blanks.
std::string text_of(const pugi::xml_document& document);
// For readers that know elements alone: indented by tabs, without an XML declaration.
std::string bare_text_of(const pugi::xml_document& document);

}  // namespace airtruth::exchange
