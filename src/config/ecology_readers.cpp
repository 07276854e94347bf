#include <utility>

#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t network_octets_max = 62; ///< peis-wire.md 2
constexpr duration tick_max = 8191ms;          ///< 13 bits of a clock stamp

} // namespace

void read_ecology(table_reader& root, ecology_description& out) {
  const bool found = root.table("ecology", "[ecology]", [&out](table_reader& in) {
    in.required("name", name_text{}, out.name);
    in.optional("seed", whole<std::uint64_t>{0, INT64_MAX}, out.seed);
    in.optional("mode",
                word<run_mode>{{{"virtual", run_mode::virtual_time}, {"wall", run_mode::wall}}},
                out.mode);
    in.optional("duration", time_span{1ms}, out.length);
    in.optional("network", text{network_octets_max}, out.network);
    duration tick = out.tick;
    if (in.optional("tick", time_span{10ms, tick_max}, tick)) {
      out.tick = std::chrono::duration_cast<std::chrono::milliseconds>(tick);
      if (out.tick != tick)
        in.problems().add(in.at("tick"), "`tick` must be whole milliseconds");
    }
  });
  if (!found && !root.has("ecology"))
    root.problems().add(root.at(), "the file lacks the table [ecology]");
}

std::vector<host_description> read_hosts(table_reader& root) {
  std::vector<host_description> out;
  name_claims names;
  root.tables("host", "[[host]]", [&](table_reader& in) {
    host_description host;
    if (in.required("name", name_text{}, host.name))
      names.claim(host.name, "host name", in.at("name"), in.problems());
    in.required("address", text{253}, host.address);
    out.push_back(std::move(host));
  });
  return out;
}

} // namespace rubicon::config
