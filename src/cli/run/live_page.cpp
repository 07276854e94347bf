#include "cli/run/live_page.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "cli/chain.hpp"
#include "cli/print/console.hpp"
#include "cli/random_id.hpp"
#include "config/load.hpp"
#include "core/text/printable.hpp"
#include "deploy/fault_sentence.hpp"
#include "explain/traces.hpp"
#include "io/loop.hpp"
#include "io/process/signal_watch.hpp"
#include "peis/tuples/key.hpp"
#include "report/expect/expectations.hpp"
#include "view/page_files.hpp"
#include "view/recorded.hpp"
#include "view/report_sample.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t picture_octets_max = std::size_t{16} << 20;

/// The server's end of a page, as the server knows it.
class page_session : public io::web_session {
public:
  explicit page_session(view::conversation x) : with_(std::move(x)) {}

  std::string on_text(std::string_view text) override { return with_.on_text(text); }
  std::optional<std::string> news() override { return with_.news(); }

private:
  view::conversation with_;
};

/// What browsers take for a picture; empty: nothing.
std::string picture_type(const std::string& file) {
  auto end = std::filesystem::path(file).extension().string();
  std::ranges::transform(end, end.begin(), [](unsigned char c) { return std::tolower(c); });
  return end == ".png"                     ? "image/png"
         : end == ".jpg" || end == ".jpeg" ? "image/jpeg"
         : end == ".webp"                  ? "image/webp"
         : end == ".svg"                   ? "image/svg+xml"
                                           : "";
}

std::map<std::string, io::web_file> files_of_page(const std::string& picture) {
  std::map<std::string, io::web_file> files{
      {"", {"text/html; charset=utf-8", std::string(view::page_html())}},
      {"page.css", {"text/css; charset=utf-8", std::string(view::page_css())}},
      {"page.js", {"text/javascript; charset=utf-8", std::string(view::page_js())}},
  };
  if (picture.empty())
    return files;
  const auto type = picture_type(picture);
  if (type.empty()) {
    say(picture + ": a floor plan is a PNG, JPEG, WebP or SVG; it is not shown");
    return files;
  }
  auto read = config::read_file(picture, picture_octets_max);
  if (read.text)
    files["plan"] = {type, std::move(*read.text)};
  else
    say(picture + ' ' + read.reason + "; the floor plan is not shown");
  return files;
}

/// How fast the run is, in ecology seconds a real second.
class speedometer {
public:
  double at(instant now) {
    const auto real = steady::now();
    if (real - since_ >= 500ms) {
      speed_ = seconds(now - then_) / seconds(real - since_);
      since_ = real;
      then_ = now;
    }
    return speed_;
  }

private:
  using steady = std::chrono::steady_clock;
  steady::time_point since_ = steady::now();
  instant then_;
  double speed_ = 0;
};

} // namespace

view::controls::outcome manual_control::take(action x) {
  const std::lock_guard guard(lock_);
  if (over_)
    return {false, "the run is over"};
  if (waiting_.size() >= waiting_max)
    return {false, "too many earlier requests are pending"};
  if (++taken_ > taken_max)
    return {false, "the limit of manual actions is reached"};
  waiting_.push_back(std::move(x));
  return {true, "accepted"};
}

std::shared_ptr<const view::controls> manual_control::controls(std::string why_no_tuples) {
  auto x = std::make_shared<view::controls>();
  x->fault = [this](const std::string& sentence) -> view::controls::outcome {
    const auto found = deploy::fault_of(what_, sentence, known_);
    if (const auto* why = std::get_if<std::string>(&found))
      return {false, *why};
    return take({.sentence = sentence, .fault = std::get<config::fault>(found)});
  };
  x->set_tuple =
      [this, why = std::move(why_no_tuples)](const std::string& owner, const std::string& key,
                                             const std::string& value) -> view::controls::outcome {
    if (!why.empty())
      return {false, why};
    action wanted{.owner = owner, .key = key, .value = value};
    if (auto refusal = refusal_of(wanted); !refusal.empty())
      return {false, std::move(refusal)};
    return take(std::move(wanted));
  };
  return x;
}

