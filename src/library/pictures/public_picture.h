// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/picture.h>
#include <airtruth/video.h>

#include "foundation/image/picture.h"
#include "picture/video/reader.h"

namespace airtruth {

FramePicture public_picture(const image::Picture& picture);
VideoInfo public_info(const video::StreamInfo& info);

}  // namespace airtruth
