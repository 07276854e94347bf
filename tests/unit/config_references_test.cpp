#include <string>

#include "config_sample.hpp"
#include "support/catch.hpp"

using namespace rubicon::test;

TEST_CASE("islands and peers share ids and names", "[config][GEN-06][ADR-02][ADR-03]") {
  const auto x = GENERATE(values<row>({
      {"[[island]]\nname = \"b\"\nid = 1\n",
       "17:6: PEIS id 1 is already taken (line 13, column 6)"},
      {"[[island]]\nname = \"K\"\nid = 2\n",
       "16:8: island name `K` is already taken (line 12, column 8)"},
      {"[[island]]\nname = \"b\"\nid = 300\n",
       "17:6: `id` must be a whole number from 1 to 254, not 300"},
      {"[[island]]\nname = \"b\"\nid = 254\n", "none"},
      {"[[island]]\nname = \"b\"\nid = 255\n",
       "17:6: `id` must be a whole number from 1 to 254, not 255"},
      {"[[island]]\nname = \"b\"\nid = 0\n",
       "17:6: `id` must be a whole number from 1 to 254, not 0"},
      {"[[peer]]\nname = \"pc2\"\nid = 1\n",
       "17:6: PEIS id 1 is already taken (line 13, column 6)"},
      {"[[peer]]\nname = \"PC\"\nid = 301\n",
       "16:8: peer or gateway name `PC` is already taken (line 5, column 8)"},
      {"[[peer]]\nname = \"k-gateway\"\nid = 301\n",
       "16:8: peer or gateway name `k-gateway` is already taken (line 12, column 8)"},
      {"gateway.name = \"pc\"\n",
       "15:16: peer or gateway name `pc` is already taken (line 5, column 8)"},
      {"[[peer]]\nname = \"p2\"\nid = 65536\n",
       "17:6: `id` must be a whole number from 1 to 65535, not 65536"},
      {"[[peer]]\nname = \"p2\"\nid = 65535\n", "none"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("mote ids and names are unique in their island, the sink included",
          "[config][GEN-06][ADR-04][ADR-07][ADR-09]") {
  const auto x = GENERATE(values<row>({
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n[[island.mote]]\nid = 2\ntype "
       "= \"c\"\nposition_m = [1, 2]\n",
       "20:6: mote id 2 is already taken (line 16, column 6)"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\nname = "
       "\"x\"\n[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [1, 2]\nname = \"X\"\n",
       "24:8: mote name `X` is already taken (line 19, column 8)"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n[[island.mote]]\nid = 3\ntype "
       "= \"c\"\nposition_m = [1, 2]\nname = \"c-2\"\n",
       "23:8: mote name `c-2` is already taken (line 15, column 1)"},
      {"[[island.mote]]\nid = 1\ntype = \"c\"\nposition_m = [1, 2]\n",
       "16:6: mote id 1 is the sink's"},
      {"sink.id = 2\n[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n",
       "17:6: mote id 2 is the sink's"},
      {"[[island.mote]]\nid = 65533\ntype = \"c\"\nposition_m = [1, 2]\n",
       "16:6: `id` must be a whole number from 1 to 65532, not 65533"},
      {"[[island.mote]]\nid = 65532\ntype = \"c\"\nposition_m = [1, 2]\n", "none"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n[[island]]\nname = \"b\"\nid = "
       "2\n[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n",
       "none"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("a mote has the type of a table or a number", "[config][GEN-06][PXY-13]") {
  const auto x = GENERATE(values<row>({
      {"[[island.mote]]\nid = 2\ntype = \"d\"\nposition_m = [1, 2]\n",
       "17:8: no mote type is called `d`: did you mean `c`?"},
      {"[[island.mote]]\nid = 2\ntype = \"lamp\"\nposition_m = [1, 2]\n",
       "17:8: no mote type is called `lamp`: there is c"},
      {"[[island.mote]]\nid = 2\ntype = 8\nposition_m = [1, 2]\n", "none"},
      {"[[island.mote]]\nid = 2\ntype = 0\nposition_m = [1, 2]\n",
       "17:8: `type` must be a whole number from 1 to 4294967295, not 0"},
      {"[[island.mote]]\nid = 2\ntype = 1.5\nposition_m = [1, 2]\n",
       "17:8: `type` must be a whole number from 1 to 4294967295, not 1.5"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("a mote to which no chain of motes leads from its sink is told", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [30, 1]\n",
       "18:14: mote `c-2` is out of reach: no chain of motes at most 30 m apart leads to its sink"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [30, 0]\n", "none"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [0, 30, 5]\n",
       "18:14: mote `c-2` is out of reach: no chain of motes at most 30 m apart leads to its sink"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [55, 0]\n"
       "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [28, 0]\n",
       "none"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [59, 0]\n"
       "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [28, 0]\n",
       "18:14: mote `c-2` is out of reach: no chain of motes at most 30 m apart leads to its sink"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("apps need what they name, and a channel of their own", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"sampler\", "
       "transducers = [\"temperature\", \"light\"] }]\n",
       "19:58: the mote has no transducer `light`; it has: temperature"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"sampler\", "
       "transducers = [\"temperature\", \"temperature\"] }]\n",
       "19:58: transducer `temperature` is already listed (line 19, column 43)"},
      {"[[island.mote]]\nid = 2\ntype = 8\nposition_m = [1, 2]\napps = [{ app = \"sampler\", "
       "transducers = [\"light\"] }]\n",
       "19:43: the mote has no transducer `light`; it has: none"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"actuator\", "
       "actuator = \"lamp\" }]\n",
       "19:40: the mote has no actuator `lamp`; it has: fan"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"actuator\", "
       "actuator = \"fan\" }, { app = \"listener\", am_type = 2 }]\n",
       "19:79: input channel 2 of the mote is already taken (line 19, column 9)"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"actuator\", "
       "actuator = \"fan\", channel = 1 }, { app = \"sampler\", transducers = [\"temperature\"] "
       "}]\n",
       "19:62: output channel 1 of the mote is already taken (line 19, column 57)"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"listener\" "
       "}, { app = \"listener\" }]\n",
       "19:31: input channel 10 of the mote is already taken (line 19, column 9)"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\nactuators = [{ name = \"x\", "
       "kind = \"relay\" }, { name = \"x\", kind = \"dimmer\" }]\n",
       "19:55: actuator `x` is already taken (line 19, column 23)"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"messenger\", "
       "text = \"x\", to = \"c-2\" }]\n",
       "19:47: `to` must be the island and the name of a mote, as in \"kitchen/climate-7\", not "
       "\"c-2\""},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"messenger\", "
       "text = \"x\", to = \"kk/c-2\" }]\n",
       "19:47: no island is called `kk`: did you mean `k`?"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"messenger\", "
       "text = \"x\", to = \"k/c-3\" }]\n",
       "19:47: no mote of island `k` is called `c-3`: did you mean `c-2`?"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"messenger\", "
       "text = \"x\", to = 2 }]\n",
       "19:47: `to` must be the island and the name of a mote, as in \"kitchen/climate-7\", not 2"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\napps = [{ app = \"messenger\", "
       "text = \"x\", to = \"k/c-2\" }]\n",
       "none"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("a mistake in a mote type is told once", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[ecology]\nname = \"t\"\nduration = \"1h\"\n[[peer]]\nname = \"pc\"\nid = "
       "300\n[mote_type.c]\ntype = 7\ntransducers.temperature = { model = \"constant\", value = 20 "
       "}\napps = [{ app = \"sampler\", transducers = [\"light\"] }]\nactuators = [{ name = "
       "\"fan\", kind = \"relay\" }]\n[[island]]\nname = \"k\"\nid = 1\n\n",
       "10:43: the mote has no transducer `light`; it has: temperature"},
      {"[ecology]\nname = \"t\"\nduration = \"1h\"\n[[peer]]\nname = \"pc\"\nid = "
       "300\n[mote_type.c]\ntype = 7\ntransducers.temperature = { model = \"constant\", value = 20 "
       "}\napps = [{ app = \"sampler\", transducers = [\"light\"] }]\nactuators = [{ name = "
       "\"fan\", kind = \"relay\" }]\n[[island]]\nname = \"k\"\nid = 1\n\n[[island.mote]]\nid = "
       "2\ntype = \"c\"\nposition_m = [1, 2]\n[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = "
       "[1, 2]\n",
       "10:43: the mote has no transducer `light`; it has: temperature"},
      {"[ecology]\nname = \"t\"\nduration = \"1h\"\n[[peer]]\nname = \"pc\"\nid = "
       "300\n[mote_type.c]\ntype = 7\ntransducers.temperature = { model = \"constant\", value = 20 "
       "}\napps = [{ app = \"sampler\", transducers = [\"light\"] }]\nactuators = [{ name = "
       "\"fan\", kind = \"relay\" }]\n[[island]]\nname = \"k\"\nid = 1\n\n[[island.mote]]\nid = "
       "2\ntype = \"c\"\nposition_m = [1, 2]\ntransducers.light = { model = \"constant\", value = "
       "1 }\n",
       "none"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after("", x.toml) == x.problem);
}

TEST_CASE("hosts are known by name", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"host = \"h1\"\n", "15:8: no host is called `h1`: there is none"},
      {"host = \"h2\"\n[[host]]\nname = \"h1\"\naddress = \"10.0.0.1\"\n",
       "15:8: no host is called `h2`: did you mean `h1`?"},
      {"host = \"h1\"\n[[host]]\nname = \"h1\"\naddress = \"10.0.0.1\"\n", "none"},
      {"host = 3\n[[host]]\nname = \"h1\"\naddress = \"10.0.0.1\"\n",
       "15:8: `host` must be the name of a host, not 3"},
      {"[[host]]\nname = \"h1\"\naddress = \"10.0.0.1\"\n[[host]]\nname = \"h1\"\naddress = "
       "\"10.0.0.1\"\n",
       "19:8: host name `h1` is already taken (line 16, column 8)"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("links lead to other peers or gateways", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"gateway.links = [\"inproc://pcc\"]\n",
       "15:18: no peer or gateway is called `pcc`: did you mean `pc`?"},
      {"gateway.links = [\"pc\"]\n", "15:18: `links` must be a link to a peer or gateway, as in "
                                     "\"inproc://kitchen-gateway\", not \"pc\""},
      {"gateway.links = [\"tcp://pc:8000\"]\n",
       "15:18: `links` must be a link to a peer or gateway, as in \"inproc://kitchen-gateway\", "
       "not \"tcp://pc:8000\""},
      {"gateway.links = [\"inproc://k-gateway\"]\n",
       "15:18: `k-gateway` cannot have a link to itself"},
      {"gateway.links = [\"inproc://pc\", \"inproc://pc\"]\n",
       "15:33: the link to `pc` is already listed (line 15, column 18)"},
      {"gateway.links = \"inproc://pc\"\n",
       "15:17: `links` must be an array in [ ], not \"inproc://pc\""},
      {"gateway.links = [\"inproc://pc\", \"inproc://pc\", \"inproc://pc\", \"inproc://pc\", "
       "\"inproc://pc\", \"inproc://pc\", \"inproc://pc\", \"inproc://pc\", \"inproc://pc\", "
       "\"inproc://pc\", \"inproc://pc\", \"inproc://pc\", \"inproc://pc\", \"inproc://pc\", "
       "\"inproc://pc\", \"inproc://pc\", \"inproc://pc\"]\n",
       "15:17: `links` must be an array of at most 16, not an array of 17"},
      {"[[peer]]\nname = \"p2\"\nid = 301\nlinks = [\"inproc://p3\"]\n[[peer]]\nname = \"p3\"\nid "
       "= 302\nlinks = [\"inproc://p2\"]\n",
       "none"},
      {"[[peer]]\nname = \"p2\"\nid = 301\nlinks = [\"inproc://p2\"]\n",
       "18:10: `p2` cannot have a link to itself"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("an island is in one air", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[island]]\nname = \"b\"\nid = 2\n[[air]]\nname = \"a\"\nislands = [\"k\", "
       "\"b\"]\n[[air]]\nname = \"a2\"\nislands = [\"k\"]\n",
       "23:12: island `k` is already in an air (line 20, column 12)"},
      {"[[island]]\nname = \"b\"\nid = 2\n[[air]]\nname = \"a\"\nislands = [\"k\", \"k\"]\n",
       "20:17: island `k` is already in an air (line 20, column 12)"},
      {"[[air]]\nname = \"a\"\nislands = [\"q\"]\n",
       "17:12: no island is called `q`: did you mean `k`?"},
      {"[[air]]\nname = \"a\"\nislands = []\n",
       "17:11: `islands` must be an array of at least 1, not an empty array"},
      {"[[island]]\nname = \"b\"\nid = 2\n[[air]]\nname = \"b\"\nislands = [\"k\"]\n",
       "19:8: air `b` has the name of an island that is not in it"},
      {"[[island]]\nname = \"b\"\nid = 2\n[[air]]\nname = \"b\"\nislands = [\"k\", \"b\"]\n",
       "none"},
      {"[[island]]\nname = \"b\"\nid = 2\nhost = \"h1\"\n[[air]]\nname = \"a\"\nislands = [\"k\", "
       "\"b\"]\n[[host]]\nname = \"h1\"\naddress = \"10.0.0.1\"\n",
       "21:17: islands `k` and `b` share an air, so they must be on one host"},
      {"[[island]]\nname = \"b\"\nid = 2\n[[air]]\nname = \"a\"\nislands = [\"k\"]\n[[air]]\nname "
       "= \"A\"\nislands = [\"b\"]\n",
       "22:8: air name `A` is already taken (line 19, column 8)"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("a proxy manager serves islands that exist", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"apps = [{ app = \"proxy_manager\", islands = [\"k\"] }]\n",
       "6:45: no island is called `k`: there is none"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(head, x.toml) == x.problem);
}

TEST_CASE("an island has at most one proxy manager", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[peer]]\nname = \"p2\"\nid = 301\napps = [{ app = \"proxy_manager\" }]\n[[peer]]\nname = "
       "\"p3\"\nid = 302\napps = [{ app = \"proxy_manager\", islands = [\"k\"] }]\n",
       "22:45: island `k` already has a proxy manager (line 18, column 9)"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}

TEST_CASE("proxies differ in name, types and tuples", "[config][GEN-06][PXY-11]") {
  const auto x = GENERATE(values<row>({
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy]]\nname = \"q\"\ntypes = [\"7..7\"]\n",
       "11:10: proxies `p` and `q` both claim type 7, with equally wide ranges (line 8, column "
       "10)"},
      {"[[proxy]]\nname = \"p\"\ntypes = [\"1..10\"]\n[[proxy]]\nname = \"q\"\ntypes = [99, "
       "\"8..17\"]\n",
       "11:14: proxies `p` and `q` both claim type 8, with equally wide ranges (line 8, column "
       "10)"},
      {"[[proxy]]\nname = \"p\"\ntypes = [\"1..10\"]\n[[proxy]]\nname = \"q\"\ntypes = [\"8..18\", "
       "5]\n",
       "none"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy]]\nname = \"p\"\ntypes = [8]\n",
       "10:8: proxy name `p` is already taken (line 7, column 8)"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy.field]]\nname = \"f\"\nchannel = "
       "1\n[[proxy.field]]\nname = \"f\"\nchannel = 1\n",
       "13:8: name `f` is already taken (line 10, column 8)"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy.field]]\nname = \"f\"\nchannel = "
       "1\n[[proxy.input]]\nname = \"f\"\nchannel = 2\nwords = { on = \"01\" }\n",
       "13:8: name `f` is already taken (line 10, column 8)"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\nproperties = { f = \"x\" }\n[[proxy.field]]\nname = "
       "\"f\"\nchannel = 1\n",
       "11:8: name `f` is already taken (line 9, column 16)"},
      {"[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy.field]]\nname = \"class\"\nchannel = 1\n",
       "10:8: `class` is a tuple that proxies set by themselves"},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(head, x.toml) == x.problem);
}

TEST_CASE("a fault hits somebody before the end", "[config][GEN-06]") {
  const auto x = GENERATE(values<row>({
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n[[fault]]\nat = \"1h1s\"\nkind "
       "= \"crash\"\nmote = \"k/c-2\"\n",
       "20:6: `at` is after the end of the run, which is at 1 h"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n[[fault]]\nat = \"1h\"\nkind = "
       "\"crash\"\nmote = \"k/c-2\"\n",
       "none"},
      {"[[island.mote]]\nid = 2\ntype = \"c\"\nposition_m = [1, 2]\n[[fault]]\nat = \"1s\"\nkind = "
       "\"crash\"\nmote = \"k/c-9\"\n",
       "22:8: no mote of island `k` is called `c-9`: did you mean `c-2`?"},
      {"[[fault]]\nat = \"1s\"\nkind = \"unplug\"\nisland = \"kitchen\"\n",
       "18:10: no island is called `kitchen`: there is k"},
      {"[[fault]]\nat = \"1s\"\nkind = \"unplug\"\nisland = \"k\"\nfor = \"0s\"\n",
       "19:7: `for` must be a time from 1 ms to 3650 d, not \"0s\""},
  }));
  CAPTURE(x.toml);
  CHECK(problem_after(island_head, x.toml) == x.problem);
}
