// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <osg/Image>
#include <osg/Texture2D>
#include <osgDB/Registry>

#include "aircraft/osg_adapter.h"

// For osg_adapter.cpp alone: images that OpenSceneGraph's loaders ask for, and
// textures from them.
namespace airtruth::aircraft {

// Given to a loader: finds its images by name in the texture folders. A loader
// would go on without a texture that is missing; here it gets a stand-in, and
// whoever uses that gets an Error.
class ImageFinder : public osgDB::ReadFileCallback {
 public:
  ImageFinder(std::filesystem::path model,
              std::vector<std::filesystem::path> folders,
              std::map<std::string, int> line_of_texture,
              std::vector<std::filesystem::path>& sources);

  osgDB::ReaderWriter::ReadResult readImage(const std::string& name,
                                            const osgDB::Options* options) override;
  osg::ref_ptr<osg::Image> read(const std::string& name);
  // Throws an Error naming the texture and the model that wants it, where
  // `image` is a stand-in.
  void check_found(const osg::Image& image) const;

 private:
  struct Failure {
    osg::ref_ptr<osg::Image> stand_in;
    std::string message;
    int line;
  };
  osg::ref_ptr<osg::Image> failed(const std::string& name, const std::string& why);

  std::filesystem::path model_;
  std::vector<std::filesystem::path> folders_;
  std::map<std::string, int> line_of_texture_;
  std::vector<std::filesystem::path>& sources_;
  std::map<std::string, osg::ref_ptr<osg::Image>> images_;
  std::vector<Failure> failures_;
};

// Tells a loader that every file is there, so that it asks for it.
class EveryFile : public osgDB::FindFileCallback {
 public:
  std::string findDataFile(const std::string& name,
                           const osgDB::Options* options,
                           osgDB::CaseSensitivity sensitivity) override;
};

// Index into the assembly's textures; the same image file with the same
// wrapping is taken once.
int texture_index(Assembly& assembly,
                  const osg::Image& image,
                  bool repeat_u,
                  bool repeat_v,
                  const std::filesystem::path& model);

}  // namespace airtruth::aircraft
