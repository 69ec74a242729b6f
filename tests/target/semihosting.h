/* Text and exit status of a target test, through the emulator's semihosting. */
#ifndef STEADYSTEP_SEMIHOSTING_H
#define STEADYSTEP_SEMIHOSTING_H

void semihosting_write(const char *text); /* zero-terminated */
_Noreturn void semihosting_exit(int status);

#endif
