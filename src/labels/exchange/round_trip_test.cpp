// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "foundation/geometry/box.h"
#include "labels/exchange/exchange.h"
#include "labels/exchange/text.h"
#include "support/exchange_formats.h"

namespace airtruth::exchange {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool often(double share) { return number(0, 1) < share; }

  // Boxes of whole and of fractional pixels, also at the picture's edges.
  Box box(int width, int height) {
    if (often(0.2)) return {0, 0, double(whole(1, width)), double(whole(1, height))};
    if (often(0.2)) return {double(width - 1), double(height - 1), 1, 1};
    if (often(0.5)) {
      const int x = whole(0, width - 2), y = whole(0, height - 2);
      return {double(x), double(y), double(whole(1, width - x)), double(whole(1, height - y))};
    }
    return {number(-3, width - 4), number(-3, height - 4), number(3.5, 40), number(3.5, 40)};
  }

  Clip clip(const std::string& name) {
    Clip clip;
    clip.name = name;
    clip.width = whole(64, 2000);
    clip.height = whole(48, 1500);
    clip.frame_rate_hz = often(0.5) ? 30 : 30000.0 / 1001;
    const int frames = whole(1, 25);
    const int tracks = whole(0, 3);
    std::vector<std::string> categories;
    for (int t = 0; t < tracks; ++t) categories.push_back(often(0.5) ? "738" : "c172 \"<&> é");
    for (int f = 0; f < frames; ++f) {
      LabelledFrame frame{f, f / *clip.frame_rate_hz, {}};
      const bool empty = often(0.2) || (f == 0 && often(0.5));
      for (int t = 0; t < tracks && !empty; ++t) {
        if (often(0.3)) continue;
        Label label;
        label.track = t + 1;
        label.category = categories[static_cast<std::size_t>(t)];
        label.box_px = box(clip.width, clip.height);
        label.visible = often(0.5) ? 1 : number(0, 1);
        label.occluded = often(0.3);
        label.truncated = often(0.3);
        label.range_m = number(10, 3000);
        label.contrast_to_noise = number(0, 60);
        label.above_horizon = often(0.5);
        label.area_px = number(0.3, 0.9) * label.box_px.area();
        frame.labels.push_back(label);
      }
      clip.frames.push_back(frame);
    }
    return clip;
  }

 private:
  std::mt19937 random_;
};

// The clip without the information that the format cannot store, as LOSS.md states.
Clip held(Format format, Clip clip) {
  const bool named_frames_only = format == Format::kYolo || format == Format::kVoc;
  if (named_frames_only || format == Format::kOtb || format == Format::kCvat)
    clip.frame_rate_hz.reset();
  std::int64_t number = 0;
  for (LabelledFrame& frame : clip.frames) {
    frame.frame = number++;
    if (format == Format::kWebdataset) continue;  // keeps all
    if (format != Format::kCoco && format != Format::kAot) frame.time_s.reset();
    std::int64_t place = 0;
    for (Label& label : frame.labels) {
      ++place;
      if (named_frames_only) label.track = place;
      if (named_frames_only) label.box_px = *clipped(label.box_px, clip.width, clip.height);
      // VOC stores whole pixels.
      if (format == Format::kVoc) label.box_px = as_box(pixels_of(label.box_px));
      if (format != Format::kCoco) label.area_px.reset();
      if (is_single_object(format)) label.track = 1;
      if (format == Format::kOtb) label.category = "aircraft";
      if (format != Format::kCoco && format != Format::kMot && format != Format::kCvat &&
          format != Format::kGot10k)
        label.visible.reset();
      // The format stores eighths, each of which is read as its middle.
      if (format == Format::kGot10k && *label.visible > 0 && *label.visible < 1)
        label.visible = 0.15 * std::min(7.0, std::ceil(*label.visible / 0.15)) - 0.075;
      if (format != Format::kCoco && format != Format::kVoc && format != Format::kCvat &&
          format != Format::kVot)
        label.occluded.reset();
      if (format != Format::kCoco && format != Format::kVoc && format != Format::kCvat &&
          format != Format::kGot10k)
        label.truncated.reset();
      if (format != Format::kCoco && format != Format::kMot && format != Format::kCvat &&
          format != Format::kAot && format != Format::kVot)
        label.range_m.reset();
      if (format == Format::kYolo || format == Format::kMot || format == Format::kOtb ||
          format == Format::kGot10k)
        label.contrast_to_noise.reset();
      if (format != Format::kCoco && format != Format::kCvat && format != Format::kAot)
        label.above_horizon.reset();
    }
  }
  return clip;
}

