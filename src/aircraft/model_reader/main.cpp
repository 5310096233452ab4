// SPDX-License-Identifier: Apache-2.0
// airtruth-model-reader reads one 3D model for the program that started it and returns plain
// arrays. Its standard input is a socket, through which it requests files by name and receives
// them.
#include <cstdint>
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
using namespace airtruth::aircraft;

// The largest message from the parent: the limit of all files of a model together.
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 30;

// The parent's files, requested by name.
class AskedFiles : public ModelFiles {
 public:
  AskedFiles(Channel& parent, const ReaderJob& job)
      : ModelFiles(job.shown_folder, job.in_data_root), parent_(parent) {}

 protected:
  Kind kind_below(const fs::path& path) override {
    parent_.send(Message::kAskKind, path.string());
    const std::string answer = answered(Message::kKind);
    return answer.size() == 1 ? static_cast<Kind>(answer[0]) : Kind::kNone;
  }
  std::string read_below(const fs::path& path, std::size_t max_bytes) override {
    WireWriter question;
    question.put(static_cast<std::uint64_t>(max_bytes));
    question.put_text(path.string());
    parent_.send(Message::kAskFile, question.take());
    return answered(Message::kFile);
  }

 private:
  std::string answered(Message wanted) {
    Channel::Received received = parent_.receive(kMaxMessageBytes);
    if (received.closed) ::_exit(0);
    if (received.is(Message::kError)) throw error_from_bytes(received.bytes);
    if (!received.is(wanted)) throw Error("gets an answer that it did not ask for");
    return std::move(received.bytes);
  }

  Channel& parent_;
};

void read_for(Channel& parent) {
  sandbox::confine({});
  const Channel::Received received = parent.receive(kMaxMessageBytes);
  if (received.closed || !received.is(Message::kJob)) return;
  const ReaderJob job = job_from_bytes(received.bytes);
  AskedFiles files(parent, job);
  parent.send(
      Message::kModel,
      bytes_of(read_model(files, job.file, job.options, model_reader::append_other_format)));
}

}  // namespace

int main(int argc, char** argv) {
  constexpr sandbox::Faults kFaults{static_cast<std::uint8_t>(Message::kError),
                                    "needs more memory than a model may take",
                                    "cannot be read as a 3D model: "};
  return sandbox::child_main(argc, argv, 0, [&](Channel& parent, std::span<char*>) {
    sandbox::told(parent, kFaults, [&] { read_for(parent); });
  });
}
