#include "view/conversation.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"

namespace rubicon::view {

namespace {

using json = nlohmann::ordered_json;

constexpr std::size_t messages_listed_max = 1000;
constexpr std::size_t frames_listed_max = 500;
constexpr std::size_t points_max = 400;  ///< of a curve
constexpr std::size_t newest_tuples = 8; ///< of a peer

/// What a mote is shown as; numbers of docs/view.md.
enum class mote_state : int { absent, joined, asleep, lost, off, flat };

/// A question that nobody can answer, and why.
struct refusal {
  std::string why;
};

double in_seconds(instant x) {
  return seconds(x.time_since_epoch());
}

instant instant_of(double x) {
  constexpr double most = 1e9; // 30 years
  return instant(std::chrono::duration_cast<duration>(
      std::chrono::duration<double>(std::clamp(x, 0.0, most))));
}

json rounded(double x) {
  return std::isfinite(x) ? json(std::round(x * 1e6) / 1e6) : json();
}
json rounded(const std::optional<double>& x) {
  return x ? rounded(*x) : json();
}

mote_state state_of(const report::mote_sample& x, bool is_mac) {
  if (!x.alive)
    return x.flat ? mote_state::flat : mote_state::off;
  if (!x.joined || (x.parent == mote_id{} && !is_mac))
    return mote_state::lost;
  return x.radio_on ? mote_state::joined : mote_state::asleep;
}

/// Hours until its battery is flat, if it goes on as it has done.
json hours_left(const report::mote_sample& x, instant now) {
  const auto hours = in_seconds(now) / 3600;
  if (!std::isfinite(x.battery_mah) || x.used_mah <= 0 || hours <= 0)
    return {};
  return std::round(std::max(0.0, x.battery_mah - x.used_mah) / x.used_mah * hours * 10) / 10;
}

const report::mote_sample* find(const report::run_sample& all, mote_address x) {
  const auto found = std::ranges::lower_bound(all.motes, x, {}, &report::mote_sample::address);
  return found != all.motes.end() && found->address == x ? &*found : nullptr;
}

/// What all islands have lost so far, by `layer/cause`.
std::map<std::string, std::uint64_t> losses_of(const report::run_sample& x) {
  std::map<std::string, std::uint64_t> all;
  for (const auto& island : x.islands)
    for (const auto& [layer, causes] : island.lost)
      for (const auto& [cause, count] : causes)
        all[layer + '/' + cause] += count;
  return all;
}

json event_json(const listed_event& x) {
  return json::array({in_seconds(x.at), x.who, x.what, x.kind});
}

/// Every n-th of many; the last stays.
template <class T>
std::vector<T> thinned(const std::vector<T>& all) {
  if (all.size() <= points_max)
    return all;
  std::vector<T> some;
  const auto step = (all.size() + points_max - 1) / points_max;
  for (std::size_t i = 0; i < all.size(); i += step)
    some.push_back(all[i]);
  if ((all.size() - 1) % step != 0)
    some.push_back(all.back());
  return some;
}

double number(const json& from, const char* key) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_number())
    throw refusal{"`" + std::string(key) + "` is missing or not a number"};
  return found->get<double>();
}

std::string text(const json& from, const char* key) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_string())
    throw refusal{"`" + std::string(key) + "` is missing or not a text"};
  return found->get<std::string>();
}

/// `1/5`
mote_address address_of(const std::string& x) {
  std::uint32_t island = 0;
  std::uint16_t mote = 0;
  const auto* const end = x.data() + x.size();
  const auto first = std::from_chars(x.data(), end, island);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != '/')
    throw refusal{"`" + x + "` is not ISLAND/MOTE"};
  const auto second = std::from_chars(first.ptr + 1, end, mote);
  if (second.ec != std::errc{} || second.ptr != end)
    throw refusal{"`" + x + "` is not ISLAND/MOTE"};
  return {island_id(island), mote_id(mote)};
}

} // namespace

/// The answers, each made of what the timeline has at that time.
class conversation::answerer {
public:
  explicit answerer(const conversation& x) : x_(x), all_(*x.all_) {}

