// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/model_cache.h"

#include "aircraft/confined/child.h"
#include "aircraft/confined/protocol.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"

namespace airtruth::confined {
namespace {

using wrapper::DiskFiles;

// Bounds on what is kept of a model.
constexpr std::size_t kMaxQuestionsKept = 10'000;  // files; a model asks for some tens
constexpr std::size_t kMaxKeptText = 65536;        // bytes of a path
// Number of hexadecimal digits of a SHA-256.
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
      (void)files.read(question.path, model::kMaxModelBytes);
    } else {
      (void)files.kind(question.path);
    }
    if (files.asked().back() != question) return false;
  }
  return true;
}

disk_cache::Cache models() { return disk_cache::Cache(disk_cache::user_folder("models")); }

}  // namespace

std::optional<disk_cache::Key> model_key(DiskFiles& files,
                                         const fs::path& file,
                                         const model::LoadOptions& options) {
  try {
    const ReaderJob job{
        file.string(), files.shown_folder().string(), files.in_data_root().string(), options};
    // The reader is another program than this one, whose build is in every key.
    const FileStamp reader = file_stamp(model_reader_program());
    disk_cache::Key key("model");
    key.add(sha256_of(files.read(file, model::kMaxModelBytes))).add(bytes_of(job));
    return key.add(reader.inode).add(reader.bytes).add(reader.changed_ns);
  } catch (const Error&) {  // the reader reports the fault
    return std::nullopt;
  }
}

std::optional<model::RawModel> cached_model(const disk_cache::Key& key, DiskFiles& files) {
  return models().find(key, [&](const std::string& body) {
    WireReader in(body);
    if (!still_answered(files, asked_from(in))) throw Error("a file has changed");
    return model_from_bytes(in.rest());
  });
}

void keep_model(const disk_cache::Key& key, const DiskFiles& files, const model::RawModel& model) {
  if (files.asked().size() <= kMaxQuestionsKept)
    models().keep(key, bytes_of_asked(files.asked()) + bytes_of(model));
}

}  // namespace airtruth::confined