void expect_near(const std::optional<double>& a, const std::optional<double>& b, double tolerance) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (a) {
    EXPECT_NEAR(*a, *b, tolerance);
  }
}

void expect_same(const Clip& read, const Clip& expected) {
  EXPECT_EQ(read.name, expected.name);
  EXPECT_EQ(read.width, expected.width);
  EXPECT_EQ(read.height, expected.height);
  expect_near(read.frame_rate_hz, expected.frame_rate_hz, 1e-12);
  ASSERT_EQ(read.frames.size(), expected.frames.size());
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    SCOPED_TRACE("frame " + std::to_string(i));
    EXPECT_EQ(read.frames[i].frame, expected.frames[i].frame);
    expect_near(read.frames[i].time_s, expected.frames[i].time_s, 1e-9);
    ASSERT_EQ(read.frames[i].labels.size(), expected.frames[i].labels.size());
    for (std::size_t k = 0; k < read.frames[i].labels.size(); ++k) {
      const Label& a = read.frames[i].labels[k];
      const Label& b = expected.frames[i].labels[k];
      EXPECT_EQ(a.track, b.track);
      EXPECT_EQ(a.category, b.category);
      EXPECT_NEAR(a.box_px.x, b.box_px.x, 1e-9);
      EXPECT_NEAR(a.box_px.y, b.box_px.y, 1e-9);
      EXPECT_NEAR(a.box_px.width, b.box_px.width, 1e-9);
      EXPECT_NEAR(a.box_px.height, b.box_px.height, 1e-9);
      expect_near(a.visible, b.visible, 1e-12);
      EXPECT_EQ(a.occluded, b.occluded);
      EXPECT_EQ(a.truncated, b.truncated);
      expect_near(a.range_m, b.range_m, 1e-12);
      expect_near(a.contrast_to_noise, b.contrast_to_noise, 1e-12);
      expect_near(a.area_px, b.area_px, 1e-9);
      EXPECT_EQ(a.above_horizon, b.above_horizon);
    }
  }
}

TEST(RoundTrip, EveryFormatKeepsAllThatItCanHold) {
  for (const Format format : kWritten) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(std::string(name(format)) + ", seed " + std::to_string(seed));
      const Folder folder;
      Draw draw(seed);
      std::vector<Clip> clips = {draw.clip("a"), draw.clip("b-2 c"), draw.clip("c_7")};
      // The user must state the size for YOLO, OTB, GOT-10k and VOT.
      for (Clip& clip : clips) std::tie(clip.width, clip.height) = std::pair(2000, 1500);
      WriteOptions options;
      options.categories = {"738", "c172 \"<&> é"};
      options.parts = {"train", "val"};
      options.with_images = format != Format::kWebdataset;  // it packs the pictures
      auto writer = make_writer(format, folder.path(), options);
      std::vector<Clip> expected;
      for (std::size_t i = 0; i < clips.size(); ++i)
        for (const Clip& clip : arranged(format, clips[i])) {
          writer->add(clip, i == 1 ? "val" : "train");
          expected.push_back(held(format, clip));
        }
      writer->finish();
      std::vector<Clip> read;
      if (!expected.empty())
        read = read_clips(format, folder.path(), {{{2000, 1500}}, "aircraft"}, {});
      ASSERT_EQ(read.size(), expected.size());
      const auto by_name = [](const Clip& a, const Clip& b) { return a.name < b.name; };
      std::sort(read.begin(), read.end(), by_name);
      std::sort(expected.begin(), expected.end(), by_name);
      for (std::size_t i = 0; i < read.size(); ++i) expect_same(read[i], expected[i]);
      if (HasFailure()) return;
    }
  }
}

// write_clips() names the classes and the parts itself and writes no pictures.
TEST(RoundTrip, OfASetThatIsWrittenAtOnce) {
  Clip clip;
  clip.name = "s";
  clip.width = 64;
  clip.height = 48;
  Label label;
  label.category = "738";
  label.box_px = {3, 4, 8, 5};
  clip.frames = {{0, std::nullopt, {label}}, {1, std::nullopt, {label}}};
  const Folder folder;
  const Part parts[] = {{"train", {clip}}, {"val", {clip}}};
  write_clips(Format::kCoco, folder.path() / "coco", parts);
  const auto read = read_clips(Format::kCoco, folder.path() / "coco", {}, {});
  ASSERT_EQ(read.size(), 2u);
  for (const Clip& one : read) {
    ASSERT_EQ(one.frames.size(), 2u);
    EXPECT_EQ(one.frames[1].labels.at(0).box_px, label.box_px);
    EXPECT_EQ(one.frames[1].labels.at(0).category, "738");
  }
  EXPECT_THROW(write_clips(Format::kCoco, folder.path() / "coco", parts), Error);
  EXPECT_THROW(write_clips(Format::kCsv, folder.path() / "csv", parts), Error);
}

