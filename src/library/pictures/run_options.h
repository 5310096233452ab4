// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sequence/pipeline/options.h"

namespace airtruth {

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
