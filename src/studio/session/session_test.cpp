// SPDX-License-Identifier: Apache-2.0
#include "studio/session/session.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "foundation/base/files.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/frame_by_frame.h"
#include "sequence/pipeline/render.h"
#include "studio/session/answers.h"
#include "support/flight_file.h"
#include "support/temporary_folder.h"

namespace airtruth::session {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
const std::string kScene =
    "# mine\n[background]\nvideo = \"flight.mp4\"\n[lens]\nvertical_fov_deg = 60\n[camera]\n"
    "position_ned_m = [0, 0, -300]\nvelocity_ned_mps = [25, 0, 0]\n"
    "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n[output]\nvideo = \"mkv\"\n"
    "[[intruder]]\nid = \"a\"\naircraft = \"c172/news\"  # a Cessna\n"
    "[[intruder.seen]]\ntime_s = 0.1\npixel = [80, 100]\nrange_m = 150\n"
    "[[intruder.seen]]\ntime_s = 0.7\npixel = [220, 130]\nrange_m = 120\n";

struct Picture {
  Json header;
  std::string jpeg;
};

// A session as its server has it, with pages that wait for their answers.
class OfASession : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test_support::TemporaryFolder();
    test_support::write_flight(*folder_ / "flight.mp4", 320, 240, 24);
  }
  static void TearDownTestSuite() { delete folder_; }

  void SetUp() override { begin(kScene); }

  void begin(const std::string& text) {
    session_.reset();
    fs::remove(file().parent_path() / ".s.toml.studio-journal");
    write_file(file(), text);
    Options options;
    options.pipeline.cache = *folder_ / "cache";
    options.out = *folder_ / "out";
    session_ = std::make_unique<Session>(
        std::make_unique<document::Document>(file(), std::nullopt, Warn()), options, ways());
  }

  static fs::path file() { return *folder_ / "s.toml"; }

  Ways ways() {
    return {[this](std::function<void()> run) {
              const std::lock_guard lock(mutex_);
              posted_.push_back(std::move(run));
              changed_.notify_all();
            },
            [this](Client, const std::string& json) { take(Json::parse(json)); },
            [this](Client, const std::string& bytes) { take_picture(bytes); },
            [this](const std::string& json) { events_.push_back(Json::parse(json)); }};
  }
  void take(const Json& message) { answers_[message["id"]].push_back(message); }
  void take_picture(const std::string& bytes) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i)
      size |= std::size_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    Picture picture{Json::parse(bytes.substr(4, size)), bytes.substr(4 + size)};
    pictures_[picture.header["id"]].push_back(std::move(picture));
  }

  // Runs what was posted until `is_done`; false where it hangs.
  bool wait_for(const std::function<bool()>& is_done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(20);
    while (!is_done()) {
      std::unique_lock lock(mutex_);
      if (!changed_.wait_until(lock, end, [this] { return !posted_.empty(); })) return false;
      const auto run = std::move(posted_.front());
      posted_.pop_front();
      lock.unlock();
      run();
    }
    return true;
  }

  std::int64_t send(const std::string& what, Json more = Json::object()) {
    more["id"] = ++last_id_;
    more["do"] = what;
    session_->take(1, more.dump());
    return last_id_;
  }
  Json ask(const std::string& what, const Json& more = Json::object()) {
    const std::int64_t id = send(what, more);
    EXPECT_TRUE(wait_for([&] { return answers_.count(id) > 0; })) << what;
    return answers_[id].empty() ? Json() : answers_[id].front();
  }
  Picture frame(const Json& more) {
    const std::int64_t id = send("frame", more);
    EXPECT_TRUE(wait_for([&] { return pictures_.count(id) + answers_.count(id) > 0; }));
    return pictures_[id].empty() ? Picture() : pictures_[id].front();
  }
  void wait_for_motion() {
    ask("plan");
    EXPECT_TRUE(wait_for([&] { return ask("undo").contains("error") && has_motion(); }));
  }
  bool has_motion() const {
    for (const Json& event : events_)
      if (event["event"] == "measured") return true;
    return false;
  }
  static Json pixel(double x, double y) {
    return Json::parse(R"([{"set":["intruder",0,"seen",0,"pixel"],"to":[)" + std::to_string(x) +
                       "," + std::to_string(y) + "]}]");
  }

  static inline test_support::TemporaryFolder* folder_ = nullptr;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> posted_;
  std::map<std::int64_t, std::vector<Json>> answers_;
  std::map<std::int64_t, std::vector<Picture>> pictures_;
  std::vector<Json> events_;
  std::int64_t last_id_ = 0;
  std::unique_ptr<Session> session_;  // ends before what its ways use
};

