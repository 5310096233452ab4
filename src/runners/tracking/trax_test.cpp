// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "runners/tracking/trax_message.h"
#include "runners/tracking/trax_tracker.h"
#include "support/process_end.h"

namespace airtruth::tracking {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(Message, ReadsWhatLibtraxWrites) {
  const auto hello = parse_line(
      R"(@@TRAX:hello "trax.name=Static" "trax.image=path;url;" "trax.version=4" "trax.channels=color;")");
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->type, Type::kHello);
  EXPECT_EQ(hello->property("trax.name"), "Static");
  EXPECT_EQ(hello->property("trax.image"), "path;url;");
  EXPECT_EQ(hello->property("nothing"), "");
  const auto state = parse_line("@@TRAX:STATUS 1,2,3,4 time=0.5\r");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->type, Type::kState);
  EXPECT_THAT(state->arguments, testing::ElementsAre("1,2,3,4"));
  EXPECT_EQ(state->property("time"), "0.5");
}

TEST(Message, WhatHasNoPrefixIsChatter) {
  EXPECT_FALSE(parse_line(""));
  EXPECT_FALSE(parse_line("loading weights"));
  EXPECT_FALSE(parse_line(" @@TRAX:quit"));
}

TEST(Message, AnEqualsSignAfterWhatIsNoKeyIsData) {
  const auto frame = parse_line("@@TRAX:frame \"image:1;1;rgb;AAA=\" a-b=c \"=x\"");
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->properties.empty());
  EXPECT_EQ(frame->arguments.size(), 3u);
}

TEST(Message, WhatIsBrokenIsSaid) {
  EXPECT_THROW(parse_line("@@TRAX:dance 1"), process::Failure);
  EXPECT_THROW(parse_line("@@TRAX:"), process::Failure);
  EXPECT_THROW(parse_line("@@TRAX:state \"1,2"), process::Failure);
}

std::string random_text(Random& random) {
  static const std::string some = "ab=\\\" \n\t,;.@:1\xc3\xa9";
  std::string text;
  const int length = static_cast<int>(random.uniform() * 12);
  for (int i = 0; i < length; ++i)
    text += some[static_cast<std::size_t>(random.uniform() * static_cast<double>(some.size()))];
  return text;
}

// A million messages of random content come back as they went; and as many lines of noise are
// messages, chatter or a process::Failure.
TEST(Message, AMillionGoThereAndBack) {
  Random random(1);
  for (int i = 0; i < 1'000'000; ++i) {
    Message message{static_cast<Type>(i % 5), {}, {}};
    for (int k = static_cast<int>(random.uniform() * 3); k > 0; --k) {
      // A text with "=" would be read as a property.
      std::string argument = random_text(random);
      if (argument.find('=') != std::string::npos) argument = "-" + argument;
      message.arguments.push_back(argument);
    }
    for (int k = static_cast<int>(random.uniform() * 3); k > 0; --k)
      message.properties.emplace_back("key." + std::to_string(k), random_text(random));
    const std::string line = line_of(message);
    ASSERT_EQ(line.find('\n'), line.size() - 1);
    ASSERT_EQ(parse_line(std::string_view(line).substr(0, line.size() - 1)), message) << line;
  }
  for (int i = 0; i < 1'000'000; ++i) {
    std::string line =
        "@@TRAX:" + (i % 2 == 0 ? "state " + random_text(random) : random_text(random));
    try {
      parse_line(line + random_text(random));
    } catch (const process::Failure&) {
    }
  }
}

TEST(Region, OfEveryKind) {
  EXPECT_EQ(box_of("1,2,3,4"), (Box{1, 2, 3, 4}));
  EXPECT_EQ(box_of("1.5, 2e1 ,3;4"), (Box{1.5, 20, 3, 4}));
  EXPECT_EQ(box_of("0,0,10,2,4,8"), (Box{0, 0, 10, 8}));
  // Two rows of five: the last two of the first, all of the second.
  EXPECT_EQ(box_of("mask:10,20,5,2,3,7"), (Box{10, 20, 5, 2}));
  EXPECT_EQ(box_of("mask:10,20,5,3,6,2,7"), (Box{11, 21, 2, 1}));
  EXPECT_EQ(box_of(mask_of({3.2, 4.4, 10, 20})), (Box{3, 4, 10, 20}));
  EXPECT_EQ(box_of(polygon_of({3.25, 4.5, 10, 20})), (Box{3.25, 4.5, 10, 20}));
  EXPECT_EQ(box_of(rectangle_of({3.1, 4.7, 10, 20})), (Box{3.1, 4.7, 10, 20}));
}

