#include "scheduler/printer.hpp"

#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>

#include <caf/actor_config.hpp>
#include <caf/actor_system.hpp>
#include <caf/make_actor.hpp>
#include <caf/monitorable_actor.hpp>

#include "core/text/printable.hpp"

namespace rubicon::scheduler {

namespace {

class printer final : public caf::monitorable_actor {
public:
  explicit printer(caf::actor_config& config) : monitorable_actor(config) {}

  ~printer() override {
    if (!line_.empty())
      flush("\n");
  }

  using caf::abstract_actor::enqueue;

  void enqueue(caf::mailbox_element_ptr x, caf::execution_unit*) override {
    const auto& content = x->content();
    if (!content.match_elements<caf::atom_value, caf::actor_id, std::string>())
      return;
    const std::scoped_lock lock(mutex_);
    flush(content.get_as<std::string>(2));
  }

  [[nodiscard]] const char* name() const override { return "printer"; }

private:
  void flush(std::string_view text) {
    line_ += text;
    const auto end = line_.rfind('\n');
    if (end == std::string::npos)
      return;
    for (std::size_t from = 0; from <= end;) { // what a message held may be anything
      const auto length = line_.find('\n', from) - from;
      const auto shown = printable(std::string_view(line_).substr(from, length)) + '\n';
      std::fwrite(shown.data(), 1, shown.size(), stderr);
      from += length + 1;
    }
    line_.erase(0, end + 1);
  }

  std::mutex mutex_; ///< any thread may complain
  std::string line_;
};

} // namespace

caf::actor make_printer(caf::actor_system& system) {
  caf::actor_config config;
  config.host = system.dummy_execution_unit();
  return caf::make_actor<printer, caf::actor>(system.next_actor_id(), system.node(), &system,
                                              config);
}

} // namespace rubicon::scheduler
