#include <string>

#include "peis/tuples/key.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {

TEST_CASE("patterns match part by part and without case", "[peis][TUP-03]") {
  const auto [pattern, name, expected] =
      GENERATE(table<std::string, std::string, bool>({{"a.*.c", "a.b.c", true},
                                                      {"a.*.c", "a.b.b.c", false},
                                                      {"a.*", "a.b.c", false},
                                                      {"A.b", "a.B", true},
                                                      {"a.b", "a.c", false},
                                                      {"", "x.y.z", true},
                                                      {"*", "x", true},
                                                      {"*", "x.y", false},
                                                      {"*.*", "x.", true},
                                                      {"a.", "a.", true},
                                                      {"a", "a.", false},
                                                      {"*.b", "a.b", true},
                                                      {"a..c", "a..c", true},
                                                      {"a.*.c", "a..c", true}}));
  CHECK(key::parse(pattern)->matches(*key::parse(name)) == expected);
}

TEST_CASE("bad keys are refused from users", "[peis][TUP-03][TUP-24]") {
  CHECK(!key::parse("a.b*"));
  CHECK(!key::parse("**"));
  CHECK(!key::parse(std::string("a\0b", 3)));
  CHECK(key::parse("1.2.3.4.5.6.7"));
  CHECK(!key::parse("1.2.3.4.5.6.7.8"));
  CHECK(key::parse(std::string(127, 'k')));
  CHECK(key::parse(std::string(128, 'k')).error() == errc::too_long);
}

TEST_CASE("keys from the wire are taken literally and cut to seven parts", "[peis][TUP-03]") {
  CHECK(!key::from_wire("x*")->is_pattern());
  CHECK(key::from_wire("*.b")->is_pattern());
  CHECK(key::from_wire("1.2.3.4.5.6.7.8.9")->text() == "1.2.3.4.5.6.7");
  CHECK(key::from_wire("")->any());
}

TEST_CASE("a prototype matches by owner, MIME type and value as well", "[peis][TUP-08]") {
  tuple x;
  x.owner = x.creator = peer_id{3};
  x.name = *key::parse("a.b");
  x.mimetype = "text/plain";
  x.value = payload(bytes{'O', 'n', 0, 'x'});
  prototype wanted;
  CHECK(wanted.matches(x));
  wanted.owner = peer_id{3};
  wanted.mimetype = "text/plain";
  wanted.value = payload(bytes{'o', 'N', 0, 'y'}); // without case, up to the first NUL
  CHECK(wanted.matches(x));
  wanted.mimetype = "text/html"; // a real kernel would call this a match (peis-wire.md 15.7)
  CHECK(!wanted.matches(x));
}

} // namespace rubicon::peis