  json answer(const json& question) {
    using function = json (answerer::*)(const json&);
    static constexpr std::array<std::pair<std::string_view, function>, 12> answers{{
        {"moment", &answerer::moment},
        {"events", &answerer::events},
        {"series", &answerer::series},
        {"tuples", &answerer::tuples},
        {"curve", &answerer::curve},
        {"mote", &answerer::mote},
        {"peer", &answerer::peer},
        {"messages", &answerer::messages},
        {"explain", &answerer::explain_message},
        {"explain_tuple", &answerer::explain_tuple},
        {"frames", &answerer::frames},
        {"next_event", &answerer::next_event},
    }};
    const auto asked = text(question, "ask");
    for (const auto& [name, give] : answers)
      if (name == asked)
        return (this->*give)(question);
    if (asked == "fault" || asked == "set")
      return control(asked, question);
    throw refusal{"`" + asked + "` is not a known request"};
  }

  json moment_of(const timeline::sample& sample, double at_s) {
    json y = {{"kind", "moment"}, {"at_s", at_s}};
    y["sample_s"] = sample == nullptr ? json() : json(in_seconds(sample->at));
    auto& columns = y["motes"];
    for (const auto* name :
         {"state", "parent", "hops", "etx", "signal", "used_mah", "hours", "delivery", "queue"})
      columns[name] = json::array();
    const report::mote_sample absent;
    for (const auto& each : x_.about_->motes) {
      const auto* const found = sample == nullptr ? nullptr : find(*sample, each.address);
      const auto& mote = found == nullptr ? absent : *found;
      const auto state = found == nullptr ? mote_state::absent : state_of(mote, each.is_mac);
      columns["state"].push_back(static_cast<int>(state));
      columns["parent"].push_back(mote.parent.value);
      columns["hops"].push_back(mote.hops);
      columns["etx"].push_back(rounded(mote.etx));
      columns["signal"].push_back(mote.signal_dbm ? json(*mote.signal_dbm) : json());
      columns["used_mah"].push_back(rounded(mote.used_mah));
      columns["hours"].push_back(found == nullptr ? json() : hours_left(mote, sample->at));
      columns["delivery"].push_back(rounded(mote.delivery));
      columns["queue"].push_back(mote.queued);
    }
    y["lost"] = sample == nullptr ? json::object() : json(losses_of(*sample));
    return y;
  }

private:
  json moment(const json& question) {
    const auto at_s = number(question, "at_s");
    return moment_of(all_.at(instant_of(at_s)), at_s);
  }

  json events(const json& /*question*/) {
    json y = {{"kind", "events"}, {"events", json::array()}};
    for (const auto& each : all_.events_from(0).events)
      y["events"].push_back(event_json(each));
    return y;
  }

  json next_event(const json& question) {
    const auto next = all_.event_after(instant_of(number(question, "after_s")));
    return {{"kind", "next_event"}, {"event", next ? event_json(*next) : json()}};
  }

  json series(const json& /*question*/) {
    json y = {{"kind", "series"}, {"times", json::array()}, {"lost", json::object()}};
    auto used = json::array();
    std::map<std::string, std::vector<std::uint64_t>> lost;
    std::size_t count = 0;
    for (const auto& sample : all_.all_samples()) {
      y["times"].push_back(in_seconds(sample->at));
      double sum = 0;
      for (const auto& mote : sample->motes)
        sum += mote.used_mah;
      used.push_back(rounded(sum));
      for (auto& [cause, all] : lost)
        all.push_back(0);
      ++count;
      for (const auto& [cause, so_far] : losses_of(*sample)) {
        auto& all = lost[cause];
        all.resize(count);
        all.back() = so_far;
      }
    }
    for (auto& [cause, all] : lost)
      y["lost"][cause] = all;
    y["used_mah"] = std::move(used);
    return y;
  }

  json tuples(const json& question) {
    const auto at_s = number(question, "at_s");
    const auto then = all_.tuples_at(instant_of(at_s));
    json y = {{"kind", "tuples"}, {"at_s", at_s}, {"tuples", json::array()}};
    for (const auto& [key, value] : then.tuples)
      y["tuples"].push_back(
          json::array({key.first, key.second, value.value, in_seconds(value.since)}));
    y["left_out"] = then.left_out;
    return y;
  }

  json curve(const json& question) {
    const auto owner = text(question, "owner");
    const auto key = text(question, "key");
    json y = {{"kind", "curve"}, {"owner", owner}, {"key", key}, {"points", json::array()}};
    std::vector<std::pair<instant, double>> points;
    for (const auto& each : all_.values_of({owner, key}))
      if (const auto value = report::number_of(each.value); value && !each.deleted)
        points.emplace_back(each.since, *value);
    for (const auto& [at, value] : thinned(points))
      y["points"].push_back(json::array({in_seconds(at), rounded(value)}));
    return y;
  }

