#include "steering/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::steering {

namespace {

using nlohmann::ordered_json;

double in_seconds(instant x) {
  return seconds(x.time_since_epoch());
}

ordered_json refused(const std::string& why) {
  return {{"ok", false}, {"why", why}};
}

/// `10.000000001s`: exact, as a file has it.
std::string file_time(instant x) {
  constexpr std::int64_t second = 1'000'000'000;
  const auto count = x.time_since_epoch().count();
  auto decimals = std::to_string(second + count % second);
  decimals[0] = '.';
  decimals.erase(decimals.find_last_not_of('0') + 1);
  return std::to_string(count / second) + (decimals.size() > 1 ? decimals : "") + 's';
}

/// A line that requests it again.
ordered_json line_of(const request& x) {
  if (const auto* set = std::get_if<set_request>(&x))
    return {{"do", "set"}, {"peer", set->peer}, {"key", set->key}, {"value", set->value}};
  if (const auto* send = std::get_if<send_request>(&x))
    return {{"do", "send"},
            {"mote", send->mote},
            {"to", send->to},
            {"octets", to_hex(send->octets)},
            {"am_type", send->am_type},
            {"reliable", send->reliable}};
  return {{"do", "fault"}, {"words", std::get<fault_request>(x).words}};
}

/// An infinite number has no JSON.
ordered_json number(double x) {
  return std::isfinite(x) ? ordered_json(x) : ordered_json();
}

ordered_json mote_json(const report::mote_sample& x, const std::string& name) {
  ordered_json out{{"name", name},
                   {"island", x.address.island.value},
                   {"mote", x.address.mote.value},
                   {"alive", x.alive},
                   {"flat", x.flat},
                   {"joined", x.joined},
                   {"radio_on", x.radio_on},
                   {"used_mah", x.used_mah},
                   {"battery_mah", number(x.battery_mah)},
                   {"parent", x.parent.value},
                   {"hops", x.hops},
                   {"queued", x.queued},
                   {"originated", x.originated},
                   {"forwarded", x.forwarded}};
  out["delivery"] = x.delivery ? ordered_json(*x.delivery) : ordered_json();
  out["etx"] = x.etx ? number(*x.etx) : ordered_json();
  out["signal_dbm"] = x.signal_dbm ? ordered_json(*x.signal_dbm) : ordered_json();
  return out;
}

} // namespace

/// Answers requests, one overload each.
class session::answerer {
public:
  explicit answerer(session& of) : of_(of) {}

  ordered_json operator()(const step_request& x) const {
    const auto until = x.until.value_or(of_.now_ + x.length.value_or(duration{}));
    if (until < of_.now_)
      return refused("`until` is over: it is " + to_text(of_.now_.time_since_epoch()));
    of_.now_ = of_.run_.run_until(std::min(until, instant(of_.facts_.length)));
    ordered_json out{{"ok", true}, {"now", in_seconds(of_.now_)}};
    if (of_.now_ < until || of_.now_ >= instant(of_.facts_.length))
      out["over"] = true;
    add_news(out);
    return out;
  }

  ordered_json operator()(const get_request& x) const {
    if (!knows(x.peer) || !(x.owner.empty() || knows(x.owner)))
      return unknown_peer(knows(x.peer) ? x.owner : x.peer);
    const auto value = of_.run_.tuple(x);
    return {{"ok", true}, {"value", value ? ordered_json(*value) : ordered_json()}};
  }

  ordered_json operator()(const set_request& x) const {
    if (!knows(x.peer))
      return unknown_peer(x.peer);
    const auto key = peis::key::parse(x.key);
    if (x.key.empty() || !key || key->is_pattern())
      return refused("`key` must be the key of one tuple");
    return act(x, of_.now_, [&] { return of_.run_.set_tuple(x); });
  }

  /// Each at a moment of its own, in which nothing has happened yet: a file that plans it has the
  /// same order.
  ordered_json operator()(const fault_request& x) const {
    const auto at = std::max(of_.now_, of_.fault_at_) + duration(1);
    auto out = act(x, at, [&] { return of_.run_.fault(x.words, at); });
    if (out["ok"] == true) {
      of_.fault_at_ = at;
      out["at"] = file_time(at);
    }
    return out;
  }

  ordered_json operator()(const send_request& x) const {
    auto out = act(x, of_.now_, [&] { return of_.run_.send(x, of_.sent_ + 1); });
    if (out["ok"] == true)
      out["number"] = ++of_.sent_;
    return out;
  }

  ordered_json operator()(const tuples_request& x) const {
    if (of_.patterns_.size() >= patterns_max)
      return refused("there are " + std::to_string(patterns_max) + " subscriptions already");
    of_.patterns_.push_back(x);
    return done();
  }

  ordered_json operator()(events_request) const {
    of_.wants_events_ = true;
    return done();
  }

