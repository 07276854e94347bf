#include "explain/record.hpp"

#include <array>
#include <limits>

#include <nlohmann/json.hpp>

namespace rubicon::explain {

namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 22> kind_words = {
    "radio_send",
    "radio_done",
    "frame",
    "frame_received",
    "serial_write",
    "serial_octets",
    "plug_serial",
    "link_opened",
    "link_octets",
    "link_lost",
    "set_tuple",
    "delete_tuple",
    "set_remote_tuple",
    "tuple_event",
    "watch_tuples",
    "send_peis_message",
    "peis_outcome",
    "send_message",
    "message_received",
    "send_ended",
    "actuator_changed",
    "story",
};
static_assert(kind_words.size() == static_cast<std::size_t>(kind::story) + 1);

/// Why a line is refused.
struct refusal {
  std::string message;
};

template <class T>
T number_in(const json& from, const char* name, T otherwise) {
  const auto found = from.find(name);
  if (found == from.end())
    return otherwise;
  const bool is_negative = found->is_number_integer() && !found->is_number_unsigned();
  if (is_negative && std::numeric_limits<T>::is_signed) {
    const auto x = found->get<std::int64_t>();
    if (x >= static_cast<std::int64_t>(std::numeric_limits<T>::min()))
      return static_cast<T>(x);
  } else if (found->is_number_unsigned()) {
    const auto x = found->get<std::uint64_t>();
    if (x <= static_cast<std::uint64_t>(std::numeric_limits<T>::max()))
      return static_cast<T>(x);
  }
  throw refusal{"`" + std::string(name) + "` is no number that fits"};
}

std::string text_in(const json& from, const char* name) {
  const auto found = from.find(name);
  if (found == from.end())
    return {};
  if (!found->is_string())
    throw refusal{"`" + std::string(name) + "` is no text"};
  return found->get<std::string>();
}

bool flag_in(const json& from, const char* name) {
  const auto found = from.find(name);
  if (found != from.end() && !found->is_boolean())
    throw refusal{"`" + std::string(name) + "` is neither true nor false"};
  return found != from.end() && found->get<bool>();
}

const json& list_in(const json& from, const char* name) {
  static const json none = json::array();
  const auto found = from.find(name);
  if (found == from.end())
    return none;
  if (!found->is_array())
    throw refusal{"`" + std::string(name) + "` is no list"};
  return *found;
}

template <class Id>
std::map<Id, std::string> names_in(const json& from, const char* name) {
  std::map<Id, std::string> names;
  for (const auto& each : list_in(from, name)) {
    if (!each.is_object())
      throw refusal{"`" + std::string(name) + "` holds something else than objects"};
    names[number_in<Id>(each, "id", 0)] = text_in(each, "name");
  }
  return names;
}

template <class Id>
json list_of(const std::map<Id, std::string>& names) {
  auto list = json::array();
  for (const auto& [id, name] : names)
    list.push_back({{"id", id}, {"name", name}});
  return list;
}

header header_in(const json& x) {
  const auto version = x.find("rubicon_record");
  if (version == x.end())
    throw refusal{"this is no record: the first line must say `rubicon_record`"};
  if (!version->is_number_integer() || *version != record_version)
    throw refusal{"a record of version " + version->dump() + ", this program reads version " +
                  std::to_string(record_version)};
  header about;
  about.ecology = text_in(x, "ecology");
  about.seed = number_in<std::uint64_t>(x, "seed", 0);
  about.file = text_in(x, "file");
  about.digest = text_in(x, "digest");
  about.peers = names_in<std::int32_t>(x, "peers");
  for (const auto& each : list_in(x, "islands")) {
    if (!each.is_object())
      throw refusal{"`islands` holds something else than objects"};
    about.islands.push_back({number_in<std::uint32_t>(each, "id", 0),
                             text_in(each, "name"),
                             number_in<std::uint16_t>(each, "sink", 0),
                             text_in(each, "gateway"),
                             names_in<std::uint16_t>(each, "motes"),
                             {}});
    for (const auto& alias : list_in(each, "aliases")) {
      if (!alias.is_string())
        throw refusal{"`aliases` holds something else than names"};
      about.islands.back().aliases.push_back(alias.get<std::string>());
    }
  }
  return about;
}

bytes octets_in(const json& x) {
  auto octets = from_hex(text_in(x, "octets"));
  if (!octets)
    throw refusal{"`octets` is not hexadecimal"};
  return *std::move(octets);
}

record record_in(const json& x, const std::map<std::uint64_t, std::string>& actors) {
  const auto path = [&](const char* name) {
    const auto number = number_in<std::uint64_t>(x, name, 0);
    if (number == 0)
      return std::string();
    const auto found = actors.find(number);
    if (found == actors.end())
      throw refusal{"`" + std::string(name) + "` names actor " + std::to_string(number) +
                    ", which no line before has introduced"};
    return found->second;
  };
  record r;
  const auto word = text_in(x, "what");
  const auto what = parse_kind(word);
  if (!what)
    throw refusal{"`what` is \"" + word.substr(0, 40) + "\", which is no kind of record"};
  r.what = *what;
  r.number = number_in<std::uint64_t>(x, "n", 0);
  r.time = instant(duration(number_in<std::int64_t>(x, "ns", 0)));
  r.from = path("from");
  r.to = path("to");
  r.cause = number_in<std::uint64_t>(x, "cause", 0);
  r.id = number_in<std::uint64_t>(x, "id", 0);
  r.mote = {island_id(number_in<std::uint32_t>(x, "island", 0)),
            mote_id(number_in<std::uint16_t>(x, "mote", 0))};
  r.peer = number_in<std::int32_t>(x, "peer", 0);
  r.channel = number_in<std::uint16_t>(x, "channel", 0);
  r.text = text_in(x, "text");
  r.octets = octets_in(x);
  r.count = number_in<std::uint32_t>(x, "count", 0);
  r.yes = flag_in(x, "yes");
  r.unheard = flag_in(x, "unheard");
  return r;
}

/// Appends fields that differ from their defaults, without the detour over a json object.
class line_writer {
public:
  explicit line_writer(std::string& out) : out_(out) { out_ += '{'; }

