#include "steering/request.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/json.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::steering {

namespace {

using nlohmann::json;

struct refusal : std::runtime_error {
  using runtime_error::runtime_error;
};

/// The members of one request.
class members {
public:
  explicit members(const json& x) : all_(x) {}

  /// @throws refusal of any other member
  void allow(std::initializer_list<std::string_view> names) const {
    std::vector<std::string> known(names.begin(), names.end());
    known.emplace_back("do");
    for (const auto& [name, value] : all_.items())
      if (std::ranges::find(known, name) == known.end())
        throw refusal("`" + name.substr(0, 40) + "` is not a member of this request" +
                      suggestion(name, known));
  }

  [[nodiscard]] bool has(const char* name) const { return all_.contains(name); }

  [[nodiscard]] std::string text(const char* name) const {
    const auto found = all_.find(name);
    if (found == all_.end())
      throw refusal(std::string("`") + name + "` is missing");
    const auto* x = found->get_ptr<const std::string*>();
    if (x == nullptr)
      throw refusal(std::string("`") + name + "` must be a text");
    if (x->size() > words_octets_max)
      throw refusal(std::string("`") + name + "` has more than " +
                    std::to_string(words_octets_max) + " octets");
    return *x;
  }

  [[nodiscard]] std::string text_or_empty(const char* name) const {
    return has(name) ? text(name) : std::string();
  }

  /// In hexadecimal.
  [[nodiscard]] bytes octets(const char* name) const {
    auto found = from_hex(text(name));
    if (!found)
      throw refusal(std::string("`") + name + "` must be octets in hexadecimal, two digits each");
    return *std::move(found);
  }

  [[nodiscard]] bool flag_or(const char* name, bool otherwise) const {
    if (!has(name))
      return otherwise;
    if (!all_.at(name).is_boolean())
      throw refusal(std::string("`") + name + "` must be true or false");
    return all_.at(name).get<bool>();
  }

  [[nodiscard]] std::uint8_t octet_or(const char* name, std::uint8_t otherwise) const {
    if (!has(name))
      return otherwise;
    const auto& x = all_.at(name);
    if (!x.is_number_unsigned() || x.get<std::uint64_t>() > 255)
      throw refusal(std::string("`") + name + "` must be a whole number from 0 to 255");
    return x.get<std::uint8_t>();
  }

  /// [s], to the nearest nanosecond.
  [[nodiscard]] duration time(const char* name) const {
    constexpr double longest_s = 1e9;
    const auto& x = all_.at(name);
    if (!x.is_number() || !(x.get<double>() >= 0 && x.get<double>() <= longest_s))
      throw refusal(std::string("`") + name + "` must be a number of seconds from 0 to 1e9");
    return duration(std::llround(x.get<double>() * 1e9));
  }

private:
  const json& all_;
};

peis::key pattern_of(const members& x) {
  auto pattern = peis::key::parse(x.text_or_empty("pattern"));
  if (!pattern)
    throw refusal("`pattern` must be a key, in which the part `*` stands for any part");
  return *std::move(pattern);
}

request step_of(const members& x) {
  x.allow({"for", "until"});
  if (x.has("for") == x.has("until"))
    throw refusal("a step needs either `for` or `until`");
  step_request step;
  if (x.has("for"))
    step.length = x.time("for");
  else
    step.until = instant(x.time("until"));
  return step;
}

request send_of(const members& x) {
  x.allow({"mote", "to", "octets", "am_type", "reliable"});
  send_request send{.mote = x.text("mote"), .to = x.text("to"), .octets = x.octets("octets")};
  send.am_type = x.octet_or("am_type", send.am_type);
  send.reliable = x.flag_or("reliable", send.reliable);
  return send;
}

template <class Request>
request without_members(const members& x) {
  x.allow({});
  return Request{};
}

using reader = std::function<request(const members&)>;

const std::map<std::string, reader>& readers() {
  static const std::map<std::string, reader> all{
      {"step", step_of},
      {"get",
       [](const members& x) {
         x.allow({"peer", "owner", "key"});
         return get_request{x.text("peer"), x.text_or_empty("owner"), x.text("key")};
       }},
      {"set",
       [](const members& x) {
         x.allow({"peer", "key", "value"});
         return set_request{x.text("peer"), x.text("key"), x.text("value")};
       }},
      {"tuples",
       [](const members& x) {
         x.allow({"owner", "pattern"});
         return tuples_request{x.text_or_empty("owner"), pattern_of(x)};
       }},
      {"fault",
       [](const members& x) {
         x.allow({"words"});
         return fault_request{x.text("words")};
       }},
      {"send", send_of},
      {"events", without_members<events_request>},
      {"motes", without_members<motes_request>},
      {"report", without_members<report_request>},
      {"record", without_members<record_request>},
      {"tables", without_members<tables_request>},
      {"finish", without_members<finish_request>},
  };
  return all;
}

request_or_reason read_request(const json& x) {
  try {
    if (!x.is_object())
      throw refusal("a request is an object, such as {\"do\": \"step\", \"for\": 1}");
    const members all(x);
    const auto what = all.text("do");
    const auto found = readers().find(what);
    if (found != readers().end())
      return found->second(all);
    std::vector<std::string> known;
    for (const auto& [name, read] : readers())
      known.push_back(name);
    throw refusal("there is no request `" + what.substr(0, 40) + '`' + suggestion(what, known));
  } catch (const refusal& why) {
    return std::string(why.what());
  }
}

} // namespace

std::variant<request_line, std::string> read_line(std::string_view line) {
  if (line.size() > line_octets_max)
    return "a line has at most " + std::to_string(line_octets_max) + " octets";
  json all;
  try {
    all = parse_json(line);
  } catch (const json::parse_error& error) {
    return "no JSON at character " + std::to_string(error.byte);
  } catch (const json::out_of_range&) {
    return "a number is too large";
  }
  request_line out;
  if (!all.is_array()) {
    out.requests.push_back(read_request(all));
    return out;
  }
  if (all.size() > batch_max)
    return "a line has at most " + std::to_string(batch_max) + " requests";
  out.is_batch = true;
  for (const auto& each : all)
    out.requests.push_back(read_request(each));
  return out;
}

} // namespace rubicon::steering
