// [[expect]]: what must come of a run.
#include <utility>

#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

using keys::of;
using keys::optional;
using keys::required;

template <class Expectation>
void check(const table_reader& /*in*/, Expectation& /*x*/) {}

void check(const table_reader& in, stream_expectation& x) {
  if (const auto* to = in.content().find("to"); to != nullptr && to->as<std::string>() != nullptr)
    x.to_name = *to->as<std::string>();
}

void check(const table_reader& in, actuations_expectation& x) {
  if (x.proxy != "*")
    in.shared().seen.uses.push_back({"an expectation looks at", x.proxy + ".*", in.at("proxy")});
}

void check(const table_reader& in, event_log_expectation& x) {
  if (x.at_most && in.sound() && *x.at_most < x.at_least)
    in.problems().add(in.at("at_most"), "`at_most` must not be less than `at_least`, which is " +
                                            std::to_string(x.at_least));
}

void note(const table_reader& in, const tuple_condition& x) {
  auto& seen = in.shared().seen;
  if (x.key.empty())
    return;
  seen.uses.push_back({"an expectation looks at", x.key, in.at("key")});
  tuple_test test{"an expectation", x.key, texts_at(in, "equals", x.equals)};
  if (x.above)
    test.above = {*x.above, in.at("above")};
  if (x.below)
    test.below = {*x.below, in.at("below")};
  seen.tests.push_back(std::move(test));
}

void read_condition(table_reader& in, tuple_condition& out) {
  in.all(
      out,
      of(required("key", &tuple_condition::key, tuple_key{}, "the tuple"),
         optional("equals", &tuple_condition::equals, list_of<text>{{}, 1}, "one of these values,"),
         optional("above", &tuple_condition::above, real{}, "or a number at or above this,"),
         optional("below", &tuple_condition::below, real{},
                  {"and below this", "", "number, more than `above`"})));
  const bool has_bounds = in.has("above") || in.has("below");
  if (has_bounds == in.has("equals"))
    in.problems().add(in.at(), "a condition needs either `equals`, or `above`, `below` or both");
  if (out.above && out.below && *out.below <= *out.above)
    in.problems().add(in.at("below"),
                      "`below` must be more than `above`, which is " + shown(*out.above));
  note(in, out);
}

void check(table_reader& in, tuple_expectation& x) {
  read_condition(in, x.then);
  in.table("when", "when of an expectation",
           {"the condition before it, see below", "from the start"},
           [&x](table_reader& part) { read_condition(part, x.when.emplace()); });
}

auto who_key() {
  return optional("who", &event_line::who, text{}, {"text that its `who` contains", "anybody"});
}

void check(table_reader& in, sometimes_expectation& x) {
  in.all(x.line, of(optional("text", &event_line::text, text{},
                             {"text that a line of the event log contains", "none"}),
                    who_key()));
  in.table("during", "during of an expectation",
           {"the condition on a tuple that holds at that moment", "any moment"},
           [&x](table_reader& part) { read_condition(part, x.during.emplace()); });
  in.table("after", "after of an expectation",
           {"a line of the event log at most `within` before it", "none"},
           [&x](table_reader& part) {
             part.all(x.after.emplace(),
                      of(required("text", &event_line::text, text{}, "text that the line contains"),
                         who_key()));
           });
  if (in.walks())
    return;
  if (!in.has("text") && !in.has("during"))
    in.problems().add(in.at(), "a situation needs `text` of a line of the event log, or `during`");
  for (const auto* key : {"who", "after"})
    if (!in.has("text") && in.has(key))
      in.problems().add(in.at(key), '`' + std::string(key) + "` has no effect without `text`");
  if (in.has("within") && !in.has("after"))
    in.problems().add(in.at("within"), "`within` has no effect without `after`");
}