  json mote(const json& question) {
    const auto asked = text(question, "address");
    const auto address = address_of(asked);
    const auto known = x_.about_->index.find(address);
    if (known == x_.about_->index.end())
      throw refusal{"there is no mote " + asked};
    const auto& about = x_.about_->motes[known->second];
    json y = {{"kind", "mote"}, {"address", asked}, {"name", about.name}};
    const auto sample = all_.at(instant_of(number(question, "at_s")));
    const auto* const found = sample == nullptr ? nullptr : find(*sample, address);
    y["facts"] = json::array();
    y["neighbours"] = json::array();
    y["used"] = json::array();
    if (!about.type.empty())
      y["facts"].push_back(json::array({"type", about.type}));
    y["facts"].push_back(json::array({"address", asked}));
    if (found != nullptr)
      add_present(y, *found, about, sample->at);
    std::vector<std::pair<instant, double>> used;
    for (const auto& each : all_.all_samples())
      if (const auto* then = find(*each, address))
        used.emplace_back(each->at, then->used_mah);
    for (const auto& [at, mah] : thinned(used))
      y["used"].push_back(json::array({in_seconds(at), rounded(mah)}));
    return y;
  }

  void add_present(json& y, const report::mote_sample& mote, const mote_index& about, instant now) {
    static constexpr std::array words{"not yet present", "joined",   "joined, radio off",
                                      "no route",        "no power", "battery flat"};
    const auto fact = [&y](const char* name, const std::string& value) {
      y["facts"].push_back(json::array({name, value}));
    };
    const auto island = mote.address.island;
    fact("state", words[static_cast<std::size_t>(state_of(mote, about.is_mac))]);
    if (mote.parent != mote_id{}) {
      fact("parent", name_of({island, mote.parent}));
      fact("hops to the sink", std::to_string(mote.hops));
    }
    if (mote.signal_dbm)
      fact("signal of its parent", std::to_string(*mote.signal_dbm) + " dBm");
    if (!about.is_mac) {
      fact("packets waiting", std::to_string(mote.queued));
      fact("own packets sent", std::to_string(mote.originated));
      fact("packets forwarded", std::to_string(mote.forwarded));
    }
    if (mote.delivery)
      fact("reliable messages acknowledged",
           std::to_string(std::lround(*mote.delivery * 100)) + " %");
    if (const auto hours = hours_left(mote, now); !hours.is_null())
      fact("battery left", std::to_string(std::lround(hours.get<double>())) + " h");
    for (const auto& each : mote.neighbours)
      y["neighbours"].push_back(json::array({name_of({island, each.mote}), rounded(each.etx)}));
    const auto packets = mote.originated + mote.forwarded;
    y["energy"] = {
        {"radio", json::array({json::array({"listening", rounded(mote.energy.radio_listen)}),
                               json::array({"receiving", rounded(mote.energy.radio_receive)}),
                               json::array({"sending", rounded(mote.energy.radio_transmit)}),
                               json::array({"off", rounded(mote.energy.radio_off)})})},
        {"processor", rounded(mote.energy.processor)},
        {"forwarded_share", packets == 0 ? json()
                                         : rounded(static_cast<double>(mote.forwarded) /
                                                   static_cast<double>(packets))}};
  }

  json peer(const json& question) {
    const auto name = text(question, "name");
    const auto at = instant_of(number(question, "at_s"));
    json y = {{"kind", "peer"}, {"name", name}, {"facts", json::array()}};
    y["links"] = json::array();
    if (const auto sample = all_.at(at)) {
      const auto found =
          std::ranges::lower_bound(sample->peers, name, {}, &report::peer_sample::name);
      if (found != sample->peers.end() && found->name == name)
        add_present(y, *found);
    }
    auto own = all_.tuples_at(at).tuples;
    std::erase_if(own, [&name](const auto& each) { return each.first.first != name; });
    y["tuples"] = own.size();
    std::ranges::stable_sort(own, std::greater(),
                             [](const auto& each) { return each.second.since; });
    own.resize(std::min(own.size(), newest_tuples));
    y["newest"] = json::array();
    for (const auto& [key, value] : own)
      y["newest"].push_back(json::array({key.second, value.value}));
    return y;
  }

