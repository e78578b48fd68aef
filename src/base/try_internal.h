/* A macro that calls a function. If the call fails with a negative FXS_ERR_*, the calling function returns this
   error. */
#ifndef FXS_TRY_INTERNAL_H
#define FXS_TRY_INTERNAL_H

#define FXS_TRY(call) \
    do { \
        const int fxs_error = (call); \
        if (fxs_error < 0) \
            return fxs_error; \
    } while (0)

#endif
