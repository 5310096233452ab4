// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "show/drawing/thumbnails.h"
#include "show/html/page.h"

namespace airtruth::report {

// Adds the stills of the sequence with this number, under the names by which a page finds them.
void add_stills(std::vector<html::PagePicture>& pictures,
                std::size_t sequence,
                const std::vector<drawing::Still>& stills);

}  // namespace airtruth::report
