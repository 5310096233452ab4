// SPDX-License-Identifier: Apache-2.0
#include "sequence/demo/virtual_flight.h"

#include <cmath>
#include <memory>

#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include "foundation/base/error.h"

namespace airtruth::demo {
namespace {

video::StreamInfo stream_of(const synthetic::FlightOptions& options, const image::Picture& first) {
  video::StreamInfo info;
  info.width = options.width;
  info.height = options.height;
  info.colour = first.colour;
  const int per_1001 = static_cast<int>(std::lround(options.frame_rate_hz * 1001));
  info.frame_rate = {per_1001, 1001};
  if (std::abs(options.frame_rate_hz - std::round(options.frame_rate_hz)) < 1e-9)
    info.frame_rate = {static_cast<int>(std::lround(options.frame_rate_hz)), 1};
  info.time_base = {info.frame_rate.den, info.frame_rate.num};
  info.frame_count_estimate = options.frame_count;
  return info;
}

}  // namespace

void write_flight(const synthetic::Flight& flight,
                  const fs::path& out,
                  const VirtualFlightOptions& options) {
  const synthetic::FlightOptions& what = flight.options();
  video::Writer writer(out,
                       stream_of(what, flight.frame(0)),
                       {.format = options.format, .quality = options.quality});
  using FramePtr = std::shared_ptr<video::Frame>;
  int next = 0;
  const auto in_flight = static_cast<std::size_t>(tbb::info::default_concurrency()) + 2;
  tbb::parallel_pipeline(
      in_flight,
      tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order,
                                  [&](tbb::flow_control& control) {
                                    if (next == what.frame_count || options.stop.stop_requested())
                                      control.stop();
                                    return next++;
                                  }) &
          tbb::make_filter<int, FramePtr>(tbb::filter_mode::parallel,
                                          [&](int index) {
                                            auto frame = std::make_shared<video::Frame>();
                                            frame->index = index;
                                            frame->pts = index;
                                            frame->time_s = index / what.frame_rate_hz;
                                            frame->picture = flight.frame(index);
                                            return frame;
                                          }) &
          tbb::make_filter<FramePtr, void>(tbb::filter_mode::serial_in_order,
                                           [&](const FramePtr& frame) {
                                             writer.write(*frame);
                                             if (options.progress)
                                               options.progress(frame->index + 1, what.frame_count);
                                           }));
  if (options.stop.stop_requested()) throw Interrupted();
  writer.finish();
}

}  // namespace airtruth::demo