TEST(Region, ThatSaysNothing) {
  for (const char* none : {"0",
                           "2",
                           "nan,nan,nan,nan",
                           "1,2,inf,4",
                           "1,2,0,4",
                           "1,2,-3,4",
                           "1e400,2,3,4",
                           "1,1,1,1,1,1",
                           "0,0,nan,1,2,2",
                           "mask:0,0,0,0",
                           "mask:1,1,4,4",
                           "mask:1,1,4,4,16"})
    EXPECT_EQ(box_of(none), std::nullopt) << none;
}

TEST(Region, ThatIsNone) {
  for (const char* bad : {"",
                          "a",
                          "1,2",
                          "1,2,3",
                          "1,2,3,4,5",
                          "1,2,,4",
                          "1,2,3,4,",
                          "0x1,2,3,4",
                          "mask:",
                          "mask:1,2,3",
                          "mask:0,0,2,2,5",
                          "mask:0,0,2,2,1,-1",
                          "mask:0,0,1e9,1e9,4",
                          "mask:0,0,2,2,1.5",
                          "mask:nan,0,2,2,1"})
    EXPECT_THROW(box_of(bad), process::Failure) << bad;
}

TEST(Hello, OfOldTrackersAndOfThoseThatAskTooMuch) {
  EXPECT_EQ(hello_of({Type::kHello, {}, {}}).version, 1);
  EXPECT_EQ(hello_of({Type::kHello, {}, {{"trax.image", "memory,url"}}}).images,
            ImageKind::kMemory);
  EXPECT_EQ(hello_of({Type::kHello, {}, {{"trax.image", "url;memory;path;"}}}).images,
            ImageKind::kMemory);
  EXPECT_EQ(hello_of({Type::kHello, {}, {{"trax.image", "path;url;memory;buffer;"}}}).images,
            ImageKind::kPath);
  EXPECT_EQ(hello_of({Type::kHello, {}, {{"trax.image", "url;data;"}}}).images, ImageKind::kBuffer);
  EXPECT_FALSE(hello_of({Type::kHello, {}, {{"trax.region", "mask;"}}}).takes_rectangles);
  EXPECT_TRUE(hello_of({Type::kHello, {}, {{"vot", "wrapper"}}}).is_for_one_run);
  for (const auto& [key, value] :
       std::initializer_list<std::pair<const char*, const char*>>{{"trax.version", "5"},
                                                                  {"trax.version", "0"},
                                                                  {"trax.version", "four"},
                                                                  {"trax.image", "url;"},
                                                                  {"trax.region", "ellipse"},
                                                                  {"trax.channels", "color;depth"}})
    EXPECT_THROW(hello_of({Type::kHello, {}, {{key, value}}}), process::Failure) << key << value;
}

// Trackers in shell, as short as they can be.
constexpr const char* kHello4 =
    R"(echo '@@TRAX:hello "trax.name=Still" "trax.version=4" "trax.image=path;" "trax.region=rectangle;"'; )";

std::string answering(const std::string& to_frame, const std::string& hello = kHello4) {
  return hello + R"(while read -r line; do case "$line" in @@TRAX:frame*) )" + to_frame +
         ";; @@TRAX:quit*) exit 0;; esac; done";
}

image::Picture picture() {
  image::Picture made = image::make_picture(32, 24, {});
  for (int p = 0; p < made.plane_count; ++p)
    for (int y = 0; y < made.planes[static_cast<std::size_t>(p)].height; ++y)
      std::fill_n(made.planes[static_cast<std::size_t>(p)].row(y),
                  made.planes[static_cast<std::size_t>(p)].width,
                  std::uint8_t{128});
  return made;
}

TrackerOptions within(double seconds) {
  TrackerOptions options;
  options.start_s = options.answer_s = seconds;
  return options;
}

std::unique_ptr<Tracker> started(const std::string& command) {
  return make_trax_tracker("trax:" + command, within(20));
}

// What a run of a few frames with a tracker ends in; "" for a good end.
std::string fault_of_named(const std::string& name, double seconds = 20) {
  const image::Picture one = picture();
  try {
    const auto tracker = make_trax_tracker(name, within(seconds));
    tracker->load(one);
    tracker->init({1, 2, 3, 4});
    for (int i = 0; i < 3; ++i) {
      tracker->load(one);
      tracker->update();
    }
    return "";
  } catch (const process::Failure& error) {
    return error.what();
  }
}

