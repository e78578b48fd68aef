"""The version of the library that this package is for: FXS_VERSION of src/include/fixsplat/fixsplat.h."""

VERSION = "1.0.0"
