// What a host is doing, as metrics that Prometheus collects (docs/metrics.md).
#pragma once

#include <string>

#include "deploy/messages.hpp"

namespace rubicon::deploy {

/// Of the host and the process of its part: `rubicon_host_...`. What the part has counted is in its
/// report.
[[nodiscard]] std::string to_metrics(const host_facts& x);

} // namespace rubicon::deploy