std::string fault_of(const std::string& command) { return fault_of_named("trax:" + command); }

// Of one that never answers: a deadline that is soon over.
std::string hang_of(const std::string& command) { return fault_of_named("trax:" + command, 1); }

TEST(TraxTracker, OfVersionFour) {
  const image::Picture one = picture();
  const std::string command =
      answering(R"(echo chatter; echo "@@TRAX:state 5,6,7,8 confidence=0.25")");
  EXPECT_EQ(trax_name("trax:" + command, within(20)), "Still");
  const auto tracker = started(command);
  tracker->load(one);
  tracker->init({1, 2, 3, 4});
  tracker->load(one);
  const Answer answer = tracker->update();
  EXPECT_FALSE(answer.lost);
  EXPECT_EQ(answer.box_px, (Box{5, 6, 7, 8}));
  EXPECT_GT(answer.seconds, 0);
  tracker->load(one);
  tracker->init({2, 2, 3, 4});
  EXPECT_EQ(tracker->update().box_px, (Box{5, 6, 7, 8}));
  EXPECT_THAT(tracker->log(), HasSubstr("chatter"));
}

TEST(TraxTracker, WithASideBelow0HasLostItsObjectAndTheAnswerSaysSo) {
  for (const auto& [region, is_negative] :
       {std::pair("5,6,-7,8", true), std::pair("5,6,7,-8", true), std::pair("5,6,0,8", false)}) {
    const image::Picture one = picture();
    const auto tracker = started(answering(std::string("echo '@@TRAX:state ") + region + "'"));
    tracker->load(one);
    tracker->init({1, 2, 3, 4});
    tracker->load(one);
    const Answer answer = tracker->update();
    EXPECT_TRUE(answer.lost) << region;
    EXPECT_EQ(answer.has_negative_side, is_negative) << region;
  }
}

// Every version is begun by what it knows, and gets pictures and regions in the form it asked for.
TEST(TraxTracker, BeginsAsEachVersionExpects) {
  for (const char* version : {"1", "2", "3"}) {
    const std::string hello = std::string("echo '@@TRAX:hello \"trax.version=") + version +
                              "\" \"trax.region=polygon\" \"trax.image=memory\"'; ";
    EXPECT_EQ(fault_of(hello + R"(read -r line; case "$line" in
        '@@TRAX:initialize "image:32;24;rgb;'*'" "1,2,4,2,4,6,1,6"') echo '@@TRAX:state 1,2,3,4';; *) exit 3;; esac
        while read -r line; do case "$line" in '@@TRAX:frame "image:32;24;rgb;'*) echo '@@TRAX:state 1,2,3,4';; *) exit 4;; esac; done)"),
              "")
        << version;
  }
  EXPECT_EQ(fault_of(
                R"(echo '@@TRAX:hello "trax.version=4" "trax.region=mask" "trax.image=buffer"';
      read -r line; [ "$line" = '@@TRAX:initialize "mask:1,2,3,4,0,12"' ] || exit 3
      while read -r line; do case "$line" in '@@TRAX:frame "data:image/png;iVBOR'*) echo '@@TRAX:state 1,2,3,4';; *) exit 4;; esac; done)"),
            "");
  // A path leads to a picture that is there.
  EXPECT_EQ(fault_of(answering(
                R"(f=${line#*file://}; [ -s "${f%\"*}" ] || exit 5; echo '@@TRAX:state 1,2,3,4')")),
            "");
}

TEST(TraxTracker, OverASocket) {
  EXPECT_EQ(
      fault_of_named("trax-socket:python3 -c \"import os, socket\n"
                     "s = socket.create_connection(('127.0.0.1', int(os.environ['TRAX_SOCKET'])))\n"
                     "f = s.makefile('rw')\n"
                     "print('words on standard output')\n"
                     "print('@@TRAX:hello trax.version=3', file=f, flush=True)\n"
                     "for line in f:\n"
                     "    if 'quit' in line: break\n"
                     "    print('@@TRAX:state 1,2,3,4', file=f, flush=True)\""),
      "");
  EXPECT_THAT(fault_of_named("trax-socket:exit 7"), HasSubstr("status 7"));
}

