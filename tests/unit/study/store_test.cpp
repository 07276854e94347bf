#include <fstream>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "study/store.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;
using namespace rubicon::study;

namespace {

store opened(const std::string& path) {
  auto found = store::open(path, store::access::write);
  REQUIRE(std::holds_alternative<store>(found));
  return std::get<store>(std::move(found));
}

run_result result(const std::string& key, std::uint64_t seed, double delivery) {
  return {key,
          "home.toml",
          seed,
          1.5,
          {{"loss", "0.1"}},
          {{"messages.delivery", delivery}, {"events", 12}},
          {{"delivery >= 99%", true, "100%"}, {"tuple a", std::nullopt, ""}},
          {{2.5, "every mote is joined", "kitchen/shelf: never joined"}},
          {{"energy.used_mah", 20, 0.5}, {"energy.used_mah", 40, 1}}};
}

std::string text_of(store& from, const std::string& sql) {
  const auto found = from.query(sql);
  if (const auto* why = std::get_if<std::string>(&found))
    return *why;
  std::string out;
  for (const auto& row : std::get<answer>(found).rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      out += row[i] + (i + 1 < row.size() ? "|" : "\n");
  return out;
}

} // namespace

TEST_CASE("a run that is added is there when the database is opened again", "[study]") {
  const test::scratch_folder folder;
  {
    auto all = opened(folder.file("study.db"));
    CHECK(!all.has("a"));
    all.add(result("a", 1, 0.9));
    all.add(result("b", 2, 0.8));
  }
  auto all = opened(folder.file("study.db"));
  CHECK(all.has("a"));
  CHECK(text_of(all, "SELECT key, file, seed, real_s FROM run ORDER BY seed") ==
        "a|home.toml|1|1.5\nb|home.toml|2|1.5\n");
  CHECK(text_of(all, "SELECT name, value FROM parameter WHERE run = 1") == "loss|0.1\n");
  CHECK(text_of(all, "SELECT expect, met, measured FROM expectation WHERE run = 1") ==
        "delivery >= 99%|1|100%\ntuple a||\n");
  CHECK(text_of(all, "SELECT at_s, invariant, detail FROM violation WHERE run = 2") ==
        "2.5|every mote is joined|kitchen/shelf: never joined\n");
  const std::vector<std::optional<double>> values{0.8, std::nullopt, 0.9};
  CHECK(all.values({"b", "c", "a"}, "messages.delivery") == values);
}

TEST_CASE("a run that is there is left as it is", "[study]") {
  const test::scratch_folder folder;
  auto all = opened(folder.file("study.db"));
  all.add(result("a", 1, 0.9));
  all.add(result("a", 1, 0.1));
  CHECK(text_of(all, "SELECT value FROM scalar WHERE name = 'messages.delivery'") == "0.9\n");
  all.add_parameters("a", {{"loss", "0.2"}, {"radio.loss", "0.1"}});
  all.add_parameters("nobody", {{"loss", "0.2"}});
  CHECK(text_of(all, "SELECT name, value FROM parameter") == "loss|0.1\nradio.loss|0.1\n");
}

TEST_CASE("a query reads, and is one statement", "[study]") {
  const test::scratch_folder folder;
  auto all = opened(folder.file("study.db"));
  all.add(result("a", 1, 0.9));
  CHECK(text_of(all, "DELETE FROM run") == "it would change the database");
  CHECK(text_of(all, "SELECT 1; SELECT 2") == "there is more than one statement");
  CHECK(text_of(all, "SELECT 1; ") == "1\n");
  CHECK(text_of(all, "") == "there is no statement");
  CHECK(text_of(all, "SELECT x FROM run") == "no such column: x");
  CHECK(text_of(all, "SELECT count(*) FROM run") == "1\n");
}

TEST_CASE("an answer has a limit", "[study]") {
  const test::scratch_folder folder;
  auto all = opened(folder.file("study.db"));
  const auto count = [&all](const std::string& last) {
    return std::get<answer>(
        all.query("WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " +
                  last + ") SELECT i FROM n"));
  };
  const auto full = count("100000");
  CHECK(full.rows.size() == answer::rows_max);
  CHECK(!full.has_more);
  const auto more = count("100001");
  CHECK(more.rows.size() == answer::rows_max);
  CHECK(more.has_more);
}

TEST_CASE("what is no database of a study is left alone", "[study]") {
  const test::scratch_folder folder;
  const auto why = [](const std::string& path, store::access how) {
    const auto found = store::open(path, how);
    const auto* reason = std::get_if<std::string>(&found);
    return reason == nullptr ? std::string("opened") : *reason;
  };
  CHECK(why(folder.file("none.db"), store::access::read) ==
        "cannot be opened: unable to open database file");
  std::ofstream(folder.file("text.db")) << "this is a text that is no database at all";
  CHECK(why(folder.file("text.db"), store::access::write) ==
        "cannot be used: file is not a database");
  static_cast<void>(opened(folder.file("study.db")));
  CHECK(why(folder.file("study.db"), store::access::read) == "opened");
}

TEST_CASE("all runs are read in the order in which they were added", "[study]") {
  const test::scratch_folder folder;
  auto all = opened(folder.file("study.db"));
  all.add(result("a", 7, 0.5));
  all.add(result("b", 3, 0.75));
  all.add_parameters("b", {{"range", "15m"}});
  std::vector<run_result> found;
  all.for_each_run([&](const run_result& x) { found.push_back(x); });
  REQUIRE(found.size() == 2);
  CHECK(found[0].key == "a");
  CHECK(found[0].seed == 7);
  CHECK(found[1].parameters == run_parameters{{"loss", "0.1"}, {"range", "15m"}});
  CHECK(found[1].scalars ==
        std::map<std::string, double>{{"messages.delivery", 0.75}, {"events", 12}});
}

TEST_CASE("a run keeps its series", "[study]") {
  const test::scratch_folder folder;
  auto all = opened(folder.file("study.db"));
  all.add(result("a", 7, 0.5));
  CHECK(text_of(all, "SELECT run, name, at_s, value FROM series") ==
        "1|energy.used_mah|20.0|0.5\n1|energy.used_mah|40.0|1.0\n");
}
