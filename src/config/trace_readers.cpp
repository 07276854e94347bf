#include "config/model_readers.hpp"
#include "config/mote_readers.hpp"
#include "config/trace_files.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t path_octets_max = 4096;

/// "12.5" or "2004-02-28 00:59:16"
struct start_text {
  using type = mote::trace_time;

  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    const auto time = found == nullptr ? std::nullopt : mote::parse_trace_time(*found);
    if (!time)
      return who.refuse(x, "seconds or a date and a time of day between quotation marks, as in "
                           "\"12.5\" or \"2004-02-28 00:59:16\"");
    return time;
  }
  [[nodiscard]] static form takes() {
    return string_form("seconds or date, as in `\"12.5\"` or `\"2004-02-28 00:59:16\"`");
  }
};

void read_format(table_reader& in, mote::trace_format& out) {
  in.optional("separator",
              word<char>{{{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"blanks", ' '}}},
              out.separator,
              {"what stands between two fields",
               "what the first line has: a semicolon, else a tab, else a comma, else blanks"});
  in.optional("columns", list_of<text>{{}, 1, mote::trace_columns_max}, out.columns,
              {"names of the columns, in order", "the first line names them"});
  in.optional("time_column", text{}, out.time_column, "seconds, or a time of day");
  in.optional("date_column", text{}, out.date_column,
              {"stands before the time, if date and time of day have a column each", "none"});
  in.optional("mote_column", text{}, out.mote_column,
              {"numbers from 0 to 4294967295", "none: all readings are of one mote"});
  in.optional("column", text{}, out.value_column, {"the values", "the quantity"});
  constexpr real any_value{-mote::trace_value_max, mote::trace_value_max};
  in.optional("min", any_value, out.least,
              {"values below it, in the file's unit, are taken for missing", "none"});
  in.optional("max", any_value, out.most, {"values above it are taken for missing", "none"});
  in.optional(
      "start", start_text{}, out.start,
      {"the time that is the start of the run", "`\"0\"`, or the earliest date in the file"});
}

/// Whether the trace has what the mote named in the TOML file replays; complains if not.
bool has_mote(const table_reader& in, const mote::trace_model& x) {
  const bool found = !x.mote || x.table->of_mote.contains(*x.mote);
  if (!found)
    in.problems().add(in.at("mote"),
                      "the trace has no readings of mote " + std::to_string(*x.mote));
  return found;
}

} // namespace

mote::trace_model read_trace(table_reader& in, mote::quantity kind) {
  mote::trace_model out;
  mote::trace_format format;
  format.value_column = word_of(kind);
  std::string file;
  in.required("file", text{path_octets_max}, file,
              {"relative to the folder of the TOML file", "", "file"});
  read_format(in, format);
  in.optional("mote", whole<std::uint32_t>{}, out.mote,
              {"whose readings are replayed; only with `mote_column`", "the mote's own id"});
  in.optional("repeat", flag{}, out.repeats,
              "begin again from the start after the last reading of all motes, which lasts as long "
              "as the one before it");
  in.optional("interpolation", word<bool>{{{"hold", false}, {"linear", true}}}, out.straight,
              "between two readings: the earlier one, or a straight line");
  in.optional("scale", real{-1e9, 1e9}, out.scale, "factor of the values");
  in.optional("offset", real{-1e9, 1e9}, out.offset, "added to the scaled value");
  if (in.walks() || !in.sound())
    return out;
  if (format.mote_column.empty()) {
    if (out.mote)
      in.problems().add(in.at("mote"), "`mote` means nothing without a `mote_column`");
    out.mote = 0;
  }
  out.table = in.shared().traces->read(in, "file", file, format);
  if (out.table && in.sound() && !has_mote(in, out))
    out.table = nullptr;
  return out;
}

bool settle_traces(std::vector<mote::transducer_config>& transducers, mote_id mote, mark at,
                   complaints& problems) {
  bool good = true;
  for (auto& each : transducers) {
    auto* trace = std::get_if<mote::trace_model>(&each.model);
    if (trace == nullptr || trace->table == nullptr || trace->mote)
      continue;
    trace->mote = mote.value;
    if (trace->table->of_mote.contains(mote.value))
      continue;
    good = false;
    problems.add(at, "the trace of `" + std::string(word_of(each.kind)) +
                         "` has no readings of mote " + to_string(mote) +
                         ": name one that it has with `mote`");
  }
  return good;
}

} // namespace rubicon::config
