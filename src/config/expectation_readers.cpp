// [[expect]]: what must come of a run.
#include <algorithm>
#include <utility>

#include "config/application_readers.hpp"
#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

/// "kitchen/fan", "kitchen" or "*".
struct scope_name {
  using type = mote_scope;

  [[nodiscard]] static std::optional<mote_scope> read(const node& x, const asker& who) {
    const auto* text = x.as<std::string>();
    if (text == nullptr)
      return who.refuse(x, "an island, a mote as in \"kitchen/fan\", or \"*\"");
    if (*text == "*")
      return mote_scope{};
    if (text->find('/') != std::string::npos) {
      const auto mote = config::read(mote_name{}, x, who);
      return mote ? std::optional(mote_scope{*text, mote->island, mote->mote}) : std::nullopt;
    }
    const auto island = island_name{}.read(x, who);
    return island ? std::optional(mote_scope{*text, *island, {}}) : std::nullopt;
  }
  [[nodiscard]] static form takes() { return string_form("island, mote or `\"*\"`"); }
};

/// A node as node_name has it, or "*"; its name as the file has it.
struct node_text {
  using type = std::string;

  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const {
    const auto* text = x.as<std::string>();
    if (text != nullptr && *text == "*")
      return *text;
    return config::read(node_name{}, x, who) ? std::optional(*text) : std::nullopt;
  }
  [[nodiscard]] static form takes() { return string_form("mote, name of a peer, or `\"*\"`"); }
};

struct proxy_text {
  using type = std::string;

  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who) {
    const auto* found = x.as<std::string>();
    return found != nullptr && *found == "*" ? std::optional(*found)
                                             : config::read(tuple_key{}, x, who);
  }
  [[nodiscard]] static form takes() {
    return string_form("prefix of its keys, as in `\"kitchen.fan\"`, or `\"*\"`");
  }
};

void read_bounds(table_reader& in, tuple_condition& out) {
  in.optional("equals", list_of<text>{{}, 1}, out.equals, "it is one of these,");
  in.optional("above", real{}, out.above, "or a number at or above this,");
  in.optional("below", real{}, out.below, {"and below this", "", "number, more than `above`"});
  const bool has_bounds = in.has("above") || in.has("below");
  if (has_bounds == in.has("equals"))
    in.problems().add(in.at(), "a condition needs either `equals`, or `above`, `below` or both");
  if (out.above && out.below && *out.below <= *out.above)
    in.problems().add(in.at("below"),
                      "`below` must be more than `above`, which is " + shown(*out.above));
}

struct kind_reader {
  duration length;
  expectation& out;

  /// A time within the run.
  void time(table_reader& in, const char* key, duration& to, const about& what,
            bool is_required = false) const {
    const bool found = is_required ? in.required(key, time_span{}, to, what)
                                   : in.optional(key, time_span{}, to, what);
    if (found && to > length)
      in.problems().add(in.at(key), '`' + std::string(key) +
                                        "` is after the end of the run, which is at " +
                                        to_text(length));
  }

  template <class Expectation>
  void share(table_reader& in, const char* of, const char* at_least = "this share") const {
    Expectation x;
    in.optional("of", scope_name{}, x.of, {of, "`\"*\"`"});
    in.required("at_least", ratio{}, x.at_least, at_least);
    out = std::move(x);
  }

  void stream(table_reader& in) const {
    stream_expectation x;
    in.required("stream", whole<std::uint16_t>{}, x.stream, "number of the stream");
    if (in.required("to", node_name{}, x.to, "where it is read"))
      x.to_name = *in.value("to")->as<std::string>();
    in.required("at_least", ratio{}, x.at_least, "this share");
    in.optional(
        "pause", time_span{1ms}, x.pause,
        {"the longest that the reader may go without a record, from its first one to the end "
         "of the run",
         "any"});
    out = std::move(x);
  }

  void actuations(table_reader& in) const {
    actuations_expectation x;
    in.optional("proxy", proxy_text{}, x.proxy, {"whose inputs", "`\"*\"`"});
    in.optional("count", whole<std::uint64_t>{1, INT64_MAX}, x.count,
                "so many must have been asked for");
    in.required("at_least", ratio{}, x.at_least, "this share");
    out = std::move(x);
  }

  void tuple(table_reader& in) const {
    tuple_expectation x;
    in.required("key", tuple_key{}, x.then.key, "the tuple");
    read_bounds(in, x.then);
    in.table("when", "when of an expectation",
             {"the condition before it, see below", "from the start"}, [&x](table_reader& part) {
               auto& condition = x.when.emplace();
               part.required("key", tuple_key{}, condition.key, "the tuple");
               read_bounds(part, condition);
             });
    time(in, "within", x.within, "so soon", true);
    out = std::move(x);
  }

