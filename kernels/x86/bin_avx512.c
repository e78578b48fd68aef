#include "lanes_avx512.h"
#include "bin_body.h"
#include "x86.h"

FXS_X86_BIN(avx512)
{
    bin(view, splats, bounds, count, boxes);
}
