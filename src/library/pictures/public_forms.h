// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <airtruth/error.h>
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

// Frames in memory at a time; as in Python.
constexpr int kMaxThreads = 256;

// What RenderOptions and StreamOptions have in common. Throws Error for a number of threads that is
// none.
template <typename AnyOptions>
pipeline::Options run_options(const AnyOptions& wanted) {
  if (wanted.threads < 0 || wanted.threads > kMaxThreads)
    throw Error("threads is " + std::to_string(wanted.threads) + "; expected 0 to " +
                std::to_string(kMaxThreads));
  pipeline::Options options = cache_options(wanted);
  options.threads = wanted.threads;
  options.warn = wanted.warn;
  options.stop = wanted.stop;
  return options;
}

}  // namespace airtruth
