// The part of an ecology that this computer runs for a deployment: its files, its process, and all
// that its processes have reported. It runs without its coordinator.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/load.hpp"
#include "deploy/host_access.hpp"
#include "deploy/messages.hpp"
#include "deploy/news_log.hpp"
#include "io/files/line_input.hpp"
#include "io/loop.hpp"
#include "io/process/process.hpp"

namespace rubicon::cli {

struct hosting {
  std::string host;             ///< own name
  std::filesystem::path folder; ///< where files are stored; nobody else writes there
  std::filesystem::path files;  ///< where what it runs writes; nobody else does
  deploy::host_access access;   ///< of the files that are deployed here
  config::extensions known;
};

class hosted_part {
public:
  /// @param loop must outlive it
  /// @param say prints a line for the operator of this computer
  hosted_part(io::loop& loop, const hosting& with, std::function<void(const std::string&)> say);
  ~hosted_part();
  hosted_part(const hosted_part&) = delete;
  hosted_part& operator=(const hosted_part&) = delete;

  [[nodiscard]] deploy::verdict offer(deploy::offer x);
  [[nodiscard]] deploy::verdict begin(const deploy::begin_part& x);
  [[nodiscard]] deploy::verdict cause(const deploy::cause_fault& x);
  [[nodiscard]] deploy::verdict end(const deploy::end_part& x);
  [[nodiscard]] deploy::news news_after(const deploy::ask_news& x);
  [[nodiscard]] deploy::host_facts facts() const;

  /// That its newest process has left; nothing: none has.
  [[nodiscard]] std::optional<report::run_report> newest_report();

  /// To be called now and then: restarts a killed process.
  void on_time();

  /// Ends what runs, whoever has begun it.
  void end_all();
  [[nodiscard]] bool is_running() const;

private:
  using steady = std::chrono::steady_clock;

  struct life {
    std::uint64_t number = 0;
    duration elapsed{};
    duration ended{}; ///< 0: it runs, or nobody has seen its end
    bool is_final = false;
    std::filesystem::path file;                   ///< of its report
    std::filesystem::file_time_type file_written; ///< when it was read
    report::part_report newest;
    std::uint64_t change = 0; ///< number of the last
  };

  /// What is offered, and what became of it.
  struct offered_part {
    std::string id;
    deploy::bundle what;
    config::ecology_description ecology; ///< of it, as a whole
    std::string files_hash;
    std::string log_level;
    deploy::part_state state = deploy::part_state::offered;
    steady::time_point began;
    steady::time_point begins_again;
    duration pause{}; ///< before the last start
    bool ending = false;
    bool refused = false;
    std::vector<life> lives;
    deploy::news_log log;
    std::uint64_t changes = 0;
  };

  [[nodiscard]] std::vector<std::string> problems_of(const deploy::offer& x,
                                                     const config::loaded& loaded) const;
  [[nodiscard]] bool has(const std::string& deployment) const;
  void cut(deploy::news& x) const;
  [[nodiscard]] duration elapsed() const { return steady::now() - part_->began; }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const;
  void start();
  void on_end(io::process_end how);
  void note(const std::string& line);
  void take_reports();
  void take_report(life& x);
  void keep_lives();
  void take_over_lives();
  [[nodiscard]] std::filesystem::path report_file(std::size_t number) const;

  io::loop& loop_;
  const hosting& with_;
  std::function<void(const std::string&)> say_;
  std::uint64_t next_life_;
  std::optional<offered_part> part_;
  std::optional<io::process> process_;
  io::line_splitter out_;
  io::line_splitter err_;
};

} // namespace rubicon::cli
