// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include <osg/FrameBufferObject>
#include <osg/GL>
#include <osg/GLExtensions>
#include <osgViewer/GraphicsWindow>
#include <osgViewer/Viewer>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "picture/backdrop/backdrop.h"
#include "picture/backdrop/egl_context.h"
#include "picture/backdrop/osg_adapter.h"
#include "picture/backdrop/osg_mesh.h"
#include "picture/backdrop/shading.h"

namespace airtruth::backdrop {
namespace {

// Distance of the near plane, in metres; nearer parts are cut off.
constexpr double kNearestM = 0.05;
// Number of multisamples for each pixel of the virtual image.
constexpr int kSamples = 4;
// Side of the tile that render_alpha draws at once, in pixels: it bounds the memory of the target.
constexpr int kTilePx = 1024;

struct PinholeView {
  lens::Pinhole lens;
  Rigid cam_from_world;
};

// Where the camera sees a sphere, with a margin. The whole frame where the sphere is too close for
// a bound.
std::optional<Box> box_of_sphere(const PinholeView& view,
                                 const Vector3& centre_in_world,
                                 double radius_m,
                                 const Box& frame) {
  const Vector3 centre = view.cam_from_world * centre_in_world;
  if (centre.z() + radius_m <= kNearestM) return std::nullopt;
  if (centre.z() < 2 * radius_m) return frame;
  const Pixel middle =
      view.lens.principal_point_px + view.lens.focal_px.cwiseProduct(centre.head<2>() / centre.z());
  const double slant = centre.norm() / centre.z();
  const Pixel reach =
      view.lens.focal_px * (slant * radius_m / (centre.z() - radius_m)) + Pixel::Constant(2);
  return Box{middle.x() - reach.x(), middle.y() - reach.y(), 2 * reach.x(), 2 * reach.y()};
}

// The mean over each pixel's block of samples. The first row of `samples` is the bottom row.
std::array<float, 4> block_mean(
    const std::vector<std::array<float, 4>>& samples, int stride, int x, int y, int size) {
  std::array<double, 4> sum{};
  const int rows = static_cast<int>(samples.size()) / stride;
  for (int j = y * size; j < (y + 1) * size; ++j) {
    for (int i = x * size; i < (x + 1) * size; ++i) {
      const auto& sample = samples[index_in(stride, i, rows - 1 - j)];
      for (std::size_t c = 0; c < 4; ++c) sum[c] += static_cast<double>(sample[c]);
    }
  }
  std::array<float, 4> mean{};
  for (std::size_t c = 0; c < 4; ++c) mean[c] = static_cast<float>(sum[c] / (size * size));
  return mean;
}

// A render target of colour and depth, multisampled where samples > 1. Every call needs the context
// to be current.
//
// It uses plain OpenGL: OpenSceneGraph's own multisampled camera requests NVIDIA's coverage samples
// from Mesa and silently draws without antialiasing.
class FrameBuffer {
 public:
  FrameBuffer(osg::GLExtensions& gl, int width, int height, GLenum colour_format, int samples)
      : gl_(gl), width_(width), height_(height) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE_EXT, &largest);
    if (width > largest || height > largest)
      throw Error("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                  " is more than OpenGL draws here; expected at most " + std::to_string(largest) +
                  " either way");
    drawn_ = make(colour_format, samples, true);
    if (samples > 1) resolved_ = make(colour_format, 0, false);
  }
  ~FrameBuffer() {
    remove(drawn_);
    remove(resolved_);
  }
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  GLuint id() const { return drawn_.frame; }

  // Reads the pixels after resolving the samples, bottom row first, as OpenGL stores them.
  void read(GLenum format, GLenum type, void* pixels) {
    if (resolved_.frame != 0) {
      gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER_EXT, drawn_.frame);
      gl_.glBindFramebuffer(GL_DRAW_FRAMEBUFFER_EXT, resolved_.frame);
      gl_.glBlitFramebuffer(
          0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    gl_.glBindFramebuffer(GL_FRAMEBUFFER_EXT,
                          resolved_.frame != 0 ? resolved_.frame : drawn_.frame);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, format, type, pixels);
  }

 private:
  struct Buffers {
    GLuint frame = 0;
    GLuint colour = 0;
    GLuint depth = 0;
  };

  GLuint make_renderbuffer(GLenum format, int samples) {
    GLuint id = 0;
    gl_.glGenRenderbuffers(1, &id);
    gl_.glBindRenderbuffer(GL_RENDERBUFFER_EXT, id);
    if (samples > 1) {
      gl_.glRenderbufferStorageMultisample(GL_RENDERBUFFER_EXT, samples, format, width_, height_);
    } else {
      gl_.glRenderbufferStorage(GL_RENDERBUFFER_EXT, format, width_, height_);
    }
    return id;
  }

