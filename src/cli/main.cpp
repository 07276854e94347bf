#include "cli/main.hpp"

int main(int argc, char* argv[]) {
  return rubicon::main(argc, argv);
}