  void clock(table_reader& in) const {
    clock_expectation x;
    in.optional("of", scope_name{}, x.of, {"whose clocks", "`\"*\"`"});
    in.required("at_most", time_span{1us}, x.at_most, "no farther");
    in.optional("share", ratio{}, x.share, "in this share of the comparisons");
    time(in, "from", x.from, "the first comparison");
    in.optional("every", time_span{10ms}, x.every, "from one comparison to the next");
    out = std::move(x);
  }

  void joined(table_reader& in) const {
    joined_expectation x;
    in.optional("of", scope_name{}, x.of,
                {"who is listed by its gateway for the first time", "`\"*\"`"});
    time(in, "within", x.within, "so long after the start of the run", true);
    out = std::move(x);
  }

  void members(table_reader& in) const {
    members_expectation x;
    std::uint64_t count = 0;
    in.optional("of", scope_name{}, x.of, {"who is listed at the end", "`\"*\"`"});
    if (in.optional("at_least", whole<std::uint64_t>{1, 1'000'000}, count,
                    {"so many", "all of them"}))
      x.at_least = count;
    out = std::move(x);
  }

  void radio(table_reader& in) const {
    radio_expectation x;
    in.optional("of", scope_name{}, x.of, {"whose radios, each of them", "`\"*\"`"});
    in.required("at_most", ratio{}, x.at_most, "share of the time that it was on");
    out = std::move(x);
  }

  void vectors(table_reader& in) const {
    vectors_expectation x;
    in.optional("node", node_text{}, x.node, {"whose programs", "`\"*\"`"});
    in.optional("missed", whole<std::uint64_t>{0, INT64_MAX}, x.missed,
                "so many vectors of synaptic channels they may miss, all together");
    time(in, "from", x.from, "not counting those before");
    out = std::move(x);
  }

  void events(table_reader& in) const {
    events_expectation x;
    in.required("at_most", whole<std::uint64_t>{1, INT64_MAX}, x.at_most,
                "messages between actors in the whole run");
    out = x;
  }

  void story(table_reader& in) const {
    story_expectation x;
    std::uint64_t most = 0;
    in.required("text", text{}, x.text, "what they contain");
    in.optional("who", text{}, x.who, {"what their `who` contains", "anybody"});
    in.optional("at_least", whole<std::uint64_t>{0, INT64_MAX}, x.at_least, "so many lines");
    if (in.optional("at_most", whole<std::uint64_t>{0, INT64_MAX}, most,
                    {"no more of them", "any number", "number, not less than `at_least`"}))
      x.at_most = most;
    if (x.at_most && in.sound() && *x.at_most < x.at_least)
      in.problems().add(in.at("at_most"), "`at_most` must not be less than `at_least`, which is " +
                                              std::to_string(x.at_least));
    out = std::move(x);
  }
};

expectation read_expectation(table_reader& in, duration length) {
  expectation out;
  const kind_reader read{length, out};
  in.one_of("kind", "what must come of the run",
            {{"delivery",
              [&](table_reader& x) { read.share<delivery_expectation>(x, "whose messages"); }},
             {"acknowledged",
              [&](table_reader& x) { read.share<acknowledged_expectation>(x, "whose messages"); }},
             {"stream", [&](table_reader& x) { read.stream(x); }},
             {"actuations", [&](table_reader& x) { read.actuations(x); }},
             {"tuple", [&](table_reader& x) { read.tuple(x); }},
             {"clock", [&](table_reader& x) { read.clock(x); }},
             {"joined", [&](table_reader& x) { read.joined(x); }},
             {"members", [&](table_reader& x) { read.members(x); }},
             {"battery",
              [&](table_reader& x) {
                read.share<battery_expectation>(x, "whose batteries, each of them",
                                                "share of the charge that is left at the end");
              }},
             {"radio", [&](table_reader& x) { read.radio(x); }},
             {"vectors", [&](table_reader& x) { read.vectors(x); }},
             {"events", [&](table_reader& x) { read.events(x); }},
             {"story", [&](table_reader& x) { read.story(x); }}},
            "[[expect]]");
  return out;
}

} // namespace

std::vector<expectation> read_expectations(table_reader& root, duration length) {
  constexpr std::size_t expectations_max = 1000;
  std::vector<expectation> out;
  root.tables("expect", "[[expect]]", "what must come of a run, up to 1000", [&](table_reader& x) {
    out.push_back(read_expectation(x, length));
    if (out.size() == expectations_max + 1)
      x.problems().add(x.at(), "a file must not expect more than " +
                                   std::to_string(expectations_max) + " things");
  });
  return out;
}

} // namespace rubicon::config
