// Programs that use the Mockup interface, inside the actor of their node.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "actors/log.hpp"
#include "actors/messages.hpp"
#include "apps/application.hpp"
#include "core/random.hpp"

namespace rubicon {

class program_host {
public:
  /// Makes the programs among `configs` and starts them on `node`, a mote::node or endpoint::pc.
  /// @param who their actor's path, without its kind
  /// @param again their node ran before: files go on
  template <class Node>
  void start(Node& node, const std::vector<apps::app_config>& configs, const std::string& who,
             std::uint64_t seed, bool again, instant now) {
    for (const auto& config : configs) {
      auto& x = programs_.emplace_back();
      x.name = std::string(apps::kind_of(config));
      x.program = apps::make_application(
          config, random_stream(seed, who + '/' + x.name + std::to_string(programs_.size())));
      x.open(again);
      x.program->start(node.attach(*x.program), now);
    }
  }

  void on_time(instant now) {
    for (auto& x : programs_)
      x.program->on_time(now);
  }

  [[nodiscard]] std::optional<instant> deadline() const {
    std::optional<instant> due;
    for (const auto& x : programs_)
      due = earliest(due, x.program->deadline());
    return due;
  }

  /// Passes on what programs have to tell, and writes what they have for their files.
  template <class Self>
  void tell(Self* self, const ecology_actor& ecology) {
    for (auto& x : programs_) {
      for (auto& what : x.program->take_stories())
        self->send(ecology, story{self->path(), std::move(what)});
      if (x.file && x.write(x.program->take_lines())) {
        const auto what = std::string(x.program->file()) + ": " + x.failure;
        log(self, spdlog::level::err, "event=not_written file={}", what);
        self->send(ecology, story{self->path(), "cannot write " + what});
      }
    }
  }

  /// @param who the node's name in the report
  template <class Self>
  void report(Self* self, const ecology_actor& ecology, const std::string& who) {
    for (const auto& x : programs_) {
      program_status status{{who, x.name, {}}};
      for (const auto& figure : x.program->figures())
        status.program.figures.emplace_back(figure.name, figure.value);
      if (x.file)
        status.program.figures.emplace_back("lines not written", static_cast<double>(x.unwritten));
      self->send(ecology, std::move(status));
    }
  }

private:
  struct hosted {
    std::string name;
    std::unique_ptr<apps::application> program;
    std::unique_ptr<std::ofstream> file; ///< nullptr: it writes none
    std::string failure;                 ///< the first; empty while all is well
    std::uint64_t unwritten = 0;         ///< lines

    void open(bool again) {
      const std::string path(program->file());
      if (path.empty())
        return;
      file = std::make_unique<std::ofstream>(path, std::ios::binary |
                                                       (again ? std::ios::app : std::ios::trunc));
      if (!again)
        *file << program->file_heading();
    }

    /// Lines are in the file when this returns. @returns whether the first failure has shown
    bool write(const std::string& lines) {
      if (!failure.empty() || (!lines.empty() && !(*file << lines << std::flush)) || !*file) {
        unwritten += static_cast<std::uint64_t>(std::count(lines.begin(), lines.end(), '\n'));
        const bool is_first = failure.empty();
        if (is_first)
          failure = std::generic_category().message(errno != 0 ? errno : EIO);
        return is_first;
      }
      return false;
    }
  };

  std::vector<hosted> programs_;
};

/// The programs among a node's apps.
template <class App>
[[nodiscard]] std::vector<apps::app_config> programs_among(const std::vector<App>& all) {
  std::vector<apps::app_config> found;
  for (const auto& app : all) {
    if (const auto* x = std::get_if<apps::app_config>(&app))
      found.push_back(*x);
  }
  return found;
}

} // namespace rubicon
