#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/checks/warnings.hpp"

namespace rubicon::config {

namespace {

/// Who writes to and reads from each stream of a file, in any of the programs that its nodes may
/// have while it runs.
class stream_warnings {
public:
  stream_warnings(const ecology_description& all, const file_places& seen, warning_list& out)
      : all_(all), seen_(seen), out_(out) {
    for (const auto& each : all.faults)
      follow(each.what);
    for (const auto& island : all.islands) {
      const mote_address gateway{island.id, no_mote};
      names_[gateway] = island.gateway_name;
      for (const auto& app : island.gateway_apps)
        add(gateway, app);
      for (const auto& mote : island.motes)
        add({island.id, mote.id}, island.name + '/' + mote.name, mote);
      if (island.outside.has_sink())
        unknown_islands_.insert(island.id);
    }
    for (const auto& peer : all.peers)
      add(peer);
  }

  void look() {
    for (const auto& [of, writers] : writers_)
      look_at_writers(of, writers);
    for (const auto& [of, at] : readers_)
      if (!writers_.contains(of) && !may_be_written(of.first))
        out_.emplace_back(at, name_of(of.first) + " reads stream " + std::to_string(of.second) +
                                  ", which no program writes to it");
  }

private:
  using stream = std::pair<mote_address, std::uint16_t>; ///< node of the read end, number

  /// Motes that are others later on: who reads or writes with them may do so in turns.
  void follow(const fault& what) {
    if (const auto* crash = std::get_if<crash_fault>(&what); crash != nullptr && crash->becomes)
      later_.emplace(crash->mote, &*crash->becomes);
    else if (const auto* move = std::get_if<move_island_fault>(&what))
      moved_.emplace(move->mote, mote_address{move->to, move->mote.mote});
    else if (const auto* flat = std::get_if<battery_end_fault>(&what))
      flat_.insert(flat->mote);
  }

  void add(mote_address who, const std::string& name, const mote_description& mote) {
    names_[who] = name;
    add_apps(who, mote);
    for (auto [x, end] = later_.equal_range(who); x != end; ++x)
      add_apps(who, *x->second);
  }

  void add_apps(mote_address who, const mote_description& mote) {
    for (const auto& app : mote.apps) {
      if (const auto* separate = std::get_if<separate_app>(&app))
        add(who, separate->program);
      else if (const auto* program = std::get_if<apps::app_config>(&app))
        add(who, *program);
    }
  }

  void add(const peer_description& peer) {
    const mote_address who{island_id(static_cast<std::uint32_t>(peer.id.value)), no_mote};
    names_[who] = peer.name;
    for (const auto& app : peer.apps) {
      if (const auto* program = std::get_if<apps::app_config>(&app))
        add(who, *program);
      else if (std::holds_alternative<proxy_manager_app>(app))
        for (const auto& what : all_.proxies)
          for (const auto& field : what.fields)
            if (field.stream)
              also_read_.emplace(who, field.stream->number);
    }
  }

  void add(mote_address who, const apps::app_config& app) {
    if (const auto* writer = std::get_if<apps::stream_writer_config>(&app)) {
      writers_[{writer->to, writer->stream}].insert(who);
    } else if (const auto* reader = std::get_if<apps::stream_reader_config>(&app)) {
      add_reader(who, reader->stream);
    } else if (const auto* average = std::get_if<apps::average_config>(&app)) {
      for (const auto& output : average->outputs)
        writers_[{output.to, output.stream}].insert(who);
      for (const auto number : average->streams)
        add_reader(who, number);
    } else if (const auto* on_off = std::get_if<apps::stream_switch_config>(&app)) {
      add_reader(who, on_off->stream);
    } else if (const auto* recorder = std::get_if<apps::recorder_config>(&app)) {
      for (const auto number : recorder->streams)
        add_reader(who, number);
    } else if (std::holds_alternative<apps::custom_config>(app)) {
      custom_.insert(who);
    }
  }

  void add_reader(mote_address who, std::uint16_t number) {
    readers_.emplace(stream{who, number}, place_of(who));
    for (auto [x, end] = moved_.equal_range(who); x != end; ++x)
      also_read_.emplace(x->second, number); // it reads there, too, if somebody writes to it
  }

  void look_at_writers(const stream& of, const std::set<mote_address>& writers) {
    const auto& [to, number] = of;
    const auto first = *writers.begin();
    const auto what = " stream " + std::to_string(number) + " to ";
    if (writers.contains(to))
      out_.emplace_back(place_of(to), name_of(to) + " writes" + what +
                                          "itself: it needs another node to read it");
    else if (!readers_.contains(of) && !also_read_.contains(of) && !custom_.contains(to) &&
             !unknown_islands_.contains(to.island))
      out_.emplace_back(place_of(first), name_of(first) + " writes" + what + name_of(to) +
                                             ", where no program reads it");
    std::vector<mote_address> at_once;
    std::ranges::copy_if(writers, std::back_inserter(at_once), [this](mote_address x) {
      return !later_.contains(x) && !moved_.contains(x) && !flat_.contains(x);
    });
    if (at_once.size() < 2)
      return;
    const auto others = at_once.size() - 2;
    out_.emplace_back(place_of(at_once[1]),
                      name_of(at_once[0]) + (others > 0 ? ", " : " and ") + name_of(at_once[1]) +
                          (others > 0 ? " and " + std::to_string(others) + " more" : "") +
                          " write" + what + name_of(to) +
                          ", which reads one of a number: each needs a `stream`" + " of its own");
  }

  /// Programs of other languages may write to any node.
  [[nodiscard]] bool may_be_written(mote_address reader) const {
    return !custom_.empty() || !unknown_islands_.empty() || strangers_may_come(all_) ||
           moved_.contains(reader);
  }

  [[nodiscard]] std::string name_of(mote_address x) const {
    const auto found = names_.find(x);
    return found == names_.end() ? to_string(x) : found->second;
  }
  [[nodiscard]] mark place_of(mote_address x) const {
    const auto found = seen_.motes.find(x);
    return found == seen_.motes.end() ? mark() : found->second.at;
  }

  const ecology_description& all_;
  const file_places& seen_;
  warning_list& out_;
  std::map<mote_address, std::string> names_;
  std::map<stream, std::set<mote_address>> writers_;
  std::map<stream, mark> readers_;
  std::set<stream> also_read_;    ///< if they are written: by proxies, by motes that moved
  std::set<mote_address> custom_; ///< nodes with programs of which no more is known
  std::set<island_id> unknown_islands_;
  std::multimap<mote_address, const mote_description*> later_;
  std::multimap<mote_address, mote_address> moved_;
  std::set<mote_address> flat_;
};

} // namespace

void warn_of_streams(const ecology_description& x, const file_places& seen, warning_list& out) {
  stream_warnings(x, seen, out).look();
}

} // namespace rubicon::config