  Buffers make(GLenum colour_format, int samples, bool with_depth) {
    Buffers buffers;
    gl_.glGenFramebuffers(1, &buffers.frame);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER_EXT, buffers.frame);
    buffers.colour = make_renderbuffer(colour_format, samples);
    gl_.glFramebufferRenderbuffer(
        GL_FRAMEBUFFER_EXT, GL_COLOR_ATTACHMENT0_EXT, GL_RENDERBUFFER_EXT, buffers.colour);
    if (with_depth) {
      buffers.depth = make_renderbuffer(GL_DEPTH_COMPONENT32F, samples);
      gl_.glFramebufferRenderbuffer(
          GL_FRAMEBUFFER_EXT, GL_DEPTH_ATTACHMENT_EXT, GL_RENDERBUFFER_EXT, buffers.depth);
    }
    if (gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER_EXT) != GL_FRAMEBUFFER_COMPLETE_EXT)
      throw Error("OpenGL cannot draw into a " + std::to_string(width_) + "x" +
                  std::to_string(height_) + " picture with " + std::to_string(samples) +
                  " samples a pixel here");
    return buffers;
  }

  void remove(const Buffers& buffers) {
    if (buffers.frame != 0) gl_.glDeleteFramebuffers(1, &buffers.frame);
    if (buffers.colour != 0) gl_.glDeleteRenderbuffers(1, &buffers.colour);
    if (buffers.depth != 0) gl_.glDeleteRenderbuffers(1, &buffers.depth);
  }

  osg::GLExtensions& gl_;
  int width_;
  int height_;
  Buffers drawn_;
  // Unused without multisampling.
  Buffers resolved_;
};

