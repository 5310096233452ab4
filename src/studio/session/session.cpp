// SPDX-License-Identifier: Apache-2.0
#include "studio/session/session.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <map>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/writer.h"
#include "sequence/pipeline/render.h"
#include "sequence/pipeline/resolved_scene.h"
#include "studio/messages/request.h"
#include "studio/session/answers.h"
#include "studio/session/gallery.h"
#include "studio/session/near_miss.h"
#include "studio/session/plan.h"
#include "studio/session/stage.h"
#include "studio/session/worker.h"

namespace airtruth::session {
namespace {

using Json = nlohmann::ordered_json;
using messages::Act;
using messages::Request;
using Urgency = Worker::Urgency;

// Around what is drawn: the reach of lens and sharpening, and the blocks of a JPEG.
constexpr int kMarginPx = 24;

// Runs `act`. Returns the line of its fault; "": it has none.
template <typename Do>
std::string fault_of(const Do& act) {
  try {
    act();
    return "";
  } catch (const Interrupted&) {
    return "cancelled";
  } catch (const Error& fault) {
    return fault.what();
  } catch (const std::exception& fault) {
    return std::string(fault.what()) + " (this is a fault of airtruth; please report it)";
  }
}

// The answer with what `act` gives, or with its fault.
template <typename Do>
std::string answer_with(std::int64_t id, const Do& act) {
  std::string text;
  const std::string line = fault_of([&] { text = ok(id, act()); });
  return line.empty() ? text : error(id, line);
}

// A scene as it was at one time, for the other threads.
struct Snapshot {
  std::int64_t revision = 0;
  std::optional<scene::Scene> scene;  // empty: the text is no scene
  std::string problem;
  scene::Background background;  // of the last text that was one
  document::Tables tables;
};

PixelBox even(PixelBox box, int width, int height) {
  const int x = std::max(0, box.x) & ~1;
  const int y = std::max(0, box.y) & ~1;
  return {x,
          y,
          std::max(2, std::min(width, box.right()) - x),
          std::max(2, std::min(height, box.bottom()) - y)};
}

// Begins something long that runs beside the pictures, behind them in its claim on the processor.
// What `job` runs ends first. `work` does not throw.
template <typename Work>
void begin_job(std::jthread& job, Work work) {
  job = std::jthread();
  job = std::jthread([work = std::move(work)](const std::stop_token& stop) {
    // Threads that the work starts inherit it.
    constexpr int kNice = 10;
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
    work(stop);
  });
}

// Aircraft and hashes are kept for all that the session does.
Options with_inputs(Options options) {
  options.pipeline.shared = pipeline::inputs_of(options.pipeline);
  return options;
}

}  // namespace

class Session::Impl {
 public:
  Impl(std::unique_ptr<document::Document> document, Options options, Ways ways)
      : document_(std::move(document)),
        options_(with_inputs(std::move(options))),
        ways_(std::move(ways)),
        stage_(quiet(options_.pipeline)),
        thumbnails_(quiet(options_.pipeline)) {
    publish();
  }
  ~Impl() {
    stop_.request_stop();
    // The worker begins jobs, so it ends before them.
    worker_.end();
    beside_.end();
    for (std::jthread* job : {&motion_job_, &camera_job_, &asked_job_}) job->request_stop();
    for (std::jthread* job : {&motion_job_, &camera_job_, &asked_job_}) *job = std::jthread();
  }

  void take(Client client, const std::string& message) {
    const std::string line = fault_of([&] { answer(client, messages::request_from(message)); });
    if (!line.empty()) ways_.send(client, error(messages::id_of(message).value_or(0), line));
  }

  void leave(Client client) {
    worker_.add(Urgency::kFrame, [this, client] { shown_.erase(client); });
  }

  void tick() {
    document_->flush();
    if (document_->look_at_disk()) {
      publish();
      tell_state();
    }
  }

