/* Files that are being written. Each has a temporary name, beside its own, until it is complete. */
#ifndef FXS_OUTPUT_H
#define FXS_OUTPUT_H

/* For a program to call once, as it begins: SIGHUP, SIGINT, SIGPIPE, SIGTERM, SIGXCPU and SIGXFSZ remove the temporary
   files of this process, then end it as they would have. A signal that is ignored or handled already stays so. The
   library never does this by itself: without it, or at any other signal, the temporary files stay behind. */
void fxs_output_remove_at_signals(void);

#endif
