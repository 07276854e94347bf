#include "deploy/host_metrics.hpp"

#include "report/print/exposition.hpp"

namespace rubicon::deploy {

std::string to_metrics(const host_facts& x) {
  using report::metric_kind;
  report::exposition out;
  const report::metric_labels host{{"host", x.host}};
  out.add("rubicon_host_info", metric_kind::gauge, "A host of a deployment; always 1",
          {{"host", x.host}, {"ecology", x.ecology}, {"deployment", x.deployment}}, 1);
  for (const auto state : {part_state::none, part_state::offered, part_state::running,
                           part_state::waiting, part_state::ended})
    out.add("rubicon_host_part", metric_kind::gauge, "1 for the state that the host's part is in",
            {{"host", x.host}, {"state", to_string(state)}}, x.state == state ? 1 : 0);
  out.add("rubicon_host_part_lives", metric_kind::gauge,
          "Processes of the part so far: each more than one was a restart", host, x.lives);
  out.add("rubicon_host_part_elapsed_seconds", metric_kind::gauge,
          "Time since the deployment began on all hosts", host, seconds(x.elapsed));
  out.add("rubicon_host_part_memory_bytes", metric_kind::gauge,
          "Memory of the part's process; 0 while there is none", host,
          static_cast<double>(x.memory));
  return out.finish();
}

} // namespace rubicon::deploy
