#include "lanes_avx2.h"
#include "bin_body.h"
#include "x86.h"

FXS_X86_BIN(avx2)
{
    bin(view, splats, bounds, count, boxes);
}