  template <class T>
  line_writer& number(std::string_view name, T x) {
    if (x != 0)
      (begin(name) += std::to_string(x)) += ',';
    return *this;
  }
  line_writer& text(std::string_view name, std::string_view x) {
    if (!x.empty())
      (begin(name) += json(x).dump(-1, ' ', false, json::error_handler_t::replace)) += ',';
    return *this;
  }
  line_writer& octets(std::string_view name, byte_view x) {
    if (!x.empty())
      ((begin(name) += '"') += to_hex(x)) += "\",";
    return *this;
  }
  line_writer& flag(std::string_view name, bool x) {
    if (x)
      begin(name) += "true,";
    return *this;
  }
  void end() {
    if (out_.back() == ',')
      out_.pop_back();
    out_ += "}\n";
  }

private:
  std::string& begin(std::string_view name) {
    out_ += '"';
    out_ += name;
    return out_ += "\":";
  }

  std::string& out_;
};

} // namespace

std::string_view to_string(kind x) {
  return kind_words[static_cast<std::size_t>(x)];
}

std::optional<kind> parse_kind(std::string_view word) {
  for (std::size_t i = 0; i < kind_words.size(); ++i)
    if (kind_words[i] == word)
      return static_cast<kind>(i);
  return std::nullopt;
}

std::string encoder::encode(const header& x) {
  json islands = json::array();
  for (const auto& island : x.islands) {
    islands.push_back({{"id", island.id},
                       {"name", island.name},
                       {"sink", island.sink},
                       {"gateway", island.gateway},
                       {"motes", list_of(island.motes)}});
    if (!island.aliases.empty())
      islands.back()["aliases"] = island.aliases;
  }
  const json line = {{"rubicon_record", record_version},
                     {"ecology", x.ecology},
                     {"seed", x.seed},
                     {"file", x.file},
                     {"digest", x.digest},
                     {"islands", islands},
                     {"peers", list_of(x.peers)}};
  return line.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
}

std::string encoder::encode(const record& x) {
  std::string out;
  const auto from = number_of(x.from, out);
  const auto to = number_of(x.to, out);
  line_writer line(out);
  line.number("n", x.number).number("ns", x.time.time_since_epoch().count());
  line.text("what", to_string(x.what)).number("from", from).number("to", to);
  line.number("cause", x.cause).number("id", x.id).number("island", x.mote.island.value);
  line.number("mote", x.mote.mote.value).number("peer", x.peer).number("channel", x.channel);
  line.text("text", x.text).octets("octets", x.octets).number("count", x.count);
  line.flag("yes", x.yes).flag("unheard", x.unheard);
  line.end();
  return out;
}

std::uint32_t encoder::number_of(const std::string& path, std::string& out) {
  if (path.empty())
    return 0;
  const auto next = static_cast<std::uint32_t>(actors_.size() + 1);
  const auto [entry, is_new] = actors_.try_emplace(path, next);
  if (is_new) {
    line_writer line(out);
    line.number("actor", next).text("path", path);
    line.end();
  }
  return entry->second;
}

std::optional<bad_line> decoder::take(std::string_view text) {
  ++lines_;
  try {
    const auto x = json::parse(text, nullptr, false);
    if (x.is_discarded() || !x.is_object())
      throw refusal{lines_ == 1 ? "this is no record: the first line is no JSON object"
                                : "this is no JSON object"};
    if (lines_ == 1)
      result_.about = header_in(x);
    else if (const auto actor = number_in<std::uint64_t>(x, "actor", 0); actor != 0)
      actors_[actor] = text_in(x, "path");
    else
      result_.records.push_back(record_in(x, actors_));
  } catch (const refusal& why) {
    return bad_line{lines_, why.message};
  }
  return std::nullopt;
}

std::optional<bad_line> decoder::finish(std::string_view rest) {
  if (!rest.empty() && lines_ > 0) {
    result_.cut_off = take(rest).has_value();
    return std::nullopt;
  }
  if (!rest.empty())
    return take(rest);
  return lines_ == 0 ? std::optional(bad_line{1, "this is no record: it is empty"}) : std::nullopt;
}

read_result read(std::string_view text) {
  decoder lines;
  read_result x;
  while (!x.problem) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) {
      x.problem = lines.finish(text);
      break;
    }
    x.problem = lines.take(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  x.content = std::move(lines.result());
  return x;
}

} // namespace rubicon::explain
