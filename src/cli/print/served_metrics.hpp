// Metrics for Prometheus to collect (docs/metrics.md): `--metrics`.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "cli/words/watch_options.hpp"
#include "core/time.hpp"
#include "io/tcp/web_server.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

/// Serves `/metrics` from now on, until it is destroyed. Text is made by a thread of its own:
/// neither a run nor a request waits for that.
class served_metrics {
public:
  /// A report of a run is collected as often.
  static constexpr duration collect_every = 5s;

  /// Says on standard error where. @throws std::runtime_error if nobody can listen there
  explicit served_metrics(const metrics_place& where);
  ~served_metrics();
  served_metrics(const served_metrics&) = delete;
  served_metrics& operator=(const served_metrics&) = delete;

  /// What is served soon: the newest of what is shown. @param first text before that of the report
  void show(std::optional<report::run_report> x, std::string first = {});

  /// As it listens.
  [[nodiscard]] std::uint16_t port() const { return server_->port(); }

private:
  struct shown {
    std::optional<report::run_report> report;
    std::string first;
  };

  /// Shared with the server's thread.
  struct newest {
    std::mutex lock;
    std::shared_ptr<const std::string> text = std::make_shared<const std::string>();
  };

  void make_texts();

  const bool motes_; ///< each of them
  std::shared_ptr<newest> newest_ = std::make_shared<newest>();
  std::optional<io::web_server> server_;
  std::mutex lock_;              ///< of the next two
  std::optional<shown> waiting_; ///< no text is made of it yet
  bool over_ = false;
  std::condition_variable wake_;
  std::thread maker_;
};

} // namespace rubicon::cli