// The scene graph with its context.
class OsgBackdrop final : public Backdrop {
 public:
  OsgBackdrop(int width, int height, const Options& options)
      : width_(width), height_(height), egl_(options.gpu, options.software) {
    // Suppresses all messages.
    osg::setNotifyLevel(osg::ALWAYS);
    const EglContext::Current current(egl_);
    device_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    viewer_ = new osgViewer::Viewer;
    viewer_->setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    window_ = viewer_->setUpViewerAsEmbeddedInWindow(0, 0, width, height);
    viewer_->setLightingMode(osg::View::NO_LIGHT);
    viewer_->getCamera()->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    viewer_->getCamera()->setCullingMode(
        // Culling would drop small aircraft.
        osg::CullSettings::NO_CULLING);
    viewer_->getCamera()->setClearMask(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    root_->setStateSet(shading_.state());
    viewer_->setSceneData(root_);
    viewer_->realize();
    gl_ = osg::GLExtensions::Get(window_->getState()->getContextID(), true);
  }

  ~OsgBackdrop() override {
    const EglContext::Current current(egl_);
    green_.reset();
    tile_.reset();
    aircraft_.clear();
    viewer_ = nullptr;
    window_ = nullptr;
  }

  image::Rgb8 render(const lens::Pinhole& lens,
                     const Rigid& cam_from_world,
                     const shade::Light& light,
                     const std::vector<Instance>& instances) override {
    const PinholeView view{lens, cam_from_world};
    const EglContext::Current current(egl_);
    shading_.set_encoding(Encoding::kSrgb);
    stage(view, light, instances);
    if (!green_) green_ = std::make_unique<FrameBuffer>(*gl_, width_, height_, GL_RGBA8, kSamples);
    const Box frame = as_box({0, 0, width_, height_});
    draw(*green_, view, frame, {0, 1, 0, 1});
    const std::size_t row_bytes = 3 * static_cast<std::size_t>(width_);
    std::vector<std::uint8_t> upside_down(row_bytes * static_cast<std::size_t>(height_));
    green_->read(GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
    image::Rgb8 result = image::make_rgb8(width_, height_);
    for (int y = 0; y < height_; ++y)
      std::memcpy(result.at(0, y),
                  upside_down.data() + row_bytes * static_cast<std::size_t>(height_ - 1 - y),
                  row_bytes);
    return result;
  }

  std::vector<std::array<float, 4>> render_alpha(const lens::Pinhole& lens,
                                                 const Rigid& cam_from_world,
                                                 const shade::Light& light,
                                                 const std::vector<Instance>& instances,
                                                 int supersampling) override {
    check(supersampling >= 1 && supersampling <= kTilePx, "supersampling is 1 to 1024");
    const PinholeView view{lens, cam_from_world};
    const EglContext::Current current(egl_);
    shading_.set_encoding(Encoding::kLinear);
    const std::vector<Box> boxes = stage(view, light, instances);
    // Side of a tile, in pixels of the frame.
    const int tile_px = kTilePx / supersampling;
    const int size = tile_px * supersampling;
    if (!tile_ || tile_->width() != size)
      tile_ = std::make_unique<FrameBuffer>(*gl_, size, size, GL_RGBA32F_ARB, 1);
    std::vector<std::array<float, 4>> result(pixels_in(width_, height_));
    std::vector<std::array<float, 4>> samples(pixels_in(size, size));
    for (int y0 = 0; y0 < height_; y0 += tile_px) {
      for (int x0 = 0; x0 < width_; x0 += tile_px) {
        const Box in_frame = as_box({x0, y0, tile_px, tile_px});
        const auto is_in = [&](const Box& box) { return intersection(box, in_frame).has_value(); };
        if (std::ranges::none_of(boxes, is_in)) continue;
        draw(*tile_, view, in_frame, {0, 0, 0, 0});
        tile_->read(GL_RGBA, GL_FLOAT, samples.data());
        for (int y = y0; y < std::min(y0 + tile_px, height_); ++y) {
          for (int x = x0; x < std::min(x0 + tile_px, width_); ++x)
            result[index_in(width_, x, y)] =
                block_mean(samples, size, x - x0, y - y0, supersampling);
        }
      }
    }
    return result;
  }

  std::string device_name() const override { return device_; }

 private:
  struct OnDevice {
    std::vector<osg::ref_ptr<osg::Texture2D>> textures;
    std::vector<std::unique_ptr<OsgMesh>> instances;
  };

  OsgMesh& instance_of(const model::Mesh& mesh, std::size_t nth) {
    const auto [place, is_new] = aircraft_.try_emplace(&mesh);
    OnDevice& on_device = place->second;
    if (is_new) on_device.textures = osg_textures(mesh);
    while (on_device.instances.size() <= nth)
      on_device.instances.push_back(std::make_unique<OsgMesh>(mesh, on_device.textures));
    return *on_device.instances[nth];
  }

  // Puts the instances into the scene graph. Returns the boxes of the frame that they can touch.
  std::vector<Box> stage(const PinholeView& view,
                         const shade::Light& light,
                         const std::vector<Instance>& instances) {
    root_->removeChildren(0, root_->getNumChildren());
    shading_.set_light(light, view.cam_from_world);
    std::vector<Box> boxes;
    std::map<const model::Mesh*, std::size_t> used;
    near_m_ = 1e9;
    far_m_ = 0;
    const Box frame = as_box({0, 0, width_, height_});
    for (const Instance& instance : instances) {
      check(instance.mesh != nullptr, "an instance has a mesh");
      OsgMesh& mesh = instance_of(*instance.mesh, used[instance.mesh]++);
      const Vector3& centre_in_world = instance.world_from_body.translation;
      const auto box = box_of_sphere(view, centre_in_world, mesh.radius_m(), frame);
      if (!box || !intersection(*box, frame)) continue;
      boxes.push_back(*box);
      mesh.place(instance, view.cam_from_world);
      root_->addChild(mesh.node());
      const double distance_m = (view.cam_from_world * centre_in_world).z();
      near_m_ = std::min(near_m_, distance_m - mesh.radius_m() - 0.01);
      far_m_ = std::max(far_m_, distance_m + mesh.radius_m() + 0.01);
    }
    near_m_ = std::max(near_m_, kNearestM);
    far_m_ = std::max(far_m_, near_m_ + 1);
    return boxes;
  }

  void draw(FrameBuffer& target,
            const PinholeView& view,
            const Box& in_frame,
            const osg::Vec4& clear_colour) {
    osg::Camera& camera = *viewer_->getCamera();
    camera.setClearColor(clear_colour);
    camera.setViewport(0, 0, target.width(), target.height());
    camera.setViewMatrix(eye_from_world(view.cam_from_world));
    camera.setProjectionMatrix(projection(view.lens, {in_frame, near_m_, far_m_}));
    window_->setDefaultFboId(target.id());
    gl_->glBindFramebuffer(GL_FRAMEBUFFER_EXT, target.id());
    viewer_->frame(0);
  }

  int width_;
  int height_;
  EglContext egl_;
  std::string device_;
  osg::ref_ptr<osg::Group> root_ = new osg::Group;
  Shading shading_;
  osg::ref_ptr<osgViewer::Viewer> viewer_;
  osg::ref_ptr<osgViewer::GraphicsWindowEmbedded> window_;
  osg::GLExtensions* gl_ = nullptr;
  std::map<const model::Mesh*, OnDevice> aircraft_;
  double near_m_ = 1;
  double far_m_ = 2;
  // The target of render().
  std::unique_ptr<FrameBuffer> green_;
  // The target of render_alpha().
  std::unique_ptr<FrameBuffer> tile_;
};

}  // namespace

std::unique_ptr<Backdrop> make_osg_backdrop(int width, int height, const Options& options) {
  check(width > 0 && height > 0, "the virtual image has a size");
  return std::make_unique<OsgBackdrop>(width, height, options);
}

}  // namespace airtruth::backdrop
