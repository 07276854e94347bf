#include "actors/run/run_files.hpp"

#include <utility>

#include "actors/messages/peis.hpp"
#include "core/tuples/device_keys.hpp"

namespace rubicon {

namespace {

/// What a program of a peer does to a tuple.
void judge_tuple(report::expectations& judge, const scheduler::delivery& x) {
  if (!x.received)
    return;
  if (const auto* set = x.as<set_tuple>())
    judge.on_tuple(set->key, tuple_text(set->value.view()), x.time);
  else if (const auto* remote = x.as<set_remote_tuple>())
    judge.on_tuple(remote->key, tuple_text(remote->value.view()), x.time);
  else if (const auto* gone = x.as<delete_tuple>())
    judge.on_tuple_gone(gone->key, x.time);
}

} // namespace

run_files::run_files(const config::ecology_description& description, const run_options& options,
                     report::expectations& judge)
    : judge_(judge.watches_tuples() ? &judge : nullptr) {
  if (options.on_tuple)
    notifier_.emplace(description, options.on_tuple);
  if (!options.debug_folder.empty())
    debug_.emplace(options.debug_folder, options.debug_file_octets_max,
                   config::debug_selection(options.debug_of));
  if (!options.record_file.empty())
    record_.emplace(options.record_file, description, options.source, options.record_octets_max);
  if (!options.serial_file.empty())
    serial_.emplace(options.serial_file);
  if (!options.pcap_folder.empty())
    captures_.emplace(options.pcap_folder, description, options.pcap_lost);
}

void run_files::watch(scheduler::trace_recorder& trace) {
  if (debug_ || record_)
    trace.observe_remarks([this](const scheduler::remark& x) {
      if (debug_)
        debug_->write(x);
      if (record_ && x.what != debug_log::selected)
        record_->write(x);
    });
  if (record_)
    trace.messages().observe([this](const message_end& x) { record_->write(x); });
  // Peers, whom one thread at a time executes, are the only ones with tuples.
  if (judge_ != nullptr || notifier_)
    trace.watch("peis_peer/", [this](const scheduler::delivery& x) {
      if (judge_ != nullptr)
        judge_tuple(*judge_, x);
      if (notifier_)
        notifier_->on_delivery(x);
    });
  if (debug_ || record_ || serial_)
    trace.observe([this](const scheduler::delivery& x) {
      if (debug_)
        debug_->write(x);
      if (record_)
        record_->write(x);
      if (serial_)
        serial_->write(x);
    });
}

void run_files::write(const report::run_sample& x) {
  if (record_)
    record_->write(x);
}

frame_observer run_files::frames() {
  if (!captures_ && !record_)
    return {};
  return [this](const radio::overheard& x) {
    if (captures_)
      captures_->write(x);
    if (record_)
      record_->write(x);
  };
}

std::vector<std::string> run_files::finish() {
  std::vector<std::string> failed;
  if (debug_)
    failed.push_back(debug_->finish());
  if (record_)
    failed.push_back(record_->finish());
  if (captures_)
    failed.push_back(captures_->finish());
  if (serial_)
    failed.push_back(serial_->finish());
  std::erase(failed, std::string());
  return failed;
}

} // namespace rubicon
