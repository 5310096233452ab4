// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace airtruth::cli {

// CLI11 2.1 (Debian 12) writes an option's default value as "INT=3", 2.4 (Debian 13) as "INT [3] ".
// Help has the first form on both.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string value = option->get_default_str();
    const std::string bracketed = " [" + value + "] ";
    if (const std::size_t at = text.find(bracketed); !value.empty() && at != std::string::npos)
      text.replace(at, bracketed.size(), "=" + value);
    return text;
  }
};

}  // namespace airtruth::cli
