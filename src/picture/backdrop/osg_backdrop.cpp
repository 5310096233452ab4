// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/osg_backdrop.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include <osg/GLExtensions>
#include <osgViewer/GraphicsWindow>
#include <osgViewer/Viewer>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "picture/backdrop/egl_context.h"
#include "picture/backdrop/frame_buffer.h"
#include "picture/backdrop/osg_adapter.h"
#include "picture/backdrop/osg_mesh.h"
#include "picture/backdrop/shading.h"

namespace airtruth::backdrop {
namespace {

// Distance of the near plane, in metres; nearer parts are cut off.
constexpr double kNearestM = 0.05;
// Side of the tile that render_alpha draws at once, in pixels: it bounds the memory of the target.
constexpr int kTilePx = 1024;

struct PinholeView {
  Pixel focal_px;
  Pixel principal_point_px;
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
      view.principal_point_px + view.focal_px.cwiseProduct(centre.head<2>() / centre.z());
  const double slant = centre.norm() / centre.z();
  const Pixel reach =
      view.focal_px * (slant * radius_m / (centre.z() - radius_m)) + Pixel::Constant(2);
  return Box{middle.x() - reach.x(), middle.y() - reach.y(), 2 * reach.x(), 2 * reach.y()};
}

bool overlap(const Box& a, const Box& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

// The mean over each pixel's block of samples. The first row of `samples` is the bottom row.
std::array<float, 4> block_mean(
    const std::vector<std::array<float, 4>>& samples, int stride, int x, int y, int size) {
  std::array<double, 4> sum{};
  const int rows = static_cast<int>(samples.size()) / stride;
  for (int j = y * size; j < (y + 1) * size; ++j) {
    for (int i = x * size; i < (x + 1) * size; ++i) {
      const auto& sample =
          samples[static_cast<std::size_t>(rows - 1 - j) * static_cast<std::size_t>(stride) +
                  static_cast<std::size_t>(i)];
      for (std::size_t c = 0; c < 4; ++c) sum[c] += static_cast<double>(sample[c]);
    }
  }
  std::array<float, 4> mean{};
  for (std::size_t c = 0; c < 4; ++c) mean[c] = static_cast<float>(sum[c] / (size * size));
  return mean;
}

// The scene graph with its context.
struct Graph {
  Graph(int frame_width, int frame_height, const Options& given)
      : width(frame_width), height(frame_height), options(given), egl(given.gpu, given.software) {
    // Suppresses all messages.
    osg::setNotifyLevel(osg::ALWAYS);
    const EglContext::Current current(egl);
    device = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    viewer = new osgViewer::Viewer;
    viewer->setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    window = viewer->setUpViewerAsEmbeddedInWindow(0, 0, width, height);
    viewer->setLightingMode(osg::View::NO_LIGHT);
    viewer->getCamera()->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    viewer->getCamera()->setCullingMode(
        // Culling would drop small aircraft.
        osg::CullSettings::NO_CULLING);
    viewer->getCamera()->setClearMask(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    root->setStateSet(shading.state());
    viewer->setSceneData(root);
    viewer->realize();
    gl = osg::GLExtensions::Get(window->getState()->getContextID(), true);
  }

  ~Graph() {
    const EglContext::Current current(egl);
    green.reset();
    tile.reset();
    aircraft.clear();
    viewer = nullptr;
    window = nullptr;
  }

  // Puts the instances into the scene graph. Returns the boxes of the frame that they can touch.
  std::vector<Box> stage(const PinholeView& view,
                         const HemisphereLight& light,
                         const std::vector<Instance>& instances);
  void draw(FrameBuffer& target,
            const PinholeView& view,
            const Box& in_frame,
            const osg::Vec4& clear_colour);
  OsgMesh& instance_of(const model::Mesh& mesh, std::size_t nth);

  struct OnDevice {
    std::vector<osg::ref_ptr<osg::Texture2D>> textures;
    std::vector<std::unique_ptr<OsgMesh>> instances;
  };

  int width;
  int height;
  Options options;
  EglContext egl;
  std::string device;
  osg::ref_ptr<osg::Group> root = new osg::Group;
  Shading shading;
  osg::ref_ptr<osgViewer::Viewer> viewer;
  osg::ref_ptr<osgViewer::GraphicsWindowEmbedded> window;
  osg::GLExtensions* gl = nullptr;
  std::map<const model::Mesh*, OnDevice> aircraft;
  double near_m = 1;
  double far_m = 2;
  // The target of render().
  std::unique_ptr<FrameBuffer> green;
  // The target of render_alpha().
  std::unique_ptr<FrameBuffer> tile;
};

OsgMesh& Graph::instance_of(const model::Mesh& mesh, std::size_t nth) {
  const auto [place, is_new] = aircraft.try_emplace(&mesh);
  OnDevice& on_device = place->second;
  if (is_new) on_device.textures = osg_textures(mesh, options.anisotropy);
  while (on_device.instances.size() <= nth)
    on_device.instances.push_back(std::make_unique<OsgMesh>(mesh, on_device.textures));
  return *on_device.instances[nth];
}

std::vector<Box> Graph::stage(const PinholeView& view,
                              const HemisphereLight& light,
                              const std::vector<Instance>& instances) {
  root->removeChildren(0, root->getNumChildren());
  shading.set_light(light, view.cam_from_world);
  std::vector<Box> boxes;
  std::map<const model::Mesh*, std::size_t> used;
  near_m = 1e9;
  far_m = 0;
  const Box frame{0, 0, static_cast<double>(width), static_cast<double>(height)};
  for (const Instance& instance : instances) {
    check(instance.mesh != nullptr, "an instance has a mesh");
    OsgMesh& mesh = instance_of(*instance.mesh, used[instance.mesh]++);
    const Vector3& centre_in_world = instance.world_from_body.translation;
    const auto box = box_of_sphere(view, centre_in_world, mesh.radius_m(), frame);
    if (!box || !overlap(*box, frame)) continue;
    boxes.push_back(*box);
    mesh.place(instance, view.cam_from_world);
    root->addChild(mesh.node());
    const double distance_m = (view.cam_from_world * centre_in_world).z();
    near_m = std::min(near_m, distance_m - mesh.radius_m() - 0.01);
    far_m = std::max(far_m, distance_m + mesh.radius_m() + 0.01);
  }
  near_m = std::max(near_m, kNearestM);
  far_m = std::max(far_m, near_m + 1);
  return boxes;
}

void Graph::draw(FrameBuffer& target,
                 const PinholeView& view,
                 const Box& in_frame,
                 const osg::Vec4& clear_colour) {
  osg::Camera& camera = *viewer->getCamera();
  camera.setClearColor(clear_colour);
  camera.setViewport(0, 0, target.width(), target.height());
  camera.setViewMatrix(eye_from_world(view.cam_from_world));
  camera.setProjectionMatrix(
      projection(view.focal_px, view.principal_point_px, {in_frame, near_m, far_m}));
  window->setDefaultFboId(target.id());
  gl->glBindFramebuffer(GL_FRAMEBUFFER_EXT, target.id());
  viewer->frame(0);
}

class OsgBackdrop final : public Backdrop {
 public:
  OsgBackdrop(int width, int height, const Options& options) : graph_(width, height, options) {}

  image::Rgb8 render(const Pixel& focal_px,
                     const Pixel& principal_point_px,
                     const Rigid& cam_from_world,
                     const HemisphereLight& light,
                     const std::vector<Instance>& instances) override;
  std::vector<std::array<float, 4>> render_alpha(const Pixel& focal_px,
                                                 const Pixel& principal_point_px,
                                                 const Rigid& cam_from_world,
                                                 const HemisphereLight& light,
                                                 const std::vector<Instance>& instances,
                                                 int supersampling) override;
  std::string device_name() const override { return graph_.device; }

 private:
  Graph graph_;
};

image::Rgb8 OsgBackdrop::render(const Pixel& focal_px,
                                const Pixel& principal_point_px,
                                const Rigid& cam_from_world,
                                const HemisphereLight& light,
                                const std::vector<Instance>& instances) {
  const PinholeView view{focal_px, principal_point_px, cam_from_world};
  const EglContext::Current current(graph_.egl);
  graph_.shading.set_encoding(Encoding::kSrgb);
  graph_.stage(view, light, instances);
  if (!graph_.green)
    graph_.green = std::make_unique<FrameBuffer>(
        *graph_.gl, graph_.width, graph_.height, GL_RGBA8, graph_.options.samples);
  const Box frame{0, 0, static_cast<double>(graph_.width), static_cast<double>(graph_.height)};
  graph_.draw(*graph_.green, view, frame, {0, 1, 0, 1});
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(graph_.width);
  std::vector<std::uint8_t> upside_down(row_bytes * static_cast<std::size_t>(graph_.height));
  graph_.green->read(GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
  image::Rgb8 result = image::make_rgb8(graph_.width, graph_.height);
  for (int y = 0; y < graph_.height; ++y)
    std::memcpy(result.at(0, y),
                upside_down.data() + row_bytes * static_cast<std::size_t>(graph_.height - 1 - y),
                row_bytes);
  return result;
}

std::vector<std::array<float, 4>> OsgBackdrop::render_alpha(const Pixel& focal_px,
                                                            const Pixel& principal_point_px,
                                                            const Rigid& cam_from_world,
                                                            const HemisphereLight& light,
                                                            const std::vector<Instance>& instances,
                                                            int supersampling) {
  check(supersampling >= 1 && supersampling <= kTilePx, "supersampling is 1 to 1024");
  const PinholeView view{focal_px, principal_point_px, cam_from_world};
  const EglContext::Current current(graph_.egl);
  graph_.shading.set_encoding(Encoding::kLinear);
  const std::vector<Box> boxes = graph_.stage(view, light, instances);
  // Side of a tile, in pixels of the frame.
  const int tile_px = kTilePx / supersampling;
  const int size = tile_px * supersampling;
  if (!graph_.tile || graph_.tile->width() != size)
    graph_.tile = std::make_unique<FrameBuffer>(*graph_.gl, size, size, GL_RGBA32F_ARB, 1);
  std::vector<std::array<float, 4>> result(static_cast<std::size_t>(graph_.width) *
                                           static_cast<std::size_t>(graph_.height));
  std::vector<std::array<float, 4>> samples(static_cast<std::size_t>(size) *
                                            static_cast<std::size_t>(size));
  for (int y0 = 0; y0 < graph_.height; y0 += tile_px) {
    for (int x0 = 0; x0 < graph_.width; x0 += tile_px) {
      const Box in_frame{static_cast<double>(x0),
                         static_cast<double>(y0),
                         static_cast<double>(tile_px),
                         static_cast<double>(tile_px)};
      if (std::none_of(
              boxes.begin(), boxes.end(), [&](const Box& box) { return overlap(box, in_frame); }))
        continue;
      graph_.draw(*graph_.tile, view, in_frame, {0, 0, 0, 0});
      graph_.tile->read(GL_RGBA, GL_FLOAT, samples.data());
      for (int y = y0; y < std::min(y0 + tile_px, graph_.height); ++y) {
        for (int x = x0; x < std::min(x0 + tile_px, graph_.width); ++x)
          result[static_cast<std::size_t>(y) * static_cast<std::size_t>(graph_.width) +
                 static_cast<std::size_t>(x)] =
              block_mean(samples, size, x - x0, y - y0, supersampling);
      }
    }
  }
  return result;
}

}  // namespace

std::unique_ptr<Backdrop> make_osg_backdrop(int width, int height, const Options& options) {
  check(width > 0 && height > 0, "the virtual image has a size");
  return std::make_unique<OsgBackdrop>(width, height, options);
}

}  // namespace airtruth::backdrop
