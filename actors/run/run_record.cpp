#include "actors/run/run_record.hpp"

#include <cerrno>
#include <limits>
#include <stdexcept>
#include <system_error>

#include <spdlog/spdlog.h>

#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/run/delivery_record.hpp"
#include "core/text/printable.hpp"
#include "peis/link/link.hpp"
#include "peis/wire/package.hpp"
#include "radio/raw_frame.hpp"
#include "view/ecology_json.hpp"
#include "view/sample_json.hpp"

namespace rubicon {

namespace {

using explain::kind;
using explain::record;

/// Motes that only the fault plan knows in this island.
void add_planned(explain::island_names& named, const config::ecology_description& ecology,
                 island_id island) {
  const auto name_of = [&](const mote_address& mote) {
    const auto home =
        std::ranges::find(ecology.islands, mote.island, &config::island_description::id);
    const auto found = std::ranges::find(home->motes, mote.mote, &config::mote_description::id);
    return found->name;
  };
  for (const auto& fault : ecology.faults) {
    if (const auto* second = std::get_if<config::mote_double_fault>(&fault.what);
        second != nullptr && second->mote.island == island)
      named.doubles[name_of(second->mote) + "-double"] = second->mote.mote.value;
    if (const auto* move = std::get_if<config::move_island_fault>(&fault.what);
        move != nullptr && move->to == island)
      named.motes.try_emplace(move->mote.mote.value, name_of(move->mote));
  }
}

/// By the names that explanations have.
void add_labels(explain::header& x, const config::ecology_description& ecology) {
  using label_kind = config::label_table::kind;
  const auto add = [&](label_kind what, const std::string& name) {
    if (auto label = ecology.labels.of(what, name); !label.empty())
      x.labels[name] = std::move(label);
  };
  for (const auto& peer : ecology.peers)
    add(label_kind::peer, peer.name);
  for (const auto& island : ecology.islands) {
    add(label_kind::island, island.name);
    for (const auto& mote : island.motes)
      add(label_kind::mote, island.name + '/' + mote.name);
    for (const auto& [id, name] : island.real.names)
      add(label_kind::mote, island.name + '/' + name);
    add(label_kind::peer, island.gateway_name);
    for (const auto& alias : island.aliases)
      add(label_kind::peer, alias.name);
  }
}

explain::header header_of(const config::ecology_description& ecology, const run_source& source) {
  explain::header x;
  x.ecology = ecology.name;
  x.seed = ecology.seed;
  x.file = source.file;
  x.digest = source.digest;
  x.options = source.options;
  x.length = ecology.length;
  x.wall = ecology.mode == config::run_mode::wall;
  for (const auto& island : ecology.islands) {
    explain::island_names named;
    named.id = island.id.value;
    named.name = island.name;
    named.sink = island.sink.id.value;
    named.gateway = island.gateway_name;
    for (const auto& mote : island.motes)
      named.motes[mote.id.value] = mote.name;
    for (const auto& alias : island.aliases) {
      named.aliases.push_back(alias.name);
      x.peers[alias.id.value] = alias.name;
    }
    add_planned(named, ecology, island.id);
    x.islands.push_back(std::move(named));
    x.peers[gateway_of(island.id).value] = island.gateway_name;
  }
  for (const auto& peer : ecology.peers)
    x.peers[peer.id.value] = peer.name;
  add_labels(x, ecology);
  return x;
}

} // namespace

run_record::run_record(const std::string& path, const config::ecology_description& ecology,
                       const run_source& source, std::uint64_t octets_max)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc), may_end_(octets_max > 0),
      octets_left_(octets_max > 0 ? octets_max : std::numeric_limits<std::uint64_t>::max()) {
  if (!file_)
    throw std::runtime_error("cannot write record " + path + ": " +
                             std::generic_category().message(errno));
  put(encode(header_of(ecology, source)));
  record r;
  r.what = kind::ecology;
  r.text = view::ecology_json(ecology);
  put(r);
}

void run_record::write(const report::run_sample& x) {
  if (octets_left_ == 0)
    return;
  record r;
  r.what = kind::sample;
  r.time = x.at;
  r.text = view::encode(x);
  put(r);
  flush(); // whoever reads while it is written finds all up to here
}

void run_record::write(const scheduler::delivery& x) {
  if (octets_left_ == 0)
    return;
  if (x.as<timer_expired>() != nullptr)
    return;
  if (const auto* carried = x.as<link_octets>()) {
    record r;
    r.what = kind::link_octets;
    r.time = x.time;
    r.from = x.sender;
    r.to = x.path;
    r.id = carried->link;
    r.unheard = !x.received;
    put_packages(std::move(r), carried->octets.view());
    return;
  }
  record r;
  const bool worth = fill_record(r, x);
  const auto cause = recorded_cause(x.cause);
  if (!worth) {
    if (cause != 0)
      left_out_[x.number] = cause;
    return;
  }
  r.number = x.number;
  r.time = x.time;
  if (r.from.empty())
    r.from = x.sender;
  r.to = x.path;
  r.cause = cause;
  r.unheard = !x.received;
  if (r.what == kind::event)
    last_story_ = r.from + '\t' + r.text;
  put(r);
}

