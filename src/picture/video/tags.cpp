// SPDX-License-Identifier: Apache-2.0
#include "picture/video/tags.h"

#include <algorithm>
#include <cctype>

#include "foundation/base/error.h"
#include "picture/video/libav.h"

extern "C" {
#include <libavutil/dict.h>
}

namespace airtruth::video {
namespace {

void add_tags(const AVDictionary* tags, std::map<std::string, std::string>& result) {
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(tags, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    std::string key(entry->key);
    std::transform(
        key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
    result[key] = entry->value;
  }
}

}  // namespace

std::map<std::string, std::string> read_tags(const std::filesystem::path& path) {
  keep_libav_quiet();
  AVFormatContext* opened = nullptr;
  if (!std::filesystem::is_regular_file(path)) return {};
  if (const int result = avformat_open_input(&opened, path.c_str(), nullptr, nullptr); result < 0)
    throw Error("cannot be opened as a video: " + reason(result), {path.string()});
  const InputPtr input(opened);
  std::map<std::string, std::string> result;
  add_tags(input->metadata, result);
  for (unsigned i = 0; i < input->nb_streams; ++i)
    if (input->streams[i]->codecpar->codec_type == AVMEDIA_TYPE_VIDEO)
      add_tags(input->streams[i]->metadata, result);
  return result;
}

}  // namespace airtruth::video
