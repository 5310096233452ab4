// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/base64.h"

#include <openssl/evp.h>

namespace airtruth {

std::string base64_of(std::string_view bytes) {
  // EVP_EncodeBlock writes a terminating zero after the text.
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                     reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

}  // namespace airtruth