  void add_present(json& y, const report::peer_sample& peer) {
    std::uint64_t queued = 0;
    for (const auto& each : peer.links) {
      queued += each.queued;
      const auto known = x_.about_->peers.find(each.to);
      y["links"].push_back(json::array(
          {known == x_.about_->peers.end() ? to_string(each.to) : known->second, each.queued}));
    }
    const auto fact = [&y](const char* name, const std::string& value) {
      y["facts"].push_back(json::array({name, value}));
    };
    fact("state", peer.runs ? "runs" : "not running");
    fact("packages waiting", std::to_string(queued));
    if (peer.to_sink)
      fact("packets waiting for the cable", std::to_string(*peer.to_sink));
  }

  [[nodiscard]] std::string name_of(mote_address x) const {
    const auto found = x_.about_->index.find(x);
    return found == x_.about_->index.end() ? "sink" : x_.about_->motes[found->second].name;
  }

  json messages(const json& question) {
    const auto list = all_.messages();
    json y = {{"kind", "messages"}, {"ready", list != nullptr}};
    y["why"] = all_.why_no_messages();
    y["messages"] = json::array();
    y["total"] = 0;
    if (list == nullptr)
      return y;
    add_time(y, *list);
    const bool lost_only = question.value("lost", false);
    const auto limit = static_cast<std::size_t>(
        std::clamp(question.value("limit", 200.0), 0.0, static_cast<double>(messages_listed_max)));
    std::optional<mote_address> of;
    if (question.contains("of"))
      of = whom(text(question, "of"), *list);
    std::vector<const listed_message*> found;
    for (const auto& each : list->messages())
      if ((!lost_only || each.kind == "lost") &&
          (!of || each.source == *of || each.destination == *of))
        found.push_back(&each);
    y["total"] = found.size();
    std::ranges::reverse(found); // the newest first
    std::ranges::stable_sort(found, {}, &rank_of);
    if (found.size() > limit)
      found.resize(limit);
    for (const auto* each : found)
      y["messages"].push_back({{"name", each->name},
                               {"from", each->from},
                               {"to", each->to},
                               {"sent_s", in_seconds(each->sent)},
                               {"ended_s", each->ended ? json(in_seconds(*each->ended)) : json()},
                               {"outcome", each->outcome},
                               {"class", each->kind}});
    return y;
  }

  /// An address, or a peer: gateways send and get as the PC of their island.
  static mote_address whom(const std::string& x, const message_list& list) {
    const auto& known = list.traces().known;
    const auto peer = known.peer_of(explain::names::kernel_path(x));
    if (!peer)
      return address_of(x);
    return {island_id(static_cast<std::uint32_t>(known.speaks_for(*peer).value)), no_mote};
  }

  /// Those come first that somebody may have to do something about.
  static int rank_of(const listed_message* x) {
    return x->kind == "lost" ? 0 : x->kind == "open" ? 1 : 2;
  }

  /// Up to when the record has been read; null: to its end.
  static void add_time(json& to, const message_list& from) {
    to["as_of_s"] = from.is_whole() ? json() : json(in_seconds(from.traces().end));
  }

  [[nodiscard]] std::shared_ptr<const message_list> recorded() const {
    auto list = all_.messages();
    if (list == nullptr)
      throw refusal{all_.why_no_messages()};
    return list;
  }

  json explain_message(const json& question) {
    const auto name = text(question, "message");
    const auto list = recorded();
    return explained(name, list->explain_message(name), *list);
  }

  json explain_tuple(const json& question) {
    const auto key = text(question, "key");
    const auto list = recorded();
    return explained(
        key,
        list->explain_tuple(text(question, "owner"), key, instant_of(number(question, "at_s"))),
        *list);
  }

  static json explained(const std::string& what, const std::string& how, const message_list& from) {
    json y = {{"kind", "explain"}, {"message", what}, {"text", how}};
    add_time(y, from);
    return y;
  }

  json frames(const json& question) {
    const auto list = recorded();
    const auto from = instant_of(number(question, "from_s"));
    const auto to = instant_of(number(question, "to_s"));
    const auto address = [&list](const std::string& path) {
      const auto found = list->traces().known.address_of(path);
      return found ? std::to_string(found->island.value) + '/' + std::to_string(found->mote.value)
                   : std::string();
    };
    json y = {{"kind", "frames"}, {"frames", json::array()}};
    add_time(y, *list);
    const auto& all = list->frames();
    for (auto each = std::ranges::lower_bound(all, from, {}, &listed_frame::begin);
         each != all.end() && each->begin <= to && y["frames"].size() < frames_listed_max; ++each)
      y["frames"].push_back(json::array({in_seconds(each->begin), seconds(each->length),
                                         address(each->from), address(each->to), each->received}));
    return y;
  }

