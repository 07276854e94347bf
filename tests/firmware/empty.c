/* A shared library that is no firmware. */
extern int exported;
int exported = 1;
