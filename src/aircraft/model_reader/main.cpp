// SPDX-License-Identifier: Apache-2.0
// airtruth-model-reader reads one 3D model for the program that started it and returns plain
// arrays. Its standard input is a socket, through which it requests files by name and receives
// them.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <unistd.h>

#include "aircraft/confined/protocol.h"
#include "aircraft/model_reader/other_formats.h"
#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"
#include "foundation/sandbox/child.h"
#include "foundation/sandbox/confine.h"

namespace {

using namespace airtruth;  // the program's own top level
namespace fs = std::filesystem;

// The largest message from the parent: the limit of all files of a model together.
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 30;

// The parent's files, requested by name.
class AskedFiles : public wrapper::ModelFiles {
 public:
  AskedFiles(sandbox::Channel& parent, const confined::ReaderJob& job)
      : ModelFiles(job.shown_folder, job.in_data_root), parent_(parent) {}

 protected:
  Kind kind_below(const fs::path& path) override {
    parent_.send(confined::Message::kAskKind, path.string());
    const std::string answer = answered(confined::Message::kKind);
    return answer.size() == 1 ? static_cast<Kind>(answer[0]) : Kind::kNone;
  }
  std::string read_below(const fs::path& path, std::size_t max_bytes) override {
    sandbox::WireWriter question;
    question.put(static_cast<std::uint64_t>(max_bytes));
    question.put_text(path.string());
    parent_.send(confined::Message::kAskFile, question.take());
    return answered(confined::Message::kFile);
  }

 private:
  std::string answered(confined::Message wanted) {
    sandbox::Channel::Received received = parent_.receive(kMaxMessageBytes);
    if (received.closed) ::_exit(0);
    if (received.is(confined::Message::kError)) throw sandbox::error_from_bytes(received.bytes);
    if (!received.is(wanted)) throw Error("gets an answer that it did not ask for");
    return std::move(received.bytes);
  }

  sandbox::Channel& parent_;
};

void read_for(sandbox::Channel& parent) {
  sandbox::confine({});
  const sandbox::Channel::Received received = parent.receive(kMaxMessageBytes);
  if (received.closed || !received.is(confined::Message::kJob)) return;
  const confined::ReaderJob job = confined::job_from_bytes(received.bytes);
  AskedFiles files(parent, job);
  parent.send(confined::Message::kModel,
              confined::bytes_of(wrapper::read_model(
                  files, job.file, job.options, model_reader::append_other_format)));
}

}  // namespace

int main(int argc, char** argv) {
  constexpr sandbox::Faults kFaults{static_cast<std::uint8_t>(confined::Message::kError),
                                    "needs more memory than a model may take",
                                    "cannot be read as a 3D model: "};
  return sandbox::child_main(argc, argv, 0, [&](sandbox::Channel& parent, std::span<char*>) {
    sandbox::told(parent, kFaults, [&] { read_for(parent); });
  });
}
