#include "config/island/model_readers.hpp"
#include "config/island/mote_readers.hpp"
#include "config/trace_files.hpp"
#include "device/trace_keys.hpp"
#include "device/transducer_keys.hpp"

namespace rubicon::config {

namespace {

/// "12.5" or "2004-02-28 00:59:16"
struct start_text {
  using type = device::trace_time;
  device::time_form times; ///< as in the file

  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const {
    const auto* found = x.as<std::string>();
    const auto time = found == nullptr ? std::nullopt : device::parse_trace_time(*found, times);
    if (!time)
      return who.refuse(x, "seconds or a date and a time of day between quotation marks, as in "
                           "\"12.5\" or \"2004-02-28 00:59:16\"");
    return time;
  }
  [[nodiscard]] static form takes() {
    return string_form("seconds or date, as in `\"12.5\"` or `\"2004-02-28 00:59:16\"`");
  }
};

/// File of a trace.
struct trace_name {
  std::string file;
};

auto trace_name_keys() {
  return keys::of(keys::required("file", &trace_name::file, text{path_octets_max},
                                 {"relative to the folder of the TOML file", "", "file"}));
}

/// @param times as in the file
auto trace_start_keys(const device::time_form& times) {
  return keys::of(keys::optional(
      "start", &device::trace_format::start, start_text{times},
      {"time in the trace at which the run starts", "`\"0\"`, or the earliest date in the file"}));
}

/// Whether the trace has what the mote named in the TOML file replays; complains if not.
bool has_mote(const table_reader& in, const device::trace_model& x) {
  const bool found = !x.mote || x.table->of_mote.contains(*x.mote);
  if (!found)
    in.problems().add(in.at("mote"),
                      "the trace has no readings of mote " + std::to_string(*x.mote));
  return found;
}

} // namespace

device::trace_model read_trace(table_reader& in, device::quantity kind) {
  device::trace_model out;
  device::trace_format format;
  trace_name named;
  in.all(named, trace_name_keys());
  const auto& file = named.file;
  in.all(format);
  in.all(format.times);
  const auto& word = in.shared().quantities.word_of(kind);
  if (format.name_column.empty() && in.has("name"))
    in.problems().add(in.at("name"), "`name` has no effect without a `name_column`");
  if (format.name.empty())
    format.name = word;
  if (format.value_column.empty())
    format.value_column = format.name_column.empty() ? word : "value";
  in.all(format, trace_start_keys(format.times));
  in.all(out);
  if (in.shared().traces == nullptr || !in.sound())
    return out;
  if (format.mote_column.empty()) {
    if (out.mote)
      in.problems().add(in.at("mote"), "`mote` has no effect without a `mote_column`");
    out.mote = 0;
  }
  const auto table = in.shared().traces->read(in, "file", file, format);
  out.table = table;
  if (table)
    in.shared().seen.traces.emplace(table, trace_place{in.at("file"), file, table->start});
  if (out.table && in.sound() && !has_mote(in, out))
    out.table = nullptr;
  return out;
}

bool settle_traces(shared_list<device::transducer_config>& transducers, mote_id mote, mark at,
                   reading& shared) {
  bool good = true;
  for (std::size_t i = 0; i < transducers.size(); ++i) {
    const auto& each = transducers[i];
    const auto* trace = std::get_if<device::trace_model>(&each.model);
    if (trace == nullptr || trace->table == nullptr || trace->mote)
      continue;
    std::get<device::trace_model>(transducers.edit()[i].model).mote = mote.value;
    if (trace->table->of_mote.contains(mote.value))
      continue;
    good = false;
    shared.problems.add(at, "the trace of `" + shared.quantities.word_of(each.kind) +
                                "` has no readings of mote " + to_string(mote) +
                                ": choose one of its motes with `mote`");
  }
  return good;
}

} // namespace rubicon::config