/// Why this tuple cannot be set; empty: it can.
std::string manual_control::refusal_of(const action& x) const {
  if (x.key.empty())
    return "a tuple needs a key";
  if (x.key.size() + x.value.size() > tuple_octets_max)
    return "the key and the value are too long";
  const auto name = peis::key::parse(x.key);
  if (!name)
    return "not a key: a key has up to 7 parts between dots and 127 characters, and `*` only as a "
           "whole part of a pattern";
  if (name->is_pattern())
    return "this is a pattern: give the key of one tuple";
  if (!owners_.contains(x.owner))
    return "there is no peer `" + x.owner + '`';
  if (peis::is_reserved(*name) && !kernels_)
    return "`" + x.key + "` belongs to the kernel: `--control=kernel` allows setting it";
  return {};
}

std::vector<std::string> manual_control::perform(const performer& by, instant now) {
  std::vector<std::string> results;
  std::vector<action> actions;
  {
    const std::lock_guard guard(lock_);
    actions.swap(waiting_);
  }
  for (auto& each : actions) {
    if (each.fault) {
      by.cause(each.sentence, *each.fault);
      results.push_back(each.sentence);
    } else if (by.set_tuple(each.owner, each.key, each.value)) {
      results.push_back("sets " + each.key + " of " + each.owner + " to " + each.value);
    } else {
      results.push_back("cannot set " + each.key + ": no peer " + each.owner + " runs");
      continue;
    }
    done_.emplace_back(now, std::move(each));
  }
  return results;
}

void manual_control::end() {
  const std::lock_guard guard(lock_);
  over_ = true;
  waiting_.clear();
}

std::string manual_control::repeated() const {
  std::string text;
  for (const auto& [at, what] : done_) {
    const auto when = std::to_string((at - instant{}) / 1ms) + "ms";
    if (what.fault)
      text += deploy::table_of(what.sentence, when);
    else
      text += "\n# at " + when + ": " + printable(what.owner) + " " + printable(what.key) + " = " +
              printable(what.value) + '\n';
  }
  return text.empty() ? text : "manual actions, for the file:\n" + text;
}

live_page::live_page(const page_place& where, const std::string& ecology,
                     const view::run_facts& facts, const std::string& mode,
                     const std::string& picture, std::shared_ptr<const view::controls> controls,
                     std::shared_ptr<const explain::traces> record)
    : timeline_(std::make_shared<view::timeline>()) {
  if (!facts.messages)
    timeline_->set_why_no_messages("The run is not recorded: add --record FILE to see where each "
                                   "message went.");
  else if (record == nullptr)
    timeline_->set_why_no_messages("Nothing is recorded yet.");
  if (record != nullptr)
    view::fill(*timeline_, std::move(record));
  io::web_site site;
  site.address = where.address;
  site.port = where.port;
  site.hosts = where.hosts;
  site.token = random_id() + random_id();
  site.files = files_of_page(picture);
  auto about = std::make_shared<const view::introduction>(
      view::introduction_of(view::with_facts(ecology, facts, mode)));
  const bool may_control = controls != nullptr;
  site.on_session = [timeline = timeline_, about = std::move(about),
                     controls = std::move(controls)] {
    return std::make_unique<page_session>(view::conversation(timeline, about, controls));
  };
  site.on_time = [timeline = timeline_] { timeline->flush(); };
  const auto token = site.token;
  auto opened = io::web_server::open(std::move(site));
  if (const auto* why = std::get_if<std::string>(&opened))
    throw std::runtime_error(*why);
  server_ = std::move(std::get<io::web_server>(opened));
  url_ = "http://" + (where.address == "0.0.0.0" ? "127.0.0.1" : where.address) + ':' +
         std::to_string(server_->port()) + '/' + token + '/';
  if (!where.address.starts_with("127."))
    say("the page is not encrypted: anyone on the network can read what it shows" +
        std::string(may_control ? ", and its address, which gives the same control" : ""));
  say("page: " + url_);
}

