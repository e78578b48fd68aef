/* Attributes and encodings of the columns of a .rad file. */
#ifndef FXS_RAD_INTERNAL_H
#define FXS_RAD_INTERNAL_H

enum {
    FXS_RAD_CENTER, FXS_RAD_ALPHA, FXS_RAD_RGB, FXS_RAD_SCALES, FXS_RAD_ORIENTATION, FXS_RAD_SH1, FXS_RAD_SH2,
    FXS_RAD_SH3, FXS_RAD_CHILD_COUNT, FXS_RAD_CHILD_START, FXS_RAD_SH_LABEL, FXS_RAD_SH1_CODE, FXS_RAD_SH2_CODE,
    FXS_RAD_SH3_CODE, FXS_RAD_PROPERTIES
};

enum {
    FXS_RAD_F32, FXS_RAD_F16, FXS_RAD_F32_LEBYTES, FXS_RAD_F16_LEBYTES, FXS_RAD_R8, FXS_RAD_R8_DELTA, FXS_RAD_S8,
    FXS_RAD_S8_DELTA, FXS_RAD_LN_0R8, FXS_RAD_LN_F16, FXS_RAD_OCT88R8, FXS_RAD_U16, FXS_RAD_U32, FXS_RAD_ENCODINGS
};

typedef struct fxs_rad_property {
    const char *name;
    int numbers;
    unsigned encodings;
} fxs_rad_property;

typedef struct fxs_rad_encoding {
    const char *name;
    int width;                     /* size of a number in bytes */
} fxs_rad_encoding;

extern const fxs_rad_property fxs_rad_properties[FXS_RAD_PROPERTIES];
extern const fxs_rad_encoding fxs_rad_encodings[FXS_RAD_ENCODINGS];

#define FXS_RAD_E 2.718281828459045    /* Euler's number e, which the coding of opacities above 1 uses */

#endif