  void thumbnail(std::int64_t frame, int width, Done done) {
    small(std::move(done), [this, frame, width]() -> std::optional<std::string> {
      return thumbnails_.at(snapshot()->background, frame, width);
    });
  }

  void aircraft_picture(const std::string& name, Done done) {
    small(std::move(done), [this, name] { return gallery_.picture(name, stop_.get_token()); });
  }

  fs::path original_film() const { return snapshot()->background.video; }
  std::optional<fs::path> rendered_film() const { return rendered_; }

 private:
  pipeline::Options quiet(pipeline::Options options) const {
    options.stop = stop_.get_token();
    options.warn = {};
    options.progress = {};
    return options;
  }

  // On the owner's thread.

  std::shared_ptr<const Snapshot> snapshot() const {
    const std::lock_guard lock(mutex_);
    return snapshot_;
  }

  void publish() {
    auto next = std::make_shared<Snapshot>();
    next->revision = document_->revision();
    next->scene = document_->scene();
    next->problem = document_->problem();
    next->tables = document_->tables();
    if (next->scene)
      next->background = next->scene->background;
    else if (snapshot_)
      next->background = snapshot_->background;
    const std::lock_guard lock(mutex_);
    snapshot_ = std::move(next);
  }

  void tell(const Json& event) { ways_.send_all(text_of(event)); }
  void tell_state() { tell({{"event", "state"}, {"state", document_->state()}}); }

  void answer(Client client, Request request) {
    switch (request.act) {
      case Act::kOpen:
        return open(client, request.id);
      case Act::kEdit:
        return change(client, request.id, [&] {
          return document_->edit(request.changes, request.merge, request.upon);
        });
      case Act::kUndo:
        return change(client, request.id, &document::Document::undo);
      case Act::kRedo:
        return change(client, request.id, &document::Document::redo);
      case Act::kSave:
        return change(client, request.id, &document::Document::save);
      case Act::kReload:
        return change(client, request.id, &document::Document::reload);
      case Act::kKeep:
        return change(client, request.id, &document::Document::keep);
      case Act::kFrame:
        return show(client, std::move(request));
      case Act::kPlan:
        return on_worker(
            worker_, client, request.id, [this] { return plan_of(stage_, ready()->tables); });
      case Act::kNearMiss:
        return on_worker(worker_, client, request.id, [this, wanted = request.near_miss] {
          return Json{{"encounter", encounter_through(stage_, ready()->tables, wanted)}};
        });
      case Act::kAircraft:
        return on_worker(beside_, client, request.id, [this, word = request.search] {
          return gallery_.groups(word);
        });
      case Act::kCalibrate:
        return calibrate(client, request.id);
      case Act::kRender:
        return render(client, request.id);
      case Act::kCancel:
        asked_job_.request_stop();
        return ways_.send(client, ok(request.id, Json::object()));
    }
  }

  // The clip is opened by the worker; the state is that of the answer's moment.
  void open(Client client, std::int64_t id) {
    worker_.add(Urgency::kPlan, [this, client, id] {
      Json facts;
      const std::string line = fault_of([&] { facts = clip_facts(); });
      ways_.post([this, client, id, facts, line]() mutable {
        if (!line.empty()) return ways_.send(client, error(id, line));
        facts["state"] = document_->state();
        ways_.send(client, ok(id, facts));
      });
    });
  }

  template <typename Do>
  void change(Client client, std::int64_t id, const Do& act) {
    const std::int64_t before = document_->revision();
    const bool is_done = act();
    if (document_->revision() != before) publish();
    ways_.send(client, ok(id, {{"state", document_->state()}, {"done", is_done}}));
    tell_state();
  }
  void change(Client client, std::int64_t id, void (document::Document::*act)()) {
    change(client, id, [this, act] {
      (*document_.*act)();
      return true;
    });
  }

