#include <algorithm>
#include <utility>

#include "config/file_readers.hpp"

namespace rubicon::config {

namespace {

constexpr std::size_t network_octets_max = 62; ///< peis-wire.md 2

void read_mote_fault(table_reader& in, const directory& names, mote_address& out) {
  in.required("mote", mote_name{names}, out);
}

unplug_fault read_unplug(table_reader& in, const directory& names) {
  unplug_fault out;
  in.required("island", island_name{names}, out.island);
  if (const auto* island = names.find(out.island); island != nullptr && !island->has_gateway)
    in.problems().add(in.at("island"), "an island with stack = \"mac\" has no serial cable");
  in.optional("for", time_span{1ms}, out.length);
  return out;
}

fault_description read_fault(table_reader& in, const directory& names, duration length) {
  fault_description out;
  if (in.required("at", time_span{}, out.at) && out.at > length)
    in.problems().add(in.at("at"),
                      "`at` is after the end of the run, which is at " + to_text(length));
  in.one_of("kind", {{"battery_end",
                      [&](table_reader& x) {
                        battery_end_fault fault;
                        read_mote_fault(x, names, fault.mote);
                        out.what = fault;
                      }},
                     {"crash",
                      [&](table_reader& x) {
                        crash_fault fault;
                        read_mote_fault(x, names, fault.mote);
                        out.what = fault;
                      }},
                     {"unplug", [&](table_reader& x) { out.what = read_unplug(x, names); }}});
  return out;
}

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

std::vector<fault_description> read_faults(table_reader& root, const directory& names,
                                           duration length) {
  std::vector<fault_description> out;
  root.tables("fault", "[[fault]]",
              [&](table_reader& x) { out.push_back(read_fault(x, names, length)); });
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.at < b.at; });
  return out;
}

} // namespace rubicon::config
