// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/assembly.h"
#include "aircraft/wrapper/model_files.h"

// Reads a model from its files to plain arrays. Debian's own aircraft are read so in this process,
// all others in a child (child.h) that runs the same code.
namespace airtruth::aircraft {

// Reads formats other than .ac (.obj .3ds ...): airtruth-model-reader has one. Empty: they are
// refused.
using AppendOther = std::function<void(Assembly& assembly,
                                       const fs::path& file,
                                       const std::vector<fs::path>& folders,
                                       const ChoosePart& choose)>;

// `file` lies below the folder of `files`: a wrapper .xml, an .ac, or another model file. Throws
// Error as load_aircraft does. The result holds check_model.
RawModel read_model(ModelFiles& files,
                    const fs::path& file,
                    const LoadOptions& options,
                    const AppendOther& append_other = {});

// The ending of a file's name in lower case, with its dot.
std::string ending_of(const fs::path& file);

// Has the name the ending of a model file, in upper or lower case: one that is read, or one that is
// known and refused (.osgt .osgb .ive ...)?
bool is_model_file(const std::string& name);

}  // namespace airtruth::aircraft