  // Answers with what `act` gives on the worker's thread.
  template <typename Do>
  void on_worker(Worker& worker, Client client, std::int64_t id, Do act) {
    worker.add(
        Urgency::kPlan,
        [this, client, id, act] { reply(client, answer_with(id, act)); },
        [this, client, id] { reply(client, error(id, "too many requests wait")); });
  }
  void reply(Client client, std::string text) {
    ways_.post([this, client, text = std::move(text)] { ways_.send(client, text); });
  }

  template <typename Do>
  void small(Done done, Do act) {
    beside_.add(
        Urgency::kLater,
        [this, done, act] {
          std::optional<std::string> jpeg;
          fault_of([&] { jpeg = act(); });
          ways_.post([done, jpeg = std::move(jpeg)]() mutable { done(std::move(jpeg)); });
        },
        [this, done] { ways_.post([done] { done(std::nullopt); }); });
  }

  // On the worker's thread.

  Json clip_facts() {
    const auto shot = snapshot();
    // A text that was never a scene: the page shows its problem.
    if (shot->background.video.empty())
      return {{"file", document_file_}, {"clip", nullptr}, {"out", options_.out.string()}};
    Clip& clip = stage_.clip(shot->background);
    const video::StreamInfo& info = clip.info();
    return {{"file", document_file_},
            {"out", options_.out.string()},
            {"clip",
             {{"video", shot->background.video.filename().string()},
              {"width", info.width},
              {"height", info.height},
              {"frames", clip.frame_count()},
              {"rate_hz", clip.rate_hz()},
              {"begin_s", clip.begin_s()},
              {"times_s", clip.times_s()},
              {"first_frame", shot->background.first_frame}}}};
  }

  // Sets the present scene up. Returns why it cannot be; "": it is.
  std::string set_up(const Snapshot& shot) {
    if (!shot.scene) return shot.problem;
    const std::string problem =
        fault_of([&] { stage_.set(shot.revision, *shot.scene, measured_); });
    if (problem.empty()) {
      measure_motion(*shot.scene);
      measure_camera(*shot.scene);
    }
    return problem;
  }

  // The present scene, which is set up. Throws Error where it cannot be.
  std::shared_ptr<const Snapshot> ready() {
    auto shot = snapshot();
    if (const std::string problem = set_up(*shot); !problem.empty()) throw Error(problem);
    return shot;
  }

  void show(Client client, Request request) {
    const std::int64_t id = request.id;
    worker_.add({Urgency::kFrame,
                 fmt::format("frame {}", client),
                 [this, client, request] { draw(client, request, false); },
                 [this, client, id] {
                   reply(client, ok(id, {{"dropped", true}}));
                 }});
  }

  void draw(Client client, const Request& request, bool exact) {
    const std::string line = fault_of([&] { draw_now(client, request, exact); });
    if (!line.empty() && !exact) reply(client, error(request.id, line));
  }

  void draw_now(Client client, const Request& request, bool exact) {
    const auto shot = snapshot();
    Clip& clip = stage_.clip(shot->background);
    Json header = {{"id", request.id}, {"frame", request.frame}, {"revision", shot->revision}};
    const std::string problem = set_up(*shot);
    std::optional<Stage::Picture> made;
    Json boxes = Json::array();
    if (request.aircraft && problem.empty()) {
      // Each request has its answer, so only the exact picture that follows it can wait.
      made = stage_.picture(request.frame, exact, [this, exact] {
        return exact && worker_.is_wanted_for(Urgency::kPlan);
      });
      if (!made) return again_later(client, request);
      boxes = boxes_of(stage_, made->moment, shot->tables);
    }
    const auto plain = made ? nullptr : clip.frame(request.frame);
    const image::Picture& picture = made ? made->picture() : plain->picture;
    const PixelBox crop = crop_of(client, request, picture, made ? &*made : nullptr);
    const std::string jpeg = jpeg_of(picture, crop, request.scale);
    header["crop"] = {crop.x, crop.y, crop.width, crop.height};
    header["scale"] = request.scale;
    header["exact"] = made ? made->exact : false;
    header["boxes"] = boxes;
    header["lines"] =
        problem.empty() ? lines_over(stage_, request.frame, shot->tables) : Json::array();
    header["directions"] = problem.empty() ? directions_over(stage_, request.frame) : Json::array();
    header["problem"] = problem.empty() ? Json() : Json(problem);
    ways_.post([this, client, bytes = framed(header, jpeg)] { ways_.send_binary(client, bytes); });
    if (made && !made->exact && stage_.is_complete()) again_later(client, request);
  }

