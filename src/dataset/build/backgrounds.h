// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dataset/build/build.h"
#include "dataset/catalogue/folder.h"

namespace airtruth::dataset {

// The files of a background: a video that is there, or a virtual flight, which is made where it is
// not. `seen` after each of its frames. A flight's files appear whole or not at all; two makers at
// once make the same bytes.
BackgroundFiles prepare(const Background& background,
                        const Folder& folder,
                        const BuildOptions& options);

// Fills size, rate and number of frames from the video. Error where it cannot be read.
void add_facts(BackgroundFiles& files);

}  // namespace airtruth::dataset
