// How the tuple layer of a kernel grows: time and memory of many subscriptions and many tuples, for
// growing numbers, so that what is not linear shows. In one process and virtual time.
//
// usage: bench_tuples [SECTION...]    none: all
// Sections: subscriptions patterns tuples repeats
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "calibration.hpp"
#include "figures.hpp"
#include "io/process/spare_memory.hpp"
#include "kernel_pair.hpp"
#include "peis/kernel/kernel.hpp"
#include "peis/tuples/tuple_record.hpp"

namespace {

using namespace rubicon;
using bench::cpu_s;
using bench::figures;
using bench::kernel_pair;

double resident_mb() {
  return static_cast<double>(io::resident_memory()) / 1e6;
}

constexpr double limit_s = 100;

void measure_subscriptions(figures& out, const std::string& what, const char* format) {
  for (const int count : {10'000, 50'000, 100'000}) {
    kernel_pair all;
    const auto name = what + ' ' + std::to_string(count);
    const auto memory = resident_mb();
    auto begun = cpu_s();
    for (int i = 0; i < count; ++i) {
      std::array<char, 64> key{};
      std::snprintf(key.data(), key.size(), format, i);
      all.command(1, [&](auto& x, instant now) {
        return x.subscriptions().subscribe(peer_id{1}, key.data(),
                                           peis::subscription_id{std::uint64_t(i + 1)}, now);
      });
    }
    const bool done = all.pass_until(
        [&] { return all.at(0).counters().tuples.subscribers >= std::size_t(count); }, limit_s);
    out.add(name + (done ? "" : " (NOT REACHED)"), cpu_s() - begun, 2, "s");
    out.add(name + ": memory", resident_mb() - memory, 0, "MB");
    begun = cpu_s();
    for (int i = 0; i < 1000; ++i) {
      std::array<char, 64> key{};
      std::snprintf(key.data(), key.size(), "a.b.k%d", i);
      all.command(0, [&](auto& x, instant now) {
        return x.tuples().set(key.data(), peis::text_content("1"), now);
      });
    }
    out.add(name + ": 1000 sets", cpu_s() - begun, 3, "s");
    begun = cpu_s();
    all.pass(60s);
    out.add(name + ": 60 s of refreshing", cpu_s() - begun, 2, "s");
    out.add(name + ": longest turn", all.turn_max_s * 1000, 1, "ms");
    begun = cpu_s();
    all.command(0, [](auto& x, instant now) { return x.on_link_closed(peis::link_id{1}, now); });
    all.pass(10s);
    out.add(name + ": subscriber gone", cpu_s() - begun, 2, "s");
  }
}

void measure_tuples(figures& out) {
  for (const int count : {10'000, 100'000, 999'000}) { // kernel.* tuples count as well
    kernel_pair all;
    const auto name = "tuples " + std::to_string(count);
    const auto memory = resident_mb();
    auto begun = cpu_s();
    for (int i = 0; i < count; ++i) {
      all.command(0, [&](auto& x, instant now) {
        return x.tuples().set("a.k" + std::to_string(i), peis::text_content("1"), now);
      });
    }
    out.add(name + ": set", cpu_s() - begun, 2, "s");
    out.add(name + ": memory of own", resident_mb() - memory, 0, "MB");
    begun = cpu_s();
    all.command(1, [&](auto& x, instant now) {
      return x.subscriptions().subscribe(peer_id{1}, "a.*", peis::subscription_id{1}, now);
    });
    const bool done = all.pass_until(
        [&] { return all.at(1).counters().tuples.pushes_received >= std::size_t(count); }, limit_s);
    out.add(name + ": pushed" + (done ? "" : " (NOT REACHED)"), cpu_s() - begun, 2, "s");
    out.add(name + ": memory", resident_mb() - memory, 0, "MB");
    out.add(name + ": longest turn", all.turn_max_s * 1000, 1, "ms");
    begun = cpu_s();
    for (int i = 0; i < count; ++i) {
      all.command(0, [&](auto& x, instant now) {
        return x.tuples().remove("a.k" + std::to_string(i), now);
      });
      if (i % 500 == 0)
        all.pass(1ms);
    }
    out.add(name + ": deleted", cpu_s() - begun, 2, "s");
  }
}

/// One peer says the same 280 octets again and again to one that has 2000 tuples.
void measure_repeats(figures& out) {
  kernel_pair all;
  for (int i = 0; i < 2000; ++i) {
    all.command(0, [&](auto& x, instant now) {
      return x.tuples().set("a.k" + std::to_string(i), peis::text_content(std::string(100, 'x')),
                            now);
    });
  }
  const auto memory = resident_mb();
  const auto begun = cpu_s();
  peis::subscribe_message message;
  message.wanted.name = *peis::key::parse("a.*");
  const auto octets = peis::encode(message);
  bytes package; // as they come from one read of a socket
  for (int i = 0; i < 300; ++i) {
    peis::package_header header;
    header.id = header.ack_id = 100'000 + i;
    header.type = peis::package_type::direct;
    header.flags = peis::package_flag::reliable;
    header.source = peer_id{2};
    header.destination = peer_id{1};
    header.port = peis::port::subscribe;
    header.length = static_cast<std::uint16_t>(octets.size());
    peis::encode(header, package);
    package.insert(package.end(), octets.begin(), octets.end());
  }
  all.command(
      0, [&](auto& x, instant now) { return x.on_link_octets(peis::link_id{1}, package, now); });
  const auto peak = resident_mb();
  out.add("300 equal subscriptions over 2000 tuples: turn", cpu_s() - begun, 2, "s");
  all.pass(10s);
  out.add("300 equal subscriptions over 2000 tuples", cpu_s() - begun, 2, "s");
  out.add("300 equal subscriptions over 2000 tuples: memory", peak - memory, 0, "MB");
}

} // namespace

int main(int argc, char* argv[]) {
  figures out;
  const auto wanted = [&](std::string_view section) {
    bool any = false;
    for (int i = 1; i < argc; ++i) {
      if (argv[i] == section)
        return true;
      any = any || argv[i][0] != '-';
    }
    return !any;
  };
  if (wanted("subscriptions"))
    measure_subscriptions(out, "subscriptions", "a.b.k%d");
  if (wanted("patterns"))
    measure_subscriptions(out, "patterns", "a.*.k%d");
  if (wanted("tuples"))
    measure_tuples(out);
  if (wanted("repeats"))
    measure_repeats(out);
}
