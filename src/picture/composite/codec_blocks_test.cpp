// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/codec_blocks.h"

#include <gtest/gtest.h>

#include "picture/composite/matte.h"

namespace airtruth::composite {
namespace {

constexpr int kCodedWidth = 96, kCodedHeight = 80;

image::Picture grainy_sky(image::Chroma chroma) {
  image::Picture picture = image::make_picture(kCodedWidth, kCodedHeight, {chroma});
  for (std::size_t p = 0; p < static_cast<std::size_t>(picture.plane_count); ++p)
    for (int y = 0; y < picture.planes[p].height; ++y)
      for (int x = 0; x < picture.planes[p].width; ++x)
        picture.planes[p].row(y)[x] =
            static_cast<std::uint8_t>((p == 0 ? 150 : 120) + (7 * x + 3 * y) % 5);
  return picture;
}

// A layer that is opaque and black within `solid`. Its patch extends `margin_px` further.
image::Layer black_box(const PixelBox& solid, int margin_px) {
  image::Layer layer;
  layer.patch = {solid.x - margin_px,
                 solid.y - margin_px,
                 solid.width + 2 * margin_px,
                 solid.height + 2 * margin_px};
  layer.pixels.resize(static_cast<std::size_t>(layer.patch.width * layer.patch.height));
  layer.coverage.assign(1, image::Coverage(layer.patch));
  for (int y = solid.y; y < solid.bottom(); ++y)
    for (int x = solid.x; x < solid.right(); ++x) {
      layer.pixels[layer.index(x, y)].alpha = 1;
      layer.coverage[0].alpha[layer.index(x, y)] = 1;
    }
  return layer;
}

TEST(CodedWindows, AreWholeMacroblocksWithinTheFrame) {
  const image::Picture sky = grainy_sky(image::Chroma::k420);
  const auto windows = coded_windows(sky, black_box({50, 30, 9, 5}, 4), 0);
  ASSERT_EQ(windows.size(), 1u);
  // A margin of 8 px turns 50..58 and 30..34 into 42..66 and 22..42.
  EXPECT_EQ(windows[0].box, (PixelBox{32, 16, 48, 32}));
  EXPECT_TRUE(image::identical(windows[0].background, image::crop(sky, {32, 16, 48, 32})));
  const auto corner = coded_windows(sky, black_box({90, 74, 4, 4}, 2), 0);
  ASSERT_EQ(corner.size(), 1u);
  EXPECT_EQ(corner[0].box, (PixelBox{80, 64, 16, 16}));
}

TEST(CodedWindows, OfIntrudersFarApartAreTwoAndOfNearOnesOne) {
  image::Layer layer = black_box({20, 20, 60, 40}, 8);
  layer.coverage.assign(2, image::Coverage(layer.patch));
  layer.coverage[0].alpha[layer.index(20, 20)] = 1;
  layer.coverage[1].alpha[layer.index(79, 59)] = 1;
  const image::Picture sky = grainy_sky(image::Chroma::k444);
  EXPECT_EQ(coded_windows(sky, layer, 0).size(), 2u);
  layer.coverage[1].alpha[layer.index(40, 40)] = 1;
  layer.coverage[0].alpha[layer.index(30, 30)] = 1;
  EXPECT_EQ(coded_windows(sky, layer, 8).size(), 1u);
}

TEST(InMarkedBlocks, MarksTheRestOfTheFramesOwnBlocksAndNoOther) {
  // Blocks begin at 8 and 16.
  const PixelBox patch{5, 3, 20, 14};
  std::vector<std::uint8_t> marked(20 * 14, 0);
  // The block of x 16..23, y 8..15.
  marked[static_cast<std::size_t>(9 - 3) * 20 + (17 - 5)] = 1;
  const auto result = in_marked_blocks(patch, marked);
  for (int y = patch.y; y < patch.bottom(); ++y)
    for (int x = patch.x; x < patch.right(); ++x)
      EXPECT_EQ(result[static_cast<std::size_t>((y - 3) * 20 + x - 5)] != 0,
                (PixelBox{16, 8, 8, 8}).contains(x, y))
          << x << ',' << y;
}

// Reduces every picture to one level, as the coarsest codec does: the background's grain is lost.
class Levelling : public PatchCoder {
 public:
  Coded code(const PixelBox&,
             const image::Picture& with_layer,
             const image::Picture& background) override {
    return {levelled(with_layer, 40), levelled(background, 152)};
  }

