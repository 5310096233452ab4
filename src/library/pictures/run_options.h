// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sequence/pipeline/options.h"

namespace airtruth {

// What RenderOptions and StreamOptions have in common.
template <typename AnyOptions>
pipeline::Options run_options(const AnyOptions& wanted) {
  pipeline::Options options;
  options.threads = wanted.threads;
  options.use_cache = wanted.use_cache;
  options.cache = wanted.cache;
  options.warn = wanted.warn;
  options.stop = wanted.stop;
  return options;
}

}  // namespace airtruth