void live_page::attach(run_options& options, const config::ecology_description& ecology) {
  plan_ = view::planned_faults(ecology);
  const bool is_wall =
      options.mode.value_or(ecology.mode) == config::run_mode::wall || options.speed > 0;
  const auto length = options.length.value_or(ecology.length);
  constexpr int samples = 100;
  if (options.look_every <= 0s)
    options.look_every =
        is_wall ? std::max(duration(static_cast<std::int64_t>(std::max(options.speed, 1.0) * 1e9)),
                           duration(1s))
                : std::max(length / samples, duration(1s));
  chain(options.on_sample, [this](const report::run_sample& x) { timeline_->add(x); });
  chain(options.on_tuple, [this](const report::tuple_write& x) { timeline_->add(x); });
  chain(options.on_event, [this](const report::logged_event& x) {
    timeline_->add(view::listed_event{x.at, x.who, x.what});
  });
  chain(options.progress, [this, speed = speedometer()](const run_progress& x) mutable {
    for (; planned_ < plan_.size() && plan_[planned_].at <= x.reached; ++planned_)
      timeline_->add(plan_[planned_]);
    timeline_->set({x.reached, x.end, true, x.events, speed.at(x.reached)});
  });
}

void live_page::report_action(instant now, const std::string& what) {
  timeline_->add(view::listed_event{now, "by hand", what, "fault"});
}

void live_page::finish(const report::run_report& x) {
  for (const auto& each : x.violations)
    if (!each.invariant.starts_with(report::expected)) // those follow
      timeline_->add(
          view::listed_event{each.at, each.invariant, "violated: " + each.detail, "violation"});
  for (const auto& each : x.expectations)
    if (each.outcome == report::expectation_report::verdict::unmet)
      timeline_->add(
          view::listed_event{each.at, each.text, "not met: " + each.measured, "expectation"});
  const auto state = timeline_->state();
  timeline_->set({instant{} + x.simulated, instant{} + x.simulated, false, x.events, state.speed});
  if (reader_)
    reader_->finish();
}

void live_page::read_on(const std::string& record, bool is_own) {
  constexpr std::uint64_t megabyte = 1 << 20;
  constexpr std::uint64_t read_max = 128 * megabyte; // it takes several times as much memory
  message_reader::bound most{
      .octets = read_max,
      .beyond = "The record is too long to follow; the rest is read when the run has ended.",
      .is_of_record = false};
  if (is_own)
    most = {.octets = own_record_octets_max - megabyte,
            .beyond = "Later messages are not kept: add --record FILE.",
            .is_of_record = true};
  std::error_code ignored;
  if (std::filesystem::is_regular_file(record, ignored)) // what is read of others nobody else gets
    reader_.emplace(record, std::move(most), timeline_);
  else
    timeline_->set_why_no_messages("The record is not a regular file.");
}

void live_page::show(const report::run_report& so_far, duration length) {
  for (const auto& each : so_far.event_log)
    if ((!forgotten_ || each.at > *forgotten_) &&
        shown_.emplace(each.at, each.who, each.what).second)
      timeline_->add(view::listed_event{each.at, each.who, each.what});
  while (shown_.size() > view::timeline::events_max) {
    forgotten_ = std::get<instant>(*shown_.begin());
    shown_.erase(shown_.begin());
  }
  const auto now = instant{} + so_far.simulated;
  if (const auto newest = timeline_->newest(); newest == nullptr || newest->at < now)
    timeline_->add(view::sample_of(so_far));
  timeline_->set({now, instant(length), true, so_far.events, 1});
}

void live_page::stay() {
  say("the page is served until Ctrl-C: " + url_);
  io::loop loop;
  bool over = false;
  const io::signal_watch signals(loop, [&over](int) { over = true; });
  while (!over)
    static_cast<void>(loop.wait_until(io::loop::time_point::clock::now() + 1h));
}

} // namespace rubicon::cli
