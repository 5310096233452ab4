// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "aircraft/model/load_options.h"
#include "aircraft/model/raw_model.h"
#include "aircraft/wrapper/assembly.h"
#include "aircraft/wrapper/model_files.h"

// Reads a model from its files to plain arrays. This process reads Debian's own aircraft with it; a
// child process (confined/child.h) reads all others with the same code.
//
// Example: for the folder AI/Aircraft/738, read_model(files, "738-Ryanair.xml", options) reads the
// wrapper, the .ac file that it names and its textures. Its result has a mesh in body axes (x
// forward, y right, z down; metres) and one sRGB picture per texture.
namespace airtruth::wrapper {

// The reader of other formats than .ac (.obj, .3ds and others), which only airtruth-model-reader
// has. Where it is empty, such files are an Error.
using AppendOther = std::function<void(Assembly& assembly, const ModelFile& file)>;

// `file` is a path below the folder of `files`: a wrapper .xml, an .ac, or another model file.
// Throws Error as load_aircraft does. The result passes check_model.
model::RawModel read_model(ModelFiles& files,
                           const fs::path& file,
                           const model::LoadOptions& options,
                           const AppendOther& append_other = {});

// The ending of a file's name in lower case, with its dot.
std::string ending_of(const fs::path& file);

// Whether a name has the ending of a model file, in upper or lower case. This includes endings that
// are recognised and refused (.osgt, .osgb, .ive and others).
bool is_model_file(const std::string& name);

}  // namespace airtruth::wrapper