void run_record::write(const message_end& x) {
  if (octets_left_ == 0)
    return;
  record r;
  r.what = kind::message_ended;
  r.time = x.at;
  r.from = x.place;
  r.id = x.number;
  r.yes = x.outcome == message_end::how::arrived;
  if (x.outcome == message_end::how::handed_over)
    r.text = "handed_over";
  else if (!r.yes)
    r.text = to_string(x.cause);
  put(r);
}

/// A delivery that is not in the record stands for its own cause.
std::uint64_t run_record::recorded_cause(std::uint64_t number) const {
  const auto found = left_out_.find(number);
  return found == left_out_.end() ? number : found->second;
}

void run_record::write(const scheduler::remark& x) {
  if (octets_left_ == 0)
    return;
  if (x.what == "event") {
    put_event(x);
    return;
  }
  if (const auto* written = std::any_cast<record>(&x.content)) {
    auto r = *written;
    r.time = x.time;
    r.cause = recorded_cause(x.cause);
    put(r);
    return;
  }
  record r;
  r.what = x.number != 0 ? kind::begun : kind::link_lost;
  r.number = x.number;
  r.time = x.time;
  r.from = x.path;
  r.cause = recorded_cause(x.cause);
  r.id = x.id;
  r.text = x.what;
  if (x.what == "package_sent")
    note_sent(r);
  else if (x.what == "package_received")
    note_received(r);
  else if (r.what == kind::begun)
    put(r);
  else
    put_packages(std::move(r), x.octets);
}

/// Those on real links are never seen to come.
void run_record::note_sent(const record& x) {
  constexpr std::size_t packages_max = 1U << 16U;
  if (sent_.size() >= packages_max)
    sent_.clear();
  sent_[{x.from, x.id}] = {x.number, x.cause};
}

/// What a package causes is caused by its own record.
void run_record::note_received(const record& x) {
  const auto here = arrived_.extract({x.from, x.id});
  left_out_[x.number] = here.empty() ? x.cause : here.mapped();
}

/// Those packages that carry content, each in a record of its own.
/// @param octets of a link, or packages of it that are lost
void run_record::put_packages(record r, byte_view octets) {
  if (const auto request = peis::decode_connect_request(octets);
      request && request->version == peis::protocol_version)
    octets = octets.subspan(peis::connect_request_size);
  for (auto header = peis::decode_header(octets); header; header = peis::decode_header(octets)) {
    const auto size = peis::header_size + header->length;
    if (size > octets.size())
      return;
    if (peis::carries_content(header->port)) {
      const auto name = peis::name_of(*header);
      const auto sent = sent_.extract({r.from, name});
      const auto [number, cause] = sent.empty() ? numbers{} : sent.mapped();
      r.number = number;
      r.cause = cause;
      r.octets = to_bytes(octets.first(size));
      put(r);
      if (!r.to.empty())
        arrived_[{r.to, name}] = number;
    }
    octets = octets.subspan(size);
  }
}

void run_record::put_event(const scheduler::remark& x) {
  const auto text = to_string(x.octets);
  if (text == last_story_)
    return;
  const auto tab = text.find('\t');
  record r;
  r.what = kind::event;
  r.time = x.time;
  r.from = text.substr(0, tab);
  r.text = text.substr(tab + 1);
  put(r);
}

void run_record::write(const radio::overheard& x) {
  if (octets_left_ == 0)
    return;
  const auto frame = radio::decode(x.psdu.view());
  if (!frame || frame->type != radio::frame_type::data || is_beacon(frame->am_type))
    return;
  record r;
  r.what = kind::frame;
  r.time = x.begin;
  r.mote.island = island_id(x.pan);
  r.text = radio::to_string(x.outcome);
  r.octets = to_bytes(x.psdu.view());
  r.yes = x.received;
  r.cause = recorded_cause(x.from.number());
  put(r);
}

void run_record::put(const record& x) {
  if (error_.empty())
    put(encode(x));
}

void run_record::put(const std::string& line) {
  if (line.size() > octets_left_) { // nothing is kept for what will not be written
    octets_left_ = 0;
    left_out_.clear();
    sent_.clear();
    arrived_.clear();
    return;
  }
  octets_left_ -= line.size();
  errno = 0;
  file_ << line;
  check();
}

/// Right after what may have failed.
void run_record::check() {
  if (file_ || !error_.empty())
    return;
  if (may_end_) {
    octets_left_ = 0;
    return;
  }
  error_ = "record " + path_ +
           " is not complete: " + std::generic_category().message(errno != 0 ? errno : EIO);
  spdlog::error("{}", printable(error_));
}

void run_record::flush() {
  errno = 0;
  file_.flush();
  check();
}

std::string run_record::finish() {
  flush();
  return error_;
}

} // namespace rubicon