  // The exact picture follows when there is nothing else to do, and the hand rests.
  void again_later(Client client, const Request& request) {
    constexpr auto kRest = std::chrono::milliseconds(150);
    worker_.add({Urgency::kLater,
                 fmt::format("exact {}", client),
                 [this, client, request] { draw(client, request, true); },
                 {},
                 std::chrono::steady_clock::now() + kRest});
  }

  // The part of a picture that is sent; keeps what the page has then.
  PixelBox crop_of(Client client,
                   const Request& request,
                   const image::Picture& picture,
                   const Stage::Picture* made) {
    const PixelBox whole{0, 0, picture.width, picture.height};
    std::optional<PixelBox> drawn;
    if (made)
      if (const auto box = setup::search_bounds(made->moment))
        drawn = intersection(wider(*box, kMarginPx), whole);
    if (made && !made->moment.spots.empty()) drawn = whole;
    Shown& shown = shown_[client];
    const Shown before = std::exchange(shown, {request.frame, drawn});
    if (!request.crops_to_change || before.frame != request.frame) return whole;
    if (!drawn && !before.drawn) return even({}, whole.width, whole.height);
    const PixelBox box = !drawn          ? *before.drawn
                         : !before.drawn ? *drawn
                                         : bounds(*drawn, *before.drawn);
    return even(box, whole.width, whole.height);
  }

  // Begin to measure what the scene needs and nothing measures yet.

  void measure_motion(const scene::Scene& scene) {
    const std::string key = motion_key(scene);
    if (key == motion_wanted_) return;
    motion_wanted_ = key;
    begin_job(motion_job_, [this, scene, key](const std::stop_token& stop) {
      std::shared_ptr<const setup::MotionSource> motion;
      pipeline::Options options = for_job(stop, "motion");
      options.threads = 1;
      fault_of([&] {
        motion =
            std::make_shared<const setup::MotionSource>(pipeline::motion_ahead(scene, options));
      });
      if (stop.stop_requested()) return;
      worker_.add(Urgency::kFrame, [this, key, motion] {
        if (motion) {
          measured_.motion = motion;
          measured_.motion_key = key;
        }
        tell_soon({{"event", "measured"}, {"of", "motion"}});
      });
    });
  }

  void measure_camera(const scene::Scene& scene) {
    std::string key;
    fault_of([&] {
      if (pipeline::needs_calibration(scene)) key = calibration_key(scene);
    });
    if (key == camera_wanted_) return;
    camera_wanted_ = key;
    camera_job_.request_stop();
    if (key.empty() || measured_.calibrated.count(key) > 0) return;
    begin_job(camera_job_, [this, scene, key](const std::stop_token& stop) {
      const std::string problem =
          fault_of([&] { pipeline::calibration_of(scene, for_job(stop, "calibrate")); });
      if (stop.stop_requested()) return;
      worker_.add(Urgency::kFrame, [this, key, problem] {
        if (problem.empty()) measured_.calibrated.insert(key);
        tell_soon({{"event", "measured"}, {"of", "calibrate"}});
      });
    });
  }

  void tell_soon(Json event) {
    ways_.post([this, event = std::move(event)] { tell(event); });
  }

  // What a page asks for that takes long; one at a time.

