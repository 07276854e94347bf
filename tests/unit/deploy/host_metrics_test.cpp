#include "deploy/host_metrics.hpp"

#include <chrono>
#include <string>

#include "support/catch.hpp"

using namespace rubicon;
using namespace std::chrono_literals;

TEST_CASE("metrics of a host have the state of its part and its process", "[deploy][ACT-06]") {
  deploy::host_facts x;
  x.host = "west";
  x.ecology = "a \"b\"";
  x.deployment = "7";
  x.state = deploy::part_state::waiting;
  x.lives = 3;
  x.elapsed = 1500ms;
  x.memory = 4096;
  const auto text = deploy::to_metrics(x);
  for (const auto* line :
       {"rubicon_host_info{host=\"west\",ecology=\"a \\\"b\\\"\",deployment=\"7\"} 1\n",
        "rubicon_host_part{host=\"west\",state=\"starting again\"} 1\n",
        "rubicon_host_part{host=\"west\",state=\"running\"} 0\n",
        "# TYPE rubicon_host_part_lives gauge\nrubicon_host_part_lives{host=\"west\"} 3\n",
        "rubicon_host_part_elapsed_seconds{host=\"west\"} 1.5\n",
        "rubicon_host_part_memory_bytes{host=\"west\"} 4096\n"}) {
    INFO(line);
    CHECK(text.find(line) != std::string::npos);
  }
}

TEST_CASE("a host without a part has metrics of itself alone", "[deploy][ACT-06]") {
  deploy::host_facts x;
  x.host = "west";
  CHECK(deploy::to_metrics(x).find("state=\"idle\"} 1\n") != std::string::npos);
}
