/* Is installed as /usr/lib/PACKAGE/PROGRAM and starts PRIVATE/SET/PACKAGE/PROGRAM.
 *
 * SET is x86-64-v3 if the processor has it and the package contains the program for it, otherwise
 * baseline. STG_INSTRUCTION_SET in the environment names another set. The launcher calls exec, so
 * the process, its name and its signals stay the same. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../cmake/x86_64_v3.h"

static const char *best_set(void) { return stg_has_x86_64_v3() ? "x86-64-v3" : "baseline"; }

/* Writes the path of the program to `target`. The file need not exist. */
static void locate(char *target, const char *set, const char *program) {
  if (snprintf(target, PATH_MAX, "%s/%s/%s", PRIVATE, set, program) >= PATH_MAX) target[0] = '\0';
}

int main(int argc, char **argv) {
  char self[PATH_MAX], target[PATH_MAX];
  ssize_t length = readlink("/proc/self/exe", self, sizeof(self) - 1);
  (void)argc;
  if (length <= 0) {
    perror("stg: /proc/self/exe");
    return 126;
  }
  self[length] = '\0';
  /* The last two parts of the path are the package and the program. */
  char *program = strrchr(self, '/');
  while (program > self && program[-1] != '/') --program;

  const char *wanted = getenv("STG_INSTRUCTION_SET");
  if (wanted != NULL && wanted[0] != '\0') {
    if (strcmp(wanted, "baseline") != 0 && strcmp(wanted, best_set()) != 0) {
      fprintf(stderr, "stg: STG_INSTRUCTION_SET: this processor has no '%s'\n", wanted);
      return 2;
    }
    locate(target, wanted, program);
  } else {
    locate(target, best_set(), program);
    if (access(target, X_OK) != 0) locate(target, "baseline", program);
  }
  execv(target, argv);
  fprintf(stderr, "stg: ");
  perror(target);
  return 126;
}