  pipeline::Options for_job(const std::stop_token& stop, const std::string& what) {
    pipeline::Options options = options_.pipeline;
    options.stop = stop;
    options.warn = [this](const std::string& line) {
      tell_soon({{"event", "warning"}, {"line", line}});
    };
    options.progress = [this, what](const pipeline::Progress& progress) {
      tell_soon({{"event", "progress"},
                 {"of", what},
                 {"done", progress.frames_done},
                 {"total", progress.frames_total}});
    };
    return options;
  }

  template <typename Do>
  void ask_for(Client client, std::int64_t id, Do act) {
    if (is_asked_) throw Error("one is running; expected to cancel it, or to wait");
    is_asked_ = true;
    begin_job(asked_job_, [this, client, id, act](const std::stop_token& stop) {
      ways_.post([this, client, text = answer_with(id, [&] { return act(stop); })] {
        is_asked_ = false;
        ways_.send(client, text);
      });
    });
  }

  void calibrate(Client client, std::int64_t id) {
    const auto shot = snapshot();
    if (!shot->scene) throw Error(shot->problem);
    ask_for(client, id, [this, scene = *shot->scene](const std::stop_token& stop) {
      return Json{
          {"values", values_of(pipeline::calibration_of(scene, for_job(stop, "calibrate")))}};
    });
  }

  void render(Client client, std::int64_t id) {
    if (!document_->state()["saved"].get<bool>())
      throw Error(
          "is not saved; expected a saved scene, from which the command line renders the "
          "same video",
          {document_->file().string()});
    const fs::path file = document_->file();
    ask_for(client, id, [this, file](const std::stop_token& stop) {
      pipeline::Options options = for_job(stop, "render");
      options.overwrite = true;
      const scene::Scene scene = scene::read_scene(file);
      const pipeline::Summary summary = pipeline::render(scene, options_.out, options);
      const fs::path film = summary.folder / (scene.name + video::extension(scene.output.video));
      const Json boxes = boxes_of_film(summary.folder / "truth.jsonl");
      ways_.post([this, film] { rendered_ = film; });
      return Json{{"folder", summary.folder.string()},
                  {"video", film.filename().string()},
                  {"boxes", boxes}};
    });
  }

  struct Shown {
    std::int64_t frame = -1;
    std::optional<PixelBox> drawn;
  };

  std::stop_source stop_;
  std::unique_ptr<document::Document> document_;
  const std::string document_file_ = document_->file().string();
  Options options_;
  Ways ways_;
  std::optional<fs::path> rendered_;
  bool is_asked_ = false;
  mutable std::mutex mutex_;
  std::shared_ptr<const Snapshot> snapshot_;
  // Of the worker's thread.
  Stage stage_;
  Measured measured_;
  std::string motion_wanted_;
  std::string camera_wanted_;
  std::map<Client, Shown> shown_;
  // Of the thread beside it, which pictures of the scene do not wait for.
  Gallery gallery_;
  Thumbnails thumbnails_;
  std::jthread motion_job_;
  std::jthread camera_job_;
  std::jthread asked_job_;
  Worker worker_;
  Worker beside_;
};

Session::Session(std::unique_ptr<document::Document> document, Options options, Ways ways)
    : impl_(std::make_unique<Impl>(std::move(document), std::move(options), std::move(ways))) {}
Session::~Session() = default;

void Session::take(Client client, const std::string& message) { impl_->take(client, message); }
void Session::leave(Client client) { impl_->leave(client); }
void Session::tick() { impl_->tick(); }
void Session::thumbnail(std::int64_t frame, int width, Done done) {
  impl_->thumbnail(frame, width, std::move(done));
}
void Session::aircraft_picture(const std::string& name, Done done) {
  impl_->aircraft_picture(name, std::move(done));
}
std::optional<fs::path> Session::original_film() const { return impl_->original_film(); }
std::optional<fs::path> Session::rendered_film() const { return impl_->rendered_film(); }

}  // namespace airtruth::session
