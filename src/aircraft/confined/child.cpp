// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/child.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "aircraft/confined/protocol.h"
#include "aircraft/wrapper/model_files.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/disk_cache/disk_cache.h"
#include "foundation/sandbox/sandbox.h"

namespace airtruth::confined {
namespace {

using wrapper::DiskFiles;

constexpr sandbox::Program kReader{
    "airtruth-model-reader", "AIRTRUTH_MODEL_READER", "the reader of 3D models"};
// Bounds on what a hostile file makes its reader ask for: bytes of a question, their number, and
// bytes of the answers.
constexpr std::size_t kMaxQuestionBytes = 65536;
constexpr std::size_t kMaxQuestions = 200'000;
constexpr std::size_t kMaxSentBytes = std::size_t{1} << 30;  // of all files together
// A model at the limits of raw_model.h, and 64 MiB for the rest.
constexpr std::size_t kMaxHandedBackBytes = 32 * model::kMaxCorners + 16 * model::kMaxTriangles +
                                            4 * model::kMaxPixels + (std::size_t{64} << 20);

void answer_kind(sandbox::Process& reader, DiskFiles& files, const std::string& path) {
  const char kind = static_cast<char>(files.kind(path));
  reader.send(Message::kKind, std::string_view(&kind, 1));
}

void answer_file(sandbox::Process& reader,
                 DiskFiles& files,
                 std::string_view question,
                 std::size_t& sent) {
  WireReader in(question);
  const auto limit = static_cast<std::size_t>(in.get<std::uint64_t>());
  const std::string path = in.get_text(kMaxQuestionBytes);
  try {
    if (sent >= kMaxSentBytes) throw Error("asks for more than 1 GiB of files");
    const std::string bytes = files.read(path, std::min(limit, kMaxSentBytes - sent));
    sent += bytes.size();
    reader.send(Message::kFile, bytes);
  } catch (const Error& error) {
    reader.send(Message::kError, bytes_of(error));
  }
}

model::RawModel serve(sandbox::Process& reader, DiskFiles& files) {
  std::size_t sent = 0;
  for (std::size_t questions = 0; questions < kMaxQuestions; ++questions) {
    const Channel::Received received = reader.receive(kMaxHandedBackBytes);
    if (received.closed)
      throw Error("cannot be read as a 3D model: " + sandbox::end_in_words(reader.end()));
    switch (received.as<Message>()) {
      case Message::kAskKind:
        answer_kind(reader, files, received.bytes.substr(0, kMaxQuestionBytes));
        break;
      case Message::kAskFile:
        answer_file(reader, files, received.bytes, sent);
        break;
      case Message::kModel:
        return model_from_bytes(received.bytes);
      case Message::kError:
        throw error_from_bytes(received.bytes);
      default:
        throw Error("makes its reader say what it should not");
    }
  }
  throw Error("asks for more than " + std::to_string(kMaxQuestions) + " files");
}

ReaderJob job_of(const ModelPlace& place, const model::LoadOptions& options) {
  return {place.file.string(), place.folder.string(), place.in_data_root.string(), options};
}

model::RawModel read_now(DiskFiles& files,
                         const ModelPlace& place,
                         const model::LoadOptions& options) {
  try {
    sandbox::Process reader(kReader, options.stop);
    reader.set_deadline(
        kReaderSeconds,
        fmt::format("is not read within {} s; a model that is whole takes a fraction "
                    "of that",
                    kReaderSeconds));
    reader.send(Message::kJob, bytes_of(job_of(place, options)));
    return serve(reader, files);
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw Error(error.message(), {files.shown(place.file).string()});
  }
}

// Bounds on what is kept of a model.
constexpr std::size_t kMaxQuestionsKept = 10'000;  // files; a model asks for some tens
constexpr std::size_t kMaxKeptText = 65536;        // bytes of a path
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
    if (question.answer.size() == kShaDigits)
      (void)files.read(question.path, model::kMaxModelBytes);
    else
      (void)files.kind(question.path);
    if (files.asked().back() != question) return false;
  }
  return true;
}

// The key of a model; empty where it cannot be read. Asks `files` for the model file's bytes.
std::optional<disk_cache::Key> model_key(DiskFiles& files,
                                         const ModelPlace& place,
                                         const model::LoadOptions& options) {
  try {
    // The reader is another program than this one, whose build is in every key.
    const FileStamp reader = file_stamp(model_reader_program());
    disk_cache::Key key("model");
    key.add(sha256_of(files.read(place.file, model::kMaxModelBytes)));
    key.add(bytes_of(job_of(place, options)));
    return key.add(reader.inode).add(reader.bytes).add(reader.changed_ns);
  } catch (const Error&) {  // the reader reports the fault
    return std::nullopt;
  }
}

}  // namespace

fs::path model_reader_program() { return sandbox::path_of(kReader); }

model::RawModel read_in_child(const ModelPlace& place,
                              const model::LoadOptions& options,
                              std::vector<fs::path>& sources) {
  const disk_cache::Cache cache(disk_cache::user_folder("models"));
  DiskFiles before(place.folder, place.in_data_root, true, place.letter_case);
  const auto key = model_key(before, place, options);
  std::optional<model::RawModel> kept;
  if (key)
    kept = cache.find(*key, [&](const std::string& body) {
      WireReader in(body);
      if (!still_answered(before, asked_from(in))) throw Error("a file has changed");
      return model_from_bytes(in.rest());
    });
  if (kept) {
    sources = before.sources();
    return *std::move(kept);
  }
  DiskFiles files(place.folder, place.in_data_root, true, place.letter_case);
  model::RawModel model = read_now(files, place, options);
  if (key && files.asked().size() <= kMaxQuestionsKept)
    cache.keep(*key, bytes_of_asked(files.asked()) + bytes_of(model));
  sources = files.sources();
  return model;
}

}  // namespace airtruth::confined