TEST(RoundTrip, NoNameLeadsOutOfTheNewFolder) {
  const Folder folder;
  Clip clip;
  const auto expect_refused = [&](const std::string& part) {
    const Part written{part, {clip}};
    EXPECT_THROW(write_clips(Format::kOtb, folder.path() / "new", {&written, 1}), Error) << part;
    EXPECT_FALSE(fs::exists(folder.path() / "new"));
  };
  clip.name = "s";
  for (const char* part : {"../other", "night/val", "..", ".", ""}) expect_refused(part);
  for (const char* name : {"../../other", "/other", "a/../../../other"}) {
    clip.name = name;
    expect_refused("train");
  }
}

// COCO's categories may hold line ends.
TEST(RoundTrip, ACategoryIsOneLine) {
  Clip clip;
  clip.name = "s";
  clip.width = 64;
  clip.height = 48;
  const Label label{.category = "b\n7,37", .box_px = {3, 4, 8, 5}};
  clip.frames = {{0, std::nullopt, {label}}, {1, std::nullopt, {label}}};
  const Folder folder;
  const Part part{"train", {clip}};
  for (const Format format : {Format::kMot, Format::kGot10k, Format::kVot}) {
    const fs::path set = folder.path() / name(format);
    write_clips(format, set, {&part, 1});
    EXPECT_EQ(read_clips(format, set, {}, {}).at(0).frames.at(0).labels.at(0).category, "b 7,37");
  }
}

// An import contains only boxes and tracks. Columns that a format requires are written all the same
// and are read back as unknown.
TEST(RoundTrip, WhatIsUnknownComesBackAsUnknown) {
  Clip clip;
  clip.name = "s";
  clip.width = 64;
  clip.height = 48;
  Label label;
  label.category = "738";
  label.box_px = {3, 4, 8, 5};
  clip.frames = {{0, std::nullopt, {label}}, {1, std::nullopt, {}}, {2, std::nullopt, {label}}};
  for (const Format format : kWritten) {
    SCOPED_TRACE(name(format));
    const Folder folder;
    auto writer = make_writer(
        format, folder.path(), {{"738"}, {"train"}, ".jpg", format != Format::kWebdataset});
    for (const Clip& one : arranged(format, clip)) writer->add(one, "train");
    writer->finish();
    const auto read = read_clips(format, folder.path(), {{{64, 48}}, "738"}, {});
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].frame_rate_hz, std::nullopt);
    ASSERT_EQ(read[0].frames.size(), 3u);
    Clip expected = clip;
    // CVAT states for every box whether it is occluded.
    if (format == Format::kCvat)
      for (LabelledFrame& frame : expected.frames)
        for (Label& each : frame.labels) each.occluded = false;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(read[0].frames[i].time_s, std::nullopt);
      ASSERT_EQ(read[0].frames[i].labels.size(), expected.frames[i].labels.size());
      if (i == 1) continue;
      Label got = read[0].frames[i].labels[0];
      EXPECT_NEAR(got.box_px.x, 3, 1e-9);  // YOLO's shares
      got.box_px = label.box_px;
      EXPECT_EQ(got, expected.frames[i].labels[0]);
    }
  }
}

// Ids of tracks in CVAT are whole numbers from 0 on, in COCO any.
TEST(RoundTrip, CvatTakesTracksOfAnyNumber) {
  const Label first{.track = 2, .category = "738", .box_px = {3, 4, 8, 5}};
  Label second = first;
  second.box_px.x = 40;
  Clip clip;
  clip.name = "s";
  const auto tracks_after = [&](std::int64_t other) {
    second.track = other;
    clip.frames = {{0, std::nullopt, {first, second}}};
    const Folder folder;
    const Part part{"train", {clip}};
    write_clips(Format::kCvat, folder.path() / "cvat", {&part, 1});
    const std::vector<Clip> read = read_clips(Format::kCvat, folder.path() / "cvat", {}, {});
    std::map<double, std::int64_t> tracks;
    for (const Label& label : read.at(0).frames.at(0).labels) tracks[label.box_px.x] = label.track;
    return std::pair(tracks[3], tracks[40]);
  };
  EXPECT_EQ(tracks_after(7), std::pair(std::int64_t{2}, std::int64_t{7}));
  EXPECT_EQ(tracks_after(0), std::pair(std::int64_t{2}, std::int64_t{1}));
  EXPECT_EQ(tracks_after(std::int64_t{1} << 40), std::pair(std::int64_t{1}, std::int64_t{2}));
}

