#include "cli/run/steered_run.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "actors/peis/peis_peer.hpp"
#include "actors/run/ecology_run.hpp"
#include "actors/run/look.hpp"
#include "actors/run/mote_messages.hpp"
#include "actors/supervision/ecology.hpp"
#include "cli/print/console.hpp"
#include "cli/print/report_output.hpp"
#include "config/plan/directory.hpp"
#include "core/hash.hpp"
#include "core/text/printable.hpp"
#include "deploy/bundle.hpp"
#include "deploy/fault_sentence.hpp"
#include "io/process/line_socket.hpp"
#include "steering/session.hpp"

namespace rubicon::cli {

namespace {

template <class State, class Handle>
State& state_of(const Handle& x) {
  return static_cast<scheduler::shell<State, typename Handle::interface>&>(x.get()).state;
}

steering::run_facts facts_of(const run_command& x, const config::ecology_description& ecology) {
  steering::run_facts facts{.name = ecology.name,
                            .seed = x.options.seed.value_or(ecology.seed),
                            .length = x.options.length.value_or(ecology.length),
                            .peers = {},
                            .motes = {}};
  for (const auto& island : ecology.islands) {
    if (!island.gateway_name.empty())
      facts.peers.push_back(island.gateway_name);
    for (const auto& mote : island.motes)
      facts.motes.emplace(mote_address{island.id, mote.id}, island.name + '/' + mote.name);
  }
  for (const auto& peer : ecology.peers)
    facts.peers.push_back(peer.name);
  return facts;
}

/// Who may send and be sent messages, by name: motes `kitchen/fan`, and peers that motes address.
std::map<std::string, mote_address> ends_of(const config::ecology_description& ecology) {
  const config::directory names(ecology);
  std::map<std::string, mote_address> ends;
  for (const auto& [island, x] : names.islands)
    for (const auto& [mote, id] : x.motes)
      ends.emplace(island + '/' + mote, mote_address{x.id, id});
  for (const auto& [peer, id] : names.ends)
    if (id.value <= static_cast<std::int32_t>(island_id_max))
      ends.emplace(peer, mote_address{island_id(static_cast<std::uint32_t>(id.value)), no_mote});
  return ends;
}

/// The run, its session, and what is between the two.
class steered_run {
public:
  steered_run(const run_command& x, ecology_file file, const io::line_socket* other)
      : known_(x.known), packed_(deploy::pack(x.file, x.instead, x.options.length, x.known).what),
        labels_(file.ecology.labels), varied_(file.varied), ends_(ends_of(file.ecology)),
        session_(facts_of(x, file.ecology), ports()) {
    auto options = x.options;
    options.source = {x.file, to_hex(file.text_hash), x.deciding};
    options.handle_signals = false; // it waits for requests most of the time
    options.on_event = [this](const report::logged_event& each) { session_.on_event(each); };
    options.on_tuple = [this](const report::tuple_write& each) { session_.on_tuple(each); };
    options.on_begun = [this](const run_control& control) { control_.emplace(control); };
    options.progress = [this, other](const run_progress&) {
      if (other != nullptr && other->is_closed())
        control_->stop();
    };
    run_.emplace(std::move(file.ecology), std::move(options));
    run_->run_until(instant{}); // before, no actor runs that could answer
  }

  steering::session& session() { return session_; }

  /// Runs it to its end, unless that was requested.
  report::run_report finish() {
    if (!report_)
      report_ = run_->finish();
    return *report_;
  }

  [[nodiscard]] const config::label_table& labels() const { return labels_; }
  [[nodiscard]] const config::variation& varied() const { return varied_; }

private:
  steering::run_ports ports() {
    return {.run_until =
                [this](instant until) {
                  run_->run_until(until);
                  return run_->world().now();
                },
            .tuple = [this](const steering::get_request& x) { return tuple(x); },
            .set_tuple =
                [this](const steering::set_request& x) {
                  return control_->set_tuple(x.peer, x.key, x.value)
                             ? std::string()
                             : "peer `" + x.peer + "` does not run";
                },
            .fault = [this](const std::string& words, instant at) { return plan(words, at); },
            .send = [this](const steering::send_request& x,
                           std::uint32_t number) { return send(x, number); },
            .table = [](const std::string& words,
                        const std::string& at) { return deploy::table_of(words, at); },
            .look = [this] { return look_at(state_of<ecology_state>(run_->root()), now()); },
            .report = [this] { return to_json(run_->report_so_far(), labels_, varied_); },
            .finish = [this] { return to_json(finish(), labels_, varied_); }};
  }