expectation read_expectation(table_reader& in) {
  expectation out;
  std::vector<std::pair<std::string_view, table_reader::part_reader>> choices;
  const auto kind = [&](std::string_view word, const auto& keys) {
    choices.emplace_back(word, [&out, keys](table_reader& part) {
      const auto use = [&](auto x) {
        check(part, x);
        out = std::move(x);
      };
      part.either(use, keys);
    });
  };
  kind("delivery",
       of(optional("of", &delivery_expectation::of, scope_name{},
                   {"sender of the messages", "`\"*\"`"}),
          required("at_least", &delivery_expectation::at_least, ratio{}, "at least this share")));
  kind("acknowledged", of(optional("of", &acknowledged_expectation::of, scope_name{},
                                   {"sender of the messages", "`\"*\"`"}),
                          required("at_least", &acknowledged_expectation::at_least, ratio{},
                                   "at least this share")));
  kind("stream",
       of(required("stream", &stream_expectation::stream, whole<std::uint16_t>{},
                   "number of the stream"),
          required("to", &stream_expectation::to, node_name{}, "node that reads it"),
          required("at_least", &stream_expectation::at_least, ratio{}, "at least this share"),
          optional("pause", &stream_expectation::pause, time_span{1ms},
                   {"longest time that the reader may be without a record, from its first one to "
                    "the end of the run",
                    "any"}),
          optional("first_within", &stream_expectation::first_within, time_span{1ms},
                   {"longest time until its first record, from the moment when the programs at "
                    "both ends first ran",
                    "`pause`"})));
  kind("actuations",
       of(optional("proxy", &actuations_expectation::proxy, proxy_name{},
                   {"proxies whose inputs are checked", "`\"*\"`"}),
          optional("count", &actuations_expectation::count, whole<std::uint64_t>{1, INT64_MAX},
                   "minimum number of requests"),
          required("at_least", &actuations_expectation::at_least, ratio{}, "at least this share")));
  kind("tuple", of(required("within", &tuple_expectation::within, time_of_run{}, "so soon")));
  kind("clock",
       of(optional("of", &clock_expectation::of, scope_name{},
                   {"motes whose clocks are checked", "`\"*\"`"}),
          required("at_most", &clock_expectation::at_most, time_span{1us}, "largest error"),
          optional("share", &clock_expectation::share, ratio{}, "in this share of the comparisons"),
          optional("from", &clock_expectation::from, time_of_run{}, "the first comparison"),
          optional("every", &clock_expectation::every, time_span{10ms},
                   "from one comparison to the next")));
  kind("joined", of(optional("of", &joined_expectation::of, scope_name{},
                             {"motes that their gateway lists for the first time", "`\"*\"`"}),
                    required("within", &joined_expectation::within, time_of_run{},
                             "latest time after the start of the run")));
  kind("members", of(optional("of", &members_expectation::of, scope_name{},
                              {"motes that are listed at the end", "`\"*\"`"}),
                     optional("at_least", &members_expectation::at_least,
                              whole<std::uint64_t>{1, 1'000'000}, {"so many", "all of them"})));
  kind("battery", of(optional("of", &battery_expectation::of, scope_name{},
                              {"motes whose batteries are checked, each of them", "`\"*\"`"}),
                     required("at_least", &battery_expectation::at_least, ratio{},
                              "share of the charge left at the end")));
  kind("radio", of(optional("of", &radio_expectation::of, scope_name{},
                            {"motes whose radios are checked, each of them", "`\"*\"`"}),
                   required("at_most", &radio_expectation::at_most, ratio{},
                            "share of the time that it was on")));
  kind(
      "vectors",
      of(optional("node", &vectors_expectation::node, any_node_name{},
                  {"nodes whose programs are checked", "`\"*\"`"}),
         optional("missed", &vectors_expectation::missed, whole<std::uint64_t>{0, INT64_MAX},
                  "number of vectors of synaptic channels that they may miss, in total"),
         optional("from", &vectors_expectation::from, time_of_run{}, "not counting those before")));
  kind("events",
       of(required("at_most", &events_expectation::at_most, whole<std::uint64_t>{1, INT64_MAX},
                   "messages between actors in the whole run")));
  kind("event_log",
       of(required("text", &event_log_expectation::text, text{}, "text that they contain"),
          optional("who", &event_log_expectation::who, text{},
                   {"text that their `who` contains", "anybody"}),
          optional("at_least", &event_log_expectation::at_least, whole<std::uint64_t>{0, INT64_MAX},
                   "smallest number of lines"),
          optional("at_most", &event_log_expectation::at_most, whole<std::uint64_t>{0, INT64_MAX},
                   {"largest number of lines", "any number", "number, not less than `at_least`"})));
  kind("sometimes",
       of(required("name", &sometimes_expectation::name, text{}, "what the situation is called"),
          optional("within", &sometimes_expectation::within, time_span{1ms},
                   "with `after`: so soon after that line")));
  in.one_of("kind", "kind of expectation", choices, "[[expect]]");
  return out;
}

} // namespace

std::vector<located<std::string>> texts_at(const table_reader& in, std::string_view key,
                                           const std::vector<std::string>& texts) {
  const auto* given = in.content().find(key);
  const auto* array = given == nullptr ? nullptr : given->as<node_array>();
  std::vector<located<std::string>> out;
  for (std::size_t i = 0; i < texts.size(); ++i)
    out.push_back({texts[i], array != nullptr && i < array->size() ? (*array)[i].at : in.at(key)});
  return out;
}

std::vector<expectation> read_expectations(table_reader& root) {
  constexpr std::size_t expectations_max = 1000;
  std::vector<expectation> out;
  root.tables("expect", "[[expect]]", "requirements on a run, up to 1000", [&](table_reader& x) {
    out.push_back(read_expectation(x));
    if (out.size() == expectations_max + 1)
      x.problems().add(x.at(), "a file must not expect more than " +
                                   std::to_string(expectations_max) + " things");
  });
  return out;
}

} // namespace rubicon::config
