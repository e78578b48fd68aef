/* The files that a command reads and writes: no output takes the place of one that is read, or of another output. */
#ifndef FILES_H
#define FILES_H

/* For main to call first: files that the library opens are known then. */
void files_begin(void);

/* What the command was given to read, as far as it knows the names, and what it writes; - is standard input or standard
   output, null is nothing. None has to be there. */
void files_read(const char *name);
void files_write(const char *name);

/* Where an output is a file that the command was given to read: refuse it, as is done without this; refuse it, naming
   --force; or let it be replaced. What belongs to such a file, as the pictures of an .sog folder, never is. */
enum files_force { FILES_REFUSE, FILES_REFUSE_UNFORCED, FILES_FORCED };
void files_force(enum files_force force);

/* Returns 0; or prints which output is not to be, and returns the exit status. */
int files_check(void);

#endif