TEST_F(OfASession, OpenTellsOfClipAndScene) {
  const Json opened = ask("open")["ok"];
  EXPECT_EQ(opened["clip"]["width"], 320);
  EXPECT_EQ(opened["clip"]["frames"], 24);
  EXPECT_EQ(opened["state"]["text"], kScene);
  EXPECT_EQ(opened["state"]["scene"]["intruder"][0]["id"], "a");
  EXPECT_TRUE(opened["state"]["saved"].get<bool>());
}

TEST_F(OfASession, AnEditMovesTheAircraftInThePicture) {
  const Picture before = frame({{"frame", 3}});
  EXPECT_TRUE(before.header["problem"].is_null());
  const Json state = ask("edit", {{"changes", pixel(120, 90)}, {"merge", "drag"}})["ok"]["state"];
  EXPECT_THAT(state["text"].get<std::string>(), HasSubstr("pixel = [120, 90]\n"));
  EXPECT_THAT(state["text"].get<std::string>(), HasSubstr("\"c172/news\"  # a Cessna"));
  EXPECT_EQ(state["undo"], 1);
  const Picture after = frame({{"frame", 3}});
  EXPECT_EQ(after.header["revision"], state["revision"]);
  const auto x = [](const Picture& picture) {
    const Json& box = picture.header["boxes"][0]["box"];
    return box[0].get<double>() + box[2].get<double>() / 2;
  };
  EXPECT_NEAR(x(after) - x(before), 40, 5);
  EXPECT_NE(before.jpeg, after.jpeg);
}

TEST_F(OfASession, AnEditOfAnotherTextIsNotDoneAndHasThePresentOne) {
  const Json text = ask("open")["ok"]["state"]["sha256"];
  EXPECT_TRUE(ask("edit", {{"changes", pixel(120, 90)}, {"upon", text}})["ok"]["done"].get<bool>());
  const Json answer = ask("edit", {{"changes", pixel(90, 90)}, {"upon", text}})["ok"];
  EXPECT_FALSE(answer["done"].get<bool>());
  EXPECT_THAT(answer["state"]["text"].get<std::string>(), HasSubstr("pixel = [120, 90]\n"));
}

TEST_F(OfASession, OfAChangeThePartThatChangedIsSent) {
  EXPECT_EQ(frame({{"frame", 3}, {"crop", "change"}}).header["crop"], Json({0, 0, 320, 240}));
  ask("edit", {{"changes", pixel(120, 90)}});
  const Json crop = frame({{"frame", 3}, {"crop", "change"}}).header["crop"];
  EXPECT_EQ(crop[0].get<int>() % 2, 0);
  EXPECT_EQ(crop[1].get<int>() % 2, 0);
  EXPECT_LT(crop[2].get<int>(), 200);
  EXPECT_LT(crop[3].get<int>(), 120);
  EXPECT_LE(crop[0].get<int>(), 60);
  EXPECT_GE(crop[0].get<int>() + crop[2].get<int>(), 140);
  EXPECT_EQ(frame({{"frame", 4}, {"crop", "change"}}).header["crop"], Json({0, 0, 320, 240}));
}

