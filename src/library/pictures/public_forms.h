// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/picture.h>
#include <airtruth/video.h>

#include "foundation/image/picture.h"
#include "picture/video/reader.h"
#include "sequence/pipeline/options.h"

// The public forms of pictures and of videos, and the options of runs that public ones state.
namespace airtruth {

FramePicture public_picture(const image::Picture& picture);
VideoInfo public_info(const video::StreamInfo& info);

// Which cache a caller's options name.
template <typename AnyOptions>
pipeline::Options cache_options(const AnyOptions& wanted) {
  pipeline::Options options;
  options.use_cache = wanted.use_cache;
  options.cache = wanted.cache;
  return options;
}

// What RenderOptions and StreamOptions have in common.
template <typename AnyOptions>
pipeline::Options run_options(const AnyOptions& wanted) {
  pipeline::Options options = cache_options(wanted);
  options.threads = wanted.threads;
  options.warn = wanted.warn;
  options.stop = wanted.stop;
  return options;
}

}  // namespace airtruth
