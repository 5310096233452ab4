// SPDX-License-Identifier: Apache-2.0
#include "show/html/page.h"

#include <fmt/format.h>

#include "foundation/base/text.h"

namespace airtruth::html {
namespace {

// Escapes text for a <script> element, so that it cannot end the element or begin a comment.
std::string in_script(std::string_view json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

}  // namespace

std::string page_of(std::string_view title,
                    std::string_view body,
                    std::string_view json,
                    const std::vector<PagePicture>& pictures,
                    std::string_view script) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += fmt::format("<title>{}</title>\n<style>\n", title);
  page += page_css();
  page += "</style>\n</head>\n<body>\n";
  page += body;
  page += "<script type=\"application/json\" id=\"data\">" + in_script(json) + "</script>\n";
  for (const auto& [id, jpeg] : pictures)
    if (!jpeg.empty())
      page +=
          fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, base64_of(jpeg));
  for (const std::string_view part : {chart_js(), common_js(), script}) {
    page += "<script>\n";
    page += part;
    page += "\n</script>\n";
  }
  page += "</body>\n</html>\n";
  return page;
}

}  // namespace airtruth::html