  json control(const std::string& asked, const json& question) {
    if (x_.controls_ == nullptr)
      throw refusal{"this page is read-only; `--control` enables actions"};
    const auto done = asked == "fault"
                          ? x_.controls_->fault(text(question, "sentence"))
                          : x_.controls_->set_tuple(text(question, "owner"), text(question, "key"),
                                                    text(question, "value"));
    return {{"kind", "done"}, {"ok", done.ok}, {"text", done.text}};
  }

  const conversation& x_;
  const timeline& all_;
};

introduction introduction_of(std::string facts) {
  introduction x{std::move(facts), {}, {}, {}};
  const auto ecology = try_parse_ordered_json(x.facts);
  if (!ecology.is_object())
    return x;
  try {
    for (const auto& island : ecology.at("islands")) {
      const island_id id(island.at("id").get<std::uint32_t>());
      const auto name = island.at("name").get<std::string>();
      for (const auto& mote : island.at("motes")) {
        const mote_address address{id, mote_id(mote.at(0).get<std::uint16_t>())};
        x.index[address] = x.motes.size();
        x.motes.push_back({address, name + '/' + mote.at(1).get<std::string>(),
                           mote.at(4).get<std::string>(), island.value("mac", false)});
      }
    }
    for (const auto& peer : ecology.value("peers", json::array()))
      x.peers[peer_id(peer.at("id").get<std::int32_t>())] = peer.at("name").get<std::string>();
  } catch (const json::exception&) {
    x.motes.clear(); // of a record that somebody has written by hand
    x.index.clear();
    x.peers.clear();
  }
  return x;
}

conversation::conversation(std::shared_ptr<const timeline> all,
                           std::shared_ptr<const introduction> about,
                           std::shared_ptr<const controls> controls)
    : all_(std::move(all)), about_(std::move(about)), controls_(std::move(controls)) {}

std::string conversation::on_text(std::string_view text_in) {
  const auto question = try_parse_ordered_json(text_in);
  json reply;
  try {
    if (!question.is_object())
      throw refusal{"a request must be a JSON object"};
    if (text(question, "ask") == "follow") {
      follows_ = question.value("on", true);
      samples_sent_ = 0;
      reply = {{"kind", "done"}, {"ok", true}, {"text", ""}};
    } else {
      reply = answerer(*this).answer(question);
    }
  } catch (const refusal& x) {
    reply = {{"kind", "refused"}, {"text", x.why}};
  } catch (const json::exception& x) {
    reply = {{"kind", "refused"}, {"text", "the request is malformed"}};
  }
  if (question.is_object() && question.contains("id") && question["id"].is_number())
    reply["id"] = question["id"];
  return json_line(reply);
}

std::optional<std::string> conversation::news() {
  if (!introduced_) {
    introduced_ = true;
    return about_->facts;
  }
  const auto state = all_->state();
  const auto events = all_->events();
  const bool is_new = !has_sent_state_ || state.now != state_sent_.now ||
                      state.running != state_sent_.running || events != events_sent_;
  const bool has_moment = follows_ && all_->samples() != samples_sent_;
  if (is_new && !(has_moment && last_was_state_)) { // in turns
    json y = {{"kind", "state"},
              {"now_s", in_seconds(state.now)},
              {"end_s", in_seconds(state.end)},
              {"running", state.running},
              {"events", state.events},
              {"speed", rounded(state.speed)},
              {"samples", all_->samples()},
              {"new_events", json::array()}};
    const auto fresh = all_->events_from(events_sent_);
    for (const auto& each : fresh.events)
      y["new_events"].push_back(event_json(each));
    state_sent_ = state;
    events_sent_ = fresh.next;
    has_sent_state_ = true;
    last_was_state_ = true;
    return json_line(y);
  }
  if (!has_moment)
    return std::nullopt;
  last_was_state_ = false;
  samples_sent_ = all_->samples();
  const auto newest = all_->newest();
  if (newest == nullptr)
    return std::nullopt;
  return json_line(answerer(*this).moment_of(newest, in_seconds(newest->at)));
}

} // namespace rubicon::view