 private:
  static image::Picture levelled(const image::Picture& picture, std::uint8_t level) {
    image::Picture result = picture.clone();
    for (std::size_t p = 0; p < static_cast<std::size_t>(result.plane_count); ++p)
      for (int y = 0; y < result.planes[p].height; ++y)
        std::fill_n(result.planes[p].row(y), result.planes[p].width, level);
    return result;
  }
};

// The formula of codec_blocks, computed by hand: the codec's own samples where the layer hides
// everything, and elsewhere the codec's change of level added to the background's grain.
TEST(Codec, ReplacesWhatIsHiddenAndShiftsWhatIsNotAndLeavesTheOtherBlocksAlone) {
  for (const auto chroma : {image::Chroma::kNone, image::Chroma::k420, image::Chroma::k444}) {
    const image::Picture before = grainy_sky(chroma);
    image::Picture after = before.clone();
    // Within the block of x 40..47, y 32..39.
    const PixelBox solid{42, 34, 4, 3};
    Levelling codec;
    MatteOptions options;
    options.coder = &codec;
    const Visible seen = composite_matte(after, black_box(solid, 8), options).at(0);
    const PixelBox block{40, 32, 8, 8};
    for (int y = 0; y < kCodedHeight; ++y)
      for (int x = 0; x < kCodedWidth; ++x) {
        const int was = before.luma().row(y)[x];
        const int expected = solid.contains(x, y)   ? 40
                             : block.contains(x, y) ? 40 + was - 152
                                                    : was;
        ASSERT_EQ(after.luma().row(y)[x], expected) << x << ',' << y;
      }
    EXPECT_EQ(seen.box, block);
    EXPECT_EQ(seen.pixels, 64);
    EXPECT_EQ(seen.covered, (Covered{solid, 12}));
    if (chroma == image::Chroma::kNone) continue;
    const int log2 = image::log2_chroma_width(chroma);
    // The layer hides the sample's whole block.
    EXPECT_EQ(after.planes[1].row(34 >> log2)[44 >> log2], 40);
    EXPECT_EQ(after.planes[2].row(40 >> log2)[44 >> log2],
              before.planes[2].row(40 >> log2)[44 >> log2]);
  }
}

TEST(Codec, NeverReachesTheOwnAircraft) {
  const image::Picture before = grainy_sky(image::Chroma::k444);
  image::Picture after = before.clone();
  image::Mask mask{
      kCodedWidth, kCodedHeight, std::vector<unsigned char>(kCodedWidth * kCodedHeight, 255)};
  for (int y = 0; y < kCodedHeight; ++y)
    for (int x = 0; x < 43; ++x) mask.free[static_cast<std::size_t>(y * kCodedWidth + x)] = 0;
  Levelling codec;
  MatteOptions options;
  options.coder = &codec;
  image::Layer layer = black_box({42, 34, 4, 3}, 8);
  hide(layer, {{own_aircraft(mask)}, {500}});
  composite_matte(after, layer, options);
  for (const std::size_t p : {0u, 1u, 2u})
    for (int y = 0; y < kCodedHeight; ++y)
      for (int x = 0; x < 43; ++x)
        ASSERT_EQ(after.planes[p].row(y)[x], before.planes[p].row(y)[x]) << x << ',' << y;
}

}  // namespace
}  // namespace airtruth::composite
