/* The library of another simulator inside a firmware of Rubicon: its octets are in the firmware, and each
 * mote loads a copy of them for itself. INNER_LIBRARY is its path when the firmware is compiled. */
#ifndef RUBICON_INNER_LIBRARY_H
#define RUBICON_INNER_LIBRARY_H

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <rubicon_mote.h>

__asm__(".section .rodata\n"
        ".balign 16\n"
        "inner_library:\n"
        ".incbin \"" INNER_LIBRARY "\"\n"
        "inner_library_end:\n"
        ".byte 0\n"
        ".previous\n");
extern const unsigned char inner_library[] __attribute__((visibility("hidden")));
extern const unsigned char inner_library_end[] __attribute__((visibility("hidden")));

static const struct rubicon_mote_host *host;
static void *library;

/* Returns whether it is loaded; the reason why not is in the log. */
static int load_library(void) {
  const size_t size = (size_t)(inner_library_end - inner_library);
  char path[] = "/tmp/rubicon-inner-XXXXXX";
  const int file = mkstemp(path);
  size_t written = 0;
  if (file < 0) {
    host->log(host->context, "no temporary file can be written");
    return 0;
  }
  while (written < size) {
    const ssize_t count = write(file, inner_library + written, size - written);
    if (count <= 0)
      break;
    written += (size_t)count;
  }
  close(file);
  library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  unlink(path);
  if (library == NULL)
    host->log(host->context, dlerror());
  return library != NULL;
}

/* What the library exports by this name. Sets *lacks if it is needed and not there, which is in the log. */
static void *find(const char *name, int is_needed, const char *advice, int *lacks) {
  void *found = dlsym(library, name);
  if (found == NULL && is_needed) {
    char line[120];
    snprintf(line, sizeof line, "the library exports no %s: %s", name, advice);
    host->log(host->context, line);
    *lacks = 1;
  }
  return found;
}

#endif
