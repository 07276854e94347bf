// The hosts of a file as processes of this computer, for a first try.
#pragma once

#include <chrono>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "cli/hosts/deployed.hpp"
#include "core/bytes.hpp"
#include "io/files/line_input.hpp"
#include "io/files/temporary_folder.hpp"
#include "io/loop.hpp"
#include "io/process/process.hpp"

namespace rubicon::cli {

/// They run until this is destroyed, and are restarted when they are killed; their own certificates
/// admit nobody else.
class local_hosts {
public:
  /// @param loop must outlive it
  /// @throws std::runtime_error if there is no room for their files
  local_hosts(io::loop& loop, const std::vector<deployed_host>& hosts);
  ~local_hosts();
  local_hosts(const local_hosts&) = delete;
  local_hosts& operator=(const local_hosts&) = delete;

  /// Of the coordinator that deploys to them.
  [[nodiscard]] control::tls_files own_certificate() const { return certificate_of(coordinator_); }

  /// To be called now and then.
  void on_time();

private:
  using steady = std::chrono::steady_clock;

  struct local_host {
    deployed_host place;
    std::optional<io::process> process;
    steady::time_point starts_at;
    io::line_splitter lines;
    std::string last_line;
  };

  [[nodiscard]] control::tls_files certificate_of(const std::string& name) const;
  void start(local_host& x);

  io::loop& loop_;
  const io::temporary_folder folder_{"rubicon-deploy"};
  std::string coordinator_ = "coordinator"; ///< no host has this name
  std::list<local_host> hosts_;             ///< processes refer to them
};

} // namespace rubicon::cli
