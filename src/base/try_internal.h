/* Returns the error of a call, if negative (FXS_ERR_*), from the calling function. */
#ifndef FXS_TRY_INTERNAL_H
#define FXS_TRY_INTERNAL_H

#define FXS_TRY(call) \
    do { \
        const int fxs_error = (call); \
        if (fxs_error < 0) \
            return fxs_error; \
    } while (0)

#endif
