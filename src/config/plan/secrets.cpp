#include "config/plan/secrets.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

namespace rubicon::config {

namespace {

constexpr std::string_view no_secret = "\"00000000000000000000000000000000\"";

void add(secret_names& to, const ecology_description& all, const std::vector<mote_app>& apps) {
  for (const auto& app : apps) {
    const auto* member = std::get_if<smepp::member_config>(&app);
    if (member == nullptr)
      continue;
    to.insert({"smepp.network_key", "smepp.network_mac", master_key_name(member->group)});
    if (all.smepp.authenticates_sender)
      to.insert("smepp.pairwise_key");
  }
}

/// Walks through a TOML file of which only texts and comments matter.
class text_walk {
public:
  text_walk(std::string_view toml, const std::vector<secret_place>& secrets)
      : rest_(toml), secrets_(secrets) {
    if (rest_.starts_with(byte_order_mark))
      out_ += take(byte_order_mark.size());
    at_ = {1, 1};
  }

  std::optional<std::string> result() {
    while (!rest_.empty())
      step();
    return found_ == secrets_.size() ? std::optional(std::move(out_)) : std::nullopt;
  }

private:
  void step() {
    const char next = rest_.front();
    if (next == '#') {
      static_cast<void>(take(std::min(rest_.find_first_of("\r\n"), rest_.size())));
    } else if (next == '"' || next == '\'') {
      const bool is_secret = std::ranges::find(secrets_, at_, &secret_place::at) != secrets_.end();
      found_ += is_secret ? 1 : 0;
      const auto text = take(length_of_text());
      out_ += is_secret ? no_secret : text;
    } else {
      out_ += take(1);
    }
  }

  /// Of the text that begins here, with its quotes.
  [[nodiscard]] std::size_t length_of_text() const {
    const char quote = rest_.front();
    const std::string three(3, quote);
    const bool is_long = rest_.starts_with(three);
    const auto end = is_long ? std::string_view(three) : std::string_view(three).substr(0, 1);
    auto i = end.size();
    while (i < rest_.size() && !rest_.substr(i).starts_with(end))
      i += quote == '"' && rest_[i] == '\\' ? 2 : 1;
    i += end.size();
    while (is_long && i < rest_.size() && rest_[i] == quote)
      ++i; // up to two quotes may stand before the end
    return std::min(i, rest_.size());
  }

  /// Columns are characters of UTF-8.
  std::string_view take(std::size_t octets) {
    const auto taken = rest_.substr(0, octets);
    rest_.remove_prefix(octets);
    for (const char x : taken)
      if (x == '\n')
        at_ = {at_.line + 1, 1};
      else if ((static_cast<unsigned char>(x) & 0xc0U) != 0x80U)
        ++at_.column;
    return taken;
  }

  std::string_view rest_;
  const std::vector<secret_place>& secrets_;
  mark at_{1, 1};
  std::string out_;
  std::size_t found_ = 0;
};

} // namespace

std::string master_key_name(const std::string& group) {
  return "smepp.group." + group + ".master_key";
}

secret_names secrets_of(const ecology_description& all, const fault& x) {
  secret_names out;
  if (const auto* crash = std::get_if<crash_fault>(&x); crash != nullptr && crash->becomes)
    add(out, all, crash->becomes->apps);
  return out;
}

secret_names secrets_of(const ecology_description& part) {
  secret_names out;
  for (const auto& island : part.islands)
    for (const auto& mote : island.motes)
      add(out, part, mote.apps);
  for (const auto& each : part.faults)
    out.merge(secrets_of(part, each.what));
  return out;
}

std::optional<std::string> without(const std::vector<secret_place>& secrets,
                                   std::string_view toml) {
  return text_walk(toml, secrets).result();
}

} // namespace rubicon::config
