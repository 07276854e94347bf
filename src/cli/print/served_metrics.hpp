// Metrics of a run for Prometheus to collect (docs/metrics.md): `--metrics`.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "cli/words/watch_options.hpp"
#include "core/time.hpp"
#include "io/tcp/web_server.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

/// Serves `/metrics` from now on, until it is destroyed.
class served_metrics {
public:
  /// A report of a run is collected as often.
  static constexpr duration collect_every = 5s;

  /// Says on standard error where. @throws std::runtime_error if nobody can listen there
  explicit served_metrics(const metrics_place& where);

  /// What is served from now on.
  void show(const report::run_report& x);

private:
  /// Shared with the server's thread.
  struct newest {
    std::mutex lock;
    std::string text;
  };

  bool motes_; ///< each of them
  std::shared_ptr<newest> newest_ = std::make_shared<newest>();
  std::optional<io::web_server> server_;
};

} // namespace rubicon::cli
