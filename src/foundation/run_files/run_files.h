// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <vector>

#include "foundation/base/files.h"

// What a command reads and writes, as one set. It is checked before anything is written, and the
// files appear together when all of them are whole.
//
//   RunFiles files;
//   files.reads(video).reads(mask);
//   files.writes(table, overwrite).writes(plot, overwrite);
//   files.begin();                                          // throws Error: nothing is written yet
//   files.write(table, [&](const fs::path& at) { write_file(at, text); });
//   files.commit();
//
// Every file is written in a hidden folder of this run beside its place, so that several runs that
// write one file at the same time do not meet before commit(), which moves a whole set at a time.
namespace airtruth {

// Throws Error where two of a list of inputs are one: by name, through links, and by another name
// of one file.
void refuse_twice(const std::vector<fs::path>& inputs);

class RunFiles {
 public:
  RunFiles();
  RunFiles(const RunFiles&) = delete;
  RunFiles& operator=(const RunFiles&) = delete;
  // Without commit() nothing stays.
  ~RunFiles();

  // A file, a folder with all files below it, or a pattern of numbered files ("frames/%06d.png").
  // An empty path is none.
  RunFiles& reads(const fs::path& input);
  // A file to write. Throws Error as check_output_file() does. An empty path is none.
  RunFiles& writes(const fs::path& output,
                   bool overwrite,
                   std::initializer_list<const char*> endings = {});
  // A folder into which files are written: those of the same names are replaced, others stay. It is
  // made where it is missing. Throws Error as check_output_folder() does, and as refuse_foreign().
  RunFiles& writes_into(const fs::path& folder, std::initializer_list<const char*> records = {});
  // A folder that is replaced as a whole, by the caller.
  RunFiles& replaces(const fs::path& folder);

  // Throws Error where an output is an input, lies in the place of one, replaces a file of a folder
  // that is read, or is another output: by name, through links, and by another name of one file.
  void check() const;
  // Checks, removes what runs that were killed left beside the outputs, and makes the hidden
  // folders.
  void begin();
  // Calls write(path) with the hidden path of an output; an empty one is passed over. An Error at
  // that path names the output.
  void write(const fs::path& output, const std::function<void(const fs::path&)>& write) const;
  // Moves everything into place. Throws Error where a file is an input of this run.
  void commit();

 private:
  class Hidden;
  struct Output {
    fs::path given;
    bool is_folder = false;
  };

  Hidden& hidden_for(const Output& output) const;

  std::vector<fs::path> inputs_;
  std::vector<Output> outputs_;
  std::vector<fs::path> replaced_;
  std::map<fs::path, std::unique_ptr<Hidden>> hidden_;  // by the folder in which it lies
};

}  // namespace airtruth
