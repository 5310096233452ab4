// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/model_cache.h"

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/confined/channel.h"
#include "aircraft/confined/model_wire.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::aircraft {
namespace {

constexpr int kReaderVersion = 3;  // increase it when the arrays of a reader change
constexpr std::size_t kMaxKeptBytes = std::size_t{512} << 20;
constexpr std::size_t kMaxQuestionsKept = 10'000;
constexpr std::size_t kMaxKeptText = 65536;
constexpr std::size_t kShaDigits = 64;

std::string bytes_of_asked(const std::vector<DiskFiles::Asked>& asked) {
  WireWriter out;
  out.put(static_cast<std::uint64_t>(asked.size()));
  for (const DiskFiles::Asked& question : asked) {
    out.put_text(question.path);
    out.put_text(question.answer);
  }
  return out.take();
}

std::vector<DiskFiles::Asked> asked_from(WireReader& in) {
  std::vector<DiskFiles::Asked> asked(in.get_count(kMaxQuestionsKept, 1));
  for (DiskFiles::Asked& question : asked) {
    question.path = in.get_text(kMaxKeptText);
    question.answer = in.get_text(kMaxKeptText);
  }
  return asked;
}

// Repeats all requests in the same order and compares the answers with the recorded ones.
bool still_answered(DiskFiles& files, const std::vector<DiskFiles::Asked>& asked) {
  for (const DiskFiles::Asked& question : asked) {
    const bool by_content = question.answer.size() == kShaDigits;
    if (by_content) {
      (void)files.read(question.path, kMaxModelBytes);
    } else {
      (void)files.kind(question.path);
    }
    if (files.asked().back() != question) return false;
  }
  return true;
}

}  // namespace

ModelCache model_cache(DiskFiles& files, const fs::path& file, const LoadOptions& options) {
  try {
    const std::string model = sha256_of(files.read(file, kMaxModelBytes));
    const ReaderJob job{
        file.string(), files.shown_folder().string(), files.in_data_root().string(), options};
    return {cache_folder() / "models",
            sha256_of(std::to_string(kReaderVersion) + ' ' + model + ' ' + bytes_of(job))};
  } catch (const Error&) {  // the reader reports the fault
    return {};
  }
}

std::optional<RawModel> cached_model(const ModelCache& cache, DiskFiles& files) {
  std::error_code ignored;
  const fs::path entry = cache.folder / cache.name;
  if (cache.name.empty() || !fs::is_regular_file(entry, ignored)) return std::nullopt;
  try {
    const std::string bytes = read_file(entry, kMaxKeptBytes);
    const std::string_view all = bytes;
    if (all.size() < kShaDigits || sha256_of(all.substr(kShaDigits)) != all.substr(0, kShaDigits))
      return std::nullopt;
    WireReader in(all.substr(kShaDigits));
    const std::vector<DiskFiles::Asked> asked = asked_from(in);
    if (!still_answered(files, asked)) return std::nullopt;
    return model_from_bytes(in.rest());
  } catch (const Error&) {  // an incomplete or foreign entry, or a missing file: the model is read
    return std::nullopt;
  }
}

void keep_model(const ModelCache& cache, const DiskFiles& files, const RawModel& model) {
  if (cache.name.empty() || files.asked().size() > kMaxQuestionsKept) return;
  const std::string body = bytes_of_asked(files.asked()) + bytes_of(model);
  if (body.size() + kShaDigits > kMaxKeptBytes) return;
  try {
    fs::create_directories(cache.folder);
    write_file(cache.folder / cache.name, sha256_of(body) + body, Flush::kLater);
  } catch (const std::exception&) {  // without a writable disk the model is read again next time
  }
}

}  // namespace airtruth::aircraft
