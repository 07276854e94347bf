#include "config/run/fault_variation.hpp"

#include <set>

#include "core/numbers/random.hpp"

namespace rubicon::config {

bool leaves_out(std::uint64_t seed, std::string_view kind) {
  return random_stream(seed, "leave out/" + std::string(kind)).chance(0.5);
}

bool varies_faults(const node& root) {
  const auto* run = root.find("ecology");
  const auto* given = run == nullptr ? nullptr : run->find(vary_faults_key);
  const auto* flag = given == nullptr ? nullptr : given->as<bool>();
  return flag != nullptr && *flag;
}

std::vector<std::string> varied_kinds(const node& root) {
  const auto* found = root.find("fault");
  const auto* faults = found == nullptr ? nullptr : found->as<node_array>();
  if (faults == nullptr || !varies_faults(root))
    return {};
  std::set<std::string> kinds;
  for (const auto& each : *faults) {
    const auto* kind = each.find("kind");
    if (const auto* word = kind == nullptr ? nullptr : kind->as<std::string>())
      kinds.insert(*word);
  }
  return {kinds.begin(), kinds.end()};
}

} // namespace rubicon::config
