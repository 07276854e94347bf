// Memory in large pages, for ecologies of many motes: with small ones a tenth of the time and more
// goes into page faults and tables.
#pragma once

#include <cstddef>

namespace rubicon::io {

/// This process is about to allocate so many octets in small pieces: the allocator takes the
/// addresses for them at once, which costs no memory before they are used, and asks the system for
/// large pages there. Where the allocator or the system cannot do that, nothing changes. glibc's
/// setting glibc.malloc.hugetlb, which can only be given from outside, does the same for all
/// memory.
/// @returns whether large pages were requested
bool expect_memory(std::size_t octets);

} // namespace rubicon::io