TEST(TraxTracker, ThatGoesWrongSaysHow) {
  EXPECT_THAT(fault_of("no_such_tracker_4711 --fast"), HasSubstr("not found"));
  EXPECT_THAT(fault_of("exit 0"), HasSubstr("ended with status 0"));
  EXPECT_THAT(fault_of("echo '@@TRAX:state 1'; cat"), StartsWith("sent no hello"));
  EXPECT_THAT(fault_of("echo '@@TRAX:hello trax.version=9'; cat"),
              StartsWith("speaks version '9'; expected 1 to 4"));
  EXPECT_THAT(fault_of(answering("echo out of memory >&2; kill -SEGV $$")),
              HasSubstr("signal 11; its last words: out of memory"));
  EXPECT_THAT(hang_of(answering("exec sleep 60")), HasSubstr("in time"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:state'")),
              StartsWith("sent a state with 0 regions"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:state 1,2,3,4 5,6,7,8'")), HasSubstr("2 regions"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:state over there'")), HasSubstr("2 regions"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:state somewhere'")),
              StartsWith("sent 'somewhere', which is no number"));
  EXPECT_THAT(fault_of(answering(R"(printf '@@TRAX:state \0x\n')")),
              StartsWith("sent '?x', which is no number"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:hello'")), HasSubstr("no state"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:quit \"trax.reason=tired\"'")),
              StartsWith("quit: tired"));
  EXPECT_THAT(fault_of(answering("echo '@@TRAX:state \"1,2'")), StartsWith("sent a quote that"));
  EXPECT_THAT(fault_of(answering(R"(printf '@@TRAX:state 1,2,3,4\n@@TRAX:state 1,2,3,4\n')")),
              StartsWith("answered before it was asked"));
  EXPECT_THAT(hang_of("exec sleep 60 # never says hello"), HasSubstr("in time"));
  EXPECT_THAT(
      fault_of(answering(R"(f=${line#*file://}; rm -r "${f%/*}"; echo '@@TRAX:state 1,2,3,4')")),
      StartsWith("cannot be given a picture: "));
  // It reads nothing: a picture in the message fills the pipe.
  EXPECT_THAT(hang_of("echo '@@TRAX:hello trax.version=3 trax.image=memory'; exec sleep 60"),
              HasSubstr("in time"));
  EXPECT_THAT(fault_of(answering("exec >&-; sleep 60")), HasSubstr("closed its output"));
}

// Endless talk on either output takes neither memory nor time from an answer.
TEST(TraxTracker, OfABabbler) {
  EXPECT_EQ(fault_of(answering(
                "head -c 3000000 /dev/zero | tr '\\0' 'x'; echo; echo '@@TRAX:state 1,2,3,4'")),
            "");
  const auto tracker = started("(yes words >&2) & " + answering("echo '@@TRAX:state 1,2,3,4'"));
  const image::Picture one = picture();
  tracker->load(one);
  tracker->init({1, 2, 3, 4});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  tracker->load(one);
  EXPECT_FALSE(tracker->update().lost);
  EXPECT_LE(tracker->log().size(), process::Child::kMaxLog);
  EXPECT_THAT(hang_of(std::string(kHello4) + "exec yes nonsense"), HasSubstr("in time"));
  EXPECT_THAT(fault_of(std::string(kHello4) + "exec yes '@@TRAX:state 1,2,3,4'"),
              HasSubstr("before it was asked"));
}

// All that a tracker started is gone after it, whatever it made of its signals.
TEST(TraxTracker, LeavesNoProcessBehind) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("airtruth_trax_" + std::to_string(::getpid()));
  {
    const auto tracker = started("trap '' TERM; (trap '' TERM; sleep 300) & echo $! > " +
                                 file.string() + "; " + answering("echo '@@TRAX:state 1,2,3,4'"));
  }
  pid_t grandchild = 0;
  std::ifstream(file) >> grandchild;
  std::filesystem::remove(file);
  ASSERT_GT(grandchild, 0);
  EXPECT_TRUE(test_support::ends(grandchild));
}

TEST(TraxTracker, EndsAWaitWhenStopped) {
  std::stop_source stop;
  TrackerOptions options = within(20);
  options.stop = stop.get_token();
  const image::Picture one = picture();
  const auto tracker = make_trax_tracker("trax:" + answering("exec sleep 60"), options);
  tracker->load(one);
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop.request_stop();
  });
  EXPECT_THROW(tracker->init({1, 2, 3, 4}), Interrupted);
  later.join();
}

}  // namespace
}  // namespace airtruth::tracking