TEST_F(OfASession, TheLineOverAFrameGoesThroughThePlaceInThatFrame) {
  wait_for_motion();
  const Json points = ask("plan")["ok"]["tracks"][0]["points"];
  ASSERT_EQ(points.size(), 24u);
  for (const int k : {0, 7, 23})
    for (const bool aircraft : {true, false}) {
      const Json line = frame({{"frame", k}, {"aircraft", aircraft}}).header["lines"][0];
      EXPECT_EQ(line["table"], Json({"intruder", 0}));
      ASSERT_EQ(line["points"].size(), 24u);
      const auto at = static_cast<std::size_t>(k);
      EXPECT_EQ(line["points"][at][0], k);
      EXPECT_NEAR(line["points"][at][1].get<double>(), points[at][1].get<double>(), 0.1);
      EXPECT_NEAR(line["points"][at][2].get<double>(), points[at][2].get<double>(), 0.1);
    }
}

TEST_F(OfASession, TheNewestFrameReplacesThoseThatWait) {
  frame({{"frame", 0}});
  std::vector<std::int64_t> ids;
  for (int k = 0; k < 20; ++k) ids.push_back(send("frame", {{"frame", k}}));
  EXPECT_TRUE(wait_for([&] { return pictures_.count(ids.back()) > 0; }));
  int dropped = 0;
  for (const std::int64_t id : ids) {
    EXPECT_EQ(answers_[id].size() + (pictures_[id].empty() ? 0 : 1), 1u) << id;
    dropped += answers_[id].empty() ? 0 : 1;
  }
  EXPECT_GE(dropped, 15);
}

// Requests that come while the one before is drawn, as those of a hand that drags do.
TEST_F(OfASession, EachFrameThatIsAskedForIsAnswered) {
  for (int round = 0; round < 10; ++round) {
    frame({{"frame", 0}});
    std::vector<std::int64_t> ids;
    for (int k = 6; k < 24; k += 6) {
      ids.push_back(send("frame", {{"frame", k}}));
      std::this_thread::sleep_for(std::chrono::milliseconds(round));
    }
    EXPECT_TRUE(wait_for([&] { return pictures_.count(ids.back()) > 0; }));
    for (const std::int64_t id : ids)
      EXPECT_EQ(answers_[id].size() + (pictures_[id].empty() ? 0 : 1), 1u) << id;
  }
}

TEST_F(OfASession, AfterTheFirstPictureTheExactOneFollows) {
  wait_for_motion();
  const std::int64_t id = send("frame", {{"frame", 12}});
  EXPECT_TRUE(wait_for([&] { return pictures_[id].size() == 2; }));
  EXPECT_FALSE(pictures_[id][0].header["exact"].get<bool>());
  EXPECT_TRUE(pictures_[id][1].header["exact"].get<bool>());
  pipeline::Options how;
  how.use_cache = false;
  pipeline::FrameByFrame frames(scene::read_scene(file()), how);
  for (int k = 0; k < 12; ++k) frames.next();
  EXPECT_EQ(pictures_[id][1].jpeg, jpeg_of(frames.next()->frame.picture, {0, 0, 320, 240}, 1));
}

TEST_F(OfASession, WhatIsWrongIsAnsweredWithItsId) {
  session_->take(1, "{\"id\": 99, \"do\": \"fly\"}");
  EXPECT_THAT(answers_[99].at(0)["error"].get<std::string>(), HasSubstr("\"fly\""));
  session_->take(1, "nonsense \xff");
  EXPECT_THAT(answers_[0].at(0)["error"].get<std::string>(), HasSubstr("no JSON object"));
  EXPECT_THAT(ask("undo")["error"].get<std::string>(), HasSubstr("nothing to undo"));
  EXPECT_THAT(ask("frame", {{"frame", 24}})["error"].get<std::string>(),
              HasSubstr("has no frame 24; it ends after 24"));
  EXPECT_THAT(ask("edit", {{"changes", Json::parse(R"([{"remove":["intruder",4]}])")}})["error"]
                  .get<std::string>(),
              HasSubstr("intruder[4] is not there"));
}

