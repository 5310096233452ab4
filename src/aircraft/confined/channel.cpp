// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/channel.h"

#include "aircraft/confined/model_wire.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxWords = 65536;

}  // namespace

std::string bytes_of(const ReaderJob& job) {
  WireWriter out;
  out.put_text(job.file);
  out.put_text(job.shown_folder);
  out.put_text(job.in_data_root);
  out.put(job.options.airspeed_kt);
  out.put(job.options.altitude_agl_ft);
  out.put(static_cast<std::uint8_t>(job.options.axes.has_value()));
  const ModelAxes axes = job.options.axes.value_or(ModelAxes{});
  out.put_text(axes.forward);
  out.put_text(axes.up);
  out.put(axes.scale);
  return out.take();
}

ReaderJob job_from_bytes(std::string_view bytes) {
  WireReader in(bytes);
  ReaderJob job;
  job.file = in.get_text(kMaxWords);
  job.shown_folder = in.get_text(kMaxWords);
  job.in_data_root = in.get_text(kMaxWords);
  job.options.airspeed_kt = in.get<double>();
  job.options.altitude_agl_ft = in.get<double>();
  const bool has_axes = in.get<std::uint8_t>() != 0;
  ModelAxes axes;
  axes.forward = in.get_text(kMaxWords);
  axes.up = in.get_text(kMaxWords);
  axes.scale = in.get<double>();
  if (has_axes) job.options.axes = axes;
  in.expect_end();
  return job;
}

}  // namespace airtruth::aircraft
