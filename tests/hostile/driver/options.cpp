#include "hostile/driver/options.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <sstream>

namespace rubicon::hostile {

namespace {

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');)
    all.push_back(part);
  return all;
}

std::optional<double> number_of(const std::string& text) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  const bool good = error == std::errc() && end == text.data() + text.size() && x >= 0 && x < 1e9;
  return good ? std::optional(x) : std::nullopt;
}

duration seconds_of(double x) {
  return std::chrono::duration_cast<duration>(std::chrono::duration<double>(x));
}

std::optional<std::string> parse_attacks(const std::string& text, options& x) {
  for (const auto& name : parts_of(text)) {
    const auto before = x.attacks.size();
    for (const auto& kind : all_attacks()) {
      if (name == "all" || name == kind.name)
        x.attacks.push_back(&kind);
    }
    if (x.attacks.size() == before)
      return "there is no attack `" + name + '`';
  }
  return std::nullopt;
}

using setter = std::function<void(options&, double)>;

const std::map<std::string, setter>& numbers() {
  const auto id = [](double y) { return peer_id{static_cast<std::int32_t>(y)}; };
  static const std::map<std::string, setter> all{
      {"--seconds", [](options& x, double y) { x.play.length = seconds_of(y); }},
      {"--settle", [](options& x, double y) { x.settle = seconds_of(y); }},
      {"--seed", [](options& x, double y) { x.play.seed = static_cast<std::uint64_t>(y); }},
      {"--rate", [](options& x, double y) { x.play.rate = y; }},
      {"--port", [](options& x, double y) { x.play.whom.port = static_cast<std::uint16_t>(y); }},
      {"--pid", [](options& x, double y) { x.victim = static_cast<pid_t>(y); }},
      {"--hub", [id](options& x, double y) { x.play.whom.hub = id(y); }},
      {"--keeper", [id](options& x, double y) { x.play.whom.keeper = id(y); }},
      {"--porch", [id](options& x, double y) { x.play.whom.porch = id(y); }},
      {"--bystander", [id](options& x, double y) { x.play.whom.bystander = id(y); }},
  };
  return all;
}

std::optional<std::string> parse_value(const std::string& word, const std::string& value,
                                       options& x) {
  if (word == "--attack")
    return parse_attacks(value, x);
  if (word == "--network") {
    x.play.whom.network = value;
    return std::nullopt;
  }
  if (word == "--links") {
    x.links.clear();
    for (const auto& part : parts_of(value)) {
      const auto count = number_of(part);
      if (!count || *count < 1 || *count > 1000)
        return "`--links` takes numbers of 1 to 1000";
      x.links.push_back(static_cast<std::size_t>(*count));
    }
    return std::nullopt;
  }
  const auto at = numbers().find(word);
  const auto number = number_of(value);
  if (at == numbers().end())
    return "there is no option `" + word + '`';
  if (!number)
    return '`' + word + "` takes a number";
  at->second(x, *number);
  return std::nullopt;
}

} // namespace

std::optional<std::string> parse(const std::vector<std::string>& words, options& x) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--loop") {
      x.loop = true;
    } else if (words[i] == "--untimed") {
      x.timed = false;
    } else if (words[i] == "--table") {
      x.table = true;
    } else if (words[i] == "--check") {
      x.check = true;
    } else if (i + 1 == words.size()) {
      return '`' + words[i] + "` is no option, or lacks its value";
    } else if (auto wrong = parse_value(words[i], words[i + 1], x)) {
      return wrong;
    } else {
      ++i;
    }
  }
  if (x.attacks.empty() || x.links.empty())
    return "which attack?";
  return std::nullopt;
}

} // namespace rubicon::hostile