TEST_F(OfASession, AProblemIsSaidAndTheClipStaysInView) {
  const Json changes = Json::parse(R"([{"set":["intruder",0,"aircraft"],"to":"c172/none"}])");
  EXPECT_TRUE(ask("edit", {{"changes", changes}})["ok"]["state"]["problem"].is_null());
  EXPECT_THAT(ask("plan")["error"].get<std::string>(), HasSubstr("c172/none"));
  const Picture picture = frame({{"frame", 3}});
  EXPECT_THAT(picture.header["problem"].get<std::string>(), HasSubstr("c172/none"));
  EXPECT_EQ(picture.jpeg, frame({{"frame", 3}, {"aircraft", false}}).jpeg);
  const Json wrong = Json::parse(R"([{"set":["intruder",0,"aircaft"],"to":"x"}])");
  EXPECT_THAT(ask("edit", {{"changes", wrong}})["ok"]["state"]["problem"].get<std::string>(),
              HasSubstr("aircaft"));
  EXPECT_FALSE(frame({{"frame", 3}}).jpeg.empty());
  ask("undo");
  ask("undo");
  EXPECT_TRUE(ask("plan").contains("ok"));
}

TEST_F(OfASession, AFileThatIsNoSceneOpensWithItsProblem) {
  begin("[background\n");
  const Json opened = ask("open")["ok"];
  EXPECT_TRUE(opened["clip"].is_null());
  EXPECT_THAT(opened["state"]["problem"].get<std::string>(), HasSubstr("is not TOML"));
}

TEST_F(OfASession, ARenderedVideoIsThatOfTheCommandLine) {
  ask("edit", {{"changes", pixel(120, 90)}});
  EXPECT_THAT(ask("render")["error"].get<std::string>(), HasSubstr("is not saved"));
  ask("save");
  const Json made = ask("render")["ok"];
  EXPECT_EQ(made["video"], "s.mkv");
  EXPECT_GE(made["boxes"].size(), 15u);
  pipeline::Options how;
  how.use_cache = false;
  const auto again = pipeline::render(scene::read_scene(file()), *folder_ / "again", how);
  EXPECT_EQ(read_file(*session_->rendered_film()), read_file(again.folder / "s.mkv"));
  EXPECT_EQ(session_->original_film(), *folder_ / "flight.mp4");
  EXPECT_TRUE(ask("render").contains("ok"));  // over the first
}

TEST_F(OfASession, WhatTakesLongCanBeCancelled) {
  const std::int64_t id = send("calibrate");
  EXPECT_THAT(ask("render")["error"].get<std::string>(), HasSubstr("one is running"));
  ask("cancel");
  EXPECT_TRUE(wait_for([&] { return answers_.count(id) > 0; }));
  EXPECT_TRUE(answers_[id][0].contains("error") || answers_[id][0].contains("ok"));
  EXPECT_FALSE(ask("calibrate").contains("error"));
}

TEST_F(OfASession, TheGalleryHasTypesWithTheirLiveries) {
  const Json groups = ask("aircraft", {{"search", "738"}})["ok"]["groups"];
  ASSERT_FALSE(groups.empty());
  EXPECT_EQ(groups[0]["name"], "738");
  EXPECT_NEAR(groups[0]["span_m"].get<double>(), 34, 2);
  EXPECT_GT(groups[0]["liveries"].size(), 5u);
  EXPECT_FALSE(ask("aircraft", {{"search", "RYANAIR"}})["ok"]["groups"].empty());
  EXPECT_TRUE(ask("aircraft", {{"search", "zzzz"}})["ok"]["groups"].empty());
  std::map<std::string, bool> has;
  for (const char* name : {"738/738-Ryanair", "bird", "../../etc/passwd", ""})
    session_->aircraft_picture(name, [&has, name](const std::optional<std::string>& jpeg) {
      has[name] = jpeg.has_value();
    });
  EXPECT_TRUE(wait_for([&] { return has.size() == 4; }));
  EXPECT_TRUE(has["738/738-Ryanair"]);
  EXPECT_TRUE(has["bird"]);
  EXPECT_FALSE(has["../../etc/passwd"]);
  EXPECT_FALSE(has[""]);
}

}  // namespace
}  // namespace airtruth::session
