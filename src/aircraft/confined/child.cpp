// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/child.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "aircraft/confined/protocol.h"
#include "foundation/base/error.h"
#include "foundation/sandbox/sandbox.h"

namespace airtruth::confined {
namespace {

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

void answer_kind(sandbox::Process& reader, wrapper::DiskFiles& files, const std::string& path) {
  const char kind = static_cast<char>(files.kind(path));
  reader.send(Message::kKind, std::string_view(&kind, 1));
}

void answer_file(sandbox::Process& reader,
                 wrapper::DiskFiles& files,
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

model::RawModel serve(sandbox::Process& reader, wrapper::DiskFiles& files) {
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

}  // namespace

fs::path model_reader_program() { return sandbox::path_of(kReader); }

model::RawModel read_in_child(wrapper::DiskFiles& files,
                              const fs::path& file,
                              const model::LoadOptions& options) {
  try {
    sandbox::Process reader(kReader, options.stop);
    reader.set_deadline(
        kReaderSeconds,
        fmt::format("is not read within {} s; a model that is whole takes a fraction "
                    "of that",
                    kReaderSeconds));
    const ReaderJob job{
        file.string(), files.shown_folder().string(), files.in_data_root().string(), options};
    reader.send(Message::kJob, bytes_of(job));
    return serve(reader, files);
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw Error(error.message(), {files.shown(file).string()});
  }
}

}  // namespace airtruth::confined
