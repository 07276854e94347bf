#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "config/toml/settings.hpp"
#include "core/numbers/random.hpp"
#include "core/text/decimal.hpp"
#include "core/text/name.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::config {

namespace {

constexpr std::string_view opening = "${";
constexpr std::size_t texts_octets_max = file_octets_max; ///< that parameters make, all together

/// As a setting has it, and a text that names it.
std::string value_text(const node& x) {
  const auto* text = x.as<std::string>();
  return text == nullptr ? describe(x) : *text;
}

/// Walks through a file, and remembers which parameters it names.
class replacement {
public:
  replacement(const node_table& known, complaints& problems) : known_(known), problems_(problems) {}

  void put(node& x) {
    if (auto* members = std::get_if<node_table>(&x.content)) {
      for (auto& each : *members)
        put(each.value);
    } else if (auto* elements = std::get_if<node_array>(&x.content)) {
      for (auto& each : *elements)
        put(each);
    } else if (const auto* text = x.as<std::string>();
               text != nullptr && text->find(opening) != std::string::npos) {
      replace(x);
    }
  }

  void doubt_unused() {
    for (const auto& each : known_)
      if (!used_.contains(each.key))
        problems_.warn(each.at, "no value names the parameter `" + each.key + '`');
  }

private:
  void replace(node& x) {
    const auto text = std::get<std::string>(x.content);
    if (text.starts_with(opening) && text.find('}') == text.size() - 1) {
      if (const auto* value = find(x, text.substr(2, text.size() - 3)))
        x.content = value->content;
      return;
    }
    auto replaced = with_values(x, text);
    if (!replaced)
      return;
    octets_ += replaced->size();
    if (octets_ <= texts_octets_max)
      x.content = *std::move(replaced);
    else if (!std::exchange(is_too_large_, true))
      problems_.add(x.at, "with its parameters the file has more than " +
                              std::to_string(texts_octets_max) + " octets of text");
  }

  std::optional<std::string> with_values(const node& x, std::string_view rest) {
    std::string out;
    for (auto at = rest.find(opening); at != std::string_view::npos; at = rest.find(opening)) {
      if (at > 0 && rest[at - 1] == '$') {
        out += std::string(rest.substr(0, at - 1)) + std::string(opening);
        rest.remove_prefix(at + opening.size());
        continue;
      }
      const auto end = rest.find('}', at);
      if (end == std::string_view::npos) {
        problems_.add(x.at, "`${` has no `}`; a plain one is `$${`");
        return std::nullopt;
      }
      const auto* value = find(x, std::string(rest.substr(at + 2, end - at - 2)));
      if (value == nullptr)
        return std::nullopt;
      out += std::string(rest.substr(0, at)) + value_text(*value);
      rest.remove_prefix(end + 1);
    }
    return out + std::string(rest);
  }

  const node* find(const node& x, const std::string& name) {
    const auto found = std::ranges::find(known_, name, &member::key);
    if (found != known_.end()) {
      used_.insert(name);
      return &found->value;
    }
    std::vector<std::string> names;
    for (const auto& each : known_)
      names.push_back(each.key);
    problems_.add(x.at,
                  "there is no parameter `" + name + "` in [parameters]" + suggestion(name, names));
    return nullptr;
  }

  const node_table& known_;
  complaints& problems_;
  std::set<std::string> used_;
  std::size_t octets_ = 0;
  bool is_too_large_ = false;
};

constexpr std::uint64_t draw_steps = 10'000;

/// One end of a range.
struct range_end {
  double value = 0;
  std::optional<std::int64_t> whole = std::nullopt;
  std::optional<std::string> unit = std::nullopt; ///< of a text
};

std::optional<range_end> end_in(const node* x) {
  if (x == nullptr)
    return std::nullopt;
  if (const auto* whole = x->as<std::int64_t>())
    return range_end{static_cast<double>(*whole), *whole};
  if (const auto* real = x->as<double>())
    return std::isfinite(*real) ? std::optional(range_end{*real}) : std::nullopt;
  const auto* text = x->as<std::string>();
  if (text == nullptr)
    return std::nullopt;
  range_end out;
  const auto* last = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), last, out.value);
  if (error != std::errc{} || !std::isfinite(out.value))
    return std::nullopt;
  out.unit = std::string(stop, last);
  return out;
}