// An aircraft that is too faint in the second frame, and a bird.
Clip clip_with_a_faint_frame() {
  Clip clip;
  clip.name = "s";
  clip.width = 64;
  clip.height = 48;
  const Label aircraft{.track = 1, .category = "738", .box_px = {3, 4, 8, 5}};
  Label faint = aircraft;
  faint.object_class = "ignore";
  Label bird{.track = 2, .category = "bird", .box_px = {20, 4, 8, 5}};
  bird.object_class = "bird";
  clip.frames = {{0, std::nullopt, {aircraft, bird}}, {1, std::nullopt, {faint, bird}}};
  return clip;
}

TEST(RoundTrip, WhatCountsNeitherWayComesBackOrIsLeftOut) {
  const Part part{"train", {clip_with_a_faint_frame()}};
  for (const Format format : kWritten) {
    if (is_single_object(format)) continue;
    SCOPED_TRACE(name(format));
    const Folder folder;
    write_clips(format, folder.path() / "set", {&part, 1});
    const auto read = read_clips(format, folder.path() / "set", {{{64, 48}}, "aircraft"}, {});
    ASSERT_EQ(read.size(), 1u);
    std::vector<std::string> classes;
    for (const LabelledFrame& frame : read[0].frames)
      for (const Label& label : frame.labels) classes.push_back(label.object_class);
    EXPECT_EQ(classes,
              has_ignore_mark(format)
                  ? (std::vector<std::string>{"aircraft", "bird", "ignore", "bird"})
                  : (std::vector<std::string>{"aircraft", "bird", "bird"}));
    EXPECT_EQ(loss(format).find("count neither way, which are left out") == std::string::npos,
              has_ignore_mark(format));
  }
}

// "738" and "gull" state no class.
TEST(RoundTrip, AClassThatNoNameStatesComesBackWhereTheFormatStatesIt) {
  Part part{"train", {clip_with_a_faint_frame()}};
  for (LabelledFrame& frame : part.clips[0].frames) frame.labels[1].category = "gull";
  for (const Format format : {Format::kCoco, Format::kAot, Format::kWebdataset}) {
    SCOPED_TRACE(name(format));
    const Folder folder;
    write_clips(format, folder.path() / "set", {&part, 1});
    std::vector<std::string> warnings;
    const auto read = read_clips(format, folder.path() / "set", {}, [&](const std::string& text) {
      warnings.push_back(text);
    });
    EXPECT_EQ(warnings, std::vector<std::string>());
    for (const LabelledFrame& frame : read.at(0).frames) {
      EXPECT_EQ(frame.labels.back().category, "gull");
      EXPECT_EQ(frame.labels.back().object_class, "bird");
    }
    EXPECT_EQ(read.at(0).frames.at(0).labels.at(0).object_class, "aircraft");
  }
}

TEST(RoundTrip, LabelsOfOurOwnKeepEverything) {
  const Folder folder;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Clip clip = Draw(seed).clip("x");
    clip.media = folder.path() / "some/video.mp4";
    clip.category_ids = {{0, "plane"}, {7, "bird"}};
    for (LabelledFrame& frame : clip.frames) {
      frame.picture = fmt::format("part/{}.jpg", frame.frame);
      frame.image_id = 100 - frame.frame;
    }
    for (LabelledFrame& frame : clip.frames)
      for (Label& label : frame.labels)
        label.object_class = label.track % 3 == 0   ? "bird"
                             : label.track % 3 == 1 ? "ignore"
                                                    : "aircraft";
    const Clip again = read_labels(folder.file("labels.jsonl", labels_jsonl(clip)));
    EXPECT_EQ(again.media, clip.media);
    EXPECT_EQ(again.category_ids, clip.category_ids);
    expect_same(again, clip);
    EXPECT_EQ(again.frames, clip.frames);
    // What is relative begins at the file's own folder.
    clip.media = "pictures.txt";
    EXPECT_EQ(read_labels(folder.file("labels.jsonl", labels_jsonl(clip))).media,
              folder.path() / "pictures.txt");
  }
}

}  // namespace
}  // namespace airtruth::exchange
