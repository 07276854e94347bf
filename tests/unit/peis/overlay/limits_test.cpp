// The limits of docs/security.md are those of the code.
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "peis/kernel/kernel.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

using cells = std::vector<std::string>;

/// The rows of the first table after a line, by their first cell.
std::map<std::string, cells> table_after(const std::string& mark) {
  std::ifstream file(RUBICON_SOURCE_DIR "/docs/security.md");
  REQUIRE(file);
  std::map<std::string, cells> rows;
  bool found = false;
  for (std::string line; std::getline(file, line);) {
    found = found || line.find(mark) != std::string::npos;
    if (found && !line.starts_with('|') && !rows.empty())
      break;
    if (!found || !line.starts_with("| "))
      continue;
    std::istringstream in(line.substr(2));
    cells all;
    for (std::string cell; std::getline(in, cell, '|');) {
      cell.erase(0, cell.find_first_not_of(' '));
      cell.erase(cell.find_last_not_of(' ') + 1);
      all.push_back(cell);
    }
    rows[all.at(0)] = all;
  }
  return rows;
}

/// The number that a cell begins with.
std::uint64_t number_in(const std::string& cell) {
  return std::stoull(cell);
}

} // namespace

TEST_CASE("limits are those that are documented", "[peis][docs][P2P-03]") {
  const auto rows = table_after("limits: checked by the test");
  const p2p_config config;
  const auto entries = [&](const char* table) { return number_in(rows.at(table).at(1)); };
  const auto octets = [&](const char* table) { return number_in(rows.at(table).at(2)); };
  CHECK(entries("links") == config.links_max);
  CHECK(entries("connections that have not asked for a link") == config.greetings_max);
  CHECK(octets("connections that have not asked for a link") == connect_request_size);
  CHECK(octets("input of a link that waits for its turn") == config.input_max);
  CHECK(entries("queue of a link") == config.queue.packages);
  CHECK(octets("queue of a link") == config.queue.octets);
  CHECK(octets("queues of all links") == config.queues_octets_max);
  CHECK(entries("hosts") == config.tables.hosts);
  CHECK(entries("routes") == config.tables.routes);
  CHECK(entries("a neighbour's routing table") == routing_pages_max * entries_per_page);
  CHECK(entries("questions about hosts without a record") == config.tables.questions_per_second);
  CHECK(entries("routing tables") == static_cast<std::uint64_t>(1s / config.tables.table_gap));
  CHECK(entries("how connecting to a host has gone") == config.tables.contacts);
  CHECK(entries("links over which sources without a route were received") ==
        config.tables.heard_over);
  CHECK(entries("ids seen") == config.tables.seen);
  CHECK(entries("messages put together") == config.assembly.messages_max);
  CHECK(octets("messages put together") == config.assembly.octets_max);
  CHECK(entries("sources to be acknowledged") == acknowledger::sources_max);
  CHECK(entries("answers about hosts that are not acknowledged") == config.tables.answers);
  CHECK(entries("messages that wait for one peer") == config.reliable.waiting_max);
  CHECK(octets("messages that wait for one peer") == config.reliable.waiting_octets_max);
  CHECK(entries("unacknowledged packages to one peer") == config.reliable.window.packages);
  CHECK(entries("probes of routes that may lead in circles") == config.tables.probes);
  CHECK(entries("Bluetooth devices of an adapter") == config.bluetooth.devices_max);
}

} // namespace rubicon::peis
