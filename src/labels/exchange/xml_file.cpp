// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/xml_file.h"

#include <sstream>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "labels/exchange/text.h"

namespace airtruth::exchange {

XmlFile::XmlFile(const std::filesystem::path& file)
    : file_(file), text_(read_file(file, std::size_t{4} << 30)) {
  const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
  if (!result)
    throw Error(std::string("is not XML: ") + result.description(),
                {file.string(), line_of(text_, result.offset)});
}

pugi::xml_node XmlFile::top(const char* name) const {
  const pugi::xml_node node = document_.document_element();
  if (std::string(node.name()) != name)
    throw Error(
        "begins with <" + std::string(node.name()).substr(0, 40) + ">; expected <" + name + ">",
        {file_.string()});
  return node;
}

pugi::xml_node XmlFile::child(const pugi::xml_node& node, const char* name) const {
  const pugi::xml_node found = node.child(name);
  if (!found) fail(node, std::string("has no <") + name + ">");
  return found;
}

double XmlFile::number(const pugi::xml_node& node, const char* name) const {
  const auto value = number_in(child(node, name).child_value());
  if (!value) fail(node, std::string("<") + name + "> is not a number");
  return *value;
}

double XmlFile::attribute(const pugi::xml_node& node, const char* name) const {
  const auto value = number_in(node.attribute(name).value());
  if (!value) fail(node, std::string(name) + " is not a number");
  return *value;
}

void XmlFile::fail(const pugi::xml_node& node, const std::string& what) const {
  throw Error("<" + std::string(node.name()) + "> " + what,
              {file_.string(), line_of(text_, node.offset_debug())});
}

pugi::xml_node add_text(pugi::xml_node node, const char* name, const std::string& text) {
  pugi::xml_node child = node.append_child(name);
  child.text().set(text.c_str());
  return child;
}

std::string text_of(const pugi::xml_document& document, const char* indent, unsigned flags) {
  std::ostringstream out;
  document.save(out, indent, flags, pugi::encoding_utf8);
  return out.str();
}

}  // namespace airtruth::exchange