  ordered_json operator()(motes_request) const {
    ordered_json motes = ordered_json::array();
    for (const auto& each : of_.run_.look().motes) {
      const auto name = of_.facts_.motes.find(each.address);
      motes.push_back(mote_json(each, name == of_.facts_.motes.end() ? "" : name->second));
    }
    return {{"ok", true}, {"motes", std::move(motes)}};
  }

  ordered_json operator()(report_request) const {
    return {{"ok", true}, {"report", parse_ordered_json(of_.run_.report())}};
  }

  ordered_json operator()(record_request) const { return {{"ok", true}, {"lines", of_.lines()}}; }

  ordered_json operator()(tables_request) const { return {{"ok", true}, {"tables", of_.tables()}}; }

  ordered_json operator()(finish_request) const {
    ordered_json out{{"ok", true}, {"report", parse_ordered_json(of_.run_.finish())}};
    of_.finished_ = true;
    add_news(out);
    return out;
  }

private:
  static ordered_json done() { return {{"ok", true}}; }

  ordered_json unknown_peer(const std::string& name) const {
    return refused("there is no peer `" + name + "`");
  }

  [[nodiscard]] bool knows(const std::string& peer) const {
    return std::ranges::find(of_.facts_.peers, peer) != of_.facts_.peers.end();
  }

  template <class Request, class Action>
  ordered_json act(const Request& x, instant happens, Action action) const {
    if (of_.actions_.size() >= actions_max)
      return refused("the run has had " + std::to_string(actions_max) + " actions");
    if (const auto why = action(); !why.empty())
      return refused(why);
    of_.actions_.push_back({of_.now_, x, happens});
    return done();
  }

  void add_news(ordered_json& out) const {
    if (of_.wants_events_) {
      auto& events = out["events"] = ordered_json::array();
      for (const auto& x : of_.events_)
        events.push_back({in_seconds(x.at), x.who, x.what});
    }
    if (!of_.patterns_.empty()) {
      auto& tuples = out["tuples"] = ordered_json::array();
      for (const auto& x : of_.tuples_)
        tuples.push_back(
            {in_seconds(x.at), x.owner, x.key, x.deleted ? ordered_json() : ordered_json(x.value)});
    }
    if (of_.missed_ > 0)
      out["missed"] = std::exchange(of_.missed_, 0);
    of_.events_.clear();
    of_.tuples_.clear();
  }

  session& of_;
};

std::string session::greeting() const {
  ordered_json motes = ordered_json::array();
  for (const auto& [address, name] : facts_.motes)
    motes.push_back(name);
  return json_line(ordered_json{{"rubicon", 1},
                                {"ecology", facts_.name},
                                {"seed", facts_.seed},
                                {"length", seconds(facts_.length)},
                                {"peers", facts_.peers},
                                {"motes", motes}});
}

std::string session::on_line(std::string_view line) {
  const auto read = read_line(line);
  if (const auto* why = std::get_if<std::string>(&read))
    return json_line(refused(*why));
  const auto& [is_batch, requests] = std::get<request_line>(read);
  ordered_json answers = ordered_json::array();
  for (const auto& each : requests) {
    const auto* x = std::get_if<request>(&each);
    answers.push_back(finished_      ? refused("the run is finished")
                      : x == nullptr ? refused(std::get<std::string>(each))
                                     : std::visit(answerer(*this), *x));
  }
  return json_line(is_batch ? answers : answers[0]);
}

void session::on_event(const report::logged_event& x) {
  if (!wants_events_)
    return;
  events_.push_back(x);
  if (events_.size() > news_max) {
    events_.pop_front();
    ++missed_;
  }
}

void session::on_tuple(const report::tuple_write& x) {
  const auto key = peis::key::parse(x.key);
  const auto fits = [&](const tuples_request& wanted) {
    return (wanted.owner.empty() || wanted.owner == x.owner) && wanted.pattern.matches(*key);
  };
  if (!key || std::ranges::none_of(patterns_, fits))
    return;
  tuples_.push_back(x);
  if (tuples_.size() > news_max) {
    tuples_.pop_front();
    ++missed_;
  }
}

std::string session::lines() const {
  std::string out;
  instant at;
  for (const auto& each : actions_) {
    if (each.at > at)
      out += json_line(ordered_json{{"do", "step"}, {"until", in_seconds(each.at)}}) + '\n';
    at = each.at;
    out += json_line(line_of(each.what)) + '\n';
  }
  return out;
}

std::string session::tables() const {
  std::string out;
  for (const auto& each : actions_) {
    const auto at = file_time(each.happens);
    if (const auto* fault = std::get_if<fault_request>(&each.what))
      out += run_.table(fault->words, at);
    else // no comment has control characters
      out += "\n# " + at + ": no file plans " + ascii_json_line(line_of(each.what)) + '\n';
  }
  return out;
}

} // namespace rubicon::steering
