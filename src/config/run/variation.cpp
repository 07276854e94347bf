#include "config/run/variation.hpp"

#include <algorithm>
#include <variant>

#include "config/run/fault_variation.hpp"
#include "config/toml/document.hpp"

namespace rubicon::config {

namespace {

/// Most files have nothing that varies, and need not be parsed for that.
bool may_vary(std::string_view text) {
  return text.find(parameters_key) != std::string_view::npos ||
         text.find(vary_faults_key) != std::string_view::npos;
}

} // namespace

variation variation_of(std::string_view toml, const settings& all, std::uint64_t seed) {
  if (!may_vary(toml) && std::ranges::none_of(all, may_vary))
    return {};
  auto parsed = parse(toml, {});
  auto* root = std::get_if<node>(&parsed);
  if (root == nullptr)
    return {};
  complaints problems;
  apply(all, *root, problems);
  variation out{put_parameters(*root, seed, problems), {}};
  for (auto& kind : varied_kinds(*root))
    if (leaves_out(seed, kind))
      out.left_out.push_back(std::move(kind));
  return problems.empty() ? out : variation();
}

std::string to_text(const variation& x) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  for (const auto& [name, value] : x.drawn)
    add(name + '=' + value);
  for (const auto& kind : x.left_out)
    add("without " + kind);
  return text;
}

} // namespace rubicon::config
