// What a main function of one's own calls (docs/applications.md):
//   int main(int argc, char* argv[]) { return rubicon::main(argc, argv, what_it_brings_along); }
#pragma once

#include "config/load.hpp"

namespace rubicon {

/// The binary: every role, every command (GEN-01). @returns the exit status of the process
int main(int argc, char* argv[], const config::extensions& known = {});

} // namespace rubicon
