#include <cli/main.hpp>

#include "frost_guard.hpp"

int main(int argc, char* argv[]) {
  rubicon::config::extensions mine;
  mine.applications.add(frost_guard_kind());
  return rubicon::main(argc, argv, mine);
}
