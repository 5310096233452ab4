// SPDX-License-Identifier: Apache-2.0
#include "aircraft/osg_image.h"

#include <osgDB/ReadFile>

#include "aircraft/ac_text.h"
#include "aircraft/texture.h"
#include "base/error.h"

namespace airtruth::aircraft {

namespace fs = std::filesystem;

ImageFinder::ImageFinder(fs::path model,
                         std::vector<fs::path> folders,
                         std::map<std::string, int> line_of_texture,
                         std::vector<fs::path>& sources)
    : model_(std::move(model)),
      folders_(std::move(folders)),
      line_of_texture_(std::move(line_of_texture)),
      sources_(sources) {}

osgDB::ReaderWriter::ReadResult ImageFinder::readImage(const std::string& name,
                                                       const osgDB::Options*) {
  return read(name).get();
}

osg::ref_ptr<osg::Image> ImageFinder::failed(const std::string& name, const std::string& why) {
  osg::ref_ptr<osg::Image> stand_in = new osg::Image;
  stand_in->allocateImage(1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE);
  const auto line = line_of_texture_.find(name);
  failures_.push_back({stand_in,
                       "wants the texture " + name + ", which " + why,
                       line == line_of_texture_.end() ? 0 : line->second});
  return stand_in;
}

osg::ref_ptr<osg::Image> ImageFinder::read(const std::string& name) {
  const auto known = images_.find(name);
  if (known != images_.end()) return known->second;
  osg::ref_ptr<osg::Image> image;
  const fs::path found = find_texture(name, folders_);
  if (found.empty()) {
    image = failed(name, "is in none of: " + listed(folders_));
  } else {
    const osg::ref_ptr<osgDB::Options> plain = new osgDB::Options;
    image = osgDB::Registry::instance()
                ->readImageImplementation(found.string(), plain.get())
                .takeImage();
    if (image) {
      image->setFileName(found.string());
      sources_.push_back(found);
    } else {
      image = failed(name, "cannot be read as a picture: " + found.string());
    }
  }
  images_[name] = image;
  return image;
}

void ImageFinder::check_found(const osg::Image& image) const {
  for (const Failure& failure : failures_)
    if (failure.stand_in == &image) throw Error(failure.message, {model_.string(), failure.line});
}

std::string EveryFile::findDataFile(const std::string& name,
                                    const osgDB::Options*,
                                    osgDB::CaseSensitivity) {
  return name;
}

int texture_index(Assembly& assembly,
                  const osg::Image& image,
                  bool repeat_u,
                  bool repeat_v,
                  const fs::path& model) {
  const std::string key = image.getFileName() + (repeat_u ? "|u" : "|") + (repeat_v ? "v" : "");
  const auto known = assembly.texture_of_file.find(key);
  if (known != assembly.texture_of_file.end()) return known->second;
  if (image.isCompressed() || image.s() <= 0 || image.t() <= 0 || image.r() != 1)
    throw Error("wants the texture " + image.getFileName() +
                    ", which is compressed for graphics cards or has no "
                    "texels; expected a plain "
                    "picture",
                {model.string()});
  const auto width = static_cast<std::size_t>(image.s());
  const auto height = static_cast<std::size_t>(image.t());
  std::vector<std::array<float, 4>> texels(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const osg::Vec4 c = image.getColor(static_cast<unsigned>(x), static_cast<unsigned>(y));
      texels[y * width + x] = {c.r(), c.g(), c.b(), c.a()};
    }
  }
  assembly.mesh.textures.push_back(
      texture_from_srgb(image.s(), image.t(), std::move(texels), repeat_u, repeat_v));
  const int index = static_cast<int>(assembly.mesh.textures.size()) - 1;
  if (!image.getFileName().empty()) assembly.texture_of_file[key] = index;
  return index;
}

}  // namespace airtruth::aircraft