/// With nine digits, which hides what binary fractions add: a time has no more decimals than fit.
double clean_decimal(double x) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::general, 9).ptr;
  double out = x;
  std::from_chars(text.data(), end, out);
  return out;
}

node drawn(const member& x, const range_end& from, const range_end& to, std::uint64_t seed) {
  random_stream random(seed, "parameter/" + x.key);
  node out{x.value.at, {}};
  if (from.whole && to.whole) {
    const auto lowest = static_cast<std::uint64_t>(*from.whole);
    const auto more = static_cast<std::uint64_t>(*to.whole) - lowest;
    const auto above = more == UINT64_MAX ? random.next() : random.below(more + 1);
    out.content = static_cast<std::int64_t>(lowest + above);
    return out;
  }
  const auto step = static_cast<double>(random.below(draw_steps + 1));
  const auto share = step / static_cast<double>(draw_steps);
  const auto value = clean_decimal(from.value + (to.value - from.value) * share);
  if (from.unit)
    out.content = shortest_decimal(value) + *from.unit;
  else
    out.content = value;
  return out;
}

/// The value for one seed, both ends included: of two whole numbers a whole one, of other numbers
/// one in 10 000 steps, of numbers with a unit (`"10s"`) one with that unit. It depends on nothing
/// but the seed and the parameter's name and range.
/// @param x its value is a table
/// @returns nothing: that is no range, as `problems` says
std::optional<node> drawn_parameter(const member& x, std::uint64_t seed, complaints& problems) {
  for (const auto& each : *x.value.as<node_table>())
    if (each.key != "from" && each.key != "to") {
      problems.add(each.at, "unknown key `" + each.key + "`: a range has `from` and `to`");
      return std::nullopt;
    }
  const auto from = end_in(x.value.find("from"));
  const auto to = end_in(x.value.find("to"));
  if (!from || !to) {
    problems.add(x.value.at, '`' + x.key +
                                 "` needs `from` and `to`, each a number, or a text that begins "
                                 "with one");
    return std::nullopt;
  }
  if (from->unit != to->unit) {
    problems.add(x.value.at, "`from` and `to` of `" + x.key + "` must have the same unit");
    return std::nullopt;
  }
  if (to->value < from->value) {
    problems.add(x.value.at, "`to` of `" + x.key + "` must not be less than `from`");
    return std::nullopt;
  }
  return drawn(x, *from, *to, seed);
}

/// Draws those that have a range. @returns whether all can be values of parameters
bool check(node_table& parameters, std::uint64_t seed, complaints& problems,
           parameter_values& drawn) {
  const auto before = problems.size();
  for (auto& each : parameters) {
    auto& x = each.value;
    if (x.as<node_table>() != nullptr) {
      if (auto value = drawn_parameter(each, seed, problems)) {
        x.content = std::move(value->content);
        drawn.emplace(each.key, value_text(x));
      }
      continue;
    }
    const auto* text = x.as<std::string>();
    if (!is_name(each.key))
      problems.add(each.at, "a parameter's name has letters, digits, - and _, at most 32");
    else if (text != nullptr && text->find(opening) != std::string::npos)
      problems.add(x.at, "a parameter cannot name another");
    else if (text == nullptr && x.as<std::int64_t>() == nullptr && x.as<double>() == nullptr &&
             x.as<bool>() == nullptr)
      problems.add(x.at,
                   '`' + each.key +
                       "` must be a text, a number, true or false, or a table with `from` and "
                       "`to`, not " +
                       describe(x));
  }
  return problems.size() == before;
}

} // namespace

parameter_values put_parameters(node& root, std::uint64_t seed, complaints& problems) {
  parameter_values drawn;
  const auto* found = root.find(parameters_key);
  if (found == nullptr)
    return drawn;
  const auto* parameters = found->as<node_table>();
  if (parameters == nullptr) {
    problems.add(found->at, "`parameters` must be a table, not " + describe(*found));
    return drawn;
  }
  auto known = *parameters; // it is taken out below
  if (!check(known, seed, problems, drawn))
    return drawn;
  replacement all(known, problems);
  auto& members = std::get<node_table>(root.content);
  std::erase_if(members, [](const member& x) { return x.key == parameters_key; });
  all.put(root);
  all.doubt_unused();
  return drawn;
}

} // namespace rubicon::config