  [[nodiscard]] instant now() { return run_->world().now(); }

  std::optional<std::string> tuple(const steering::get_request& x) {
    const auto& peers = state_of<ecology_state>(run_->root()).peers;
    const auto reader = peers.find(x.peer);
    const auto owner = peers.find(x.owner.empty() ? x.peer : x.owner);
    if (reader == peers.end() || owner == peers.end() || !reader->second.handle)
      return std::nullopt;
    const auto& kernel = state_of<peis_peer_state>(reader->second.handle).kernel;
    const auto found = kernel.reader().find(owner->second.id, x.key);
    return found ? std::optional(std::string(found->text())) : std::nullopt;
  }

  std::string plan(const std::string& words, instant at) {
    const auto found = deploy::fault_of(packed_, words, known_);
    if (const auto* why = std::get_if<std::string>(&found))
      return *why;
    const auto when = at.time_since_epoch();
    run_->plan({.at = when, .what = std::get<config::fault>(found)}, {when});
    return {};
  }

  std::string send(const steering::send_request& x, std::uint32_t number) {
    const auto mote = ends_.find(x.mote);
    if (mote == ends_.end() || mote->second.mote == no_mote)
      return "there is no mote `" + x.mote + '`';
    const auto to = ends_.find(x.to);
    if (to == ends_.end())
      return "no mote, and no peer with an id up to 254, is named `" + x.to + '`';
    return send_as(state_of<ecology_state>(run_->root()), mote->second,
                   {number, to->second, payload(x.octets), x.reliable, x.am_type});
  }

  config::extensions known_;
  deploy::bundle packed_;
  config::label_table labels_;
  config::variation varied_;
  std::map<std::string, mote_address> ends_;
  steering::session session_;
  std::optional<run_control> control_;
  std::optional<report::run_report> report_;
  std::optional<ecology_run> run_;
};

exit_status refuse(const std::string& why) {
  static_cast<void>(print(stderr, printable("--steer: " + why) + '\n'));
  return exit_status::refused;
}

/// Each answer that refuses is printed with the place of its request.
exit_status steer_by_file(const run_command& x, ecology_file file) {
  std::ifstream in(x.steer);
  if (!in)
    return refuse("cannot read " + x.steer);
  steered_run run(x, std::move(file), nullptr);
  std::size_t number = 0;
  for (std::string line; !run.session().is_finished() && std::getline(in, line);) {
    ++number;
    if (line.empty())
      continue;
    const auto answer = run.session().on_line(line);
    if (answer.find("\"ok\":false") != std::string::npos)
      return refuse(x.steer + ':' + std::to_string(number) + ": " + answer);
  }
  return print_report(run.finish(), {x.json, x.full, x.brief}, run.labels(), run.varied());
}

} // namespace

exit_status run_steered(const run_command& x, ecology_file file) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(x.steer, ignored))
    return steer_by_file(x, std::move(file));
  auto opened = io::line_socket::connect(x.steer);
  if (const auto* why = std::get_if<std::string>(&opened))
    return refuse(*why);
  auto& other = std::get<io::line_socket>(opened);
  steered_run run(x, std::move(file), &other);
  if (!other.write(run.session().greeting()))
    return exit_status::interrupted;
  while (!run.session().is_finished()) {
    const auto line = other.read(steering::line_octets_max);
    if (!line || !other.write(run.session().on_line(*line)))
      return exit_status::interrupted; // nobody is left who could see the end
  }
  return print_report(run.finish(), {x.json, x.full, x.brief}, run.labels(), run.varied());
}

} // namespace rubicon::cli
