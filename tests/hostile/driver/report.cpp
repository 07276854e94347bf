#include "hostile/driver/report.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

#include "hostile/attack.hpp"

namespace rubicon::hostile {

namespace {

using counts = std::map<std::string, std::uint64_t>;

/// Over all peers, without zeros.
counts told_by(const nlohmann::json& report) {
  counts all;
  for (const auto& peer : report.at("peers")) {
    for (const auto* part : {"lost", "links_closed", "limits"}) {
      if (!peer.contains(part))
        continue;
      for (const auto& [cause, count] : peer.at(part).items()) {
        if (count.get<std::uint64_t>() > 0)
          all[std::string(part) + '.' + cause] += count.get<std::uint64_t>();
      }
    }
  }
  return all;
}

/// What is wrong with a run as such.
std::string fault_of(const nlohmann::json& report) {
  if (report.at("simulated_s") == 0 || report.at("peers").empty())
    return "the report is not complete";
  for (const auto& peer : report.at("peers")) {
    if (!peer.at("alive").get<bool>())
      return "peer " + peer.at("name").get<std::string>() + " has ended";
  }
  if (!report.at("violations").empty())
    return "violations: " + report.at("violations").dump();
  if (!report.at("actors").at("failures").empty())
    return "failures: " + report.at("actors").at("failures").dump();
  return {};
}

/// A crowd of a few links needs no limit.
bool is_told(const attack_kind& kind, const counts& all, bool few) {
  return (kind.crowd && few) || kind.told.empty() ||
         std::any_of(kind.told.begin(), kind.told.end(),
                     [&](auto cause) { return all.contains(std::string(cause)); });
}

void print(const counts& all, const std::string& fault, bool table) {
  std::printf("%s", table ? "" : "report  ");
  const char* gap = table ? "" : "  ";
  for (const auto& [cause, count] : all) {
    std::printf("%s%s %llu", gap, cause.c_str(), static_cast<unsigned long long>(count));
    gap = table ? ", " : "  ";
  }
  if (table)
    std::printf("%s%s |\n", fault.empty() ? "" : " BAD: ", fault.c_str());
  else
    std::printf("  %s\n", fault.empty() ? "good" : ("BAD: " + fault).c_str());
}

} // namespace

bool tell_report(const std::string& file, const std::string& attack, bool table) {
  std::ifstream in(file);
  const auto report = nlohmann::json::parse(in, nullptr, false);
  if (!report.is_object()) {
    std::printf("report    BAD: there is none\n");
    return false;
  }
  const auto all = told_by(report);
  auto fault = fault_of(report);
  for (const auto& kind : all_attacks()) {
    if ((attack == kind.name || attack == "all") && !is_told(kind, all, attack != "all"))
      fault += (fault.empty() ? "not told: " : ", not told: ") + std::string(kind.name);
  }
  print(all, fault, table);
  return fault.empty();
}

} // namespace rubicon::hostile
