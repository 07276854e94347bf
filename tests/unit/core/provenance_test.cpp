#include <string>
#include <vector>

#include "core/account/provenance.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

class sample_source : public provenance_source {
public:
  [[nodiscard]] std::uint64_t begin(std::string_view what, std::uint64_t id) override {
    begun.push_back(std::string(what) + ' ' + std::to_string(id) + ' ' +
                    std::to_string(provenance().number()));
    return 100 + begun.size();
  }

  [[nodiscard]] message_ledger* ledger() override { return nullptr; }
  [[nodiscard]] std::string_view place() const override { return "mote/a/b"; }
  [[nodiscard]] instant time() const override { return {}; }

  std::vector<std::string> begun;
};

struct waiting {
  int content = 0;
  provenance from = {};

  friend bool operator==(const waiting&, const waiting&) = default;
};

} // namespace

TEST_CASE("nothing has a number while nothing is recorded", "[core]") {
  CHECK(provenance().number() == 0);
  CHECK(provenance::begin("message").number() == 0);
  const turn_of no_actor(nullptr);
  CHECK(provenance().number() == 0);
}

TEST_CASE("what waits keeps what was handled when it was made", "[core]") {
  sample_source who;
  waiting first;
  {
    const turn_of turn(&who);
    turn_of::handles(7, {});
    first = {1};
    turn_of::handles(8, {});
    const waiting second{1};
    CHECK(first.from.number() == 7);
    CHECK(second.from.number() == 8);
    CHECK(first == second); // it is no part of a value
  }
  CHECK(provenance().number() == 0);
  CHECK(first.from.number() == 7);
}

TEST_CASE("what is done for a thing that has waited comes from where that came from", "[core]") {
  sample_source who;
  const turn_of turn(&who);
  turn_of::handles(7, {});
  const waiting x{1};
  turn_of::handles(9, {});
  {
    const acting_on its(x.from);
    CHECK(provenance().number() == 7);
    {
      const acting_on nothing(provenance::none());
      CHECK(provenance().number() == 0);
    }
    CHECK(waiting{2}.from.number() == 7);
  }
  CHECK(provenance().number() == 9);
}

TEST_CASE("what begins has a number of its own, and a cause", "[core]") {
  sample_source who;
  const turn_of turn(&who);
  turn_of::handles(7, {});
  const acting_on message(provenance::begin("message"));
  const acting_on attempt(provenance::begin("attempt", 3));
  CHECK(provenance().number() == 102);
  CHECK(who.begun == std::vector<std::string>{"message 0 7", "attempt 3 101"});
}
